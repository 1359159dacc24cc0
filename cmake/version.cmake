# version: MAJOR.MINOR.PATCH, as the firmware's own header has it.
set(version_header ${CMAKE_CURRENT_LIST_DIR}/../firmware/include/quiesce_version.h)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${version_header})
file(STRINGS ${version_header} version REGEX "^#define QUIESCE_VERSION_[A-Z]+ [0-9]")
list(TRANSFORM version REPLACE "^#define QUIESCE_VERSION_[A-Z]+ ([0-9]+).*" "\\1")
list(JOIN version "." version)
