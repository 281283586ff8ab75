#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Commands that pages name exist: scripts, benchmarks, their rows and the suites of Testing/Benchmarks/run.py. So do the rows of those suites.

check-benchmarks.py [--programs FOLDER]    of the benchmarks that were built, for their rows
"""
import argparse
import glob
import os
import re
import subprocess
import sys

os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
sys.path.insert(0, os.path.join("Testing", "Benchmarks"))
# pylint: disable=wrong-import-position
from harness import cases  # noqa: E402
from harness.rows import SUFFIXES  # noqa: E402

COMMAND = re.compile(r"\bBenchmark([A-Z]\w+)|--benchmark_filter=([^\s`]+)|\b((?:Testing|Documentation)/[\w./-]+\.(?:py|sh|cxx))\b|--only[ =]([a-z-]+)")


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def rows(program, known={}):
    """Of a program; None if it was not built or does not start."""
    if program not in known:
        path = os.path.join(options.programs or "", "Benchmark" + program)
        known[program] = None
        if options.programs and os.path.exists(path):
            done = subprocess.run([path, "--benchmark_list_tests=true"], check=False, text=True, stdout=subprocess.PIPE)
            known[program] = done.stdout.split() if done.returncode == 0 else None
    return known[program]


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--programs", help="folder")
options = parser.parse_args()
declared = set(re.findall(r"lacuna_add_benchmark\((\w+)", read("Testing/Benchmarks/CMakeLists.txt")))
suites = {suite.name for suite in cases.SUITES}
problems = []
for page in ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", *sorted(glob.glob("Documentation/**/*.md", recursive=True))]:
    text = read(page)
    program = None
    for match in COMMAND.finditer(text):
        where = f"{page}:{text.count(chr(10), 0, match.start()) + 1}"
        name, picked, path, suite = match.groups()
        if name:
            program = name
            if name not in declared:
                problems.append(f"{where}: there is no program Benchmark{name}")
        elif picked and program in declared and rows(program) is not None:
            if not any(re.search(picked, row) for row in rows(program)):
                problems.append(f"{where}: Benchmark{program} has no row {picked}")
        elif path and not os.path.exists(path):
            problems.append(f"{where}: there is no {path}")
        elif suite and suite not in suites:
            problems.append(f"{where}: run.py has no suite {suite}")
for suite in cases.SUITES:
    own = [each.ours for each in suite.comparisons] + [row for each in (*suite.scalings, *suite.threads) for _, row in each.series[0][1]]
    for row in own:  # peers may not be installed
        there = rows(row.program) if not row.program.endswith(".py") else None
        if there is not None and row.name not in {SUFFIXES.sub("", name) for name in there}:
            problems.append(f"suite {suite.name}: Benchmark{row.program} has no row {row.name}")
print("\n".join(problems), file=sys.stderr, end="\n" if problems else "")
sys.exit(1 if problems else 0)
