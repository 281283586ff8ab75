# SPDX-License-Identifier: BSD-3-Clause
"""From a skull with a hole to programs for a mill, and back from the program to the patient."""
import os

import numpy as np
from gcode_files import read_gcode
from lacuna.errors import raising
from lacuna_test import output
from paraview import servermanager
from paraview.simple import LoadPlugin, OutputPort, SaveData
from vtkmodules.numpy_interface import dataset_adapter as dsa

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
RADIUS = 4.0
STEP_OVER = 1.0
SCALLOP = RADIUS - np.sqrt(RADIUS**2 - STEP_OVER**2 / 4)
MICROMETRE = 0.001


def fetch(proxy, port=0):
    data = servermanager.Fetch(proxy, idx=port)
    wrapped = dsa.WrapDataObject(data)
    return wrapped, lambda name: np.asarray(wrapped.FieldData[name]).ravel()


def dimensions(wrapped):
    found = [0, 0, 0]
    wrapped.VTKObject.GetDimensions(found)
    return found


def closest_on_triangle(p, a, b, c):
    """Squared distances of points from triangles, all of shape (..., 3): plane or nearest edge."""
    best = np.full(p.shape[:-1], np.inf)
    for u, v in ((a, b), (b, c), (c, a)):
        t = np.clip(np.sum((p - u) * (v - u), -1) / np.sum((v - u) ** 2, -1), 0, 1)
        best = np.minimum(best, np.sum((p - u - t[..., None] * (v - u)) ** 2, -1))
    normal = np.cross(b - a, c - a)
    height = np.sum((p - a) * normal, -1)
    inside = np.ones(p.shape[:-1], bool)
    for u, v in ((a, b), (b, c), (c, a)):
        inside &= np.sum(np.cross(v - u, p - u) * normal, -1) >= 0
    return np.where(inside, height**2 / np.sum(normal**2, -1), best)


class Part:
    """The triangles of a regular grid of points, each cell cut from (i, j) to (i + 1, j + 1)."""

    def __init__(self, points, dimensions):
        columns, rows, _ = dimensions
        self.grid = points.reshape(rows, columns, 3)
        self.spacing = self.grid[1, 1, :2] - self.grid[0, 0, :2]

    def distance(self, places):
        """Of points from the triangles within RADIUS of them, seen along z."""
        rows, columns, _ = self.grid.shape
        n = np.ceil((RADIUS + 0.1) / self.spacing).astype(int)
        first = np.floor((places[:, :2] - self.grid[0, 0, :2]) / self.spacing).astype(int)
        best = np.full(len(places), np.inf)
        for dj in range(-n[1], n[1] + 1):
            for di in range(-n[0], n[0] + 1):
                i, j = first[:, 0] + di, first[:, 1] + dj
                here = (i >= 0) & (i < columns - 1) & (j >= 0) & (j < rows - 1)
                i, j, p = i[here], j[here], places[here]
                a, c = self.grid[j, i], self.grid[j + 1, i + 1]
                for b in (self.grid[j, i + 1], self.grid[j + 1, i]):
                    best[here] = np.minimum(best[here], closest_on_triangle(p, a, b, c))
        return np.sqrt(best)


def places_on(steps, count, random):
    """Places spread over the motions of a program that are not rapid, and over its positions."""
    cuts = np.flatnonzero(steps[1:, 3] > 0)
    k = random.choice(cuts, count)
    t = np.where(np.arange(count) % 4 == 0, 1, random.random(count))[:, None]
    return steps[k, :3] + t * (steps[k + 1, :3] - steps[k, :3])


def swept_distance(points, steps):
    """Of points from the space that the ball has swept on all motions but rapid ones: above 0 left."""
    cuts = np.flatnonzero(steps[1:, 3] > 0)
    up = np.array([0, 0, RADIUS])
    a, b = steps[cuts, :3] + up, steps[cuts + 1, :3] + up
    (left, front), (right, back) = (np.minimum(a, b)[:, :2] - RADIUS - 1).T.copy(), (np.maximum(a, b)[:, :2] + RADIUS + 1).T.copy()
    result = []
    for p in points:
        near = (left <= p[0]) & (p[0] <= right) & (front <= p[1]) & (p[1] <= back)
        start, d = a[near], (b - a)[near]
        t = np.clip(np.sum((p - start) * d, 1) / np.maximum(np.sum(d * d, 1), 1e-30), 0, 1)
        result.append(np.sqrt(np.sum((start + t[:, None] * d - p) ** 2, 1).min()) - RADIUS)
    return np.array(result)


