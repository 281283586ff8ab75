# SPDX-License-Identifier: BSD-3-Clause
"""Whether implants can be made and put in: solid, thickness, gap along the cut bone, and the way in.

    . build/release/lacuna-env.sh
    xvfb-run -a pvpython Testing/Science/implant_fit.py --tool PATH/implant_cases.py --out FOLDER [--cases NAME,...] [--random FIRST-LAST]
                         [--picture FILE.png] [--check] [NAME=CT.mha ...]

Cuts holes as skull_implants.py does, has lacuna.implant close them, and measures each implant against the CT with the hole:

clearance   mm from points of the edge to the nearest surface of bone (1 mm and more from the outer and inner face's end): mean, percentiles 5 and 95
largest     the largest of these
thinnest    mm, least distance between outer and inner face, 2 mm and more from the edge
intrusion   mm^3 of the implant in bone
contact     points of the implant, 1 mm apart, that meet bone on their way out against InsertionDirection
least       mm, the least distance of these points from bone on the first 12 mm of the way
closed, intersecting   by VTK's edges; pairs of triangles that cut each other, by CGAL (compiled where g++ and libcgal-dev are)
admesh, slicer         what Debian's admesh would repair, and whether prusa-slicer finds a manifold; empty without the program

The picture shows the first implant in its skull, cut open along InsertionDirection, and both ends of the cut from near.

FOLDER keeps the implants and fit.csv; a later call makes only what is missing. FOLDER/fit.md is the table. --check ends with 1 when an
implant misses a goal (is_good), and with 77 when the tool or the skulls are missing.
"""
import argparse
import csv
import os
import re
import shutil
import subprocess
import sys

import numpy as np
from scipy.spatial import cKDTree
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPlane, vtkPlaneCollection, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkThreshold
from vtkmodules.vtkFiltersGeneral import vtkClipClosedSurface
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkIOGeometry import vtkSTLWriter
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from skull_implants import LEVEL, find_skulls, load_tool, skull_surface  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
FIELDS = ["skull", "case", "diameter", "volume", "closed", "intersecting", "thinnest", "clearance", "p5", "p95", "largest", "intrusion", "contact",
          "least", "undercut", "admesh", "slicer", "warnings", "problem"]
OUTER, INNER, EDGE = range(3)  # ImplantFace
STEP = 0.25  # mm, of the grid in which intrusion is measured
DENSE, REACH = 0.25, 20  # mm


def face_of(implant, face):
    part = vtkThreshold()
    part.SetInputData(implant)
    part.SetInputArrayToProcess(0, 0, 0, 1, "ImplantFace")
    part.SetThresholdFunction(vtkThreshold.THRESHOLD_BETWEEN)
    part.SetLowerThreshold(face - 0.5)
    part.SetUpperThreshold(face + 0.5)
    surface = vtkGeometryFilter()
    surface.SetInputConnection(part.GetOutputPort())
    surface.Update()
    return surface.GetOutput()


def corners_of(surface):
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    return points[vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)]


def spread(corners, spacing):
    """Points on triangles, no farther than spacing apart, with their areas."""
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    points, weights = [], []
    for parts in np.unique(np.ceil(sides / spacing).astype(int)):
        chosen = np.ceil(sides / spacing).astype(int) == parts
        share = [((i + 1 / 3) / parts, (j + 1 / 3) / parts) for i in range(parts) for j in range(parts - i)]
        for u, v in share:
            points.append(corners[chosen, 0] * (1 - u - v) + corners[chosen, 1] * u + corners[chosen, 2] * v)
            weights.append(areas[chosen] / len(share))
    return np.concatenate(points), np.concatenate(weights)


class Surface:
    """Distances to triangles: to points DENSE apart on them, which is at most 0.02 mm more at 0.5 mm."""

    def __init__(self, data, around=None):
        """around: an array of points; what is farther than REACH from their box is left out."""
        corners = corners_of(data)
        if around is not None:
            low, high = around.min(axis=0) - REACH, around.max(axis=0) + REACH
            corners = corners[((corners.max(axis=1) > low) & (corners.min(axis=1) < high)).all(axis=1)]
            coarse = cKDTree(around)
            corners = corners[coarse.query(corners.mean(axis=1), distance_upper_bound=REACH)[0] < REACH]
        self.tree = cKDTree(spread(corners, DENSE)[0])

    def distances(self, points, limit):
        return np.minimum(self.tree.query(points, distance_upper_bound=limit)[0], limit)


def percentile(values, weights, part):
    order = np.argsort(values)
    return float(values[order][np.searchsorted(np.cumsum(weights[order]), part * weights.sum())])


