# SPDX-License-Identifier: BSD-3-Clause
"""RBF Surface beside other programs that make surfaces of points: thirty cases with known surfaces, and larger ones.

    . build/release/lacuna-env.sh
    /usr/bin/python3 Testing/Science/surface_peers.py --out FOLDER --poisson PATH/PoissonRecon [--cgal]
                     [--parts cases,normals,large,heads] [--only REGEX] [--again PROGRAM]

cases: sphere, torus, ellipsoid, kumara and cup of about 80 mm. 10 000 points uniform by area; errors of 0, 0.2 and 0.5 mm RMS on each axis;
normals off by 5 degrees RMS; all points, or 30 % of them missing in 12 patches of 7 to 19 mm radius, each on one side. normals: the same
points without normals; the peers get those that CGAL estimates (--cgal), Lacuna none. large: 100 000 points of the kumara. heads: a million
points of the bone (500 HU) and the skin (-300 HU) of each */*head*.mha in LACUNA_TEST_DATA.

Each program runs with two threads. Lacuna has one setting for all (and two more, FINE, for large); of a peer's settings (SETTINGS) the best of each case counts. The RMS and the
95 % quantile are of distances from the mesh to the true surface and back, 6000 places each, uniform by area. FOLDER/results.csv
keeps what was measured, and a later call measures only what is missing; --again measures a program anew. FOLDER/results.md has the tables.
"""
import argparse
import csv
import glob
import importlib.util
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np

import shapes

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "Benchmarks"))
from harness import machine  # noqa: E402

THREADS = 2
EDGE = 0.7  # mm, of the triangles of Lacuna and CGAL Poisson
PLACES = 6000  # where distances are measured, on either surface
SIGMAS = (0.0, 0.2, 0.5)
SETTINGS = {
    # depth, point weight, samples per node
    "PoissonRecon": [(7, 2, 1.5), (6, 2, 5), (6, 0.5, 5), (6, 2, 15), (6, 0.1, 15), (8, 2, 1.5), (8, 10, 1.5), (7, 10, 1.5)],
    # distance of triangles, mm
    "CGAL Poisson": [(0.1,), (0.02,)],
    "CGAL advancing front": [()],
    "Lacuna": [()],
}
FINE = [(0.35, 0.01), (0.35, 0.001)]  # OutputSpacing and Accuracy, mm: Lacuna's further settings for large
FIELDS = ["part", "case", "program", "setting", "rms", "q95", "largest", "closed", "triangles", "clock", "processor", "memory", "version", "problem"]


# Points and meshes in files

def write_points(path, points, normals=None):
    """PLY that every program reads."""
    columns = points if normals is None else np.concatenate([points, normals], axis=1)
    names = ("x", "y", "z", "nx", "ny", "nz")[:columns.shape[1]]
    with open(path, "wb") as file:
        file.write(("ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(points)
                    + "".join(f"property float {name}\n" for name in names) + "end_header\n").encode())
        file.write(np.ascontiguousarray(columns, "<f4").tobytes())


def read_points(path):
    """Points and normals (None without) of the PLY files written here and by surface_peers_cgal."""
    with open(path, "rb") as file:
        head = []
        while not head or head[-1] != "end_header":
            head.append(file.readline().decode().strip())
        count, width = int(next(line for line in head if line.startswith("element")).split()[2]), sum(line.startswith("property") for line in head)
        table = np.loadtxt(file) if "ascii" in head[1] else np.fromfile(file, "<f4").astype(float)
    table = table.reshape(count, width)
    return table[:, :3], table[:, 3:] if width == 6 else None


def read_mesh(path):
    """vtkPolyData of triangles."""
    from vtkmodules.vtkFiltersCore import vtkTriangleFilter
    from vtkmodules.vtkIOPLY import vtkPLYReader
    reader = vtkPLYReader()
    reader.SetFileName(path)
    triangles = vtkTriangleFilter()
    triangles.PassVertsOff()
    triangles.PassLinesOff()
    triangles.SetInputConnection(reader.GetOutputPort())
    triangles.Update()
    return triangles.GetOutput()


