#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Strong and weak scaling over MPI's ranks, one thread each: measured with two, and what 1000 would do.

    . build/release/lacuna-env.sh
    Testing/Benchmarks/ranks.py [--quick] [--ranks N] [--rounds N] [--benchmark_out FILE]

Strong: the same work by more ranks; weak: as much work for each. Times are the processor time of the busiest rank, which what else the
machine does changes little; inputs are there before.

Measured: rounds of one rank and of N ranks, one after the other, the first update of each left out; the median of the rounds.

By parts: what each of many ranks would do, done one after the other by one process, each by a new filter: ranks exchange nothing but the sums of
Occluded Angle, so a rank's time is that of its part of the output, and nothing is extrapolated but the network
(Documentation/DeveloperGuide/distributed.md). All parts, or twenty of them where all would take too long, two for weak scaling; the busiest counts.

Rows of the file: CASE/strong/ranks:N and CASE/weak/ranks:N, measured, with the time by the clock, too (for that leave the machine alone);
CASE/strong/parts:N and CASE/weak/parts:N.
"""
import argparse
import json
import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
LATENCY = 2e-6  # s, of a message between nodes
BANDWIDTH = 12.5e9  # bytes/s: 100 Gbit/s
SUMMED = 1 << 22  # values that are summed at once
MANY = 2, 10, 100, 1000
FEW = 20  # parts, where all would take more than ALL
ALL = 30  # s
LINES = 100  # of Occluded Angle, of two directions each
SHARES_DIRECTIONS = "occluded-angle"  # the others share the output


# --- in pvbatch; work: how much, 1 for one rank. Each gives the input and a function that makes the filter. ---


def occluded_angle(size, work):
    import paraview.simple as pv
    shape = pv.IncompleteShape(Shape="Sphere", Dimensions=[int(160 * size)] * 3)
    return shape, lambda: pv.OccludedAngle(Input=shape, NumberOfDirections=2 * math.ceil(LINES * work))


def swept_volume(size, work):
    import paraview.simple as pv
    sweep = pv.PhantomSweep(NumberOfSlices=100, ImageSize=[int(320 * size), int(240 * size)], PixelSpacing=0.2 / size)
    spacing = 0.16 / size / work ** (1 / 3)
    return sweep, lambda: pv.SweptVolume(Input=sweep, OutputSpacing=[spacing] * 3, MemoryLimit=10 ** 7)  # of all ranks together


def iso_ray_caster(size, work):
    import paraview.simple as pv
    skull = pv.SkullPhantom(Spacing=[2 / size] * 3)
    return skull, lambda: pv.BSplineIsoRayCaster(Input=skull, IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9],
                                                 PixelSpacing=0.09 / size / math.sqrt(work))


def speckle(size, work):
    import paraview.simple as pv
    image = pv.Wavelet(WholeExtent=[0, int(200 * size) - 1, 0, int(200 * size) - 1, 0, int(200 * size * work) - 1])
    return image, lambda: pv.SpeckleFilter(Input=image, Operation="Median", KernelSize=[5, 5, 5])


def rbf_interpolator(size, work):
    import paraview.simple as pv
    sphere = pv.Sphere(Radius=50, ThetaResolution=36, PhiResolution=30)
    values = pv.Calculator(Input=sphere, ResultArrayName="Value", Function="coordsX + sin(coordsZ/15)")
    spacing = 0.4 / size / work ** (1 / 3)
    return values, lambda: pv.RBFInterpolator(Input=values, ScalarArray="Value", Kernel="Linear", OutputSpacing=[spacing] * 3)


CASES = {"occluded-angle": occluded_angle, "swept-volume": swept_volume, "iso-ray-caster": iso_ray_caster, "speckle": speckle,
         "rbf-interpolator": rbf_interpolator}


# In ParaView's Programmable Filter, on each rank: its processor time so far.
STAMP = """
import time
from vtkmodules.vtkParallelCore import vtkMultiProcessController
rank = vtkMultiProcessController.GetGlobalController().GetLocalProcessId()
with open({file!r} + str(rank), "w", encoding="ascii") as file:
    file.write(repr(time.process_time()))
