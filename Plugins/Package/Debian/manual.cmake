# SPDX-License-Identifier: BSD-3-Clause
# cmake -DPROGRAM=... -DVERSION=... -DDESCRIPTION=... -DPAGE=... -P manual.cmake
# Writes a manual page, compressed, around what PROGRAM --help prints.
execute_process(COMMAND "${PROGRAM}" --help OUTPUT_VARIABLE help RESULT_VARIABLE result)
if (NOT result EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --help failed")
endif ()
get_filename_component(name "${PROGRAM}" NAME)
string(REPLACE "\\" "\\e" help "${help}")
string(REPLACE "-" "\\-" help "${help}")
string(REGEX REPLACE "(^|\n)([.'])" "\\1\\\\&\\2" help "${help}")
string(TOUPPER "${name}" title)
string(REPLACE "-" "\\-" plain "${name}")
get_filename_component(text "${PAGE}" NAME_WLE)
get_filename_component(folder "${PAGE}" DIRECTORY)
file(WRITE "${folder}/${text}"
  ".TH ${title} 1 \"\" \"Lacuna ${VERSION}\" \"User commands\"\n"
  ".SH NAME\n${plain} \\- ${DESCRIPTION}\n"
  ".SH SYNOPSIS\n.B ${plain}\n[\\fIoption\\fR]...\n"
  ".SH DESCRIPTION\n.nf\n${help}.fi\n")
execute_process(COMMAND gzip -9nc "${folder}/${text}" OUTPUT_FILE "${PAGE}" COMMAND_ERROR_IS_FATAL ANY)
