# SPDX-License-Identifier: BSD-3-Clause
"""A part as it was made against its plan: the scan of a print or a milled part is laid on the plan, and its deviation is told.

    pvpython -- -m lacuna.as_made PLAN PART [--level VALUE] [--output part.vtp] [--report DIR]

    from lacuna import as_made
    found = as_made.compare(as_made.read("implant.stl"), as_made.read("print.stl"))
    print("\\n".join(as_made.describe(found)))
"""
import argparse
import collections
import html
import os
import sys
import xml.etree.ElementTree
import zipfile

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import mutable, vtkIdTypeArray, vtkPoints, vtkDoubleArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData, vtkStaticCellLocator
from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkFeatureEdges, vtkFlyingEdges3D, vtkImplicitPolyDataDistance, vtkTriangleFilter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

MESHES = (".stl", ".ply", ".obj", ".vtp", ".3mf")
MILLIMETRES = {"micron": 0.001, "millimeter": 1, "centimeter": 10, "inch": 25.4, "foot": 304.8, "meter": 1000}  # units of 3MF
WRONG_UNITS = ((25.4, "inches"), (10, "centimetres"), (1000, "metres"))  # mm in one of them
TURNS = 12  # first looks about the shortest axis: a round part has no others
# How many looks are followed, with so many points of the part: by rounds of fitting from LOOKS on.
FIRST, LOOKS, NEXT, FINE = 60, (8, 150), (3, 500), 2000
WITHIN = (0.25, 0.5, 1.0)  # mm

Found = collections.namedtuple("Found", "plan part matrix rms other mirrored one_sided")
Found.__doc__ = """A part laid on its plan.

plan, part: vtkPolyData of triangles in the plan's coordinates, mm. Point array Deviation (double, mm): distance of a point from the
other one's surface. Of part it is positive outside of the plan, where there is too much. Of plan it is positive outside of the part, where
something is missing. matrix: 4 by 4, a rotation and a shift, from the file's coordinates of the part to those of the plan. rms: root of the mean squared
deviation over both surfaces, mm. other: the same in the next best position, turned by more than 20 degrees; mirrored: of the part's mirror image.
"""


def read(path, level=None):
    """A surface in mm as vtkPolyData of triangles.

    path: a mesh (.stl, .ply, .obj, .vtp: mm; .3mf: its unit), or a volume that lacuna.data.open_volume reads. level: of the part's
    surface in the volume's grey levels; None: halfway from air to material. Raises ValueError when there is
    no such file, no surface in it, or a point is not finite.
    """
    if path.lower().endswith(".3mf"):
        surface = _read_3mf(path)
    elif path.lower().endswith(MESHES):
        import paraview.simple as pv
        from lacuna.data import fetch
        from lacuna.errors import raising
        if not os.path.isfile(path):
            raise ValueError(f"{path}: there is no such file")
        with raising():
            reader = pv.OpenDataFile(path)
            surface = fetch(reader)
        pv.Delete(reader)
    else:
        surface = _read_volume(path, level)
    return _triangles(surface, path)


def _triangles(surface, path):
    if not surface or not surface.IsA("vtkPolyData"):
        raise ValueError(f"{path} has no surface")
    if surface.GetNumberOfPoints() and not np.isfinite(vtk_to_numpy(surface.GetPoints().GetData())).all():
        raise ValueError(f"{path}: a point is not finite")
    plain = vtkPolyData()
    plain.SetPoints(surface.GetPoints())
    plain.SetPolys(surface.GetPolys())
    plain.SetStrips(surface.GetStrips())
    whole = vtkTriangleFilter()
    whole.SetInputData(plain)
    clean = vtkCleanPolyData()  # STL has each corner for each triangle
    clean.SetInputConnection(whole.GetOutputPort())
    clean.Update()
    plain = vtkPolyData()
    if clean.GetOutput().GetNumberOfPolys() == 0:
        raise ValueError(f"{path} has no surface")
    points = vtkPoints()
    points.SetData(numpy_to_vtk(vtk_to_numpy(clean.GetOutput().GetPoints().GetData()).astype(float), deep=True))
    plain.SetPoints(points)
    plain.SetPolys(clean.GetOutput().GetPolys())
    return plain


