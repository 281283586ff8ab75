# SPDX-License-Identifier: BSD-3-Clause
# Debian packages by cpack, when LACUNA_DEBIAN is on (preset package; Testing/Tools/package.sh):
#   lacuna      plugins, libraries, Python package, emulator
#   lacuna-dev  headers, kernels and what find_package(Lacuna) reads
#   lacuna-doc  examples and, if it was built before (Documentation/build-site.sh), the site
if (NOT LACUNA_WITH_PARAVIEW)
  message(FATAL_ERROR "The Debian packages are for ParaView: LACUNA_DEBIAN needs LACUNA_WITH_PARAVIEW")
endif ()
set(LACUNA_PACKAGE_CONTACT "The Lacuna developers <lacuna@example.org>" CACHE STRING
  "Who answers for the packages: name and mail address")
set(LACUNA_SITE "${CMAKE_SOURCE_DIR}/build/site/html" CACHE PATH
  "The site to be put into lacuna-doc")
set(debian "${CMAKE_CURRENT_LIST_DIR}/Debian")
set(made "${CMAKE_CURRENT_BINARY_DIR}/Debian")
file(MAKE_DIRECTORY "${made}")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # each package has its own
set(CPACK_PACKAGE_CONTACT "${LACUNA_PACKAGE_CONTACT}")
set(CPACK_PACKAGING_INSTALL_PREFIX "${CMAKE_INSTALL_PREFIX}")
set(CPACK_OUTPUT_FILE_PREFIX "${CMAKE_BINARY_DIR}")
set(CPACK_STRIP_FILES ON)
set(CPACK_PRE_BUILD_SCRIPTS "${debian}/before-packing.cmake")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# 1~debian12, 1~debian13, 1 (unstable): a system that is upgraded gets the packages of its new version.
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
file(STRINGS /etc/os-release system_id REGEX "^ID=")
file(STRINGS /etc/os-release system_version REGEX "^VERSION_ID=")
if (system_version)
  string(REGEX REPLACE "^ID=|\"" "" system_id "${system_id}")
  string(REGEX REPLACE "^VERSION_ID=|\"" "" system_version "${system_version}")
  string(APPEND CPACK_DEBIAN_PACKAGE_RELEASE "~${system_id}${system_version}")
endif ()
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_COMPONENTS_ALL runtime python Unspecified development documentation)
set(CPACK_COMPONENT_RUNTIME_GROUP lacuna)
set(CPACK_COMPONENT_PYTHON_GROUP lacuna)
set(CPACK_COMPONENT_UNSPECIFIED_GROUP lacuna)
set(CPACK_COMPONENT_DEVELOPMENT_GROUP dev)
set(CPACK_COMPONENT_DOCUMENTATION_GROUP doc)

# Debian's Python has one version; the wrappers are made for it.
math(EXPR next_python "${Python3_VERSION_MINOR} + 1")

