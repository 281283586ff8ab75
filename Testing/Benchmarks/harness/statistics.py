# SPDX-License-Identifier: BSD-3-Clause
"""Medians, spreads and exponents of what was measured in rounds.

A result of run.py: {"suites": {name: {"rows": {key: [row or None for each round]}, ...}}, ...} with
row = {"wall": ms, "cpu": ms, "counters": {...}, "label": text}.
"""
import math
import statistics
from dataclasses import dataclass


@dataclass
class Spread:
    """The median of several rounds, and the least and the largest."""
    median: float
    least: float
    largest: float

    @classmethod
    def of(cls, values):
        values = [value for value in values if value is not None and math.isfinite(value)]
        return cls(statistics.median(values), min(values), max(values)) if values else None


class Measured:
    """The rows of a suite."""

    def __init__(self, suite):
        self.rows = suite.get("rows", {})

    def values(self, row, what):
        """Of each round; None where it failed. what: wall or cpu of the row (which may be counters), or a counter."""
        name = {"wall": row.wall, "cpu": row.cpu}.get(what, what)
        found = []
        for each in self.rows.get(row.key, []):
            value = None if each is None else each[name] if name in ("wall", "cpu") else each["counters"].get(name)
            found.append(value)
        return found

    def spread(self, row, what="wall"):
        return Spread.of(self.values(row, what))

    def ratio(self, numerator, denominator, what="wall"):
        """Of the same rounds."""
        pairs = zip(self.values(numerator, what), self.values(denominator, what))
        return Spread.of([a / b for a, b in pairs if a is not None and b])

    def exponent(self, points, what="wall"):
        """p of time ~ x^p by least squares of logarithms, of each round; None for fewer than two sizes."""
        series = [(x, self.values(row, what)) for x, row in points]
        rounds = max((len(values) for _, values in series), default=0)
        return Spread.of([slope([(x, values[i]) for x, values in series if i < len(values) and values[i]]) for i in range(rounds)])


def slope(points):
    if len(points) < 2:
        return None
    x, y = [math.log(a) for a, _ in points], [math.log(b) for _, b in points]
    mean_x, mean_y = statistics.mean(x), statistics.mean(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x)**2 for a in x)