def _read_3mf(path):
    """All objects of a 3MF file's build, where they lie, in mm."""
    core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    try:
        with zipfile.ZipFile(path) as file:
            name = next(name for name in file.namelist() if name.lower().endswith(".model"))
            model = xml.etree.ElementTree.fromstring(file.read(name))
    except FileNotFoundError as error:
        raise ValueError(f"{path}: there is no such file") from error
    except (OSError, StopIteration, zipfile.BadZipFile, xml.etree.ElementTree.ParseError) as error:
        raise ValueError(f"{path} is no 3MF file: {error or 'it has no model'}") from error
    unit = model.get("unit", "millimeter")
    if unit not in MILLIMETRES:
        raise ValueError(f"{path}: {unit} is no unit of 3MF")
    objects = {one.get("id"): one for one in model.iter(core + "object")}
    points, corners, count = [], [], 0

    def add(key, place, depth=0):
        nonlocal count
        if key not in objects or depth > 16:
            raise ValueError(f"{path}: the object {key} is not there")
        one = objects[key]
        own = [[float(vertex.get(axis)) for axis in "xyz"] for vertex in one.iter(core + "vertex")]
        if own:
            triangles = [[int(triangle.get(corner)) for corner in ("v1", "v2", "v3")] for triangle in one.iter(core + "triangle")]
            if triangles and not (0 <= np.min(triangles) and np.max(triangles) < len(own)):
                raise ValueError(f"{path}: a triangle has a corner that is not there")
            points.append(np.array(own) @ place[:3] + place[3])
            corners.extend((np.array(triangles, int).reshape(-1, 3) + count).tolist())
            count += len(own)
        for part in one.iter(core + "component"):
            add(part.get("objectid"), _join(_place(part), place), depth + 1)

    def _place(item):
        numbers = [float(number) for number in (item.get("transform") or "1 0 0 0 1 0 0 0 1 0 0 0").split()]
        if len(numbers) != 12:
            raise ValueError(f"{path}: a transform has {len(numbers)} numbers, not 12")
        place = np.array(numbers).reshape(4, 3)
        if np.linalg.det(place[:3]) <= 0:
            raise ValueError(f"{path} mirrors an object")
        return place

    def _join(first, then):
        return np.vstack([first[:3] @ then[:3], first[3] @ then[:3] + then[3]])

    try:
        for item in model.iter(core + "item"):
            add(item.get("objectid"), _place(item))
    except (TypeError, ValueError) as error:
        raise ValueError(str(error) if str(error).startswith(path) else f"{path} is no 3MF file: {error}") from error
    if not corners:
        raise ValueError(f"{path} has no surface")
    return _surface(np.concatenate(points) * MILLIMETRES[unit], np.array(corners))


def _surface(points, corners):
    surface, places, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points, float), deep=True))
    offsets = numpy_to_vtk(np.arange(0, 3 * len(corners) + 1, 3), deep=True, array_type=vtkIdTypeArray().GetDataType())
    cells.SetData(offsets, numpy_to_vtk(np.ascontiguousarray(corners.ravel()), deep=True, array_type=vtkIdTypeArray().GetDataType()))
    surface.SetPoints(places)
    surface.SetPolys(cells)
    return surface


def _read_volume(path, level):
    import paraview.simple as pv
    from lacuna.data import fetch, open_volume
    reader = open_volume(path)
    image = fetch(reader)
    pv.Delete(reader)
    values = image.GetPointData().GetScalars()
    if values.GetNumberOfComponents() != 1:
        raise ValueError(f"{path} has {values.GetNumberOfComponents()} numbers in each voxel, not one")
    indices = vtkImageData()  # the filter's answer does not depend on how VTK's version heeds directions
    indices.SetExtent(image.GetExtent())
    indices.GetPointData().SetScalars(values)
    contour = vtkFlyingEdges3D()
    contour.SetInputData(indices)
    contour.ComputeNormalsOff()
    contour.ComputeScalarsOff()
    contour.SetValue(0, find_level(vtk_to_numpy(values)) if level is None else level)
    contour.Update()
    surface = contour.GetOutput()
    if surface.GetNumberOfPoints() == 0:
        raise ValueError(f"{path}: nothing has the level {contour.GetValue(0):g}")
    matrix = image.GetIndexToPhysicalMatrix()
    matrix = np.array([matrix.GetElement(i, k) for i in range(4) for k in range(4)]).reshape(4, 4)
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
    corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    if np.linalg.det(matrix[:3, :3]) < 0:
        corners = corners[:, ::-1]  # left-handed indices: still the same patient, with triangles the other way
    return _surface(points, corners)


