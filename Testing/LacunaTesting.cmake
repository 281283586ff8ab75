# SPDX-License-Identifier: BSD-3-Clause
# Helpers that declare tests.

# What .ci/run repeats with sanitizers (label sanitize): tests of what takes files and streams of others.
add_custom_target(LacunaSanitizeTests)

# lacuna_test_program(<target>)
# A third quicker to compile, hardly slower to run: what takes long in tests is in the kernels. Once more
# by half with the fuzz targets, whose few tests CI builds.
function (lacuna_test_program target)
  target_include_directories(${target} PRIVATE "${CMAKE_SOURCE_DIR}/Testing")
  set(level -O1)
  if (LACUNA_SANITIZE MATCHES "fuzzer")
    set(level -O0)
  endif ()
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release,RelWithDebInfo>:${level}>)
endfunction ()

# lacuna_test_headers(<target> <header>... LIBRARIES <target>...)
# Headers for all test programs that lacuna_use_headers names: a third to a half of what these tests take to
# compile.
function (lacuna_test_headers target)
  cmake_parse_arguments(arg "" "" "LIBRARIES" ${ARGN})
  set(source "${CMAKE_BINARY_DIR}/Testing/${target}.cxx")
  file(CONFIGURE OUTPUT "${source}" CONTENT "int main() {}\n")
  add_executable(${target} "${source}") # with the options of programs
  target_link_libraries(${target} PRIVATE ${arg_LIBRARIES})
  lacuna_test_program(${target})
  lacuna_precompile(${target} ${arg_UNPARSED_ARGUMENTS})
endfunction ()

lacuna_test_headers(LacunaKernelTestHeaders
  gtest/gtest.h
  algorithm array atomic chrono cmath cstring fstream functional limits random sstream stdexcept
  string thread vector
  LIBRARIES GTest::gtest)

# lacuna_module_test_program(<target>)
# A test program that uses VTK.
function (lacuna_module_test_program target)
  lacuna_test_program(${target})
  if (NOT TARGET LacunaModuleTestHeaders)
    lacuna_test_headers(LacunaModuleTestHeaders
      vtkCallbackCommand.h vtkDoubleArray.h vtkFieldData.h vtkFloatArray.h vtkImageData.h
      vtkInformation.h vtkMatrix3x3.h vtkNew.h vtkPointData.h vtkPoints.h vtkPolyData.h
      vtkSmartPointer.h vtkStreamingDemandDrivenPipeline.h vtkStringArray.h vtkTable.h
      vtkUnsignedCharArray.h
      algorithm cmath cstring fstream functional limits sstream string vector
      LIBRARIES VTK::CommonCore VTK::CommonDataModel VTK::CommonExecutionModel)
  endif ()
  lacuna_use_headers(${target} LacunaModuleTestHeaders)
endfunction ()

# lacuna_test_cxx_executable(<target> <name of the list of tests> [source...])
# Of a module's Testing/Cxx, see vtk_add_test_cxx.
function (lacuna_test_cxx_executable target)
  vtk_test_cxx_executable(${target} ${ARGN})
  lacuna_module_test_program(${target})
endfunction ()