set(CPACK_DEBIAN_LACUNA_PACKAGE_NAME lacuna)
set(CPACK_DEBIAN_LACUNA_PACKAGE_SECTION science)
set(CPACK_DEBIAN_LACUNA_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=")
string(JOIN ", " CPACK_DEBIAN_LACUNA_PACKAGE_DEPENDS
  "python3 (>= 3.${Python3_VERSION_MINOR}~)" "python3 (<< 3.${next_python}~)"
  python3-paraview python3-numpy)
set(CPACK_DEBIAN_LACUNA_PACKAGE_SUGGESTS "lacuna-doc, lacuna-dev")
set(recommended python3-matplotlib) # writes reports as PDF; Qt's SVG shows icons
if (LACUNA_WITH_QT AND lacuna_qt STREQUAL "Qt5")
  list(APPEND recommended libqt5svg5)
elseif (LACUNA_WITH_QT)
  list(APPEND recommended qt6-svg-plugins)
endif ()
if (LACUNA_HAS_FFMPEG) # loaded when a camera or a screen is opened
  file(REAL_PATH "${LACUNA_FFMPEG_avdevice}" avdevice)
  string(REGEX MATCH "\\.so\\.([0-9]+)" avdevice "${avdevice}")
  list(APPEND recommended "libavdevice${CMAKE_MATCH_1}")
endif ()
list(JOIN recommended ", " CPACK_DEBIAN_LACUNA_PACKAGE_RECOMMENDS)
set(CPACK_DEBIAN_LACUNA_PACKAGE_CONTROL_EXTRA
  "${debian}/control/postinst" "${debian}/control/prerm" "${debian}/control/postrm"
  "${debian}/control/triggers")
set(CPACK_DEBIAN_LACUNA_DESCRIPTION
"ParaView plugin: surfaces from incomplete medical volume data
Lacuna makes surfaces from medical volume data that is irregular or
incomplete. Tracked freehand ultrasound becomes a volume, a closed surface and
a measurement; a skull CT becomes a depth map whose hole is filled by radial
basis functions, an implant plate, a mould and a milling program.

It has the plugins for Debian's ParaView, the Python package lacuna for
pvpython, the libraries, and an emulator of a FASTRAK tracker.

It is research software, not a medical device.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME lacuna-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
# besides paraview-dev, what ParaView's CMake package looks for with the components that Lacuna's names;
# then what kernels are linked with
set(kernel_libraries libopenblas-pthread-dev) # whose path the targets name
if (LACUNA_HAS_OPENIGTLINK)
  list(APPEND kernel_libraries libopenigtlink-dev)
endif ()
if (LACUNA_HAS_SERIALPORT)
  list(APPEND kernel_libraries libserialport-dev)
endif ()
if (LACUNA_HAS_FFMPEG)
  list(APPEND kernel_libraries libavformat-dev libavcodec-dev libswscale-dev libavutil-dev)
endif ()
if (NOT VTK_DIR MATCHES "paraview") # ParaView 6.1 uses Debian's VTK, and paraview-dev does not bring its headers
  list(APPEND kernel_libraries libvtk9-qt-dev)
endif ()
math(EXPR next_paraview "${ParaView_VERSION_MINOR} + 1")
string(JOIN ", " CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
  "lacuna (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})"
  "paraview-dev (>= ${ParaView_VERSION_MAJOR}.${ParaView_VERSION_MINOR})"
  "paraview-dev (<< ${ParaView_VERSION_MAJOR}.${next_paraview}~)"
  libopenmpi-dev libdouble-conversion-dev libpugixml-dev libpython3-dev zlib1g-dev
  ${kernel_libraries})
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "cmake, lacuna-doc")
set(CPACK_DEBIAN_DEV_DESCRIPTION
"ParaView plugin: C++ headers and CMake package of Lacuna
What find_package(Lacuna) and the compiler need to use Lacuna's VTK classes,
and the kernels without VTK as static libraries.

See the package lacuna.")

set(CPACK_DEBIAN_DOC_PACKAGE_NAME lacuna-doc)
set(CPACK_DEBIAN_DOC_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOC_PACKAGE_SUGGESTS lacuna)
set(CPACK_DEBIAN_DOC_PACKAGE_CONTROL_EXTRA "${debian}/control-doc/prerm")
set(CPACK_DEBIAN_DOC_DESCRIPTION
"ParaView plugin: user guide, examples and C++ reference of Lacuna
The site of Lacuna, to be read by a web browser from disk, and its examples:
Python scripts and state files of ParaView.

See the package lacuna.")

# /usr/share/doc, as each package must have it
file(READ "${CMAKE_SOURCE_DIR}/LICENSE" license)
string(REGEX REPLACE "^[^\n]*\n\n[^\n]*\n\n" "" license "${license}") # title and owner, said before
string(REGEX REPLACE "\n+$" "" license "${license}")
string(REPLACE "\n\n" "\n.\n" license "${license}")
string(REPLACE "\n" "\n " license " ${license}")
configure_file("${debian}/copyright.in" "${made}/copyright" @ONLY)
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC) # of SOURCE_DATE_EPOCH, if set
configure_file("${debian}/changelog.in" "${made}/changelog.Debian" @ONLY)
configure_file("${CMAKE_SOURCE_DIR}/CHANGELOG.md" "${made}/changelog" COPYONLY)
foreach (name IN ITEMS changelog changelog.Debian)
  execute_process(COMMAND gzip -9nf "${made}/${name}" COMMAND_ERROR_IS_FATAL ANY)
endforeach ()
foreach (package IN ITEMS lacuna lacuna-dev lacuna-doc)
  set(component runtime)
  if (package STREQUAL "lacuna-dev")
    set(component development)
  elseif (package STREQUAL "lacuna-doc")
    set(component documentation)
  endif ()
  install(FILES "${made}/copyright" "${made}/changelog.gz" "${made}/changelog.Debian.gz"
    DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package}" COMPONENT ${component})
  if (EXISTS "${debian}/${package}.lintian-overrides")
    install(FILES "${debian}/${package}.lintian-overrides" RENAME "${package}"
      DESTINATION "${CMAKE_INSTALL_DATADIR}/lintian/overrides" COMPONENT ${component})
  endif ()
endforeach ()
configure_file("${debian}/README.Debian.in" "${made}/README.Debian" @ONLY)
install(FILES "${made}/README.Debian"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/lacuna" COMPONENT runtime)

# ParaView's programs read which plugins there are from a file paraview.conf. That of Debian's later than 5.11 names a folder
# for plugins of others, which gets links; where Debian has none, this package brings one beside the programs.
set(plugin_folder)
file(GLOB own_list "${CMAKE_INSTALL_FULL_LIBDIR}/paraview-${ParaView_VERSION_MAJOR}.${ParaView_VERSION_MINOR}/paraview.conf")
if (own_list)
  file(STRINGS "${own_list}" plugin_folder REGEX "^/.*/plugins$")
endif ()
if (plugin_folder)
  foreach (plugin IN LISTS lacuna_plugins)
    file(RELATIVE_PATH library "${plugin_folder}"
      "${CMAKE_INSTALL_FULL_LIBDIR}/${PARAVIEW_PLUGIN_SUBDIR}/${plugin}/${plugin}.so")
    file(CREATE_LINK "${library}" "${made}/${plugin}.so" SYMBOLIC)
    install(FILES "${made}/${plugin}.so" DESTINATION "${plugin_folder}" COMPONENT runtime)
  endforeach ()
else ()
  file(WRITE "${made}/paraview.conf"
    "${CMAKE_INSTALL_FULL_LIBDIR}/${PARAVIEW_PLUGIN_SUBDIR}/lacuna.plugins.xml\n")
  install(FILES "${made}/paraview.conf" DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime)
endif ()

set(page "${made}/lacuna-fastrak-emulator.1.gz")
add_custom_command(OUTPUT "${page}"
  COMMAND "${CMAKE_COMMAND}" "-DPROGRAM=$<TARGET_FILE:lacuna-fastrak-emulator>"
    "-DVERSION=${PROJECT_VERSION}" "-DPAGE=${page}"
    "-DDESCRIPTION=emulates a Polhemus FASTRAK tracker and an ultrasound scanner"
    -P "${debian}/manual.cmake"
  DEPENDS lacuna-fastrak-emulator "${debian}/manual.cmake" VERBATIM)
add_custom_target(LacunaManual ALL DEPENDS "${page}")
install(FILES "${page}" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT runtime)

install(DIRECTORY "${CMAKE_SOURCE_DIR}/Documentation/Examples/"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/lacuna-doc/examples" COMPONENT documentation
  PATTERN __pycache__ EXCLUDE)
if (EXISTS "${LACUNA_SITE}/index.html")
  install(DIRECTORY "${LACUNA_SITE}/"
    DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/lacuna-doc/html" COMPONENT documentation)
  install(FILES "${debian}/lacuna-doc.doc-base" RENAME lacuna-doc
    DESTINATION "${CMAKE_INSTALL_DATADIR}/doc-base" COMPONENT documentation)
else ()
  message(STATUS "No site at ${LACUNA_SITE}: lacuna-doc will have the examples only")
endif ()
include(CPack)
