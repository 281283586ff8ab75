# SPDX-License-Identifier: BSD-3-Clause
# Language level, warnings, sanitizers and where the build tree puts its files.
set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON) # static kernels are linked into shared modules
if (NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif ()

include(GNUInstallDirs)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_BINDIR}")
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}")
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/${CMAKE_INSTALL_LIBDIR}")

# Installed modules find each other wherever the tree is moved to; those of a package are where the
# system looks.
set(lacuna_relative_rpath ON)
if (LACUNA_DEBIAN)
  set(lacuna_relative_rpath OFF)
  set(CMAKE_SKIP_INSTALL_RPATH ON)
elseif (NOT CMAKE_INSTALL_RPATH)
  set(CMAKE_INSTALL_RPATH "\$ORIGIN")
endif ()

add_compile_options(-Wall -Wextra -Wno-unused-parameter)
# The same numbers whatever the compiler's default: no silent fused multiply-add.
add_compile_options(-ffp-contract=off)
if (LACUNA_WARNINGS_AS_ERRORS)
  add_compile_options(-Werror)
  if (CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 16)
    add_compile_options(-Wno-error=nonnull) # by mistake, where a vector is given a list
  endif ()
endif ()
if (LACUNA_SANITIZE)
  # otherwise undefined behaviour is said and no test fails
  add_compile_options(-fsanitize=${LACUNA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${LACUNA_SANITIZE})
endif ()
if (LACUNA_COVERAGE)
  add_compile_options(--coverage -Wno-error=maybe-uninitialized) # which counters cause by mistake
  add_link_options(--coverage)
endif ()

# lacuna_precompile(<target> <header>...)
# Headers that many sources include, compiled once for all targets that lacuna_use_headers names. A source
# includes what it needs all the same: CMAKE_DISABLE_PRECOMPILE_HEADERS must change nothing.
function (lacuna_precompile target)
  set(headers ${ARGN})
  list(TRANSFORM headers REPLACE ".+" "<\\0>")
  target_precompile_headers(${target} PRIVATE ${headers})
  if (CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp") # for ccache
  endif ()
endfunction ()

# lacuna_use_headers(<target> <target of lacuna_precompile>)
function (lacuna_use_headers target headers)
  target_precompile_headers(${target} REUSE_FROM ${headers})
  if (CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -fpch-preprocess) # for ccache
  endif ()
endfunction ()

# lacuna_use_library_headers(<headers> <header>... LIBRARIES <target>... MODULES <module>...)
# Precompiles headers as libraries are compiled, and uses them in the modules.
function (lacuna_use_library_headers headers)
  cmake_parse_arguments(arg "" "" "LIBRARIES;MODULES" ${ARGN})
  set(source "${CMAKE_BINARY_DIR}/Headers/${headers}.cxx")
  file(CONFIGURE OUTPUT "${source}" CONTENT "")
  add_library(${headers} OBJECT "${source}")
  target_link_libraries(${headers} PRIVATE ${arg_LIBRARIES})
  lacuna_precompile(${headers} ${arg_UNPARSED_ARGUMENTS})
  foreach (module IN LISTS arg_MODULES)
    get_target_property(library ${module} ALIASED_TARGET)
    lacuna_use_headers(${library} ${headers})
  endforeach ()
endfunction ()

# lacuna_use_kernel_headers(<kernel>...)
function (lacuna_use_kernel_headers)
  lacuna_use_library_headers(LacunaKernelHeaders
    algorithm array cmath cstddef cstdint cstring functional limits memory optional sstream stdexcept string
    string_view utility vector
    MODULES ${ARGN})
endfunction ()
