#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Records of what was built and tested on which system, and the tables of pages made of them.

compatibility.py record --suite SUITE [--demo] [--command TEXT] [--tests OPTION...]
    writes build/compatibility/SUITE.json about build/release. --demo: the demo and README's script ran.
    --tests: what ./test.sh was given; its results are in build/compatibility/tests*.xml (JUnit, of ctest).
compatibility.py keep FILE...
    takes records over into Documentation/DeveloperGuide/compatibility.json, one for each suite, and writes the tables
compatibility.py check
    whether the tables are those of the records

Testing/Tools/chroot.sh FOLDER paraview SUITE makes a record.
"""
import argparse
import datetime
import glob
import json
import os
import re
import subprocess
import sys
import xml.etree.ElementTree

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
KEPT = os.path.join(TOP, "Documentation", "DeveloperGuide", "compatibility.json")
PAGES = {"DeveloperGuide/compatibility.md": "full", "UserGuide/which-version.md": "short"}
NAMES = {"bookworm": "Debian 12", "trixie": "Debian 13", "sid": "Debian unstable"}


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def output(*command):
    return subprocess.run(command, cwd=TOP, check=True, text=True, stdout=subprocess.PIPE).stdout.strip()


def installed(package):
    """The upstream version of an installed package."""
    return re.sub(r"^\d+:|[-+~].*$", "", output("dpkg-query", "-W", "-f=${Version}", package))


def vtk_version():
    """Of the VTK that ParaView has."""
    return output(sys.executable, "-c", "from vtkmodules.vtkCommonCore import vtkVersion; print(vtkVersion.GetVTKVersion())")


def tests(paths):
    """How many tests passed, which failed and which were skipped, by their last result."""
    last = {case.get("name"): case.get("status") for path in sorted(paths) for case in xml.etree.ElementTree.parse(path).getroot().iter("testcase")}
    return {"passed": sum(status == "run" for status in last.values()), "failed": sorted(name for name, status in last.items() if status == "fail"),
            "skipped": sorted(name for name, status in last.items() if status not in ("run", "fail"))}


def record(options):
    cache = dict(re.findall(r"^(\w+):\w+=(.*)$", read(os.path.join(TOP, "build", "release", "CMakeCache.txt")), re.MULTILINE))
    compiler = output(cache["CMAKE_CXX_COMPILER"], "-dumpfullversion")
    result = {
        "suite": options.suite, "system": NAMES.get(options.suite, options.suite), "architecture": output("dpkg", "--print-architecture"),
        "paraview": installed("paraview"), "vtk": vtk_version(),
        "qt": installed("qtbase5-dev" if cache.get("Qt5_DIR") else "qt6-base-dev"), "compiler": f"GCC {compiler}",
        "cmake": installed("cmake"), "python": output(sys.executable, "-c", "import platform; print(platform.python_version())"),
        "build": True, "demo": options.demo, "commit": output("git", "rev-parse", "--short=8", "HEAD"), "date": str(datetime.date.today()),
        "command": options.command or " ".join(["Testing/Tools/chroot.sh", "FOLDER", "paraview", options.suite, *(options.tests or [])])}
    folder = os.path.join(TOP, "build", "compatibility")
    os.makedirs(folder, exist_ok=True)
    if options.tests is not None:
        result["tests"] = dict(tests(glob.glob(os.path.join(folder, "tests*.xml"))), **{key: result[key] for key in ("commit", "date", "command")})
    with open(os.path.join(folder, f"{options.suite}.json"), "w", encoding="utf-8") as file:
        json.dump(result, file, indent=1)


def order(records):
    return sorted(records, key=lambda each: [int(part) for part in each["paraview"].split(".")])


def counts(each):
    if "tests" not in each:
        return "not run"
    found = each["tests"]
    failed, skipped = len(found["failed"]), len(found["skipped"])
    return f"{found['passed']} passed, {failed} failed, {skipped} skipped ({found['commit']}, {found['date']}, `{found['command']}`)"


def full(records):
    yield "| system | ParaView, its VTK | Qt | compiler, CMake, Python | demo (commit, date, command) | tests |"
    yield "|---|---|---|---|---|---|"
    for each in records:
        yield (f"| {each['system']}, {each['architecture']} | {each['paraview']}, {each['vtk']} | {each['qt']} | {each['compiler']}, {each['cmake']}, "
               f"{each['python']} | {'passes' if each['demo'] else 'not run'} ({each['commit']}, {each['date']}, `{each['command']}`) | {counts(each)} |")
    for each in records:
        found = each.get("tests", {"failed": []})
        if found["failed"]:
            yield ""
            yield f"Failed on {each['system']}: {', '.join(f'`{name}`' for name in found['failed'])}."


def short(records):
    yield "| your system | its ParaView | builds and runs both demos |"
    yield "|---|---|---|"
    for each in records:
        yield f"| {each['system']} | {each['paraview']} | {'yes' if each['demo'] else 'not tried'}, {each['date']} |"


def written(page, kind):
    """A page with the table between <!-- compatibility --> and <!-- end -->."""
    records = order(json.loads(read(KEPT)))
    table = "\n".join({"full": full, "short": short}[kind](records))
    return re.sub(r"(<!-- compatibility -->\n).*?(<!-- end -->)", lambda found: f"{found[1]}{table}\n{found[2]}", page, flags=re.DOTALL)


def keep(options):
    kept = {each["suite"]: each for each in json.loads(read(KEPT))} if os.path.exists(KEPT) else {}
    for path in options.files:
        each = json.loads(read(path))
        before = kept.get(each["suite"], {})
        if "tests" not in each and "tests" in before and before["paraview"] == each["paraview"]:
            each["tests"] = before["tests"]
        kept[each["suite"]] = each
    with open(KEPT, "w", encoding="utf-8") as file:
        json.dump(order(kept.values()), file, indent=1, ensure_ascii=False)
        file.write("\n")
    for name, kind in PAGES.items():
        path = os.path.join(TOP, "Documentation", name)
        text = written(read(path), kind)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)


def check(_):
    for name, kind in PAGES.items():
        page = read(os.path.join(TOP, "Documentation", name))
        if written(page, kind) != page:
            sys.exit(f"Documentation/{name}: its table is not that of compatibility.json; run Testing/Tools/compatibility.py keep")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(required=True)
    one = commands.add_parser("record")
    one.add_argument("--suite", required=True)
    one.add_argument("--demo", action="store_true")
    one.add_argument("--command", help="that ran; default: chroot.sh's")
    one.add_argument("--tests", nargs=argparse.REMAINDER)
    one.set_defaults(do=record)
    two = commands.add_parser("keep")
    two.add_argument("files", nargs="*")
    two.set_defaults(do=keep)
    commands.add_parser("check").set_defaults(do=check)
    options = parser.parse_args()
    options.do(options)


main()
