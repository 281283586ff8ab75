# SPDX-License-Identifier: BSD-3-Clause
# cmake -DBUILD=... -DSOURCE=... -DEXAMPLE=... -DWORK=... [-DPVPYTHON=...] -P embed.cmake
# Configures, builds and runs the example that embeds Lacuna: first against the build tree, then
# against an installation that was moved since, a proof that the package is relocatable; then a program of
# kernels alone against that. With PVPYTHON, ParaView's Python loads the plugin from there, too.
function (run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if (NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif ()
endfunction ()

function (build_and_run name prefix)
  file(GLOB_RECURSE config "${prefix}/LacunaConfig.cmake")
  get_filename_component(config "${config}" DIRECTORY)
  run("${CMAKE_COMMAND}" -GNinja -S "${SOURCE}" -B "${WORK}/${name}" "-DLacuna_DIR=${config}"
    "-DEXAMPLE=${EXAMPLE}" -DCMAKE_BUILD_TYPE=Release)
  run("${CMAKE_COMMAND}" --build "${WORK}/${name}")
  run("${WORK}/${name}/example/Embedding" "${WORK}/${name}")
  foreach (file IN ITEMS embedding.png embedding.igs)
    file(SIZE "${WORK}/${name}/${file}" size)
    if (size LESS 10000)
      message(FATAL_ERROR "${WORK}/${name}/${file} has ${size} bytes")
    endif ()
  endforeach ()
endfunction ()

file(REMOVE_RECURSE "${WORK}")
build_and_run(of-build "${BUILD}/lib/cmake")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${WORK}/installed")
file(RENAME "${WORK}/installed" "${WORK}/moved")
get_filename_component(project "${SOURCE}/../.." ABSOLUTE)
file(GLOB_RECURSE texts "${WORK}/moved/*.cmake" "${WORK}/moved/*.py" "${WORK}/moved/*.xml")
foreach (text IN LISTS texts)
  file(STRINGS "${text}" fixed
    REGEX "(^|-[A-Z]|-isystem|[^-A-Za-z0-9._}])(${WORK}/installed|${BUILD}|${project})([^-A-Za-z0-9._]|$)")
  if (fixed)
    message(FATAL_ERROR "${text} is for one place only: ${fixed}")
  endif ()
endforeach ()
if (NOT EXISTS "${WORK}/moved/share/doc/lacuna/LICENSE")
  message(FATAL_ERROR "an installation does not carry the licence")
endif ()
build_and_run(of-installation "${WORK}/moved")
file(GLOB_RECURSE config "${WORK}/moved/LacunaConfig.cmake")
get_filename_component(config "${config}" DIRECTORY)
run("${CMAKE_COMMAND}" -GNinja -S "${SOURCE}/kernels" -B "${WORK}/kernels" "-DLacuna_DIR=${config}"
  -DCMAKE_BUILD_TYPE=Release)
run("${CMAKE_COMMAND}" --build "${WORK}/kernels")
run("${WORK}/kernels/Kernels" "${WORK}/kernels/calibration.xml")
execute_process(COMMAND "${CMAKE_COMMAND}" -E compare_files "${WORK}/of-build/embedding.png"
  "${WORK}/of-installation/embedding.png" RESULT_VARIABLE differ)
if (differ)
  message(FATAL_ERROR "the pictures differ")
endif ()
if (PVPYTHON)
  set(maker "${BUILD}/bin/LacunaMakeCTSeries") # not without GDCM
  if (NOT EXISTS "${maker}")
    set(maker "")
  endif ()
  file(GLOB_RECURSE package "${WORK}/moved/__init__.py")
  get_filename_component(package "${package}" DIRECTORY)
  get_filename_component(package "${package}" DIRECTORY)
  run("${CMAKE_COMMAND}" -E env --unset=LACUNA_PLUGIN --unset=LD_LIBRARY_PATH --unset=PV_PLUGIN_CONFIG_FILE
    "PYTHONPATH=${package}" "${PVPYTHON}" --force-offscreen-rendering "${SOURCE}/moved.py" "${WORK}/moved" "${maker}" "${WORK}/series")
endif ()