def corners(mesh):
    """Points, n x 3, and triangles, m x 3."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    return vtk_to_numpy(mesh.GetPoints().GetData()).astype(float), vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)


def to_vtk(points, normals=None):
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData
    data, places = vtkPolyData(), vtkPoints()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    data.SetPoints(places)
    if normals is not None:
        array = numpy_to_vtk(np.ascontiguousarray(normals), deep=True)
        array.SetName("Normals")
        data.GetPointData().SetNormals(array)
    return data


# The judge

def on_triangles(points, triangles, count, random):
    """Places uniform by area."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    chosen = random.choice(len(triangles), count, p=area / area.sum())
    u, v = random.random((2, count, 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    return a[chosen] + u * (b - a)[chosen] + v * (c - a)[chosen]


def from_mesh(mesh, places):
    """Distances of places from the nearest point of the triangles."""
    from vtkmodules.vtkCommonCore import mutable
    from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator
    locator = vtkStaticCellLocator()
    locator.SetDataSet(mesh)
    locator.BuildLocator()
    nearest, cell, part, square = [0.0, 0.0, 0.0], mutable(0), mutable(0), mutable(0.0)
    result = np.empty(len(places))
    for i, place in enumerate(places):
        locator.FindClosestPoint(place, nearest, cell, part, square)
        result[i] = square.get()
    return np.sqrt(result)


def is_closed(triangles):
    """Every edge has two triangles."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1).astype(np.int64)
    return bool((np.unique(edges[:, 0] * (1 + edges.max()) + edges[:, 1], return_counts=True)[1] == 2).all())


class Shape:
    """The truth is known."""

    def __init__(self, name):
        self.shape = shapes.make(name)
        self.places = self.shape.sample(PLACES, np.random.default_rng(1001))[0]

    def judge(self, mesh):
        points, triangles = corners(mesh)
        there = np.abs(self.shape.distance(on_triangles(points, triangles, PLACES, np.random.default_rng(1002))))
        return np.concatenate([there, from_mesh(mesh, self.places)])


class Scan:
    """The truth is a fine mesh."""

    def __init__(self, mesh):
        self.mesh = mesh
        self.places = on_triangles(*corners(mesh), PLACES, np.random.default_rng(1001))

    def judge(self, mesh):
        there = from_mesh(self.mesh, on_triangles(*corners(mesh), PLACES, np.random.default_rng(1002)))
        return np.concatenate([there, from_mesh(mesh, self.places)])


# The programs

class Failure(Exception):
    pass


def run(*command, timeout=1800):
    """Seconds of the clock and of the processor, the largest memory in MB, and what the program prints."""
    # threads that wait do not spin: on a busy machine they would only take time from the others
    environment = dict(os.environ, OMP_NUM_THREADS=str(THREADS), OPENBLAS_NUM_THREADS=str(THREADS), OMP_WAIT_POLICY="passive")
    with tempfile.TemporaryFile() as file:
        start = time.perf_counter()
        with subprocess.Popen([str(each) for each in command], stdout=file, stderr=subprocess.STDOUT, env=environment) as process:
            guard = threading.Timer(timeout, process.kill)
            guard.start()
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            guard.cancel()
        wall = time.perf_counter() - start
        file.seek(0)
        said = file.read().decode(errors="replace")
    if process.returncode:
        raise Failure(f"not done in {timeout} s" if wall >= timeout else (said.strip().splitlines() or [f"ended with code {process.returncode}"])[-1])
    return np.array([wall, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024]), said


def poisson(options, setting, source, out):
    depth, weight, samples = setting
    return out + ".ply", run(options.poisson, "--in", source, "--out", out + ".ply", "--depth", depth, "--pointWeight", weight,
                                   "--samplesPerNode", samples)[0]


def cgal(task):
    return lambda options, setting, source, out: (out + ".ply", run(options.cgal_program, task, source, out + ".ply", *((EDGE, *setting) if setting else ()))[0])


def lacuna(options, setting, source, out):
    _, said = run(sys.executable, os.path.abspath(__file__), "--lacuna", source, out + ".ply", *(setting or (EDGE,)))
    return out + ".ply", np.array(json.loads(said.splitlines()[-1]))


PROGRAMS = {"PoissonRecon": poisson, "CGAL Poisson": cgal("poisson"), "CGAL advancing front": cgal("front"), "Lacuna": lacuna}


def run_lacuna(source, target, edge, accuracy=0.01):
    """In a process of its own; prints the seconds and the memory of the filter."""
    import lacuna as package
    from vtkmodules.vtkCommonCore import vtkSMPTools
    from vtkmodules.vtkIOPLY import vtkPLYWriter
    vtkSMPTools.SetBackend("STDThread")
    vtkSMPTools.Initialize(THREADS)
    points, normals = read_points(source)
    surface = package.vtkLacunaRBFSurface()
    surface.SetInputData(to_vtk(points, normals))
    surface.SetOutputSpacing(float(edge))
    surface.SetAccuracy(float(accuracy))
    problems = []
    surface.AddObserver("ErrorEvent", lambda *_: problems.append(1))
    start, busy = time.perf_counter(), time.process_time()
    surface.Update()
    wall, busy = time.perf_counter() - start, time.process_time() - busy
    if problems or not surface.GetOutput().GetNumberOfCells():
        sys.exit("RBF Surface reports an error")
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    writer = vtkPLYWriter()
    writer.SetInputData(surface.GetOutput())
    writer.SetFileName(target)
    writer.Write()
    print(json.dumps([wall, busy, memory]))


def build_cgal(folder):
    """The path of the compiled program; None without CGAL."""
    program = os.path.join(folder, "surface_peers_cgal")
    source = os.path.join(HERE, "surface_peers_cgal.cxx")
    if not os.path.exists("/usr/include/CGAL/Advancing_front_surface_reconstruction.h"):
        print("CGAL is not installed (libcgal-dev, libeigen3-dev): left out")
        return None
    if not os.path.exists(program) or os.path.getmtime(program) < os.path.getmtime(source):
        subprocess.run(["g++", "-std=c++17", "-O2", "-DNDEBUG", "-DCGAL_EIGEN3_ENABLED", "-w", "-I/usr/include/eigen3", source, "-o", program, "-lgmp", "-lmpfr"], check=True)
    return program


# The cases

def prepare(options):
    """(part, case, file of points for the peers, file for Lacuna, truth) one by one."""
    folder = os.path.join(options.out, "points")
    os.makedirs(folder, exist_ok=True)

    def path(name):
        return os.path.join(folder, name + ".ply")
    truths = {}

    def truth(name):
        return truths.setdefault(name, Shape(name))
    for part in ("cases", "normals"):
        for shape in shapes.NAMES if part in options.parts else ():
            for sigma in SIGMAS:
                for patches in (False, True):
                    name = f"{shape}, {sigma} mm, {'patches' if patches else 'whole'}"
                    if not re.search(options.only, name):
                        continue
                    file = path(f"{shape}-{sigma}-{int(patches)}")
                    points, normals = shapes.case(shape, sigma, patches)
                    if part == "cases":
                        write_points(file, points, normals)
                        yield part, name, file, file, truth(shape)
                        continue
                    bare, estimated = file.replace(".ply", "-bare.ply"), file.replace(".ply", "-estimated.ply")
                    if not options.cgal_program:
                        print("normals: needs --cgal, which estimates the peers' normals; left out")
                        return
                    write_points(bare, points)
                    if not os.path.exists(estimated):
                        run(options.cgal_program, "normals", bare, estimated)
                    yield part, name, estimated, bare, truth(shape)
    if "large" in options.parts:
        write_points(path("large"), *shapes.case("kumara", 0.0, False, 100000, 0.0))
        yield "large", "kumara, 100 000 points", path("large"), path("large"), truth("kumara")
    if "heads" in options.parts:
        yield from heads(path)


def heads(path):
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkPolyDataConnectivityFilter
    from vtkmodules.vtkIOImage import vtkMetaImageReader
    files = sorted(glob.glob(os.path.join(os.environ.get("LACUNA_TEST_DATA", ""), "*", "*head*.mha")))
    if not files:
        print("heads: no */*head*.mha in LACUNA_TEST_DATA; left out")
    for file in files:
        for kind, level in (("bone", 500), ("skin", -300)):
            reader, contour, largest = vtkMetaImageReader(), vtkFlyingEdges3D(), vtkPolyDataConnectivityFilter()
            reader.SetFileName(file)
            contour.SetInputConnection(reader.GetOutputPort())
            contour.SetValue(0, level)
            contour.ComputeNormalsOff()
            largest.SetInputConnection(contour.GetOutputPort())
            largest.SetExtractionModeToLargestRegion()
            largest.Update()
            mesh = largest.GetOutput()
            points, triangles = corners(mesh)
            random = np.random.default_rng(5)
            a, b, c = (points[triangles[:, i]] for i in range(3))
            across = np.cross(b - a, c - a)
            area = np.linalg.norm(across, axis=1)
            chosen = random.choice(len(triangles), 1000000, p=area / area.sum())
            u, v = random.random((2, len(chosen), 1))
            u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
            name = f"{os.path.basename(os.path.dirname(file))}, {kind}"
            write_points(path(name.replace(", ", "-")), a[chosen] + u * (b - a)[chosen] + v * (c - a)[chosen], (across / np.maximum(area, 1e-30)[:, None])[chosen])
            yield "heads", name, path(name.replace(", ", "-")), path(name.replace(", ", "-")), Scan(mesh)


# Tables

def best(rows):
    """Of these rows the one with the least error; those that failed come last."""
    return min(rows, key=lambda row: float(row["rms"] or "inf"), default=None)


def tables(rows, facts):
    text = ["# RBF Surface beside other programs", "", "| | |", "|---|---|", *(f"| {key} | {value} |" for key, value in facts.items()), ""]
    titles = {"cases": "Thirty cases, points with normals", "normals": "The same points without normals", "large": "100 000 points of the kumara", "heads": "A million points of a head"}
    for part, title in titles.items():
        chosen = [row for row in rows if row["part"] == part]
        programs = [name for name in PROGRAMS if any(row["program"] == name for row in chosen)]
        if not chosen:
            continue
        if part in ("large", "heads"):
            text += [f"## {title}", "", "| case | program | setting | RMS, mm | 95 %, mm | closed | clock, s | processor, s | memory, MB |", "|---|---|---|---:|---:|---|---:|---:|---:|"]
            for row in sorted(chosen, key=lambda row: row["case"]):
                text.append("| " + " | ".join([row["case"], row["program"], row["setting"] or "–"] + (
                    [f"{float(row['rms']):.4f}", f"{float(row['q95']):.4f}", row["closed"], f"{float(row['clock']):.1f}", f"{float(row['processor']):.1f}", f"{float(row['memory']):.0f}"]
                    if row["rms"] else [row["problem"], "", "", "", "", ""])) + " |")
            text.append("")
            continue
        peers = [name for name in programs if name != "Lacuna"]
        text += [f"## {title}", "", "| case | Lacuna: RMS; 95 %, mm | " + " | ".join(f"{name}: RMS; 95 %, mm (setting)" for name in peers) + " | Lacuna / best peer, RMS |",
                 "|---|---:|" + "---:|" * (len(peers) + 1)]
        ratios = []
        for case in dict.fromkeys(row["case"] for row in chosen):
            cells = {}
            for name in programs:
                row = best([row for row in chosen if row["case"] == case and row["program"] == name])
                cells[name] = row if row and row["rms"] else None
            shown = [case]
            for name in ["Lacuna"] + peers:
                row = cells.get(name)
                shown.append(f"{float(row['rms']):.4f}; {float(row['q95']):.4f}" + (f" ({row['setting']})" if row["setting"] else "") + ("" if row["closed"] == "yes" else ", open")
                             if row else "–")
            rivals = [float(cells[name]["rms"]) for name in peers if cells[name]]
            if rivals and cells.get("Lacuna"):
                ratios.append(float(cells["Lacuna"]["rms"]) / min(rivals))
                shown.append(f"**{ratios[-1]:.{2 if ratios[-1] >= 0.01 else 3}f}**")
            else:
                shown.append("–")
            text.append("| " + " | ".join(shown) + " |")
        if ratios:
            text += ["", f"In {sum(r <= 0.7 for r in ratios)} of {len(ratios)} cases RBF Surface has at most 0.7 times the best peer's RMS. The largest ratio is {max(ratios):.2f}."]
        text.append("")
    return "\n".join(text)


def mesh_path(options, row):
    stem = re.sub(r"[^A-Za-z0-9.]+", "-", "-".join([row["part"], row["case"], row["program"], row["setting"]])).strip("-")
    return os.path.join(options.out, "meshes", stem + ".ply")


def measure(options, part, case, program, setting, source, truth):
    row = dict.fromkeys(FIELDS, "")
    row.update(part=part, case=case, program=program, setting=" ".join(str(each) for each in setting), version=options.version if program == "Lacuna" else "")
    try:
        path, used = PROGRAMS[program](options, setting, source, os.path.splitext(mesh_path(options, row))[0])
        mesh = read_mesh(path)
        if mesh.GetNumberOfCells() == 0:
            raise Failure("no surface")
        distances = truth.judge(mesh)
        row.update(rms=f"{np.sqrt(np.mean(distances**2)):.6f}", q95=f"{np.quantile(distances, 0.95):.6f}", largest=f"{distances.max():.4f}",
                   closed="yes" if is_closed(corners(mesh)[1]) else "no", triangles=mesh.GetNumberOfCells(),
                   clock=f"{used[0]:.2f}", processor=f"{used[1]:.2f}", memory=f"{used[2]:.0f}")
    except Failure as problem:
        row["problem"] = str(problem)[:200].replace("|", "/")
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", metavar="FOLDER", help="points, meshes and tables")
    parser.add_argument("--poisson", metavar="PATH", help="the program PoissonRecon")
    parser.add_argument("--cgal", action="store_true", help="compile surface_peers_cgal.cxx and run it")
    parser.add_argument("--parts", default="cases,normals,large,heads", help="default: all")
    parser.add_argument("--only", default="", metavar="REGEX", help="cases by name")
    parser.add_argument("--settings", type=int, default=99, metavar="N", help="of each peer the first N")
    parser.add_argument("--programs", default=",".join(PROGRAMS), help="default: all")
    parser.add_argument("--again", action="append", default=[], metavar="PROGRAM", help="measure it anew")
    parser.add_argument("--lacuna", nargs="+", metavar="IN OUT EDGE ACCURACY", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.lacuna:
        return run_lacuna(*options.lacuna)
    if not options.out:
        parser.error("--out FOLDER is missing")
    options.parts = options.parts.split(",")
    os.makedirs(os.path.join(options.out, "meshes"), exist_ok=True)
    package = importlib.util.find_spec("lacuna")
    if not package:
        sys.exit("there is no Python package lacuna: . build/release/lacuna-env.sh")
    build = os.path.abspath(os.path.join(os.path.dirname(package.origin), *[".."] * 4))
    cache = machine.read(os.path.join(build, "CMakeCache.txt"))
    source = re.search(r"CMAKE_HOME_DIRECTORY:\w+=(.*)", cache)
    options.version = machine.output("git", "-C", source.group(1) if source else HERE, "log", "-1", "--format=%h")
    options.cgal_program = build_cgal(options.out) if options.cgal else None
    programs = {"Lacuna": True, "PoissonRecon": options.poisson, "CGAL Poisson": options.cgal_program, "CGAL advancing front": options.cgal_program}
    table, rows = os.path.join(options.out, "results.csv"), []
    if os.path.exists(table):
        with open(table, encoding="utf-8", newline="") as file:
            rows = [row for row in csv.DictReader(file)]

    def save():
        with open(table + ".new", "w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        os.replace(table + ".new", table)
    for part, case, source, bare, truth in prepare(options):
        for program in [name for name in options.programs.split(",") if programs[name]]:
            settings = SETTINGS[program] + (FINE if (part, program) == ("large", "Lacuna") else [])
            for setting in settings[:options.settings]:
                same = [row for row in rows if (row["part"], row["case"], row["program"], row["setting"]) == (part, case, program, " ".join(str(each) for each in setting))]
                if same and program not in options.again:
                    continue
                row = measure(options, part, case, program, setting, bare if program == "Lacuna" else source, truth)
                rows = [each for each in rows if each not in same] + [row]
                print(f"{case:28} {program:22} {row['setting']:12} RMS {row['rms'] or row['problem']} 95 % {row['q95']}  {row['clock']} s", flush=True)
                save()
    with open(os.path.join(options.out, "results.md"), "w", encoding="utf-8") as file:
        file.write(tables(rows, machine.describe(os.path.join(HERE, "..", ".."), build)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
