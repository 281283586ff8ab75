# SPDX-License-Identifier: BSD-3-Clause
"""Plots of what run.py measured: SVG on a ground of its own, dark where the reader's device asks for dark pages."""
import os
import re

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot, ticker  # noqa: E402

from harness.report import is_yardstick  # noqa: E402
from harness.statistics import Measured  # noqa: E402

INK, FAINT, GRID, GROUND = "#20303c", "#63727c", "#dde3e7", "#ffffff"
OURS, OTHERS = "#0f6e8c", ("#b0520f", "#6b3fa0", "#3d7a2e", "#a03050")
DARK = {INK: "#e3e8eb", FAINT: "#a3b0b8", GRID: "#3a464e", GROUND: "#151b1f", OURS: "#6cc5df",
        OTHERS[0]: "#f0a060", OTHERS[1]: "#bb9cf2", OTHERS[2]: "#8fcf7d", OTHERS[3]: "#f08ca0"}
MARKERS = ("o", "s", "^", "D", "v")

pyplot.rcParams.update({
    "svg.fonttype": "none", "svg.hashsalt": "lacuna", "font.family": "sans-serif", "font.sans-serif": ["Helvetica", "Arial", "DejaVu Sans"], "font.size": 11,
    "axes.edgecolor": FAINT, "axes.labelcolor": INK, "axes.titlecolor": INK, "axes.titlesize": 12, "axes.titleweight": "bold", "axes.titlelocation": "left", "axes.titlepad": 12,
    "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.8, "axes.grid": True, "axes.axisbelow": True, "grid.color": GRID, "grid.linewidth": 0.8,
    "text.color": INK, "xtick.color": FAINT, "ytick.color": FAINT, "xtick.labelcolor": INK, "ytick.labelcolor": INK, "figure.facecolor": GROUND, "axes.facecolor": GROUND,
    "lines.linewidth": 1.8, "lines.markersize": 5.5, "xtick.minor.size": 0, "ytick.minor.size": 0})


def save(figure, path, title):
    """The words of the plot stay text, so that they can be read by search and by screen readers."""
    figure.savefig(path, format="svg", metadata={"Date": None, "Creator": None, "Title": title})
    pyplot.close(figure)
    with open(path, encoding="utf-8") as file:
        text = file.read()
    rules = "".join(f'[style*="{what}: {light}"]{{{what}:{dark}!important}}' for light, dark in DARK.items() for what in ("fill", "stroke"))
    text = re.sub(r"<\?xml.*?\?>\s*<!DOCTYPE.*?>\s*", "", text, flags=re.DOTALL)
    text = text.replace("<defs>", f"<!-- SPDX-License-Identifier: BSD-3-Clause; drawn by Testing/Benchmarks/run.py -->\n<style>@media (prefers-color-scheme: dark){{{rules}}}</style>\n <defs>", 1)
    # numbers need no more than hundredths of a point
    text = re.sub(r"(\d+\.\d\d)\d+", r"\1", text)
    text = "\n".join(line.rstrip() for line in text.splitlines()) + "\n"
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def colour(index):
    return OURS if index == 0 else OTHERS[(index - 1) % len(OTHERS)]


def seconds_axis(axis):
    """Of values in ms."""
    def name(value, _position):
        for unit, size in (("s", 1e3), ("ms", 1), ("µs", 1e-3)):
            if value >= size:
                return f"{value / size:g} {unit}"
        return f"{value * 1e6:g} ns"
    axis.set_major_formatter(ticker.FuncFormatter(name))
    axis.set_minor_formatter(ticker.NullFormatter())


def plain_axis(axis):
    def name(value, _position):
        digits, power = f"{value:.10e}".split("e")
        if value >= 1e4 and float(digits) == 1:
            return f"$10^{{{int(power)}}}$"
        return f"{float(f'{value:.3g}'):,.0f}".replace(",", "\u2009") if value >= 1 else f"{value:g}"
    axis.set_major_formatter(ticker.FuncFormatter(name))
    axis.set_minor_formatter(ticker.NullFormatter())


def curve(axes, points, measured, index, value):
    """A line with its spread; gives the last point. value(row) is a Spread or None."""
    there = [(x, value(row)) for x, row in points]
    there = [(x, spread) for x, spread in there if spread]
    if not there:
        return None
    x = [each for each, _ in there]
    middle = [spread.median for _, spread in there]
    axes.vlines(x, [spread.least for _, spread in there], [spread.largest for _, spread in there], color=colour(index), linewidth=3.5, alpha=0.35)
    axes.plot(x, middle, color=colour(index), marker=MARKERS[index % len(MARKERS)], linewidth=2.2 if index == 0 else 1.5, clip_on=False, zorder=3)
    return x[-1], middle[-1]


