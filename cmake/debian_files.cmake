# Run by CPack before it makes the packages: what Debian asks of every one besides the installed files.
string(TIMESTAMP today "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(root ${CPACK_TEMPORARY_DIRECTORY}/${component}/usr/share)
  file(WRITE ${root}/doc/${package}/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: modcal

Files: *
Copyright: 2026 the authors of modcal
License: GPL-3.0-or-later
 On Debian systems the GNU General Public License, version 3, stands in
 /usr/share/common-licenses/GPL-3.
")
  file(WRITE ${root}/doc/${package}/changelog "${package} (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium

  * Built by CPack.

 -- ${CPACK_PACKAGE_CONTACT}  ${today}
")
  file(GLOB pages ${root}/man/man1/*.1)
  execute_process(COMMAND gzip -9n ${root}/doc/${package}/changelog ${pages} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
