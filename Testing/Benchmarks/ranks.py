#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Strong and weak scaling over MPI's ranks, one thread each, on the cores of this machine.

    . build/release/lacuna-env.sh
    Testing/Benchmarks/ranks.py [--quick] [--ranks N] [--benchmark_out FILE]

Strong: the same work by more ranks; weak: as much work for each. Times are the processor time of the busiest rank, which what else the
machine does changes little, the median of some; inputs are there before. Prints them as a table, and what the model of
Documentation/DeveloperGuide/distributed.md makes of them for more ranks. A row of the file is CASE/strong/ranks:N or CASE/weak/ranks:N,
with the time by the clock, too: for that leave the machine alone.
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
MANY = 10, 100, 1000


# --- in pvbatch; work: how much, 1 for one rank. Each gives the input and a function that makes the filter. ---


def occluded_angle(size, work):
    import paraview.simple as pv
    shape = pv.IncompleteShape(Shape="Sphere", Dimensions=[int(160 * size)] * 3)
    return shape, lambda: pv.OccludedAngle(Input=shape, NumberOfDirections=int(200 * work))


def swept_volume(size, work):
    import paraview.simple as pv
    sweep = pv.PhantomSweep(NumberOfSlices=100, ImageSize=[int(320 * size), int(240 * size)], PixelSpacing=0.2 / size)
    spacing = 0.25 / size / work ** (1 / 3)
    return sweep, lambda: pv.SweptVolume(Input=sweep, OutputSpacing=[spacing] * 3)


def iso_ray_caster(size, work):
    import paraview.simple as pv
    skull = pv.SkullPhantom(Spacing=[2 / size] * 3)
    return skull, lambda: pv.BSplineIsoRayCaster(Input=skull, IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9],
                                                 PixelSpacing=0.12 / size / math.sqrt(work))


def speckle(size, work):
    import paraview.simple as pv
    image = pv.Wavelet(WholeExtent=[0, int(200 * size) - 1, 0, int(200 * size) - 1, 0, int(200 * size * work) - 1])
    return image, lambda: pv.SpeckleFilter(Input=image, Operation="Median", KernelSize=[5, 5, 5])


def rbf_interpolator(size, work):
    import paraview.simple as pv
    sphere = pv.Sphere(Radius=50, ThetaResolution=36, PhiResolution=30)
    values = pv.Calculator(Input=sphere, ResultArrayName="Value", Function="coordsX + sin(coordsZ/15)")
    spacing = 0.6 / size / work ** (1 / 3)
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


def measure(size, ranks, times, out):
    import lacuna.plugin
    lacuna.plugin.load()
    import paraview.simple as pv
    rows = {}
    for name, case in CASES.items():
        for kind in ("strong", "weak"):
            if kind == "weak" and ranks == 1:  # the same work
                rows[f"{name}/weak/ranks:1"] = rows[f"{name}/strong/ranks:1"]
                continue
            source, make = case(size, ranks if kind == "weak" else 1)
            source.UpdatePipeline()
            wall, processor = [], []
            for _ in range(times):
                made = make()
                before = pv.ProgrammableFilter(Input=pv.Sphere(), Script=STAMP.format(file=out + "before"))
                after = pv.ProgrammableFilter(Input=made, Script=STAMP.format(file=out + "after"), CopyArrays=0)
                before.UpdatePipeline()
                start = time.perf_counter()
                after.UpdatePipeline()
                points = made.GetDataInformation().GetNumberOfPoints()  # of all ranks, so it waits for them
                wall.append(time.perf_counter() - start)
                processor.append([b - a for a, b in zip(stamps(out + "before", ranks), stamps(out + "after", ranks))])
                for each in (after, before, made):
                    pv.Delete(each)
            rows[f"{name}/{kind}/ranks:{ranks}"] = {"processor": processor, "wall": wall, "points": points}
            pv.Delete(source)
    with open(out, "w", encoding="utf-8") as file:
        json.dump(rows, file)


# --- the table ---


def sum_time(ranks, size):
    """Of values of size bytes over all ranks, by reduce-scatter and all-gather (Rabenseifner): latency and bandwidth."""
    return 2 * math.log2(ranks) * LATENCY + 2 * (ranks - 1) / ranks * size / BANDWIDTH