def place_labels(axes, labels, size=10.5):
    """Labels right of the ends of their lines, moved apart where they would touch."""
    to_points = axes.transData.transform
    pixels = axes.figure.dpi / 72
    placed = []  # middle, half of the height, left
    for x, y, text, paint in sorted(labels, key=lambda label: to_points((label[0], label[1]))[1]):
        at = to_points((x, y))
        half = 0.62 * size * pixels * (1 + text.count("\n"))
        middle = max([other + room + half for other, room, left in placed if abs(left - at[0]) < 140 * pixels] + [at[1]])
        placed.append((middle, half, at[0]))
        axes.annotate(text, (x, y), xytext=(9, (middle - at[1]) / pixels), textcoords="offset points", va="center", color=paint, fontsize=size, annotation_clip=False)


def scaling(measured, each, path):
    figure, axes = pyplot.subplots(figsize=(7.2, 4.3))
    axes.set_xscale("log")
    axes.set_yscale("log")
    ends = []
    for index, (label, points) in enumerate(each.series):
        end = curve(axes, points, measured, index, measured.spread)
        if end:
            there = [(x, row) for x, row in points if measured.spread(row)]
            exponent = measured.exponent(there)
            power = f"n$^{{{exponent.median:.2f}}}$" if exponent else ""
            ends.append((*end, label + ("\n" if len(label) > 15 else " · " if power else "") + power, colour(index)))
    if not ends:
        pyplot.close(figure)
        return False
    axes.set_xlabel(each.x)
    axes.set_title(each.title)
    axes.set_ylabel("time by the clock")
    axes.yaxis.set_major_locator(ticker.LogLocator(numticks=8))
    plain_axis(axes.xaxis)
    sizes = sorted({x for _, points in each.series for x, row in points if measured.spread(row)})
    if sizes[-1] / sizes[0] < 100:  # too few powers of ten to read
        axes.xaxis.set_major_locator(ticker.FixedLocator(sizes))
    seconds_axis(axes.yaxis)
    axes.grid(axis="x", visible=False)
    figure.subplots_adjust(left=0.14, right=0.72, top=0.88, bottom=0.14)
    place_labels(axes, ends)
    save(figure, path, each.title)
    return True


