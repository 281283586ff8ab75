# SPDX-License-Identifier: BSD-3-Clause
"""Programs for milling machines, read back."""
import re

import numpy as np


def read_gcode(path):
    """x, y, z, feed (0: rapid) of each block of a program that moves."""
    mode, feed, at, steps = None, 0.0, [None] * 3, []
    with open(path, encoding="ascii") as file:
        lines = file.read().splitlines()
    assert lines[0] == lines[-1] == "%" and lines[-2] == "M30" and re.fullmatch(r"O\d{4}", lines[1])
    for line in lines[2:-1]:
        if line.startswith("("):
            continue
        words = re.findall(r"([A-Z])([-+.0-9]+)", line)
        assert "".join(letter + number for letter, number in words) == line.replace(" ", ""), line
        for letter, number in words:
            if letter == "G" and number in ("00", "01"):
                mode = int(number)
            elif letter == "F":
                feed = float(number)
            elif letter in "XYZ":
                assert re.fullmatch(r"-?\d+\.\d{0,3}", number), line
                at["XYZ".index(letter)] = float(number)
        if None not in at and any(letter in "XYZ" for letter, _ in words):
            steps.append([*at, feed if mode else 0])
    return np.array(steps)
