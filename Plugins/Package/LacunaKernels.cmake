# SPDX-License-Identifier: BSD-3-Clause
# LACUNA_KERNELS_ONLY: kernels, what is made of them alone, and their tests, with no VTK to be
# found. The commands of VTK's module system that kernels use, for libraries that are just that.

# vtk_module_add_module(<name> <as in VTK>): a static library, depending on what vtk.module says.
function (vtk_module_add_module name)
  file(READ vtk.module text)
  string(REGEX REPLACE "#[^\n]*" "" text "${text}")
  separate_arguments(words UNIX_COMMAND "${text}")
  cmake_parse_arguments(module "EXCLUDE_WRAP" "NAME;LIBRARY_NAME" "DESCRIPTION;DEPENDS" ${words})
  cmake_parse_arguments(arg "FORCE_STATIC" "" "HEADERS;PRIVATE_HEADERS;SOURCES;NOWRAP_CLASSES;PRIVATE_CLASSES"
    ${ARGN})
  if (NOT module_NAME STREQUAL name OR module_UNPARSED_ARGUMENTS OR arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "${CMAKE_CURRENT_SOURCE_DIR}/vtk.module: not understood: "
      "${module_UNPARSED_ARGUMENTS} ${arg_UNPARSED_ARGUMENTS}")
  endif ()
  set(classes ${arg_NOWRAP_CLASSES} ${arg_PRIVATE_CLASSES})
  list(TRANSFORM classes APPEND ".cxx")
  add_library(${module_LIBRARY_NAME} STATIC ${classes} ${arg_SOURCES})
  add_library(${name} ALIAS ${module_LIBRARY_NAME})
  set_property(GLOBAL APPEND PROPERTY lacuna_kernels ${name})
  # The first, where nothing is, makes commands those of VTK's modules: to ccache they are the same then.
  target_include_directories(${module_LIBRARY_NAME} PUBLIC
    "${CMAKE_CURRENT_BINARY_DIR}" "${CMAKE_CURRENT_SOURCE_DIR}")
  target_link_libraries(${module_LIBRARY_NAME} PUBLIC ${module_DEPENDS})
endfunction ()

function (vtk_module_link name)
  get_target_property(library ${name} ALIASED_TARGET)
  target_link_libraries(${library} ${ARGN})
endfunction ()

function (vtk_module_include name)
  get_target_property(library ${name} ALIASED_TARGET)
  target_include_directories(${library} ${ARGN})
endfunction ()

macro (vtk_module_find_package) # PACKAGE <name>; its variables are for the caller
  find_package(${ARGV1} REQUIRED)
endmacro ()

set(lacuna_decoder_folder "Lacuna-kernels")
file(GLOB_RECURSE lacuna_kernel_files RELATIVE "${CMAKE_SOURCE_DIR}" CONFIGURE_DEPENDS
  Filters/vtk.module Readers/vtk.module Sources/vtk.module)
list(FILTER lacuna_kernel_files INCLUDE REGEX "/Kernel/vtk\\.module$")
set(lacuna_kernel_folders ${lacuna_kernel_files})
list(TRANSFORM lacuna_kernel_folders REPLACE "/vtk\\.module$" "")
foreach (folder IN LISTS lacuna_kernel_folders)
  add_subdirectory(${folder})
endforeach ()
get_property(lacuna_kernels GLOBAL PROPERTY lacuna_kernels)
lacuna_use_kernel_headers(${lacuna_kernels})
if (BUILD_TESTING)
  foreach (folder IN LISTS lacuna_kernel_folders)
    add_subdirectory(${folder}/Testing)
  endforeach ()
endif ()
add_subdirectory(Sources/Acquisition/Emulator)
if (LACUNA_HAS_GDCM)
  add_subdirectory(Readers/CTSeries/Decoder)
endif ()
if (LACUNA_HAS_OPENCASCADE)
  add_subdirectory(Filters/Fabrication/Program)
endif ()
if (BUILD_TESTING)
  add_subdirectory(Testing/Fuzz)
endif ()