def find_level(values):
    """The grey level of a part's surface in a scan: halfway between the most frequent levels of air and of material, which Otsu's method (1979)
    divides. Thin parts have many voxels on their surface, which draw means and medians towards it."""
    counts, edges = np.histogram(values, 256)
    middles = (edges[1:] + edges[:-1]) / 2
    below, sums = np.cumsum(counts), np.cumsum(counts * middles)
    with np.errstate(divide="ignore", invalid="ignore"):
        between = (sums[-1] * below / below[-1] - sums) ** 2 / (below * (below[-1] - below))
    first = 1 + np.nanargmax(between)  # bin of material
    smooth = np.convolve(counts, np.ones(5) / 5, "same")
    return (middles[smooth[:first].argmax()] + middles[first + smooth[first:].argmax()]) / 2


class _Solid:
    """A surface of triangles: samples of it by area, and closest points on it."""

    def __init__(self, surface):
        self.points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
        self.corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        a, b, c = (self.points[self.corners[:, k]] for k in range(3))
        normals = np.cross(b - a, c - a)
        self.areas = np.linalg.norm(normals, axis=1) / 2
        self.area = self.areas.sum()
        if not self.area > 0:
            raise ValueError("a surface has no area")
        self.normals = normals / np.maximum(2 * self.areas[:, None], 1e-300)
        middles = (a + b + c) / 3
        self.center = self.areas @ middles / self.area
        spread = np.zeros((3, 3))
        for corner in (a, b, c, middles):  # of triangles: a twelfth for each corner, three quarters for the middle
            off = corner - self.center
            spread += (self.areas[:, None] * off).T @ off * (0.75 if corner is middles else 1 / 12)
        values, self.axes = np.linalg.eigh(spread / self.area)  # the shortest first
        self.size = np.sqrt(values)
        self.axes[:, 2] *= np.sign(np.linalg.det(self.axes))
        self.locator = vtkStaticCellLocator()
        self.surface = surface
        self.locator.SetDataSet(surface)
        self.locator.BuildLocator()

    def samples(self, count):
        """So many points, evenly by area, the same ones each time."""
        places = (np.arange(count) + 0.5) / count * self.area
        ends = np.cumsum(self.areas)
        found = np.minimum(np.searchsorted(ends, places), len(ends) - 1)
        u = (np.arange(count) * 0.7548776662466927) % 1  # the plastic number's sequence fills a square evenly
        v = (np.arange(count) * 0.5698402909980532) % 1
        u, v = np.where(u + v > 1, 1 - u, u)[:, None], np.where(u + v > 1, 1 - v, v)[:, None]
        a, b, c = (self.points[self.corners[found, k]] for k in range(3))
        return a + u * (b - a) + v * (c - a)

    def closest(self, points):
        """Closest points of the surface, and the normals there."""
        feet, cells = [], []
        cell, sub, square, foot = mutable(0), mutable(0), mutable(0.0), [0.0] * 3
        find = self.locator.FindClosestPoint
        for point in points.tolist():
            find(point, foot, cell, sub, square)
            feet.append(tuple(foot))
            cells.append(cell.get())
        feet = np.array(feet)
        return feet, self.normals[cells]


def _fit(plan, points, matrix, rounds, tolerance):
    """Moves points onto the plan from a first guess, point to plane with Tukey's weights; returns the matrix."""
    for _ in range(rounds):
        moved = points @ matrix[:3, :3].T + matrix[:3, 3]
        feet, normals = plan.closest(moved)
        off = moved - feet
        # where the foot is on an edge, the way to it, not the triangle's normal, is what counts
        lengths = np.linalg.norm(off, axis=1)
        ways = np.where((lengths > 1e-9)[:, None], off / np.maximum(lengths, 1e-9)[:, None], normals)
        scale = max(1.4826 * np.median(lengths), 1e-4)
        weights = np.maximum(1 - (lengths / (6 * scale)) ** 2, 0) ** 2
        middle = moved.mean(axis=0)
        rows = np.hstack([np.cross(moved - middle, ways), ways])
        step = np.linalg.lstsq(rows.T @ (weights[:, None] * rows) + 1e-9 * np.eye(6), -rows.T @ (weights * lengths), rcond=None)[0]
        angle = np.linalg.norm(step[:3])
        turn = _rotation(step[:3])
        change = np.eye(4)
        change[:3, :3], change[:3, 3] = turn, middle + step[3:] - turn @ middle
        matrix = change @ matrix
        if angle * plan.size[2] < tolerance and np.linalg.norm(step[3:]) < tolerance:
            break
    return matrix


