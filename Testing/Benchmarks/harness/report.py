# SPDX-License-Identifier: BSD-3-Clause
"""The page that run.py writes."""
import re

from harness.statistics import Measured

NOISY = 0.05  # of all cores, had by others


def number(value, digits=3):
    """With so many digits that mean something, in groups of three."""
    if value == 0:
        return "0"
    rounded = float(f"{value:.{digits}g}")
    if abs(rounded) >= 1e9 or abs(rounded) < 1e-4:
        text = f"{rounded:g}"
    elif abs(rounded) >= 1000:
        text = f"{rounded:,.0f}".replace(",", "\u202f")
    else:
        text = f"{rounded:.10f}".rstrip("0").rstrip(".")
    return text.replace("-", "−")


def times(spread):
    """A ratio with its spread, in one line."""
    if spread is None:
        return ""
    return f"**{number(spread.median)}** ({number(spread.least)}\u2009–\u2009{number(spread.largest)})".replace(" ", "\u00a0").replace("\u2009", "\u202f")


def milliseconds(spread):
    return number(spread.median) if spread else ""


def both_times(measured, row):
    """Clock and processor."""
    wall, cpu = measured.spread(row), measured.spread(row, "cpu")
    return f"{milliseconds(wall)}\u00a0/\u00a0{milliseconds(cpu)}" if wall and cpu else milliseconds(wall)


def table(headings, rows, text=(0,)):
    """Columns stand right but those of text."""
    lines = ["| " + " | ".join(headings) + " |", "|" + "|".join("---" if i in text else "---:" for i in range(len(headings))) + "|"]
    return "\n".join(lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]) + "\n"


def is_yardstick(row):
    return row.label.startswith("yardstick: ")