def threads(groups, path, cores):
    """groups: of (title, measured, Threads): small panels with common axes."""
    shown = [(suite.title, measured, each) for suite, measured, each in groups
             if any(measured.spread(row) for _, points in each.series for n, row in points if n > 1)]
    if not shown:
        return False
    columns = min(3, len(shown))
    lines = -(-len(shown) // columns)
    figure, grid = pyplot.subplots(lines, columns, figsize=(3.0 * columns + 0.4, 2.5 * lines + 0.5), sharex=True, sharey=True, squeeze=False)
    for axes in grid.flat[len(shown):]:
        axes.set_visible(False)
    for place, (axes, (title, measured, each)) in enumerate(zip(grid.flat, shown)):
        axes.plot([1, min(4, cores), 4], [1, min(4, cores), min(4, cores)], color=FAINT, linewidth=1, linestyle=(0, (4, 3)))
        for index, (label, points) in enumerate(each.series):
            rows = dict(points)
            curve(axes, points, measured, index, lambda row, rows=rows, measured=measured: measured.ratio(rows[1], row))
            if len(each.series) > 1:
                axes.annotate(label, (0.98, 0.05 + 0.11 * (len(each.series) - 1 - index)), xycoords="axes fraction", ha="right", color=colour(index), fontsize=8.5)
        axes.set_title(title, fontsize=10.5, pad=6)
        axes.set_xticks([1, 2, 4])
        axes.tick_params(labelbottom=place + columns >= len(shown))
        if place + columns >= len(shown):
            axes.set_xlabel("threads")
        if place % columns == 0:
            axes.set_ylabel("times as fast")
        axes.set_ylim(0, min(4, cores) + 0.5)
        axes.set_yticks(range(min(4, cores) + 1))
        axes.grid(axis="x", visible=False)
    figure.tight_layout(h_pad=1.4, w_pad=1.2)
    save(figure, path, "Speed-up by threads")
    return True


def peers(suites, measured, path):
    """All ratios to peers in one picture."""
    lines, ratios = [], []  # (heading, what, peer, ratio), of which some are empty
    for suite in suites:
        heading = suite.title
        for each in suite.comparisons:
            there = [(peer, measured[suite.name].ratio(peer, each.ours)) for peer in each.peers if not is_yardstick(peer)]
            there = sorted(((peer, ratio) for peer, ratio in there if ratio), key=lambda item: item[1].median)
            if there and heading:
                lines.append((heading, "", "", None))
                heading = ""
            for index, (peer, ratio) in enumerate(there):
                lines.append(("", "" if index else each.title, peer.label, ratio))
                ratios.append(ratio)
    if not ratios:
        return False
    figure, axes = pyplot.subplots(figsize=(8.6, 0.7 + 0.25 * len(lines)))
    axes.set_xscale("log")
    for line, (heading, what, peer, ratio) in enumerate(lines):
        axes.annotate(heading or what, (0, line), xycoords=("axes fraction", "data"), xytext=(-262 if heading else -252, 0), textcoords="offset points",
                      va="center", fontweight="bold" if heading else "normal", fontsize=10)
        if ratio:
            axes.axhline(line, color=GRID, linewidth=0.8, zorder=0)
            axes.plot([ratio.least, ratio.largest], [line, line], color=OURS, linewidth=3.5, alpha=0.35, solid_capstyle="butt")
            axes.plot(ratio.median, line, marker="o", color=OURS)
            axes.annotate(peer, (ratio.largest, line), xytext=(8, 0), textcoords="offset points", va="center", fontsize=9, color=FAINT, annotation_clip=False,
                          bbox={"facecolor": GROUND, "edgecolor": "none", "pad": 0.8})
    axes.axvline(1, color=FAINT, linewidth=1, zorder=1)
    axes.set_ylim(len(lines) - 0.4, -0.6)
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
    axes.set_xlabel("times as fast as the peer, by the clock")
    axes.set_xlim(min(0.5, min(ratio.least for ratio in ratios) / 1.5), max(ratio.largest for ratio in ratios) * 1.5)
    plain_axis(axes.xaxis)
    height = figure.get_size_inches()[1]
    figure.subplots_adjust(left=0.435, right=0.82, top=1 - 0.15 / height, bottom=0.55 / height)
    save(figure, path, "Times as fast as each peer")
    return True


def ranks(rows, path, cores):
    """rows: {case: {kind: {ranks: ms}}} as run.rank_rows gives them: lines by parts, and what was measured as rings; a line of that where there are no parts."""
    figure, both = pyplot.subplots(1, 2, figsize=(8.6, 3.6), sharex=True)
    for axes, kind, words in zip(both, ("strong", "weak"), ("Strong scaling: the same work", "Weak scaling: work in proportion")):
        ends, most, by_parts = [], 1, False
        for index, (case, kinds) in enumerate(sorted(rows.items())):
            marker = MARKERS[index % len(MARKERS)]
            for way, style in ((kind + " by parts", {}), (kind, {"markerfacecolor": "none"})):
                there = sorted(kinds.get(way, {}).items())
                if len(there) < 2:
                    continue
                x = [n for n, _ in there]
                y = [there[0][1] / time for _, time in there]
                line = not style or kind + " by parts" not in kinds
                axes.plot(x if line else x[1:], y if line else y[1:], color=colour(index), marker=marker, zorder=3, linestyle="-" if line else "none", **style)
                if line:
                    ends.append((x[-1], y[-1], case, colour(index)))
                by_parts |= not style
                most = max(most, x[-1])
        can = most if by_parts else min(most, cores)  # measured ranks beyond the cores take turns
        axes.plot([1, can, most], [1, can, can] if kind == "strong" else [1, 1, can / most], color=FAINT, linewidth=1, linestyle=(0, (4, 3)))
        axes.set_title(words, fontsize=10.5)
        axes.set_xlabel("ranks")
        axes.set_ylabel("times as fast as one rank" if kind == "strong" else "efficiency")
        if by_parts:
            axes.set_xscale("log")
            plain_axis(axes.xaxis)
            if kind == "strong":
                axes.set_yscale("log")
                plain_axis(axes.yaxis)
        else:
            axes.xaxis.set_major_locator(ticker.MaxNLocator(integer=True))
        if kind == "weak" or not by_parts:
            axes.set_ylim(bottom=0)
        axes.grid(axis="x", visible=False)
        figure.subplots_adjust(left=0.08, right=0.8, top=0.88, bottom=0.16, wspace=0.3)
        if axes is both[1]:
            place_labels(axes, ends, 8.5)
    save(figure, path, "Speed-up by ranks")
    return True


def draw(results, suites, folder, rank_rows):
    """All plots of a run; gives their names."""
    names = []

    def drawn(name, done):
        if done:
            names.append(name)

    suites = [suite for suite in suites if suite.name in results["suites"]]
    measured = {suite.name: Measured(results["suites"][suite.name]) for suite in suites}
    drawn("peers", peers(suites, measured, os.path.join(folder, "peers.svg")))
    drawn("threads", threads([(suite, measured[suite.name], each) for suite in suites for each in suite.threads], os.path.join(folder, "threads.svg"), results["cores"]))
    if rank_rows:
        drawn("ranks", ranks(rank_rows, os.path.join(folder, "ranks.svg"), results["cores"]))
    for suite in suites:
        for each in suite.scalings:
            drawn(each.file, scaling(measured[suite.name], each, os.path.join(folder, f"{each.file}.svg")))
    return names
