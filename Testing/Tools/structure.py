#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Figures of the structure of the C++ sources, as a table.

    structure.py [--list FIGURE] [FOLDER]     FOLDER: another copy of the project

--list prints what is behind a figure: lone (headers with one includer), long (functions of more than 80
lines), plain (vtkLacuna*.h without a vtkObject), glue (files and functions with their lines of glue and
boilerplate) or quoted (names in quotes in the glue of classes of VTK and ParaView).

Production sources are the *.h and *.cxx of git that are in no folder Testing and not in Documentation. Lines are all
lines, lines of code those that are neither blank nor only comment.

An includer is a production source that names the header in an #include, except the header's own source
(lacunaFan.cxx for lacunaFan.h). Tests do not count; the next row is those headers that a test includes, too, or whose
class is one of VTK or Qt. A public header of a filter has no includer, and is
not counted as one with one.

A function is a block with a name and "(" before it, in a namespace or class. Its lines are those from its
declaration (not its comment) to its closing brace. Lambdas and local classes are part of the function
around them.

Glue is the lines of the files GLUE in Filters/Common. Boilerplate is, in all other files, the lines of the
functions REQUESTS, which answer VTK's requests, and those lines of RequestData that name an information object or a
class of the glue. The lists also have the names of earlier versions, so that these can be measured, too.
"""
import argparse
import collections
import os
import re
import subprocess

GLUE = re.compile(r"Filters/Common/(?:vtkL|l)acuna(Algorithm|Errors|Execution|Failure|Input|Meeting|Reading|Request|Writer|Writing)\w*\.(h|cxx)$")
REQUESTS = re.compile(r"::(RequestDataObject|RequestInformation|RequestUpdateExtent|RequestUpdateTime|ProcessRequest|Announce|Ask|GetOrigins|MakeNothing)$")
NAMED = re.compile(r"\b(vtkInformation\w*|inputVector|outputVector|inputs|outputs|vtkLacuna(Execution|Failure|Inputs|Meeting|Reading|Request|Writing))\b")
LONGEST = 80
NOT_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*', re.DOTALL | re.MULTILINE)


def blank(match):
    """Comments, strings and directives as blanks; numbers like 1'000 stay."""
    if match[0][0] == "'" and re.match(r"[0-9a-fA-F]", match.string[match.start() - 1]):
        return match[0]
    return re.sub(r"[^\n]", " ", match[0])


def functions(text):
    """Name, first line and lines of each function."""
    code = re.sub(r"vtkLacunaAlgorithmOf\((\w+)\)", r" \1", NOT_CODE.sub(blank, text))
    scopes = []  # the functions and initializers (True), namespaces and classes (False) around; name, first line
    start = 0  # of the declaration
    for mark in re.finditer(r"[{};]|(?<!:)\b(?:public|private|protected):(?!:)", code):
        inside = any(scope[0] for scope in scopes)
        if mark[0] == "{":
            head = re.sub(r"^\s*template\s*<[^{]*?>\s*(?=\w)", blank, code[start:mark.start()])
            name = re.search(r"(operator\s*[^\s(]+(?:\(\))?|[~\w]+(?:<[^()]*?>)?(?:::[~\w]+(?:<[^()]*?>)?)*)\s*\(", head)
            assigned = re.search(r"=", re.sub(r"\(.*\)|operator\s*[=!<>+*/-]+", "", head, flags=re.DOTALL))
            container = re.match(r"\s*(?:class|struct|union|enum|namespace|extern)\b[^()]*$", head)
            line = code.count("\n", 0, start + len(code[start:mark.start()]) - len(code[start:mark.start()].lstrip())) + 1
            scopes.append((not container, name[1] if name and not assigned and not inside and not container else None, line))
        elif mark[0] == "}" and scopes:
            _, name, line = scopes.pop()
            if name:
                yield name, line, code.count("\n", 0, mark.end()) - line + 2
        if not any(scope[0] for scope in scopes):
            start = mark.end()


arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("folder", nargs="?", default=os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
arguments.add_argument("--list", choices=("lone", "long", "plain", "glue", "quoted"))
options = arguments.parse_args()
os.chdir(options.folder)
listed = subprocess.run(("git", "ls-files", "*.h", "*.cxx"), capture_output=True, text=True, check=True).stdout.split()
sources = {}
for path in listed:
    if "Testing" not in path.split("/") and not path.startswith("Documentation/") and os.path.exists(path):
        with open(path, encoding="utf-8") as file:
            sources[path] = file.read()
headers = [path for path in sources if path.endswith(".h")]

includers = collections.defaultdict(list)
for path, text in sources.items():
    for name in set(re.findall(r'^\s*#\s*include\s+["<](\w+\.h)[">]', text, re.MULTILINE)):
        if os.path.splitext(os.path.basename(path))[0] != name[:-2]:
            includers[name].append(path)
lone = {path: includers[os.path.basename(path)][0] for path in headers if len(includers[os.path.basename(path)]) == 1}
tests = "\n".join(open(path, encoding="utf-8").read() for path in listed if "Testing" in path.split("/") and os.path.exists(path))
reasons = [path for path in lone if f'"{os.path.basename(path)}"' in tests or re.match("vtk|pq", os.path.basename(path))]
found = [(lines, path, first, name) for path, text in sources.items() for name, first, lines in functions(text)]
found.sort(key=lambda row: (-row[0], row[1:]))
long = [row for row in found if row[0] > LONGEST]
named = [path for path in headers if os.path.basename(path).startswith("vtkLacuna")]
plain = [path for path in named if not re.search(r"\bvtk\w*TypeMacro\(|: public Super$", sources[path], re.MULTILINE)]
glue = {path: sources[path].count("\n") for path in sources if GLUE.match(path)}
requests = [row for row in found if row[1] not in glue and REQUESTS.search(row[3])]
for lines, path, first, name in found:
    if path not in glue and name.endswith("::RequestData"):
        requests.append((sum(1 for line in sources[path].split("\n")[first - 1:first - 1 + lines] if NAMED.search(line)), path, first, name))
quoted = sorted({(name, path) for path in glue for name in re.findall(r'"((?:vtk|pq)(?!Lacuna)[A-Z]\w+)"', re.sub(r"#\s*include[^\n]*", "", sources[path]))})

if options.list == "lone":
    print(*(f"{header}: {includer}" for header, includer in sorted(lone.items())), sep="\n")
elif options.list == "long":
    print(*(f"{lines:5} {path}:{first} {name}" for lines, path, first, name in long), sep="\n")
elif options.list == "plain":
    print(*plain, sep="\n")
elif options.list == "glue":
    print(*(f"{lines:5} {path}" for path, lines in glue.items()), *(f"{lines:5} {path}:{first} {name}" for lines, path, first, name in requests), sep="\n")
elif options.list == "quoted":
    print(*(f"{name}: {path}" for name, path in quoted), sep="\n")
else:
    everything = "\n".join(sources.values())
    code = sum(1 for line in re.sub(r"//[^\n]*|/\*.*?\*/", lambda match: "\n" * match[0].count("\n"), everything, flags=re.DOTALL).split("\n") if line.strip())
    boilerplate = sum(lines for lines, *_ in requests)
    print("| figure | value |", "|---|---|",
          f"| production sources | {len(sources)} |",
          f"| their lines | {sum(text.count(chr(10)) for text in sources.values())} |",
          f"| of them code | {code} |",
          f"| headers with one includer | {len(lone)} of {len(headers)} |",
          f"| of these with a test of their own, or a class of VTK or Qt | {len(reasons)} |",
          f"| longest function | {found[0][0]} lines, `{found[0][3]}` |",
          f"| functions of more than {LONGEST} lines | {len(long)} of {len(found)} |",
          f"| `vtkLacuna*.h` without a vtkObject | {len(plain)} of {len(named)} |",
          f"| lines of glue and boilerplate | {sum(glue.values())} + {boilerplate} = {sum(glue.values()) + boilerplate} |",
          f"| names of other classes in quotes in the base | {len({name for name, _ in quoted})} |", sep="\n")
