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
# The examples' pages are written for the project's folder: here the site lies beside them, and programs
# and libraries are found without a path.
set(examples "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/doc/usr/share/doc/lacuna-doc/examples")
file(GLOB pages "${examples}/README.md" "${examples}/*/README.md")
foreach (page IN LISTS pages)
  file(READ "${page}" text)
  string(REPLACE "    . build/release/lacuna-env.sh\n" "" text "${text}")
  string(REGEX REPLACE "(LD_PRELOAD=|    )build/release/(lib|bin)/" "\\1" text "${text}")
  string(REPLACE "pvpython Documentation/Examples/" "pvpython /usr/share/doc/lacuna-doc/examples/" text "${text}")
  string(REPLACE "cmake -S Documentation/Examples/" "cmake -S /usr/share/doc/lacuna-doc/examples/" text "${text}")
  if (EXISTS "${examples}/../html")
    string(REGEX REPLACE "\\]\\(((\\.\\./)+)(UserGuide|DeveloperGuide)/([a-z0-9-]+)\\.md"
      "](\\1html/Documentation/\\3/\\4.html" text "${text}")
    string(REGEX REPLACE "\\]\\(((\\.\\./)+)UserGuide/pictures/" "](\\1html/_images/" text "${text}")
  endif ()
  file(WRITE "${page}" "${text}")
endforeach ()