def crossings(implant, low):
    """Where lines along z, STEP apart from low, cross the implant: column, row and height."""
    corners = corners_of(implant)
    first = np.ceil((corners[..., :2].min(axis=1) - low[:2]) / STEP).astype(int)
    last = np.floor((corners[..., :2].max(axis=1) - low[:2]) / STEP).astype(int)
    a, b, c = (corners[:, k] for k in range(3))
    twice = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    found = []
    for i in range((last - first)[:, 0].max() + 1):
        for j in range((last - first)[:, 1].max() + 1):
            k = np.flatnonzero((first[:, 0] + i <= last[:, 0]) & (first[:, 1] + j <= last[:, 1]) & (twice != 0))
            node = first[k] + (i, j)
            x, y = (low[:2] + STEP * node).T
            u = ((x - a[k, 0]) * (c[k, 1] - a[k, 1]) - (y - a[k, 1]) * (c[k, 0] - a[k, 0])) / twice[k]
            v = ((b[k, 0] - a[k, 0]) * (y - a[k, 1]) - (b[k, 1] - a[k, 1]) * (x - a[k, 0])) / twice[k]
            inside = (u >= 0) & (v >= 0) & (u + v <= 1)
            height = a[k, 2] + u * (b[k, 2] - a[k, 2]) + v * (c[k, 2] - a[k, 2])
            found.append(np.column_stack([node, height])[inside])
    return np.concatenate(found)


def intrusion(case, implant):
    """mm³ of bone in the implant, on a grid."""
    low = np.array(implant.GetBounds())[::2] - 0.1234  # no line meets a corner
    found = crossings(implant, low)
    found = found[np.lexsort(found.T[[2, 1, 0]])]
    columns, starts, counts = np.unique(found[:, :2], axis=0, return_index=True, return_counts=True)
    count = 0
    for column, start, number in zip(columns, starts, counts):
        heights = found[start:start + number, 2]
        for bottom, top in zip(heights[::2], heights[1::2]):
            z = np.arange(bottom + STEP / 2, top, STEP)
            count += int((case.sample(np.column_stack([np.tile(low[:2] + STEP * column, (len(z), 1)), z])) > LEVEL).sum())
    return count * STEP ** 3


def way_out(case, bone, points, direction):
    """How many points meet bone on their way out, and their least distance from it on the first 12 mm."""
    contact = np.zeros(len(points), bool)
    for step in np.arange(0, 150, 0.25):
        contact |= case.sample(points - step * direction) > LEVEL
    least = min(bone.distances(points - step * direction, 5.0).min() for step in np.arange(0, 12, 0.5))
    return int(contact.sum()), float(least)


def slicers(path):
    """What admesh would change in an STL file, and whether prusa-slicer finds a manifold."""
    repairs, manifold = "", ""
    if shutil.which("admesh"):
        said = subprocess.run(["admesh", path], capture_output=True, text=True, check=True).stdout
        counts = [int(n) for n in re.findall(r"(?:Degenerate facets|Edges fixed|Facets removed|Facets added|Facets reversed|Backwards edges|Normals fixed)\s*:\s*(\d+)",
                                             said)]
        repairs = sum(counts) if counts else said
    if shutil.which("prusa-slicer"):
        said = subprocess.run(["prusa-slicer", "--info", path], capture_output=True, text=True, check=False).stdout
        manifold = int("manifold = yes" in said and "open_edges" not in said and "facets_removed" not in said)
    return repairs, manifold


def compile_cgal(folder):
    """A program, or None."""
    program = os.path.join(folder, "implant_fit_cgal")
    if not os.path.exists(program) and (not shutil.which("g++") or subprocess.run(
            ["g++", "-O2", "-std=c++17", "-o", program, os.path.join(HERE, "implant_fit_cgal.cxx"), "-lgmp", "-lmpfr"], check=False).returncode):
        return None
    return program


