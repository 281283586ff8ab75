#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How many lines of the kernels ran: coverage.py <JSON file of gcovr> <least percentage>.

A table of the kernels, then the files below the least percentage with the lines that did not run. Fails if all together
are below it. A template counts once: a line has run if it ran in one of its instances.
"""
import collections
import json
import os
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


def read(path):
    """{file: {line: whether it ran}}"""
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    ran = collections.defaultdict(dict)
    for each in report["files"]:
        name = os.path.relpath(os.path.realpath(each["file"]), os.path.realpath(ROOT))
        for line in each["lines"]:
            if not line.get("gcovr/noncode"):
                number = line["line_number"]
                ran[name][number] = ran[name].get(number, False) or line["count"] != 0
    return ran


def ranges(numbers):
    """3-5 for lines 3, 4 and 5."""
    parts = []
    for number in sorted(numbers):
        if parts and number == parts[-1][1] + 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ", ".join(str(first) if first == last else f"{first}-{last}" for first, last in parts)


def percentage(lines):
    return 100 * sum(lines) / len(lines) if lines else 100.0


def main(path, least):
    ran = read(path)
    kernels = collections.defaultdict(list)
    for name, lines in ran.items():
        kernels[os.path.dirname(name)] += lines.values()
    everything = [line for lines in kernels.values() for line in lines]
    if not everything:
        sys.exit(f"{path} has no lines: were the tests built with --coverage?")
    print(f"{'kernel':<40}{'lines':>8}{'ran':>8}{'%':>8}")
    for kernel, lines in sorted(kernels.items()):
        print(f"{kernel:<40}{len(lines):>8}{sum(lines):>8}{percentage(lines):>8.1f}")
    print(f"{'all':<40}{len(everything):>8}{sum(everything):>8}{percentage(everything):>8.1f}")
    below = sorted((percentage(list(lines.values())), name) for name, lines in ran.items())
    below = [(part, name) for part, name in below if part < least]
    if below:
        print(f"\nfiles below {least:g} %, and lines that did not run:")
    for part, name in below:
        print(f"{part:5.1f} %  {name}: {ranges(number for number, reached in ran[name].items() if not reached)}")
    if percentage(everything) < least:
        sys.exit(f"coverage: {percentage(everything):.1f} % of the kernels' lines ran, {least:g} % are wanted")


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