def _rotation(vector):
    """The rotation by a vector's length about it (Rodrigues)."""
    angle = np.linalg.norm(vector)
    if angle < 1e-15:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def _spread(plan, part, matrix, count):
    """Root of the mean squared distance, of the part's points from the plan and the other way."""
    turn, shift = matrix[:3, :3], matrix[:3, 3]
    there = part.samples(count) @ turn.T + shift
    back = (plan.samples(count) - shift) @ turn
    squares = [((points - solid.closest(points)[0]) ** 2).sum(axis=1).mean() for solid, points in ((plan, there), (part, back))]
    return float(np.sqrt(np.mean(squares)))


def _register(plan, part):
    """[(rms, matrix)] of the positions that were followed, the best first. They are more than 20 degrees from each other."""
    looks = [np.eye(4)]  # as it lies
    for flip in (np.diag([1.0, 1, 1]), np.diag([-1.0, 1, -1])):
        for k in range(TURNS):
            look = np.eye(4)
            look[:3, :3] = plan.axes @ _rotation(np.array([2 * np.pi * k / TURNS, 0, 0])) @ flip @ part.axes.T
            look[:3, 3] = plan.center - look[:3, :3] @ part.center
            looks.append(look)
    rated = sorted((_spread(plan, part, look, FIRST), k) for k, look in enumerate(looks))
    points = part.samples(LOOKS[1])
    looks = [_fit(plan, points, looks[k], 8, 1e-2) for _, k in rated[:LOOKS[0]]]
    rated = sorted((_spread(plan, part, look, LOOKS[1]), k) for k, look in enumerate(looks))
    points, followed = part.samples(NEXT[1]), []
    for _, k in rated:
        if len(followed) < NEXT[0] and all(_angle(looks[k], other) > 20 for _, other in followed):
            matrix = _fit(plan, points, looks[k], 25, 1e-3)
            followed.append((_spread(plan, part, matrix, NEXT[1]), matrix))
    apart = []
    for one in sorted(followed, key=lambda one: one[0]):
        if all(_angle(one[1], other) > 20 for _, other in apart):
            apart.append(one)
    return apart


def _angle(matrix, other):
    """Degrees between two rotations."""
    return np.degrees(np.arccos(np.clip((np.trace(matrix[:3, :3].T @ other[:3, :3]) - 1) / 2, -1, 1)))


def compare(plan, part):
    """Lays a part on its plan (vtkPolyData of triangles in mm each, as read() gives them): a Found.

    No position needs to be near: the part may lie and be turned anyhow. It is moved as a whole, never scaled and never mirrored; places
    where it differs do not draw it away from the others. Raises ValueError when the sizes do not fit, as of a file in inches.
    """
    one, two = _Solid(plan), _Solid(part)
    ratio = np.sqrt(two.area / one.area)
    larger = max(ratio, 1 / ratio)
    for factor, name in WRONG_UNITS:
        if abs(larger / factor - 1) < 0.1:
            size, whose = ("large", "plan") if ratio > 1 else ("small", "part")
            raise ValueError(f"the part is {larger:.4g} times as {size} as the plan: the {whose}'s file seems to be in {name}. Save it in millimetres")
    if not 0.5 < ratio < 2:
        raise ValueError(f"the part's surface has {two.area / 100:.4g} cm², the plan's {one.area / 100:.4g} cm²: these are not the same part")
    followed = _register(one, two)
    matrix = _fit(one, two.samples(FINE), followed[0][1], 25, 1e-5)
    rms = _spread(one, two, matrix, NEXT[1])
    image = _surface(two.points * [-1, 1, 1], two.corners[:, ::-1])
    mirrored = _register(one, _Solid(image))[0][0]
    moved = _surface(two.points @ matrix[:3, :3].T + matrix[:3, 3], two.corners)
    whole = _surface(one.points, one.corners)
    for surface, to in ((moved, plan), (whole, moved)):
        distance = vtkImplicitPolyDataDistance()
        distance.SetInput(to)
        values = vtkDoubleArray()
        distance.FunctionValue(surface.GetPoints().GetData(), values)
        values.SetName("Deviation")
        surface.GetPointData().SetScalars(values)
    # a surface without an inside has no sign
    return Found(whole, moved, matrix, rms, followed[1][0] if len(followed) > 1 else None, mirrored, not (_is_closed(plan) and _is_closed(part)))