def measure(tool, options, skull, ct, name):
    start = os.path.join(options.out, f"{skull}-{name.replace(':', '')}")
    case = tool.Case(ct, name)
    row = dict.fromkeys(FIELDS, "") | {"skull": skull, "case": name, "diameter": f"{2 * 85 * case.half:.0f}"}
    if name.startswith("random:") and not case.fair():
        return row | {"problem": "unfair"}
    cut_bone = skull_surface(case)
    subprocess.run([options.pvpython, options.tool, "cut", ct, name, f"{start}.mha"], check=True, stdout=subprocess.DEVNULL)
    hole = [f"{x:.3f}" for x in case.c + 85 * case.w]
    made = subprocess.run([options.pvpython, "--", "-m", "lacuna.implant", f"{start}.mha", "--output", f"{start}.vtp", "--hole", *hole,
                           *options.settings.split()], capture_output=True, text=True, check=False)
    os.remove(f"{start}.mha")
    if made.returncode:
        return row | {"problem": " ".join((made.stderr or made.stdout).split())}
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(f"{start}.vtp")
    reader.Update()
    implant = reader.GetOutput()
    fields = implant.GetFieldData()
    direction = np.array(fields.GetArray("InsertionDirection").GetTuple(0))
    case.a = np.minimum(case.cut(), case.a)  # from here on the skull with the hole

    if options.picture:
        draw(options.picture, case, implant)
        options.picture = None
    edges = vtkFeatureEdges()
    edges.SetInputData(implant)
    edges.FeatureEdgesOff()
    edges.NonManifoldEdgesOn()
    edges.BoundaryEdgesOn()
    edges.Update()
    bare = vtkPolyData()
    bare.SetPoints(implant.GetPoints())
    bare.SetPolys(implant.GetPolys())
    writer = vtkSTLWriter()
    writer.SetInputData(bare)
    writer.SetFileName(f"{start}.stl")
    writer.SetFileTypeToBinary()
    writer.Write()
    repairs, manifold = slicers(f"{start}.stl")
    crossing = ""
    if options.cgal:
        said = subprocess.run([options.cgal, f"{start}.stl"], capture_output=True, text=True, check=True).stdout.split()
        crossing = said[3] if said[:3] == ["1", "1", "1"] else f"closed {said[0]}, manifold {said[1]}, outward {said[2]}"

    wall, outer, inner = (corners_of(face_of(implant, face)) for face in (EDGE, OUTER, INNER))
    points, weights = spread(wall, 0.5)
    ways = spread(wall, 1.0)[0]
    bone = Surface(cut_bone, ways)
    gaps = bone.distances(points, 10.0)
    rim = cKDTree(ways)
    faces = np.concatenate([spread(face, 1.0)[0] for face in (outer, inner)])
    faces = faces[rim.query(faces)[0] < 8.0]  # what is farther within has bone of the rim only behind it
    contact, least = way_out(case, bone, np.concatenate([ways, faces]), direction)
    middle = spread(outer, 1.0)[0]
    middle = middle[rim.query(middle)[0] >= 2.0]
    undercut = fields.GetArray("UndercutVolume")
    return row | {"volume": f"{fields.GetArray('Volume').GetValue(0):.0f}", "closed": int(edges.GetOutput().GetNumberOfCells() == 0), "intersecting": crossing,
                  "thinnest": f"{cKDTree(spread(inner, DENSE)[0]).query(middle)[0].min():.2f}", "clearance": f"{np.average(gaps, weights=weights):.3f}",
                  "p5": f"{percentile(gaps, weights, 0.05):.3f}", "p95": f"{percentile(gaps, weights, 0.95):.3f}", "largest": f"{gaps.max():.2f}",
                  "intrusion": f"{intrusion(case, implant):.1f}", "contact": contact, "least": f"{least:.3f}",
                  "undercut": f"{undercut.GetValue(0):.1f}" if undercut else "", "admesh": repairs, "slicer": manifold,
                  "warnings": made.stdout.count("warning:")}


# The picture

def opened(data, plane, color, inside):
    """A closed surface cut by a plane, the cut in another colour."""
    planes = vtkPlaneCollection()
    planes.AddItem(plane)
    clip = vtkClipClosedSurface()
    clip.SetInputData(data)
    clip.SetClippingPlanes(planes)
    clip.SetScalarModeToColors()
    clip.SetBaseColor(*color)
    clip.SetClipColor(*inside)
    clip.SetPassPointData(False)
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(clip.GetOutputPort())
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(0.25)
    actor.GetProperty().SetDiffuse(0.75)
    return actor


