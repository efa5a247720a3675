# Run by CPack before it makes the package: what Debian asks of every package besides the installed files.
set(root ${CPACK_TEMPORARY_DIRECTORY}/usr/share)
file(WRITE ${root}/doc/modcal/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: modcal

Files: *
Copyright: 2026 the authors of modcal
License: GPL-3.0-or-later
 On Debian systems the GNU General Public License, version 3, stands in
 /usr/share/common-licenses/GPL-3.
")
string(TIMESTAMP today "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${root}/doc/modcal/changelog "modcal (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium

  * Built by CPack.

 -- ${CPACK_PACKAGE_CONTACT}  ${today}
")
execute_process(COMMAND gzip -9n ${root}/doc/modcal/changelog ${root}/man/man1/modcal.1 COMMAND_ERROR_IS_FATAL ANY)
