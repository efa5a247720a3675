# What `cmake --install` writes besides the targets: public headers, files for find_package and
# pkg-config. No path of this machine stands in them.
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/modcal)

foreach(component IN LISTS modcal_components)
  install(EXPORT modcal-${component} NAMESPACE modcal:: DESTINATION ${package})
endforeach()
configure_package_config_file(cmake/modcalConfig.cmake.in generated/modcalConfig.cmake
                              INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/generated/modcalConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/generated/modcalConfig.cmake
              ${PROJECT_BINARY_DIR}/generated/modcalConfigVersion.cmake cmake/modcal_needs.cmake
              cmake/FindLibCsv.cmake
        DESTINATION ${package})

# modcal_pkg_config(sim "Time stepping ..." REQUIRES ... LIBRARIES -l...): modcal-sim.pc
function(modcal_pkg_config component description)
  cmake_parse_arguments(ARG "" "" "REQUIRES;LIBRARIES" ${ARGN})
  list(JOIN ARG_REQUIRES ", " requires)
  list(JOIN ARG_LIBRARIES " " libraries)
  string(REGEX REPLACE "[^/]+" ".." to_prefix ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
  configure_file(cmake/modcal.pc.in generated/modcal-${component}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/generated/modcal-${component}.pc
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()
modcal_pkg_config(model "Modal model of a string" LIBRARIES -lmodcal_model
                  REQUIRES eigen3 fmt tbb fftw3 libhwy udunits)
modcal_pkg_config(io "Records in CSV and audio files" LIBRARIES -lmodcal_io -lcsv
                  REQUIRES modcal-model sndfile matio hdf5 libzip zlib)
modcal_pkg_config(sim "Simulation of a bowed string" LIBRARIES -lmodcal_sim REQUIRES modcal-model)
modcal_pkg_config(inverse "Forces at the contact from reactions" REQUIRES modcal-sim
                  LIBRARIES -lmodcal_pluck -lmodcal_identify -lmodcal_inverse)
modcal_pkg_config(calib "Calibration of the modal model" REQUIRES modcal-inverse gsl nlopt_cxx
                  LIBRARIES -lmodcal_calib -lceres -lglog)

install(CODE "set(MODCAL_SOURCE_DIR \"${PROJECT_SOURCE_DIR}\")
set(MODCAL_INCLUDE_DIR \"${CMAKE_INSTALL_INCLUDEDIR}/modcal\")")
install(SCRIPT cmake/install_headers.cmake)
