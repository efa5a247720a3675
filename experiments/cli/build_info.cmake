# Writes build_info.hpp where it has changed: run at every build, so that the commit is the one built.
execute_process(COMMAND git -C "${SOURCE_DIR}" rev-parse --short=12 HEAD OUTPUT_VARIABLE COMMIT
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
execute_process(COMMAND git -C "${SOURCE_DIR}" status --porcelain --untracked-files=no
                OUTPUT_VARIABLE CHANGES OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT COMMIT)
  set(COMMIT "unknown")
endif()
if(CHANGES)
  set(DIRTY "true")
else()
  set(DIRTY "false")
endif()
# A program is known by what it is built of: commits do not tell of new files, archives or flags.
file(GLOB_RECURSE SOURCES "${SOURCE_DIR}/libsim/*" "${SOURCE_DIR}/libinverse/*" "${SOURCE_DIR}/libcalib/*"
     "${SOURCE_DIR}/experiments/*")
list(SORT SOURCES)
set(DIGESTS "${FLAGS}")
foreach(source IN LISTS SOURCES)
  file(SHA256 "${source}" digest)
  string(APPEND DIGESTS "${digest}")
endforeach()
string(SHA256 SOURCES "${DIGESTS}")
string(SUBSTRING "${SOURCES}" 0 16 SOURCES)
# LIBRARIES: name=version,name=version
string(REPLACE "," ";" LIBRARIES "${LIBRARIES}")
list(LENGTH LIBRARIES LIBRARY_COUNT)
list(TRANSFORM LIBRARIES REPLACE "^(.*)=(.*)$" "{\"\\1\", \"\\2\"}")
list(JOIN LIBRARIES ", " LIBRARY_TABLE)
file(CONFIGURE OUTPUT "${OUTPUT}" @ONLY CONTENT [[#pragma once

#include <array>
#include <utility>

namespace modcal {

inline constexpr char kBuildVersion[] = "@VERSION@";
inline constexpr char kBuildCommit[] = "@COMMIT@";
inline constexpr bool kBuildDirty = @DIRTY@;
inline constexpr char kBuildCompiler[] = "@COMPILER@";
inline constexpr char kBuildType[] = "@BUILD_TYPE@";
inline constexpr char kBuildSources[] = "@SOURCES@";
inline constexpr std::array<std::pair<const char*, const char*>, @LIBRARY_COUNT@> kBuildLibraries = {{@LIBRARY_TABLE@}};
// Seen from the program's folder.
inline constexpr std::array kBuildConfigs = {"@INSTALLED_CONFIGS@", "@BUILD_CONFIGS@"};

}  // namespace modcal
]])