def check_path(path, name, **options):
    """What holds for every program: it is the path, it does not gouge, and it clears the rim."""
    surface = path.Input
    port = path.Input.Port
    file = output(f"FabricationChain-{name}.nc")
    warnings = []
    with raising(warnings):
        path.UpdatePipeline()
        SaveData(file, path, AcceptWarnings=1, **options)
    steps = read_gcode(file)
    lines, field = fetch(path)
    grid, grid_field = fetch(surface, port)
    assert np.array_equal(field("PressToPatient"), grid_field("PressToPatient"))
    wanted = np.asarray(lines.Points)
    wanted = wanted[np.r_[True, np.any(np.diff(wanted, axis=0) != 0, axis=1)]]
    found = steps[np.r_[True, np.any(np.diff(steps[:, :3], axis=0) != 0, axis=1)], :3]
    assert found.shape == wanted.shape and np.abs(found - wanted).max() < 1e-9, name
    part = Part(np.asarray(grid.Points), dimensions(grid))
    random = np.random.default_rng(7)
    places = places_on(steps, 4000, random)
    gouge = RADIUS - part.distance(places + [0, 0, RADIUS])
    assert gouge.max() <= MICROMETRE, (name, gouge.max())
    assert gouge.max() > -0.02, (name, "the tool touches")
    left, _ = fetch(path, 1)
    at = np.asarray(left.Points)
    over = np.asarray(left.PointData["LeftOver"]) - np.asarray(left.PointData["Unreachable"])
    border = np.any((at[:, :2] - at[:, :2].min(axis=0) < 1e-6) | (at[:, :2].max(axis=0) - at[:, :2] < 1e-6), axis=1)
    print(f"{name}: {len(steps)} blocks, {field('MachiningTime')[0] / 60:.0f} min, deepest {1000 * gouge.max():.2f} um, "
          f"left {over.max():.3f} mm, at the rim {over[border].max():.3f} mm, {warnings}", flush=True)
    # a border that slopes has the scallops of its slope
    assert over[border].max() < (8 if name == "Model" else 1) * SCALLOP + MICROMETRE, (name, over[border].max())
    return steps, part, warnings


skull = SkullPhantom()
truth = skull.GetClientSideObject()
depth = BSplineIsoRayCaster(Input=skull, IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9])
filled = RBFHoleFiller(Input=depth, Smoothing=5)
filled.DefectRegion = "None"
with raising():
    filled.UpdatePipeline()
image, image_field = fetch(filled)
columns, rows, _ = dimensions(image)
to_world = image_field("ImageToWorld").reshape(4, 4)
fitted = np.asarray(image.PointData["Fitted"]).reshape(rows, columns)
mask = np.asarray(image.PointData["FilledMask"]).reshape(rows, columns)


def offset_surface(depths, chosen, offset):
    """Points of the patient at pixels of a depth map, moved along its normals towards the viewer."""
    spacing = np.linalg.norm(to_world[:3, :2], axis=0)
    down, right = np.gradient(depths, spacing[1], spacing[0])
    j, i = np.nonzero(chosen & np.isfinite(down) & np.isfinite(right))
    local = np.column_stack([i, j, depths[j, i], np.ones(len(i))])
    axes = to_world[:3, :3] / np.linalg.norm(to_world[:3, :3], axis=0)
    normals = np.column_stack([right[j, i], down[j, i], -np.ones(len(i))]) @ axes.T
    return (local @ to_world.T)[:, :3] + offset * normals / np.linalg.norm(normals, axis=1)[:, None]


def at_pixel(array, patient):
    """Values of an array of the map at the pixels nearest to points of the patient."""
    local = np.rint((patient - to_world[:3, 3]) @ np.linalg.inv(to_world[:3, :3]).T).astype(int)
    return array[local[:, 1], local[:, 0]]


# The intact skull, from the phantom's formula
view = to_world[:3, 2] / np.linalg.norm(to_world[:3, 2])
true = np.full((rows, columns), np.nan)
for j, i in np.argwhere(np.isfinite(fitted)):
    true[j, i] = truth.IntersectOuterSurface(to_world[:3, 3] + to_world[:3, :2] @ [i, j], view)
true /= np.linalg.norm(to_world[:3, 2])
core = mask == 1
fill = np.abs(fitted - true)[core].max()
print(f"fill within {fill:.3f} mm of the intact skull", flush=True)

