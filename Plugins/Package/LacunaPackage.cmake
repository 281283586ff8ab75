# SPDX-License-Identifier: BSD-3-Clause
# What find_package(Lacuna COMPONENTS ...) reads, in the build tree and when installed.
include(CMakePackageConfigHelpers)
vtk_module_export_find_packages(
  CMAKE_DESTINATION "${lacuna_cmake_destination}"
  FILE_NAME         "Lacuna-vtk-module-find-packages.cmake"
  MODULES           ${lacuna_modules})
configure_package_config_file(Plugins/Package/LacunaConfig.cmake.in
  "${CMAKE_BINARY_DIR}/${lacuna_cmake_destination}/LacunaConfig.cmake"
  INSTALL_DESTINATION "${lacuna_cmake_destination}")
write_basic_package_version_file(
  "${CMAKE_BINARY_DIR}/${lacuna_cmake_destination}/LacunaConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
configure_file(Plugins/Package/LacunaParaViewPython.cmake
  "${CMAKE_BINARY_DIR}/${lacuna_cmake_destination}/LacunaParaViewPython.cmake" COPYONLY)
install(FILES
  "${CMAKE_BINARY_DIR}/${lacuna_cmake_destination}/LacunaConfig.cmake"
  "${CMAKE_BINARY_DIR}/${lacuna_cmake_destination}/LacunaConfigVersion.cmake"
  "${CMAKE_BINARY_DIR}/${lacuna_cmake_destination}/LacunaParaViewPython.cmake"
  DESTINATION "${lacuna_cmake_destination}" COMPONENT development)
if (NOT LACUNA_DEBIAN) # whose packages have a file of their own for it
  install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/lacuna" COMPONENT runtime)
endif ()
