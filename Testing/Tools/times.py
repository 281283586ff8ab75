#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the times of the last run of .ci/run (build/ci/times.tsv) into README.md and CONTRIBUTING.md, at their markers.

    times.py [MINUTES]     also the minutes of a first ./demo.sh: chroot.sh FOLDER demo prints its time
"""
import os
import re
import sys

os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
try:
    with open("build/ci/times.tsv", encoding="ascii") as file:
        rows = [line.rstrip("\n").split("\t") for line in file]
except FileNotFoundError:
    sys.exit("build/ci/times.tsv is missing: run .ci/run first")
minutes = {row[0]: float(row[1]) for row in rows}
ended = {(commit, cores): date for *_, commit, date, cores in rows}  # a run may go on over midnight
measured = " and ".join(sorted(f"commit {commit} on {date}, {cores} cores" for (commit, cores), date in ended.items()))
table = ["| stage | minutes | processor minutes | tests |", "|---|---|---|---|",
         *(f"| {name} | {clock} | {processor} | {tests} |" for name, clock, processor, tests, *_ in rows),
         f"| all | {sum(minutes.values()):.1f} | {sum(float(row[2]) for row in rows):.1f} | |", "",
         f"Measured at {measured}. Processor minutes leave out the scripts that run in forks of one ParaView."]
if len(sys.argv) > 1:
    minutes["demo"] = float(sys.argv[1])
for page in "README.md", "CONTRIBUTING.md":
    with open(page, encoding="utf-8") as file:
        text = file.read()
    text = re.sub("(<!-- times -->\n).*?(?=<!-- end -->)", lambda match: match[1] + "\n".join(table) + "\n", text, flags=re.DOTALL)
    text = re.sub(r"(<!-- minutes of (\w+) -->)[\d.]+", lambda match: f"{match[1]}{minutes[match[2]]:.0f}" if match[2] in minutes else match[0], text)
    with open(page, "w", encoding="utf-8") as file:
        file.write(text)