for mould in ("Female", "Male"):
    press = PressOrientation(Input=filled, Mould=mould, OutputSpacing=0.5, FlangeWidth=20)
    with raising():
        press.UpdatePipeline()
    grid, field = fetch(press)
    points = np.asarray(grid.Points)
    path = MillingToolPath(Input=press, ToolRadius=RADIUS, StepOver=STEP_OVER, RoughingStep=4, MapSpacing=0.5,
                           StockTop=points[:, 2].max() + 1, Overrun=RADIUS if mould == "Female" else 0)
    steps, part, warnings = check_path(path, mould, ToolNumber=4)
    assert not warnings, warnings
    reach = steps[steps[:, 3] == 800][:, :2]
    beyond = max(path.Overrun, path.LeadRadius)
    for least, largest in ((reach.min(axis=0) - points[:, :2].min(axis=0), beyond),
                           (points[:, :2].max(axis=0) - reach.max(axis=0), beyond)):
        assert np.all(least <= -path.Overrun + MICROMETRE) and np.all(least >= -2 - largest), least

    # Back in the patient: of the fit's offset under the plate the program leaves scallops and no more.
    matrix = field("PressToPatient").reshape(4, 4)
    assert abs(np.linalg.det(matrix[:3, :3]) - 1) < 1e-12
    offset = field("SurfaceOffset")[0]
    random = np.random.default_rng(3)
    steepest = np.asarray(grid.PointData["WallAngle"])[np.asarray(grid.PointData["PressRegion"]) == 2].max()
    scallop = RADIUS - np.sqrt(RADIUS**2 - (STEP_OVER / np.cos(np.radians(steepest))) ** 2 / 4)
    for name, depths, slack in (("fit", fitted, 3 * MICROMETRE), ("skull", true, 1.2 * fill)):
        patient = offset_surface(depths, core, offset)
        patient = patient[random.choice(len(patient), 400, replace=False)]
        machined = (patient - matrix[:3, 3]) @ matrix[:3, :3]
        left = swept_distance(machined, steps)
        print(f"  {name}: {left.min():.4f} to {left.max():.4f} mm left, scallop {scallop:.4f} mm", flush=True)
        assert left.min() > -slack and left.max() < scallop + slack
        for axis in (0, 1) if name == "fit" else ():
            wrong = swept_distance(machined * np.where(np.arange(3) == axis, -1, 1), steps)
            print(f"  mirrored: {wrong.min():.3f} to {wrong.max():.3f} mm", flush=True)
            assert max(-wrong.min(), wrong.max()) > 1

# The block around the defect, whose border slopes down: the hole of the skull, not its mirror image, is what is milled out.
model = DefectModel(Input=filled)
path = MillingToolPath(Input=OutputPort(model, 1), ToolRadius=RADIUS, StepOver=STEP_OVER, MapSpacing=0.5)
path.RoughingStep, path.Overrun = 4, RADIUS
steps, part, warnings = check_path(path, "Model")
assert len(warnings) == 1 and "too large for" in warnings[0], warnings  # for the edge of the floor
matrix = fetch(model, 1)[1]("PressToPatient").reshape(4, 4)
for flip in (1, -1):
    patient = offset_surface(true, np.isfinite(true), 0)
    patient = patient[np.random.default_rng(5).choice(len(patient), 600, replace=False)]
    machined = (patient - matrix[:3, 3]) @ matrix[:3, :3]
    low, high = part.grid[0, 0, :2], part.grid[-1, -1, :2]
    within = ((low + 2 < machined[:, :2]) & (machined[:, :2] < high - 2)).all(axis=1)
    hole = np.array([truth.IsInDefect(*p) for p in patient[within]])
    # the shank takes away what is above the ball
    below = machined[within] * [flip, 1, 1] - np.array([0, 0, 0.3])
    milled = np.min([swept_distance(below - [0, 0, h], steps) for h in np.arange(5.0)], axis=0) < 0
    marked = at_pixel(mask, patient[within]) == 1  # the hole and the pixels at its edge
    wrong = np.mean(milled != marked)
    print(f"model, {'as it is' if flip == 1 else 'mirrored'}: {100 * wrong:.1f} % of {len(hole)} places wrong", flush=True)
    if flip == 1:
        # within a cell of the hole's edge the grid's wall slopes
        assert milled[hole].all() and milled[marked].all() and wrong < 0.08
    else:
        assert not milled[hole].all() and wrong > 0.25