class Page:
    def __init__(self, results, suites):
        self.results = results
        self.suites = [suite for suite in suites if suite.name in results["suites"]]
        self.measured = {suite.name: Measured(results["suites"][suite.name]) for suite in self.suites}

    def text(self, plots):
        """plots: names of the plots that were drawn."""
        parts = [self.head(), self.peers(plots), self.yardsticks(), self.threads(plots), self.ranks(plots), self.exponents()]
        parts += [self.section(suite, plots) for suite in self.suites]
        parts.append(self.failures())
        return "\n".join(part for part in parts if part)

    def head(self):
        results = self.results
        runs = results.get("runs", 1)
        facts = "".join(f"| {name} | {value} |\n" for name, value in results["machine"].items())
        load = results["load"]
        noise = (f"Other programs had {100 * load['mean']:.0f} % of the cores in the mean (most in a suite: {100 * load['largest']:.0f} %)"
                 + (": **the machine was busy, so times by the clock, and less so ratios, are too long or off; processor times are nearer the truth.**"
                    if load["largest"] > NOISY else ": the machine was quiet."))
        ranks = results.get("ranks") or {}
        others = "" if ranks.get("Lacuna") in (None, results["machine"]["Lacuna"]) else "but those of ranks, whose build is told there, "
        quick = ("**A quick run: small cases, and too few rounds to quote a figure.**\n\n" if results["quick"] else "")
        return (f"# Benchmarks\n\nWritten by `{results['command']}`, which needs a release build ([how](../../CONTRIBUTING.md)) and the packages of "
                "`Testing/Tools/packages-benchmarks.txt` (`Testing/Tools/benchmarks.sh` installs and builds them first); run it to have the same of your machine. All figures "
                f"{others}are of {'one run' if runs == 1 else f'{runs} runs'} of {results['minutes']:.0f} minutes: each row and its peers were measured in turns, {results['rounds']} rounds "
                "(less where a table says so); given are the median and, in parentheses, the least and the largest of the rounds. A ratio is taken within a round. "
                "*Clock* is the time one waits, *processor* the time of all threads together, both in ms.\n\n"
                "How far surfaces are from the truth, beside other programs, is on the page of [surfaces from points](surfaces-from-points.md).\n\n"
                f"{quick}{noise}\n\n| | |\n|---|---|\n{facts}")

    def compared(self, wanted):
        for suite in self.suites:
            measured = self.measured[suite.name]
            for each in suite.comparisons:
                peers = [peer for peer in each.peers if is_yardstick(peer) == wanted and measured.ratio(peer, each.ours)]
                for i, peer in enumerate(peers):
                    yield suite, each, peer, measured, i == 0

    def peers(self, plots):
        rows, last = [], None
        for suite, each, peer, measured, first in self.compared(False):
            if suite is not last:
                rows.append((f"**[{suite.title}](#{anchor(suite.title)})**",) + ("",) * 5)
                last = suite
            own = (each.title, both_times(measured, each.ours)) if first else ("", "")
            rows.append((*own, both_times(measured, peer), peer.label,
                         times(measured.ratio(peer, each.ours)), times(measured.ratio(peer, each.ours, "cpu"))))
        if not rows:
            return ""
        return ("## Beside peers\nHow many times as fast as a peer that does the same on the same machine in the same rounds.\n\n" + picture("peers", "Times as fast as each peer", plots)
                + table(("", "clock / processor, ms", "peer: clock / processor, ms", "", "times as fast, clock", "times as fast, processor"), rows, (0, 3)))

    def yardsticks(self):
        rows = []
        for suite, each, peer, measured, first in self.compared(True):
            name = f"{suite.title}: {each.title}" if first else ""
            rows.append((name, both_times(measured, each.ours) if first else "", both_times(measured, peer), peer.label.split(": ", 1)[1],
                         times(measured.ratio(each.ours, peer)), times(measured.ratio(each.ours, peer, "cpu"))))
        if not rows:
            return ""
        return ("## Beside the least possible\nHow many times as long as work that any program would have to do.\n\n"
                + table(("", "clock / processor, ms", "yardstick: clock / processor, ms", "", "times as long, clock", "times as long, processor"), rows, (0, 3)))

    def threads(self, plots):
        rows = []
        for suite in self.suites:
            measured = self.measured[suite.name]
            for each in suite.threads:
                for label, points in each.series:
                    rows += filter(None, [thread_row(measured, f"{each.title}: {label}" if label != "Lacuna" else each.title, dict(points))])
        if not rows:
            return ""
        return ("## Threads\nHow many times as fast by the clock as with one thread, and how much more the processors work. Results do not depend on the number of threads. "
                "Four threads on fewer cores show what too many cost; VTK's filters take no more than there are cores. Dashed: as many times as fast as there are threads, and cores for them.\n\n" + picture("threads", "Speed-up by threads", plots)
                + table(("", "1 thread, ms", "2: times as fast", "4: times as fast", "2: processor", "4: processor"), rows))

    def ranks(self, plots):
        ranks = self.results.get("ranks")
        if not ranks or not ranks.get("rows"):
            return ""
        build = f" Lacuna {ranks['Lacuna']}, measured at {ranks['Date']}." if "Lacuna" in ranks else ""
        text = f"## Ranks\nMPI's ranks on this machine (`Testing/Benchmarks/ranks.py`), by the processor time of the busiest one.{build}\n\n" + picture("ranks", "Speed-up by ranks", plots)
        return (text + ranks["text"] + " By parts: the time of the busiest of so many ranks, done one after the other, and what a network would take; what 1000 ranks repeat is at "
                "most the least of their parts. Weak scaling counts points as work, of which those of a finer grid may cost less, and takes two of many parts: so it can be above "
                "100 % ([how](../DeveloperGuide/distributed.md#a-thousand-ranks-part-by-part)).\n")

    def exponents(self):
        rows = []
        for suite in self.suites:
            measured = self.measured[suite.name]
            for each in suite.scalings:
                for label, points in each.series:
                    there = [(x, row) for x, row in points if measured.spread(row)]
                    wall, cpu = measured.exponent(there), measured.exponent(there, "cpu")
                    if wall:
                        rows.append((f"[{each.title}](#{anchor(suite.title)})", label, f"{number(there[0][0])} – {number(there[-1][0])} {each.x}", times(wall), times(cpu)))
        if not rows:
            return ""
        return ("## Size\nThe exponent p of time ~ sizeᵖ, fitted to all sizes: 1 is in proportion.\n\n"
                + table(("", "", "sizes", "clock", "processor"), rows, (0, 1, 2)))

    def section(self, suite, plots):
        measured = self.measured[suite.name]
        facts = self.results["suites"][suite.name]
        parts = [f"## {suite.title}\n{suite.about} `Testing/Benchmarks/run.py --only {suite.name}`"
                 + (f" ({facts['rounds']} round{'s' if facts['rounds'] > 1 else ''})" if facts["rounds"] != self.results["rounds"] else "")
                 + (f"; others had {100 * facts['others']:.0f} % of the cores." if facts["others"] > NOISY else ".") + "\n"]
        for each in suite.scalings:
            parts.append(picture(each.file, each.title, plots) + size_table(measured, each))
        for each in suite.figures:
            rows = [(label, *(cell(measured.spread(row, name), form) for name, _, form in each.columns)) for label, row in each.rows
                    if any(measured.spread(row, name) for name, _, _ in each.columns)]
            if rows:
                parts.append(f"**{each.title}**\n\n" + table(("", *(heading for _, heading, _ in each.columns)), rows))
        if len(parts) == 1:
            parts.append("Its rows are in the tables at the top.\n")
        return "\n".join(filter(None, parts))

    def failures(self):
        rows = [(suite.title, what, why) for suite in self.suites for what, why in self.results["suites"][suite.name]["errors"].items()]
        rows += [(name, "", why) for name, why in self.results.get("left_out", {}).items()]
        if (ranks := self.results.get("ranks")) and not ranks.get("rows"):
            rows.append(("Ranks", "", ranks["text"]))
        if not rows:
            return ""
        return "## What was not measured\n\n" + table(("", "", ""), [(a, f"`{b}`" if b else "", clean(c)) for a, b, c in rows], (0, 1, 2))


def thread_row(measured, title, rows):
    one = measured.spread(rows[1])
    if one is None or not any(measured.spread(row) for n, row in rows.items() if n != 1):
        return None
    speed = [times(measured.ratio(rows[1], rows[n])) if n in rows else "" for n in (2, 4)]
    work = [times(measured.ratio(rows[n], rows[1], "cpu")) if n in rows else "" for n in (2, 4)]
    return (title, milliseconds(one), *speed, *work)


def size_table(measured, scaling):
    sizes = sorted({x for _, points in scaling.series for x, row in points if measured.spread(row)})
    rows = []
    for x in sizes:
        cells = []
        for _, points in scaling.series:
            row = dict(points).get(x)
            cells.append(both_times(measured, row) if row else "")
        rows.append((number(x), *cells))
    return table((scaling.x, *(f"{label}: clock / processor, ms" for label, _ in scaling.series)), rows, ()) if rows else ""


def cell(spread, form):
    return "" if spread is None else format(spread.median, form).replace("-", "−")


def picture(name, words, plots):
    return f"![{words}]({name}.svg)\n\n" if name in plots else ""


def anchor(heading):
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def clean(text):
    return " ".join(text.split()).replace("|", "\\|")
