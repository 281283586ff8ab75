# SPDX-License-Identifier: BSD-3-Clause
# Included before find_package(ParaView). Debian's ParaView 5.13 and later installs its Python modules as NAME.cpython-313-….so,
# but its CMake package looks for NAME.so and stops with an error. Here such a target gets the file that exists.
# Where all files exist this does nothing; delete it when Debian has mended its packages.

# A macro, so that it sets variables of the file that defines the targets. That file unsets _IMPORT_PREFIX once its targets are
# defined, just before it looks for their files.
macro (lacuna_find_python_modules variable access value file)
  if ("${file}" MATCHES "Python[A-Za-z]*-targets\\.cmake$" AND "${access}" STREQUAL "REMOVED_ACCESS")
    foreach (lacuna_target IN LISTS _cmake_import_check_targets)
      set(lacuna_module "${_cmake_import_check_files_for_${lacuna_target}}")
      if (lacuna_module MATCHES "\\.so$" AND NOT EXISTS "${lacuna_module}")
        string(REGEX REPLACE "so$" "cpython-*.so" lacuna_module "${lacuna_module}")
        file(GLOB lacuna_module "${lacuna_module}")
        if (lacuna_module)
          set("_cmake_import_check_files_for_${lacuna_target}" "${lacuna_module}")
          set_target_properties("${lacuna_target}" PROPERTIES IMPORTED_LOCATION "${lacuna_module}")
          get_target_property(lacuna_configurations "${lacuna_target}" IMPORTED_CONFIGURATIONS)
          foreach (lacuna_configuration IN LISTS lacuna_configurations)
            set_target_properties("${lacuna_target}" PROPERTIES "IMPORTED_LOCATION_${lacuna_configuration}" "${lacuna_module}")
          endforeach ()
        endif ()
      endif ()
    endforeach ()
  endif ()
endmacro ()
variable_watch(_IMPORT_PREFIX lacuna_find_python_modules)