def draw(path, case, implant):
    """case: of the skull with the hole."""
    direction = np.array(implant.GetFieldData().GetArray("InsertionDirection").GetTuple(0))
    middle = vtk_to_numpy(implant.GetPoints().GetData()).mean(axis=0)
    beside = np.cross(direction, (0, 0, 1) if abs(direction[2]) < 0.8 else (0, 1, 0))
    beside /= np.linalg.norm(beside)
    along = np.cross(beside, direction)
    plane = vtkPlane()
    plane.SetOrigin(*middle)
    plane.SetNormal(*beside)
    bare = vtkPolyData()
    bare.SetPoints(implant.GetPoints())
    bare.SetPolys(implant.GetPolys())
    places = corners_of(face_of(implant, EDGE)).mean(axis=1)
    places = places[np.abs((places - middle) @ beside) < 1]
    ends = [places[np.argmin((places - middle) @ along)], places[np.argmax((places - middle) @ along)]]
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(4)
    window.SetSize(960, 330)
    for k, (focus, scale, tilt) in enumerate(((middle, 75, 0.8), (ends[0], 7, 0.0), (ends[1], 7, 0.0))):
        renderer = vtkRenderer()
        renderer.SetBackground(1, 1, 1)
        renderer.SetViewport(k / 3, 0, (k + 1) / 3, 1)
        renderer.AddActor(opened(skull_surface(case), plane, (0.93, 0.90, 0.83), (0.80, 0.70, 0.52)))
        renderer.AddActor(opened(bare, plane, (0.62, 0.78, 0.90), (0.10, 0.33, 0.56)))
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(*focus)
        camera.SetPosition(*(focus - 500 * (beside + tilt * direction)))
        camera.SetViewUp(*-direction)
        renderer.ResetCameraClippingRange()
        camera.SetParallelScale(scale)
        window.AddRenderer(renderer)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


def is_good(row):
    """The goals: printable without repair, a gap of 0.5 ± 0.1 mm, at most 20 mm³ in bone, and a way in that is free."""
    if row["problem"]:
        return row["problem"] == "unfair"
    return (str(row["closed"]) == "1" and str(row["intersecting"]) in ("", "0") and str(row["admesh"]) in ("", "0") and str(row["slicer"]) in ("", "1")
            and 0.4 <= float(row["clearance"]) <= 0.6 and float(row["intrusion"]) <= 20 and str(row["contact"]) == "0")


def write_table(path, rows):
    with open(path, "w", encoding="utf-8") as file:
        file.write("| skull | hole | closed | crossing pairs | thinnest, mm | gap: mean (5, 95 %), mm | largest gap, mm | in bone, mm³ | contact | least gap on the "
                   "way, mm | undercut, mm³ | admesh | slicer |\n" + "|---" * 13 + "|\n")
        for row in rows:
            if not row["problem"]:
                file.write("| {skull} | {case} | {closed} | {intersecting} | {thinnest} | {clearance} ({p5}, {p95}) | {largest} | {intrusion} | {contact} | {least} "
                           "| {undercut} | {admesh} | {slicer} |\n".format(**row))
            elif row["problem"] != "unfair":
                file.write(f"| {row['skull']} | {row['case']} | {row['problem']} |" + " |" * 10 + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("skulls", nargs="*", metavar="NAME=CT.mha")
    parser.add_argument("--tool", default=os.path.join(os.environ.get("LACUNA_TEST_DATA", ""), "..", "tools", "implant_cases.py"))
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--out", required=True)
    parser.add_argument("--cases", default="")
    parser.add_argument("--random", default="")
    parser.add_argument("--picture")
    parser.add_argument("--settings", default="", help="further options of lacuna.implant, one text")
    options = parser.parse_args()
    options.pvpython = shutil.which("pvpython")
    if not os.path.exists(options.tool):
        print(f"skipped: no {options.tool} (--tool)")
        return 77
    os.makedirs(options.out, exist_ok=True)
    skulls = dict(text.split("=", 1) for text in options.skulls) or find_skulls(options)
    if not skulls:
        print("skipped: no skull: set LACUNA_TEST_DATA or install invesalius-examples")
        return 77
    options.cgal = compile_cgal(options.out)
    tool = load_tool(options.tool)
    names = [name for name in options.cases.split(",") if name]
    if options.random:
        first, last = map(int, options.random.split("-"))
        names += [f"random:{seed}" for seed in range(first, last + 1)]
    path = os.path.join(options.out, "fit.csv")
    rows = list(csv.DictReader(open(path, encoding="utf-8"))) if os.path.exists(path) and not options.check else []
    for skull, ct in skulls.items():
        for name in names:
            if any((row["skull"], row["case"]) == (skull, name) for row in rows):
                continue
            rows.append(measure(tool, options, skull, ct, name))
            print(", ".join(f"{key} {value}" for key, value in rows[-1].items() if value != ""), flush=True)
            with open(path, "w", encoding="utf-8", newline="") as file:
                writer = csv.DictWriter(file, FIELDS)
                writer.writeheader()
                writer.writerows(rows)
    write_table(os.path.join(options.out, "fit.md"), rows)
    bad = [f"{row['skull']} {row['case']}" for row in rows if not is_good(row)]
    if bad:
        print("these miss a goal:", ", ".join(bad))
    return 1 if options.check and bad else 0


if __name__ == "__main__":
    sys.exit(main())
