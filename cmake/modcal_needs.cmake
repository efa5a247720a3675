# The parts of modcal and the packages each needs. The build reads these tables, and so does the
# installed modcalConfig.cmake: a static library leaves its packages to be linked by the user.
# NAME=module is a module of pkg-config; its target PkgConfig::MODCAL_NAME carries a prefix that the
# user's own project will not have.
set(modcal_needs_model Eigen3 fmt TBB FFTW=fftw3 HWY=libhwy UDUNITS=udunits)
set(modcal_needs_io LibCsv SNDFILE=sndfile MATIO=matio HDF=hdf5 ZIP=libzip ZLIB=zlib)
set(modcal_needs_sim "")
set(modcal_needs_inverse "")
set(modcal_needs_calib Ceres GSL=gsl NLOPT=nlopt_cxx)
set(modcal_needs_program CLI11 yaml-cpp SQLITE=sqlite3 XXHASH=libxxhash)
set(modcal_needs_build nlohmann_json) # headers that no installed header includes

# What a component stands on, the lowest first, and itself.
set(modcal_components model io sim inverse calib)
set(modcal_parts_model model)
set(modcal_parts_io model io)
set(modcal_parts_sim model sim)
set(modcal_parts_inverse model sim inverse)
set(modcal_parts_calib model sim inverse calib)

# modcal_find_needs(model sim): looks for the packages of these parts and lists in modcal_missing those
# that are not there. A macro, because imported targets belong to the folder that asks for them.
macro(modcal_find_needs)
  set(modcal_missing "")
  list(PREPEND CMAKE_MODULE_PATH ${modcal_cmake_folder})
  foreach(modcal_part ${ARGN})
    foreach(modcal_need IN LISTS modcal_needs_${modcal_part})
      if(modcal_need MATCHES "^([A-Z]+)=(.+)$")
        set(modcal_module MODCAL_${CMAKE_MATCH_1})
        set(modcal_need ${CMAKE_MATCH_2})
        find_package(PkgConfig QUIET)
        if(PKG_CONFIG_FOUND AND NOT TARGET PkgConfig::${modcal_module})
          pkg_check_modules(${modcal_module} QUIET IMPORTED_TARGET ${modcal_need})
        endif()
        if(NOT TARGET PkgConfig::${modcal_module})
          list(APPEND modcal_missing "${modcal_need} (by pkg-config)")
        endif()
      else()
        find_package(${modcal_need} QUIET)
        if(NOT ${modcal_need}_FOUND)
          list(APPEND modcal_missing ${modcal_need})
        endif()
      endif()
    endforeach()
  endforeach()
  list(POP_FRONT CMAKE_MODULE_PATH)
  list(JOIN modcal_missing ", " modcal_missing)
endmacro()
