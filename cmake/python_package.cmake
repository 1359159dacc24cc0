# What the Python package carries beside its modules: compiled parts, and of the project's tree what
# it reads, at the places that both have here (quiesce/base/paths.py).
set(tree quiesce/tree)
set(builds ${tree}/build/host)

add_custom_target(python_parts DEPENDS quiesce_bench icount_plugin quiesce_plant quiesce_dampers)
install(TARGETS quiesce_bench icount_plugin COMPONENT python
        RUNTIME DESTINATION ${builds}/sim_hil LIBRARY DESTINATION ${builds}/sim_hil)
install(TARGETS quiesce_plant quiesce_dampers COMPONENT python
        LIBRARY DESTINATION ${builds}/sim_hil/python)
# Where the headers of its standard are (tools/lib/fmi.sh).
if(TARGET quiesce_fmu)
  add_dependencies(python_parts quiesce_fmu)
  install(TARGETS quiesce_fmu COMPONENT python LIBRARY DESTINATION ${builds}/targets/fmu)
endif()
install(DIRECTORY sim_hil/data COMPONENT python DESTINATION ${tree}/sim_hil)
# C that `rules compile` and `identify export` hand out, and that rules are walked with.
install(DIRECTORY firmware/base firmware/fuzzy COMPONENT python DESTINATION ${tree}/firmware
        FILES_MATCHING PATTERN *.c PATTERN *.h)
install(DIRECTORY sim_hil/damper/learned/cores COMPONENT python
        DESTINATION ${tree}/sim_hil/damper/learned)
install(DIRECTORY firmware/plants COMPONENT python DESTINATION ${tree}/firmware)
install(FILES firmware/param/parameters.toml COMPONENT python DESTINATION ${tree}/firmware/param)
install(FILES firmware/comm/quiesce.dbc COMPONENT python DESTINATION ${tree}/firmware/comm)

# What draws the page of `quiesce live`, where it was fetched (tools/lib/uplot.sh).
set(uplot ${PROJECT_SOURCE_DIR}/build/deps/uplot)
if(EXISTS ${uplot})
  install(FILES ${uplot}/uPlot.iife.min.js ${uplot}/uPlot.min.css ${uplot}/LICENSE COMPONENT python
          DESTINATION ${tree}/build/deps/uplot)
endif()

# What `quiesce hil` drives in the emulator, where somebody has built it: no compiler for this
# machine can.
set(QUIESCE_IMAGES "" CACHE PATH "Folder with the images of the preset mps2")
if(QUIESCE_IMAGES)
  file(GLOB images ${QUIESCE_IMAGES}/*_shm*.elf ${QUIESCE_IMAGES}/*_uart*.elf ${QUIESCE_IMAGES}/*_live.elf
       ${QUIESCE_IMAGES}/uart_echo.elf)
  install(FILES ${images} COMPONENT python DESTINATION ${tree}/build/mps2/targets/mps2)
endif()
