#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Commands behind the figures of the pages: each one that a page quotes is there, and a section that speaks of speed quotes one.

check-benchmarks.py [folder] [--build FOLDER]    the project's folder; default: this one

Of a build also: filters of rows pick some, and patterns of ctest find tests. Programs that were not built are taken on trust.
"""
import argparse
import os
import re
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("folder", nargs="?", default=os.path.normpath(os.path.join(HERE, "..", "..")))
parser.add_argument("--build", help="a build of everything")
options = parser.parse_args()

COMMAND = re.compile(r"\bBenchmark([A-Z]\w+)|--benchmark_filter=([^\s`]+)|(?:\bctest\b|\btest\.sh\b)([^`\n]*)|\b((?:Testing|Documentation)/[\w./-]+\.(?:py|sh|cxx))\b|--only[ =]([a-z-]+)")
SPEED = re.compile(r"EPYC|processor(?:'s)? time|times as (?:fast|long)\b", re.IGNORECASE)
IS_COMMAND = re.compile(r"\bBenchmark[A-Z]\w+|\bctest\b|Testing/Benchmarks/|\.py`|`Test[A-Z]\w+")


def read(*path):
    try:
        with open(os.path.join(options.folder, *path), encoding="utf-8") as file:
            return file.read()
    except OSError:
        return ""


def pages():
    for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md"):
        yield name
    for folder, _, names in sorted(os.walk(os.path.join(options.folder, "Documentation"))):
        for name in sorted(names):
            if name.endswith(".md"):
                yield os.path.relpath(os.path.join(folder, name), options.folder)


def output(*command):
    return subprocess.run(command, check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout


def rows(program, known={}):
    """Of a program; None where it was not built."""
    if program not in known:
        path = os.path.join(options.build or "", "bin", "Benchmark" + program)
        known[program] = output(path, "--benchmark_list_tests=true").split() if options.build and os.path.exists(path) else None
    return known[program]


def tests(known=[]):
    """(name, labels) of the build's tests."""
    if not known:
        known.extend(re.findall(r"Test +#\d+: (\S+)", output("ctest", "--test-dir", options.build, "-N")))
    return known


declared = set(re.findall(r"lacuna_add_benchmark\((\w+)", read("Testing", "Benchmarks", "CMakeLists.txt")))
suites = set(re.findall(r"Suite\(\s*\"([a-z-]+)\"", read("Testing", "Benchmarks", "harness", "cases.py")))
problems = []
for page in pages():
    text = read(page)
    program = None
    for match in COMMAND.finditer(text):
        where = f"{page}:{text.count(chr(10), 0, match.start()) + 1}"
        name, filter_, ctest, path, suite = match.groups()
        if name:
            program = name
            if name not in declared:
                problems.append(f"{where}: there is no program Benchmark{name}")
        elif filter_ and program in declared and rows(program) is not None:
            if not any(re.search(filter_, row) for row in rows(program)):
                problems.append(f"{where}: no row of Benchmark{program} is picked by {filter_}")
        elif path and not os.path.exists(os.path.join(options.folder, path)):
            problems.append(f"{where}: there is no {path}")
        elif suite and suite not in suites:
            problems.append(f"{where}: run.py has no suite {suite}")
        elif ctest and options.build:
            for *quoted, bare in re.findall(r"-R +(?:\"([^\"]+)\"|'([^']+)'|(\S+))", ctest):
                wanted = "".join(quoted).replace(r"\|", "|") or bare.rstrip(".,;:)")  # tables escape the bar
                if not any(re.search(wanted, test) for test in tests()):
                    problems.append(f"{where}: no test is found by ctest -R {wanted}")
    if page.startswith(os.path.join("Documentation", "Benchmarks")) or page in ("CHANGELOG.md", "CONTRIBUTING.md"):
        continue  # made of the commands; speeds there are those of the pages
    start = 1
    for section in re.split(r"^(?=#)", text, flags=re.MULTILINE):
        speed = SPEED.search(section)
        if speed and not IS_COMMAND.search(section):
            problems.append(f"{page}:{start + section.count(chr(10), 0, speed.start())}: a figure of speed without the command that gives it")
        start += section.count("\n")
if not declared:
    problems.append(f"{options.folder} has no benchmarks")
for problem in problems:
    print(problem, file=sys.stderr)
sys.exit(1 if problems else 0)