# lacuna_add_kernel_test(<name> [SANITIZE] [REAL_TIME] [SHARDS <number>] SOURCES <file>... LIBRARIES <target>...)
# A GoogleTest program without VTK, in ctest as Kernel.<name>. SANITIZE: see above. REAL_TIME: see
# lacuna_tests_in_real_time. SHARDS: so many of its tests run at once, since they mostly wait or take long.
function (lacuna_add_kernel_test name)
  cmake_parse_arguments(arg "SANITIZE;REAL_TIME" "SHARDS" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(Test${name}Kernel ${arg_SOURCES})
  target_link_libraries(Test${name}Kernel PRIVATE ${arg_LIBRARIES} GTest::gtest GTest::gtest_main)
  target_compile_definitions(Test${name}Kernel PRIVATE LACUNA_TEST_DATA="${LACUNA_TEST_DATA}")
  lacuna_test_program(Test${name}Kernel)
  lacuna_use_headers(Test${name}Kernel LacunaKernelTestHeaders)
  set(command)
  if (NOT arg_REAL_TIME)
    set(command ${LACUNA_BESIDE_REAL_TIME})
  endif ()
  if (arg_SHARDS)
    list(APPEND command "${CMAKE_SOURCE_DIR}/Testing/Tools/shards.sh" ${arg_SHARDS})
  endif ()
  add_test(NAME Kernel.${name} COMMAND ${command} "$<TARGET_FILE:Test${name}Kernel>")
  set_tests_properties(Kernel.${name} PROPERTIES LABELS "kernel")
  if (arg_SANITIZE)
    set_property(TEST Kernel.${name} APPEND PROPERTY LABELS "sanitize")
    add_dependencies(LacunaSanitizeTests Test${name}Kernel)
  endif ()
  if (arg_REAL_TIME)
    lacuna_tests_in_real_time(Kernel.${name})
  endif ()
endfunction ()

# lacuna_tests_in_real_time(<test>...)
# Devices, frames and deadlines in real time. They run one at a time and first: they mostly wait, so other
# tests run beside them. Those yield the processor: their commands begin with LACUNA_BESIDE_REAL_TIME.
set(LACUNA_BESIDE_REAL_TIME nice)
set(_vtk_test_cxx_pre_args ${LACUNA_BESIDE_REAL_TIME}) # what vtk_add_test_cxx begins commands with
function (lacuna_tests_in_real_time)
  set_tests_properties(${ARGN} PROPERTIES RESOURCE_LOCK real-time COST 1000)
endfunction ()

# lacuna_tests_in_interpreters(<test>...)
# Their program is not built with the sanitizer of the modules that it loads: it has the sanitizer's
# library preloaded, with that of the exceptions it watches. Its own leaks and races (Qt, Mesa, MPI) are
# not looked for.
set(lacuna_sanitizer_libraries)
if (LACUNA_SANITIZE MATCHES "address|thread")
  string(SUBSTRING "${CMAKE_MATCH_0}" 0 1 sanitizer)
  foreach (library IN ITEMS ${sanitizer}san stdc++)
    execute_process(COMMAND "${CMAKE_CXX_COMPILER}" -print-file-name=lib${library}.so
      OUTPUT_VARIABLE file OUTPUT_STRIP_TRAILING_WHITESPACE)
    list(APPEND lacuna_sanitizer_libraries "${file}")
  endforeach ()
  list(JOIN lacuna_sanitizer_libraries ":" lacuna_sanitizer_libraries)
endif ()
function (lacuna_tests_in_interpreters)
  if (lacuna_sanitizer_libraries)
    set_property(TEST ${ARGN} APPEND PROPERTY ENVIRONMENT "ASAN_OPTIONS=detect_leaks=0"
      "TSAN_OPTIONS=ignore_noninstrumented_modules=1:halt_on_error=1")
    set_property(TEST ${ARGN} APPEND PROPERTY ENVIRONMENT_MODIFICATION
      "LD_PRELOAD=path_list_prepend:${lacuna_sanitizer_libraries}")
  endif ()
endfunction ()

# lacuna_tests_with_emulated_ports(<test>...)
# In real time, with the library without which libserialport does not open the emulator's port. By its
# name, which is looked for in LD_LIBRARY_PATH: LD_PRELOAD is parted at blanks, also those of folders.
function (lacuna_tests_with_emulated_ports)
  lacuna_tests_in_real_time(${ARGN})
  set_property(TEST ${ARGN} APPEND PROPERTY ENVIRONMENT_MODIFICATION
    "LD_PRELOAD=path_list_append:$<TARGET_FILE_NAME:LacunaPseudoTerminalPorts>")
  set_property(TEST ${ARGN} APPEND PROPERTY ENVIRONMENT_MODIFICATION
    "LD_LIBRARY_PATH=path_list_prepend:$<TARGET_FILE_DIR:LacunaPseudoTerminalPorts>")
endfunction ()

# lacuna_add_paraview_test(<script.py> [REAL_TIME] [NAME <name>] [LABELS <label>...] [ARGS <argument>...])
# Runs a script of Testing/ParaView in pvpython, with the plugin of the build tree at hand: in a fork of one
# that all tests share (forked.py). In one of its own: REAL_TIME (see lacuna_tests_in_real_time), and with
# sanitizers, which forbid forks of programs with threads. A script that lacks the real data leaves with
# code 77, which counts as skipped.
function (lacuna_add_paraview_test script)
  cmake_parse_arguments(arg "REAL_TIME" "NAME" "LABELS;ARGS" ${ARGN})
  get_filename_component(name "${script}" NAME_WE)
  set(name "ParaView.${name}")
  if (arg_NAME)
    set(name "${arg_NAME}")
  endif ()
  set(pvpython "$<TARGET_FILE:ParaView::pvpython>")
  if (arg_REAL_TIME)
    set(command "${pvpython}" --force-offscreen-rendering)
  elseif (LACUNA_SANITIZE)
    set(command ${LACUNA_BESIDE_REAL_TIME} "${pvpython}" --force-offscreen-rendering)
  else ()
    find_package(Python3 REQUIRED COMPONENTS Interpreter)
    set(command "${Python3_EXECUTABLE}"
      "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/ParaView/forked.py" "${pvpython}")
  endif ()
  add_test(NAME "${name}"
    COMMAND ${command} "${CMAKE_CURRENT_SOURCE_DIR}/${script}" ${arg_ARGS})
  set_tests_properties("${name}" PROPERTIES
    LABELS "paraview;${arg_LABELS}"
    SKIP_RETURN_CODE 77
    ENVIRONMENT "LACUNA_PLUGIN=$<TARGET_FILE:LacunaPlugin>;LACUNA_TEST_DATA=${LACUNA_TEST_DATA};LACUNA_TEST_OUTPUT=${CMAKE_BINARY_DIR}/Testing/Temporary;PYTHONPATH=${CMAKE_BINARY_DIR}/${lacuna_python_destination}:${CMAKE_CURRENT_FUNCTION_LIST_DIR}/ParaView")
  lacuna_tests_in_interpreters("${name}")
  if (arg_REAL_TIME)
    lacuna_tests_with_emulated_ports("${name}")
  endif ()
endfunction ()

# lacuna_add_example_test(<folder of Documentation/Examples> <script> [ARGS <argument>...])
# Runs an example and loads its state files (Testing/ParaView/Example.py), in ctest as Example.<folder>.
function (lacuna_add_example_test topic script)
  cmake_parse_arguments(arg "" "" "ARGS" ${ARGN})
  lacuna_add_paraview_test(Example.py NAME Example.${topic} LABELS example
    ARGS "${topic}" "${script}" ${arg_ARGS})
endfunction ()

# lacuna_add_example_script(<script of Documentation/Examples> [ARGS <argument>...])
# Runs a script of an example alone (Testing/ParaView/ExampleScript.py).
function (lacuna_add_example_script script)
  cmake_parse_arguments(arg "" "" "ARGS" ${ARGN})
  get_filename_component(name "${script}" NAME_WE)
  lacuna_add_paraview_test(ExampleScript.py NAME ParaView.${name} LABELS example
    ARGS "${script}" ${arg_ARGS})
endfunction ()

# lacuna_find_cgal()
# Makes the target LacunaCGAL (header-only geometry library, for tests only) if it is installed.
function (lacuna_find_cgal)
  if (TARGET LacunaCGAL)
    return ()
  endif ()
  find_path(LACUNA_CGAL_INCLUDE_DIR CGAL/Polygon_mesh_processing/self_intersections.h)
  find_library(LACUNA_GMP gmp)
  find_library(LACUNA_MPFR mpfr)
  if (LACUNA_CGAL_INCLUDE_DIR AND LACUNA_GMP AND LACUNA_MPFR)
    add_library(LacunaCGAL INTERFACE)
    target_include_directories(LacunaCGAL SYSTEM INTERFACE "${LACUNA_CGAL_INCLUDE_DIR}")
    target_link_libraries(LacunaCGAL INTERFACE "${LACUNA_MPFR}" "${LACUNA_GMP}")
  endif ()
endfunction ()

# lacuna_find_opencascade()
# Makes the target LacunaOpenCASCADE (data exchange of the CAD kernel, for tests and benchmarks)
# if it is installed. Not through its CMake package: Debian's links libtbb, which it does not depend
# on, and sets compile definitions for whole folders.
function (lacuna_find_opencascade)
  if (TARGET LacunaOpenCASCADE)
    return ()
  endif ()
  find_path(LACUNA_OPENCASCADE_INCLUDE_DIR IGESControl_Reader.hxx PATH_SUFFIXES opencascade)
  set(libraries)
  foreach (library IN ITEMS TKIGES TKSTEP TKXSBase TKShHealing TKTopAlgo TKGeomAlgo TKBRep TKGeomBase TKG3d
      TKG2d TKMath TKernel)
    string(REGEX REPLACE "^TK" "TKDE" later "${library}") # TKIGES is TKDEIGES since OpenCASCADE 7.8
    find_library(LACUNA_OPENCASCADE_${library} NAMES ${library} ${later})
    list(APPEND libraries "${LACUNA_OPENCASCADE_${library}}")
  endforeach ()
  if (LACUNA_OPENCASCADE_INCLUDE_DIR AND NOT libraries MATCHES "NOTFOUND")
    add_library(LacunaOpenCASCADE INTERFACE)
    target_include_directories(LacunaOpenCASCADE SYSTEM INTERFACE
      "${LACUNA_OPENCASCADE_INCLUDE_DIR}")
    target_link_libraries(LacunaOpenCASCADE INTERFACE ${libraries})
  endif ()
endfunction ()
