# Flags that every target of the project is compiled with, and no target of a user's: libraries link
# modcal_flags privately and do not export it. No -march: kernels choose their instruction set at run
# time. -fcx-limited-range: std::complex products and quotients without the slow library routine
# for infinities; NaN still propagates.
add_library(modcal_flags INTERFACE)
target_include_directories(modcal_flags INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(
  modcal_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
                         -Wcast-align -Wformat=2 -Wno-missing-field-initializers)
# Clang and clang-tidy do not know GCC's own flags. -Wno-restrict, -Wno-maybe-uninitialized: GCC 12 reports
# both falsely inside std::string at -O3 (GCC bugs 105651 and 105562).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT MODCAL_TIDY)
  target_compile_options(modcal_flags INTERFACE -Wno-restrict -Wno-maybe-uninitialized
                                                -fcx-limited-range)
  # Units of many sources end before GCC has to look for memory to give back, which is a tenth of their time.
  target_compile_options(modcal_flags INTERFACE --param=ggc-min-heapsize=1000000)
endif()
# In a unit of several sources a local name may be another file's (Clang), and GCC takes its sources for
# headers, whose classes hold nothing unnamed. The preset dev warns of what shadows.
if(CMAKE_UNITY_BUILD)
  target_compile_options(
    modcal_flags INTERFACE $<$<CXX_COMPILER_ID:Clang>:-Wno-shadow> $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
if(MODCAL_WERROR)
  target_compile_options(modcal_flags INTERFACE -Werror)
endif()
if(MODCAL_SANITIZE)
  target_compile_options(modcal_flags INTERFACE -fsanitize=${MODCAL_SANITIZE} -fno-omit-frame-pointer
                                                -fno-sanitize-recover=all)
  target_link_options(modcal_flags INTERFACE -fsanitize=${MODCAL_SANITIZE})
endif()
if(MODCAL_TIDY)
  set(CMAKE_CXX_CLANG_TIDY clang-tidy)
endif()

# clang-tidy cannot read GCC's precompiled headers. Without optimization fmt turns on a little of its own
# in its headers, which GCC 12 does not turn off again after a precompiled one; Eigen then fails to compile.
if(MODCAL_TIDY OR NOT CMAKE_BUILD_TYPE MATCHES "^(Release|RelWithDebInfo|MinSizeRel)$")
  set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
endif()

# modcal_precompiled(json LINK ...): headers of cmake/precompiled that targets of these flags share.
function(modcal_precompiled name)
  cmake_parse_arguments(ARG "" "" "LINK" ${ARGN})
  set(empty ${PROJECT_BINARY_DIR}/generated/precompiled_${name}.cpp)
  file(CONFIGURE OUTPUT ${empty} CONTENT "")
  add_library(modcal_precompiled_${name} OBJECT EXCLUDE_FROM_ALL ${empty})
  target_link_libraries(modcal_precompiled_${name} PRIVATE modcal_flags ${ARG_LINK})
  target_precompile_headers(modcal_precompiled_${name} PRIVATE
                            ${PROJECT_SOURCE_DIR}/cmake/precompiled/${name}.hpp)
endfunction()

# Kernels that Highway compiles once per instruction set include themselves: each is compiled alone.
function(modcal_single)
  foreach(source IN LISTS ARGN)
    if(source MATCHES "generated|page_assets")
      continue()
    endif()
    file(STRINGS ${source} repeats REGEX "include .hwy/foreach_target.h" LIMIT_COUNT 1)
    if(repeats)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
endfunction()

# modcal_library(model COMPONENT model FOLDERS base model LINK fmt::fmt) makes the static library
# modcal_model with the alias modcal::model of every source file in and below these folders, save those
# EXCEPT names. LINK: what its headers include; PRIVATE_LINK: what its sources include; BUILD_WITH: the
# same where it is headers only, which an installed library no longer needs. COMPONENT: part of the
# package that it is installed with. PRECOMPILED: which of cmake/precompiled its files include; standard
# where it is left out.
function(modcal_library name)
  cmake_parse_arguments(ARG "" "PRECOMPILED;COMPONENT"
                        "FOLDERS;EXCEPT;SOURCES;LINK;PRIVATE_LINK;BUILD_WITH" ${ARGN})
  foreach(folder IN LISTS ARG_FOLDERS)
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${folder}/*.cpp)
    list(APPEND ARG_SOURCES ${found})
  endforeach()
  foreach(file IN LISTS ARG_EXCEPT)
    list(FILTER ARG_SOURCES EXCLUDE REGEX "/${file}$")
  endforeach()
  modcal_single(${ARG_SOURCES})
  add_library(modcal_${name} STATIC ${ARG_SOURCES})
  add_library(modcal::${name} ALIAS modcal_${name})
  target_compile_features(modcal_${name} PUBLIC cxx_std_20)
  target_include_directories(
    modcal_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                          $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/modcal>)
  list(TRANSFORM ARG_BUILD_WITH REPLACE "(.+)" "$<BUILD_INTERFACE:\\1>")
  target_link_libraries(
    modcal_${name}
    PRIVATE $<BUILD_INTERFACE:modcal_flags>
    PUBLIC ${ARG_LINK}
    PRIVATE ${ARG_PRIVATE_LINK} ${ARG_BUILD_WITH})
  if(NOT ARG_PRECOMPILED)
    set(ARG_PRECOMPILED standard)
  endif()
  target_precompile_headers(modcal_${name} REUSE_FROM modcal_precompiled_${ARG_PRECOMPILED})
  if(ARG_COMPONENT AND MODCAL_INSTALL)
    set_target_properties(modcal_${name} PROPERTIES EXPORT_NAME ${name})
    install(TARGETS modcal_${name} EXPORT modcal-${ARG_COMPONENT})
  endif()
endfunction()