def repeated(alone, some, ranks):
    """The part of the work that all ranks repeat, from two times."""
    return min(1.0, max(0.0, (ranks * some / alone - 1) / (ranks - 1)))


def extrapolate(rows, case, ranks):
    """Strong scaling: the repeated part, as (median, least, largest) of the rounds, and how many times as fast many ranks are by each."""
    one, some = rows[f"{case}/strong/ranks:1"], rows[f"{case}/strong/ranks:{ranks}"]
    alone = one["seconds"]
    each = [repeated(a, b, ranks) for a, b in zip(one["rounds"], some["rounds"])]
    parts = repeated(alone, some["seconds"], ranks), min(each), max(each)
    summed = 4 * one["points"] if case == "occluded-angle" else 0
    return parts, [[alone / (alone * (part + (1 - part) / many) + sum_time(many, summed) * bool(summed)) for part in parts] for many in MANY]


def spread(values):
    """Of (median, and what may be least and largest)."""
    def number(value):
        return f"{value:.0f}" if value >= 10 else f"{value:.1f}"
    return f"{number(values[0])} ({number(min(values))} – {number(max(values))})"


def table(rows, ranks):
    lines = [f"| | 1 rank, s | {ranks} ranks, s | strong: times as fast | weak: efficiency | repeated part | " +
             " | ".join(f"model, {many} ranks" for many in MANY) + " |", "|---" * (6 + len(MANY)) + "|"]
    for case in CASES:
        strong = [rows[f"{case}/strong/ranks:{n}"]["seconds"] for n in (1, ranks)]
        weak = [rows[f"{case}/weak/ranks:{n}"]["seconds"] for n in (1, ranks)]
        part, many = extrapolate(rows, case, ranks)
        lines.append(f"| {case} | {strong[0]:.2f} | {strong[1]:.2f} | {strong[0] / strong[1]:.2f} | {100 * weak[0] / weak[1]:.0f} % | "
                     f"{spread([100 * each for each in part])} % | " + " | ".join(f"{spread(each)} times" for each in many) + " |")
    return "\n".join(lines)


def run(options):
    mpirun, pvbatch = shutil.which("mpirun"), shutil.which("pvbatch")
    if not mpirun or not pvbatch:
        sys.exit("no mpirun or pvbatch")
    environment = dict(os.environ, VTK_SMP_MAX_THREADS="1", OPENBLAS_NUM_THREADS="1", OMPI_ALLOW_RUN_AS_ROOT="1",
                       OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMPI_MCA_rmaps_base_oversubscribe="1")
    rows = {}
    with tempfile.TemporaryDirectory() as folder:
        for ranks in (1, options.ranks):
            out = os.path.join(folder, "rows.json")
            done = subprocess.run([mpirun, "-n", str(ranks), pvbatch, "--force-offscreen-rendering", os.path.abspath(__file__), "--in-pvbatch",
                                   str(ranks), out, *(["--quick"] if options.quick else [])], env=environment, check=False, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            if done.returncode != 0:
                sys.exit(done.stdout)
            with open(out, encoding="utf-8") as file:
                for name, row in json.load(file).items():  # not there: the Programmable Filter makes min and max others
                    rounds = [max(each) for each in row["processor"]]
                    rows[name] = {"seconds": statistics.median(rounds), "rounds": rounds, "wall": statistics.median(row["wall"]), "points": row["points"]}
    print(table(rows, options.ranks))
    if options.benchmark_out:
        benchmarks = [{"name": name, "run_type": "iteration", "iterations": 1, "real_time": 1000 * row["wall"], "cpu_time": 1000 * row["seconds"],
                       "time_unit": "ms"} for name, row in rows.items()]
        with open(options.benchmark_out, "w", encoding="utf-8") as file:
            json.dump({"benchmarks": benchmarks}, file, indent=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="small cases, once")
    parser.add_argument("--ranks", type=int, default=2, help="besides one rank")
    parser.add_argument("--benchmark_out", metavar="FILE", help="also write the rows as Google Benchmark's JSON")
    parser.add_argument("--in-pvbatch", nargs=2, metavar=("RANKS", "OUT"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.ranks < 2:
        parser.error("--ranks must be 2 or more: one rank is measured in any case")
    if options.in_pvbatch:
        measure(0.5 if options.quick else 1.4, int(options.in_pvbatch[0]), 1 if options.quick else 5, options.in_pvbatch[1])
    else:
        run(options)


main()
