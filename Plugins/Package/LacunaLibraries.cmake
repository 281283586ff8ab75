# SPDX-License-Identifier: BSD-3-Clause
# Finds the libraries that modules can do without. Sets LACUNA_HAS_<NAME> for each.

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

# OpenCASCADE writes STEP. Not through its CMake package: Debian's sets compile definitions for whole folders.
# Since 7.8 the library of STEP has another name.
find_path(LACUNA_OPENCASCADE_INCLUDE_DIR STEPControl_Writer.hxx PATH_SUFFIXES opencascade)
find_library(LACUNA_OPENCASCADE_TKDESTEP TKDESTEP)
set(lacuna_step TKSTEP)
if (LACUNA_OPENCASCADE_TKDESTEP)
  set(lacuna_step TKDESTEP)
endif ()
lacuna_find_libraries(OPENCASCADE "solids cannot be written as STEP"
  ${lacuna_step} TKXSBase TKTopAlgo TKBRep TKG3d TKMath TKernel)
