# `cpack -G DEB` in the folder of a build: program, libraries with headers and docs as one Debian package, and
# the Python package, where it is built, as another.
# What the program needs at run time is read off it; what a program linked with the libraries needs to be
# built is suggested.
file(STRINGS ${PROJECT_SOURCE_DIR}/packages.txt development REGEX "^lib[a-z0-9.+-]+-dev$")
list(REMOVE_ITEM development libgtest-dev libgmock-dev libbenchmark-dev)
list(JOIN development ", " suggests)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME modcal)
# As Debian's own tools take them from the environment; a package for others needs a name that can be asked.
if(DEFINED ENV{DEBEMAIL})
  set(maintainer "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
else()
  set(maintainer "The authors of modcal <modcal@localhost>")
endif()
set(MODCAL_PACKAGE_MAINTAINER "${maintainer}" CACHE STRING "Maintainer of the Debian package, \"Name <address>\"")
set(CPACK_PACKAGE_CONTACT "${MODCAL_PACKAGE_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "calibrates bowed strings and identifies the force of the bow")
set(CPACK_PACKAGE_DESCRIPTION
    "modcal calibrates the modal model of a bowed string and identifies the
 friction force between bow and string from the reactions at the string's
 ends, both with standard deviations.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL Unspecified)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME modcal)
set(CPACK_DEBIAN_UNSPECIFIED_DESCRIPTION "${CPACK_PACKAGE_DESCRIPTION}")
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SUGGESTS "${suggests}")
if(MODCAL_PYTHON)
  # The module is made for one version of Python, and needs nothing of the program.
  math(EXPR next "${modcal_python_minor} + 1")
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-modcal)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "${CPACK_PACKAGE_DESCRIPTION}
 This package is for Python 3: import modcal.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= 3.${modcal_python_minor}), python3 (<< 3.${next}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "modcal, python3-matplotlib, python3-pandas, python3-scipy")
endif()
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_files.cmake)
include(CPack)
