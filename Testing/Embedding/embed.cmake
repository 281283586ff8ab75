# SPDX-License-Identifier: BSD-3-Clause
# cmake -DBUILD=... -DSOURCE=... -DWORK=... -P embed.cmake
# Installs Lacuna into a folder of its own, moves that folder, then configures, builds and runs a
# program that finds it there: what an embedder does, and a proof that the package is relocatable.
function (run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if (NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif ()
endfunction ()

file(REMOVE_RECURSE "${WORK}")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${WORK}/installed")
file(RENAME "${WORK}/installed" "${WORK}/moved")
file(GLOB_RECURSE config "${WORK}/moved/*/LacunaConfig.cmake")
get_filename_component(config "${config}" DIRECTORY)
run("${CMAKE_COMMAND}" -GNinja -S "${SOURCE}" -B "${WORK}/program" "-DLacuna_DIR=${config}"
  -DCMAKE_BUILD_TYPE=Release)
run("${CMAKE_COMMAND}" --build "${WORK}/program")
run("${WORK}/program/SkullDepthMap")
