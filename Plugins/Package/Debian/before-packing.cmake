# SPDX-License-Identifier: BSD-3-Clause
# Static libraries: kernels belong to those who develop; the client-server wrappings, which ParaView's
# functions install as well, are linked into the plugin and of no use outside.
file(GLOB libraries RELATIVE "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/lacuna"
  "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/lacuna/usr/lib/*/*.a")
foreach (library IN LISTS libraries)
  file(RENAME "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/lacuna/${library}"
    "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/dev/${library}")
endforeach ()
file(GLOB wrappings "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/dev/usr/lib/*/*CS.a")
if (wrappings)
  file(REMOVE ${wrappings})
endif ()
