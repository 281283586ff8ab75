# SPDX-License-Identifier: BSD-3-Clause
# Finds the VTK to build against: ParaView's own, or a plain one. Sets lacuna_flavor.

# One list, used here and again by LacunaConfig.cmake. Never find_package(VTK) without
# COMPONENTS: that asks for every third party of every VTK module (Qt5, HDF5, ...).
set(lacuna_vtk_components
  CommonComputationalGeometry CommonCore CommonDataModel CommonExecutionModel CommonMath CommonMisc CommonSystem
  CommonTransforms FiltersCore FiltersExtraction FiltersGeneral FiltersGeometry
  FiltersSources ImagingCore ImagingGeneral IOCore IOGeometry IOImage IOXML)
if (LACUNA_WITH_PARAVIEW)
  # With COMPONENTS, Debian 12 needs few -dev packages next to paraview-dev; without, about
  # 15 more. RemotingViews brings the X11 and GLEW targets of the C++ rendering tests.
  find_package(ParaView 5.11 REQUIRED
    COMPONENTS RemotingCore RemotingServerManager RemotingViews)
  if (LACUNA_WITH_QT)
    # what ParaView's component libraries link; asking for them as COMPONENTS would ask for Qt's help
    find_package(Qt5 5.15 QUIET COMPONENTS Widgets OpenGL)
    if (NOT Qt5_FOUND)
      message(FATAL_ERROR "LACUNA_WITH_QT needs Qt 5 (Debian: qtbase5-dev libqt5opengl5-dev); "
        "turn it off to do without the buttons in ParaView's properties panel")
    endif ()
  endif ()
  set(lacuna_flavor "pv${ParaView_VERSION_MAJOR}.${ParaView_VERSION_MINOR}")
else ()
  # ParaView carries a whole VTK: it serves when no plain VTK is installed.
  file(GLOB lacuna_paraview_vtk LIST_DIRECTORIES ON
    "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/paraview-*/vtk")
  find_package(VTK 9.1 REQUIRED
    COMPONENTS ${lacuna_vtk_components}
    OPTIONAL_COMPONENTS TestingCore TestingRendering RenderingOpenGL2 InteractionStyle
      Python WrappingPythonCore
    PATHS ${lacuna_paraview_vtk})
  set(lacuna_flavor "vtk${VTK_MAJOR_VERSION}.${VTK_MINOR_VERSION}")
endif ()

# lacuna_find_libraries(<NAME> <what is lacking without it> <library>...)
# Sets LACUNA_<NAME>_LIBRARIES and LACUNA_HAS_<NAME>: ON when all are found, LACUNA_<NAME>_INCLUDE_DIR
# is, and LACUNA_WITH_<NAME> asks for them.
function (lacuna_find_libraries name lacking)
  set(libraries)
  foreach (library IN LISTS ARGN)
    find_library(LACUNA_${name}_${library} ${library})
    list(APPEND libraries "${LACUNA_${name}_${library}}")
  endforeach ()
  set(has OFF)
  if (LACUNA_WITH_${name} AND LACUNA_${name}_INCLUDE_DIR AND NOT libraries MATCHES "NOTFOUND")
    set(has ON)
  else ()
    message(STATUS "No ${name}: ${lacking}")
  endif ()
  set(LACUNA_${name}_LIBRARIES "${libraries}" PARENT_SCOPE)
  set(LACUNA_HAS_${name} "${has}" PARENT_SCOPE)
endfunction ()

# GDCM decodes compressed DICOM pixels; without it the CT Series Reader reads those that are not
# compressed, deflated or run-length encoded. Not through its CMake package: Debian's can bring the VTK that GDCM's own filters were built with.
find_path(LACUNA_GDCM_INCLUDE_DIR gdcmImage.h
  PATH_SUFFIXES gdcm-3.0 gdcm-3.1 gdcm-3.2)
lacuna_find_libraries(GDCM "the CT Series Reader will not read JPEG, JPEG-LS and JPEG 2000"
  gdcmMSFF gdcmDSED gdcmCommon)

# libserialport opens the tracker's port.
find_path(LACUNA_SERIALPORT_INCLUDE_DIR libserialport.h)
lacuna_find_libraries(SERIALPORT "trackers on serial ports cannot be opened" serialport)

# FFmpeg reads the scanner's video.
find_path(LACUNA_FFMPEG_INCLUDE_DIR libavdevice/avdevice.h PATH_SUFFIXES ffmpeg)
lacuna_find_libraries(FFMPEG "video cannot be read" avdevice avformat avcodec swscale avutil)
# loaded when it is needed: it brings some eighty others, of sound and windows
list(REMOVE_ITEM LACUNA_FFMPEG_LIBRARIES "${LACUNA_FFMPEG_avdevice}")

# libopenigtlink knows the messages of trackers and scanners of the network. Not through its CMake
# package: Debian's stops with an error under CMake 2.8 and newer when its settings are used.
find_path(LACUNA_OPENIGTLINK_INCLUDE_DIR igtl_header.h
  PATH_SUFFIXES openigtlink)
lacuna_find_libraries(OPENIGTLINK "trackers and scanners behind OpenIGTLink cannot be used"
  OpenIGTLink)
