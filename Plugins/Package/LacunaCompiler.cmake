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