def _is_closed(surface):
    edges = vtkFeatureEdges()
    edges.SetInputData(surface)
    edges.FeatureEdgesOff()
    edges.Update()
    return edges.GetOutput().GetNumberOfCells() == 0


Deviation = collections.namedtuple("Deviation", "mean rms low high outward outward_at inward inward_at within")


def deviation(surface):
    """Of a surface with Deviation: mean, rms, low and high (2.5 % and 97.5 % of the area are below), the largest outward and inward, in mm,
    with their places; within: parts of the area at most so many mm off, of WITHIN. By area: each point has a third of its triangles."""
    values = vtk_to_numpy(surface.GetPointData().GetArray("Deviation"))
    points = vtk_to_numpy(surface.GetPoints().GetData())
    corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    a, b, c = (points[corners[:, k]] for k in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    weights = sum(np.bincount(corners[:, k], areas, len(points)) for k in range(3))
    weights /= weights.sum()
    order = np.argsort(values)
    share = np.cumsum(weights[order])
    low, high = (float(values[order[min(np.searchsorted(share, part), len(order) - 1)]]) for part in (0.025, 0.975))
    most, least = values.argmax(), values.argmin()
    return Deviation(float(weights @ values), float(np.sqrt(weights @ values**2)), low, high, float(values[most]), points[most],
                     float(values[least]), points[least], [float(weights[np.abs(values) <= limit].sum()) for limit in WITHIN])


def warnings(found):
    """What somebody who uses the numbers has to know: a list of sentences."""
    told = []
    if found.mirrored < 0.5 * found.rms and found.rms - found.mirrored > 0.1:
        told.append(f"the part's mirror image fits the plan better ({found.mirrored:.2f} mm) than the part does ({found.rms:.2f} mm): it was made mirrored, for "
                    "the wrong side")
    if found.other is not None and found.other < 1.25 * found.rms + 0.02:
        told.append(f"the part fits in another position nearly as well ({found.other:.2f} mm, here {found.rms:.2f} mm): it is too symmetric to say which "
                    "place of the part is which of the plan")
    if found.one_sided:
        told.append("one of the surfaces is not closed: where it has a border, outside and inside are not sure")
    return told


def describe(found):
    """The result in plain words, a list of lines."""
    return [f"{name}: {value}" for name, value in rows(found)]


def rows(found):
    """(quantity, value) of the table."""
    def place(point):
        return "at " + " ".join(f"{x:.1f}" for x in point) + " mm"
    there, back = deviation(found.part), deviation(found.plan)
    turn = _angle(found.matrix, np.eye(4))
    listed = [("deviation of the part from the plan, RMS", f"{there.rms:.3f} mm"), ("the same, mean", f"{there.mean:+.3f} mm"),
              ("95 % of the part's surface", f"{there.low:+.2f} to {there.high:+.2f} mm"),
              ("most material too much", f"{there.outward:+.2f} mm {place(there.outward_at)}"),
              ("most material missing", f"{0 - back.outward:+.2f} mm {place(back.outward_at)}")]
    listed += [(f"surface within {limit:g} mm", f"{100 * part:.1f} %") for limit, part in zip(WITHIN, there.within)]
    listed += [("volume as planned, as made", f"{_volume(found.plan) / 1000:.3f} ml, {_volume(found.part) / 1000:.3f} ml")] if not found.one_sided else []
    shift = " ".join(f"{x:.2f}" for x in found.matrix[:3, 3])
    return [*listed, ("how the part was moved onto the plan", f"turned by {turn:.1f}°, its file's origin to {shift} mm")]


def _volume(surface):
    """mm³, by the divergence theorem."""
    points = vtk_to_numpy(surface.GetPoints().GetData())
    points = points - points.mean(axis=0)
    a, b, c = (points[vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(
        prog="lacuna.as_made", description="Lays a part as it was made on its plan, and tells how far it is from it. The part may lie and be turned anyhow. "
        "Research software, not a medical device.",
        epilog="Exit codes: 0 done; 1 something failed, one sentence says what; 2 the command is wrong.")
    parser.add_argument("plan", metavar="PLAN", help="the implant as planned, in mm: " + " ".join(MESHES))
    parser.add_argument("part", metavar="PART", help="the part as made: a mesh as above, or a scan of it (a DICOM series, .mha, .nrrd, .nii, .vti)")
    parser.add_argument("--level", type=float, metavar="VALUE", help="grey level of the part's surface in a scan. Default: halfway from air to material")
    parser.add_argument("--output", metavar="FILE", help="write the part where it lies on the plan, with its Deviation: .vtp")
    parser.add_argument("--report", metavar="DIR", help="write index.html with pictures and numbers into this folder")
    options = parser.parse_args(arguments)
    if options.output and not options.output.lower().endswith(".vtp"):
        parser.error(f"--output: {options.output} does not end in .vtp, which can hold the deviation")
    if not options.plan.lower().endswith(MESHES):
        parser.error(f"PLAN: {options.plan} does not end in one of {' '.join(MESHES)}")
    return options


def main(arguments=None):
    """The command. Returns 0, or 1 after a failure that one sentence on the standard error explains; wrong arguments exit with 2."""
    options = parse_arguments(arguments)
    try:
        if options.report:
            os.makedirs(options.report, exist_ok=True)
        found = compare(read(options.plan), read(options.part, options.level))
        told = warnings(found)
        print("\n".join(describe(found) + [f"warning: {one}" for one in told]), flush=True)
        if options.output:
            _write(options.output, found.part)
        if options.report:
            from lacuna.implant import check_screen
            check_screen("the deviation is measured, the report is not written", "lacuna.as_made")
            write_report(options.report, found, os.path.basename(options.plan), os.path.basename(os.path.abspath(options.part)))
    except (ValueError, RuntimeError, OSError, MemoryError) as error:
        print(f"lacuna.as_made: {error or 'there is not enough memory'}", file=sys.stderr, flush=True)
        return 1
    return 0


def _write(path, surface):
    from lacuna.errors import raising
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(surface)
    with raising():
        if not writer.Write():
            raise ValueError(f"{path} cannot be written")


def write_report(folder, found, plan_name, part_name):
    """Writes index.html and its pictures into a folder that exists. plan_name, part_name: of the files, without their folders."""
    import paraview.simple as pv
    from lacuna import pictures
    from lacuna.implant_report import STYLE
    from lacuna.solids import NOTICE
    there = deviation(found.part)
    limit = max(0.5, np.ceil(10 * max(-there.low, there.high)) / 10)
    source = pv.TrivialProducer()
    source.GetClientSideObject().SetOutput(found.part)
    view = pictures.new_picture((900, 720))
    view.OrientationAxesVisibility = 0
    display = pictures.show_surface(source, view, pictures.METAL)
    pictures.color_by(display, view, "Deviation", "deviation, mm", (-limit, limit))
    axes = _Solid(found.plan).axes
    shown = (("outside", "One side", 1), ("inside", "The other side", -1))
    for name, _, sign in shown:
        pictures.look(view, list(sign * axes[:, 0]), list(axes[:, 2]))
        pictures.save(view, os.path.join(folder, name + ".png"))
    pv.Delete(view)
    pv.Delete(source)
    values = vtk_to_numpy(found.part.GetPointData().GetArray("Deviation"))
    counts, edges = np.histogram(np.clip(values, -limit, limit), 80, (-limit, limit))
    curve = [("points", (edges[1:] + edges[:-1]) / 2, 100 * counts / len(values), (47, 110, 168), "line")]
    pictures.write_pixels(os.path.join(folder, "histogram.png"), pictures.chart_pixels(curve, ("deviation, mm", "part of the points, %"), legend=False))
    text = html.escape
    told = "\n".join(f'<p class="warning">{text(one)}</p>' for one in warnings(found)) or '<p class="fine">No warnings.</p>'
    table = "\n".join(f"<tr><td>{text(name)}</td><td>{text(value)}</td></tr>" for name, value in rows(found))
    figures = "\n".join(f'<figure><img src="{name}.png" alt="{text(title)}"><figcaption>{text(title)}: blue is too little, red too much</figcaption></figure>'
                        for name, title, _ in shown)
    with open(os.path.join(folder, "index.html"), "w", encoding="utf-8") as file:
        file.write(f"""<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>As made against as planned</title><style>{STYLE}</style></head>
<body>
<h1>As made against as planned</h1>
<p>Plan: {text(plan_name)} · part: {text(part_name)}</p>
<p class="notice"><b>{text(NOTICE)}</b></p>
<h2>Warnings</h2>
{told}
<h2>Deviation</h2>
<div class="two">
{figures}
<figure><img src="histogram.png" alt="Histogram"><figcaption>How often each deviation occurs</figcaption></figure>
</div>
<table>
{table}
</table>
<p>Places are in the plan's coordinates. The part was turned and shifted as a whole, and neither scaled nor mirrored.</p>
</body>
</html>
""")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
