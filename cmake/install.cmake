# What `cmake --install` puts beside other libraries: find_package(quiesce) finds quiesce::core, the
# controller, and quiesce::comm, its messages on CAN. The sizes and the choice of this build go along.
include(CMakePackageConfigHelpers)

set_target_properties(quiesce_core PROPERTIES EXPORT_NAME core)
set_target_properties(quiesce_comm PROPERTIES EXPORT_NAME comm)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/quiesce)

install(TARGETS quiesce_core quiesce_comm EXPORT quiesce COMPONENT library
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY firmware/include/ COMPONENT library DESTINATION ${QUIESCE_INSTALL_HEADERS})
file(GLOB headers firmware/comm/*.h firmware/comm/generated/*.h)
install(FILES ${headers} COMPONENT library DESTINATION ${QUIESCE_INSTALL_HEADERS}/comm)
install(FILES firmware/comm/quiesce.dbc COMPONENT library
        DESTINATION ${CMAKE_INSTALL_DATADIR}/quiesce)
install(EXPORT quiesce COMPONENT library FILE quiesce-targets.cmake NAMESPACE quiesce::
        DESTINATION ${package})

configure_package_config_file(cmake/quiesce-config.cmake.in
                              ${PROJECT_BINARY_DIR}/quiesce-config.cmake
                              INSTALL_DESTINATION ${package} NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may break what calls it.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/quiesce-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/quiesce-config.cmake
              ${PROJECT_BINARY_DIR}/quiesce-config-version.cmake
        COMPONENT library DESTINATION ${package})