"""


def stamps(start, ranks):
    found = []
    for rank in range(ranks):
        with open(start + str(rank), encoding="ascii") as file:
            found.append(float(file.read()))
    return found


def measure(size, ranks, out):
    """One round by real ranks: {row: [each rank's processor time, time by the clock]}. The Programmable Filter makes min and max others here."""
    import paraview.simple as pv
    rows = {}
    for name, case in CASES.items():
        for kind in ("strong", "weak"):
            if kind == "weak" and ranks == 1:  # the same work
                rows[f"{name}/weak/ranks:1"] = rows[f"{name}/strong/ranks:1"]
                continue
            source, make = case(size, ranks if kind == "weak" else 1)
            source.UpdatePipeline()
            for _ in range(2):  # the first time memory is new, and libraries are loaded
                made = make()
                before = pv.ProgrammableFilter(Input=pv.Sphere(), Script=STAMP.format(file=out + "before"))
                after = pv.ProgrammableFilter(Input=made, Script=STAMP.format(file=out + "after"), CopyArrays=0)
                before.UpdatePipeline()
                start = time.perf_counter()
                after.UpdatePipeline()
                made.GetDataInformation().GetNumberOfPoints()  # of all ranks, so it waits for them
                wall = time.perf_counter() - start
                processor = [b - a for a, b in zip(stamps(out + "before", ranks), stamps(out + "after", ranks))]
                for each in (after, before, made):
                    pv.Delete(each)
            rows[f"{name}/{kind}/ranks:{ranks}"] = processor, wall
            pv.Delete(source)
    return rows


def parts(size, quick):
    """Of each case: {row: {"seconds": of the busiest part, "mean", "least", "points"} or {"refused": why}}"""
    import paraview.simple as pv
    rows = {}
    for name, case in CASES.items():
        for kind in ("strong", "weak"):
            for ranks in (1, *MANY):
                if kind == "weak" and ranks == 1:  # the same work
                    rows[f"{name}/weak/parts:1"] = rows[f"{name}/strong/parts:1"]
                    continue
                work = ranks if kind == "weak" else 1
                source, make = case(size, work / ranks if name == SHARES_DIRECTIONS else work)
                made = make()
                rows[f"{name}/{kind}/parts:{ranks}"] = busiest_part(made, name, kind, ranks, quick)
                pv.Delete(made)
                pv.Delete(source)
    return rows


def busiest_part(proxy, name, kind, ranks, quick):
    if name == SHARES_DIRECTIONS:
        wanted, ranks = [0], 1
    else:
        count = min(ranks, 2 if quick or kind == "weak" else FEW)
        wanted = [int((each + 0.5) * ranks / count) for each in range(count)]
    said = []
    points = 0

    def listen(_, __, text):
        said.append(text)
    listen.CallDataType = "string0"

    def seconds_of(rank):
        nonlocal points
        taken = []
        while len(taken) < (3 if kind == "strong" else 2):  # the first makes the input
            proxy.SMProxy.RecreateVTKObjects()  # a rank has nothing of what others have prepared
            algorithm = proxy.GetClientSideObject()
            algorithm.AddObserver("ErrorEvent", listen)
            algorithm.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
            start = time.process_time()
            algorithm.UpdatePiece(rank, ranks, 0)
            taken.append(time.process_time() - start)
            points = algorithm.GetOutputDataObject(0).GetNumberOfPoints()
            if said:
                return None
        return statistics.mean(taken[1:])
    seconds = []
    for rank in wanted:
        seconds.append(seconds_of(rank))
        if said:
            return {"refused": said[0].strip().partition("): ")[2]}
    if kind == "strong" and not quick and 3 * ranks * statistics.mean(seconds) < ALL:
        seconds = [seconds_of(rank) for rank in range(ranks)]
    return {"seconds": max(seconds), "mean": statistics.mean(seconds), "least": min(seconds), "points": points}


# --- the table ---


def sum_time(ranks, values, directions):
    """Of so many values over all ranks, by reduce-scatter and all-gather (Rabenseifner): latency and bandwidth."""
    size = values * (4 if directions <= 1022 else 8)
    return math.ceil(values / SUMMED) * 2 * math.log2(ranks) * LATENCY + 2 * (ranks - 1) / ranks * size / BANDWIDTH


def at(rows, case, kind, ranks):
    """Time of the busiest of so many ranks with what the network takes, from their parts; None when it is refused."""
    row = rows[f"{case}/{kind}/parts:{ranks}"]
    if "refused" in row:
        return None
    directions = 2 * LINES * (ranks if kind == "weak" else 1)
    return row["seconds"] + (sum_time(ranks, row["points"], directions) if case == SHARES_DIRECTIONS and ranks > 1 else 0.0)


def table(measured, by_parts, ranks):
    def number(value):
        return f"{value:.0f}" if value >= 20 else f"{value:.1f}"
    texts, refused = [], []
    for kind, title, cell in (("strong", "Strong scaling: times as fast as one rank", number),
                              ("weak", "Weak scaling: efficiency", lambda ratio: f"{100 * ratio:.0f} %")):
        lines = [f"| {title} | 1 rank, s | {ranks} ranks, measured | 1, by parts, s | " + " | ".join(f"{many}, by parts" for many in MANY) +
                 (f" | busiest / mean of {MANY[-1]} | repeated, at most |" if kind == "strong" else " |"), "|---" * (4 + len(MANY) + 2 * (kind == "strong")) + "|"]
        for case in CASES:
            one, some = (measured[f"{case}/{kind}/ranks:{n}"]["rounds"] for n in (1, ranks))
            ratios = [a / b for a, b in zip(one, some)]
            cells = [f"{statistics.median(one):.2f}", cell(statistics.median(ratios))]
            if len(ratios) > 1:
                cells[-1] += f" ({cell(min(ratios))} – {cell(max(ratios))})"
            alone = at(by_parts, case, kind, 1)
            cells.append(f"{alone:.2f}")
            for many in MANY:
                taken = at(by_parts, case, kind, many)
                cells.append(cell(alone / taken) if taken else "refused")
                if not taken:
                    refused.append(f"{case}, {many} ranks, {kind}: " + by_parts[f"{case}/{kind}/parts:{many}"]["refused"])
            if kind == "strong":
                part = by_parts[f"{case}/strong/parts:{MANY[-1]}"]
                shares = case != SHARES_DIRECTIONS and "mean" in part
                cells += [f"{part['seconds'] / part['mean']:.1f}" if shares else "–", f"{100 * part['least'] / alone:.2g} %" if "least" in part else "–"]
            lines.append(f"| {case} | " + " | ".join(cells) + " |")
        texts.append("\n".join(lines))
    rounds = len(measured[f"{next(iter(CASES))}/strong/ranks:1"]["rounds"])
    said = f"Measured: the median of {rounds} rounds, and the extremes." if rounds > 1 else "Measured: one round."
    return "\n\n".join([*texts, *refused, said])


def run(options):
    mpirun, pvbatch = shutil.which("mpirun"), shutil.which("pvbatch")
    if not mpirun or not pvbatch:
        sys.exit("no mpirun or pvbatch")
    environment = dict(os.environ, VTK_SMP_MAX_THREADS="1", OPENBLAS_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1",
                       OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_rmaps_base_oversubscribe="1")
    measured = {}
    with tempfile.TemporaryDirectory() as folder:
        def job(ranks, what):
            out = os.path.join(folder, "rows.json")
            done = subprocess.run([mpirun, "-n", str(ranks), pvbatch, "--force-offscreen-rendering", os.path.abspath(__file__), "--in-pvbatch",
                                   what, str(ranks), out, *(["--quick"] if options.quick else [])], env=environment, check=False, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            if done.returncode != 0:
                sys.exit(done.stdout)
            with open(out, encoding="utf-8") as file:
                return json.load(file)
        for _ in range(1 if options.quick else options.rounds):
            for ranks in (1, options.ranks):
                for name, (processor, wall) in job(ranks, "measure").items():
                    row = measured.setdefault(name, {"rounds": [], "wall": []})
                    row["rounds"].append(max(processor))
                    row["wall"].append(wall)
        by_parts = job(1, "parts")
    print(table(measured, by_parts, options.ranks))
    if options.benchmark_out:
        rows = {name: (statistics.median(row["wall"]), statistics.median(row["rounds"])) for name, row in measured.items()}
        for case in CASES:
            for kind in ("strong", "weak"):
                for many in (1, *MANY):
                    taken = at(by_parts, case, kind, many)
                    if taken:
                        rows[f"{case}/{kind}/parts:{many}"] = taken, taken
        benchmarks = [{"name": name, "run_type": "iteration", "iterations": 1, "real_time": 1000 * wall, "cpu_time": 1000 * processor,
                       "time_unit": "ms"} for name, (wall, processor) in rows.items()]
        with open(options.benchmark_out, "w", encoding="utf-8") as file:
            json.dump({"benchmarks": benchmarks}, file, indent=1)


def run_in_pvbatch(what, ranks, out, quick):
    import lacuna.plugin
    lacuna.plugin.load()
    size = 0.5 if quick else 1.4
    rows = measure(size, ranks, out) if what == "measure" else parts(size, quick)
    with open(out, "w", encoding="utf-8") as file:
        json.dump(rows, file)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="small cases, once")
    parser.add_argument("--ranks", type=int, default=2, help="besides one rank")
    parser.add_argument("--rounds", type=int, default=3, help="of what is measured")
    parser.add_argument("--benchmark_out", metavar="FILE", help="also write the rows as Google Benchmark's JSON")
    parser.add_argument("--in-pvbatch", nargs=3, metavar=("WHAT", "RANKS", "OUT"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.ranks < 2:
        parser.error("--ranks must be 2 or more: one rank is measured in any case")
    if options.rounds < 1:
        parser.error("--rounds must be 1 or more")
    if options.in_pvbatch:
        what, ranks, out = options.in_pvbatch
        run_in_pvbatch(what, int(ranks), out, options.quick)
    else:
        run(options)


main()
