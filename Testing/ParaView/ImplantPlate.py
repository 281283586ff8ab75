# SPDX-License-Identifier: BSD-3-Clause
"""From the phantom of a skull to plates in STL and PLY, as a script does it."""
import json
import os

import lacuna
import numpy as np
from lacuna.errors import PipelineError, raising
from lacuna.solids import save_solid
from lacuna_test import output
from solid_files import MILLIMETER, judge_3mf, read_3mf
from paraview import servermanager
from paraview.simple import (CreateView, Delete, ExtractSelection, LoadPlugin, OpenDataFile, PolyLineSource,
                             QuerySelect, SaveData, Show, Transform)
from vtkmodules.numpy_interface import dataset_adapter as dsa
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def fetch(proxy):
    proxy.UpdatePipeline()
    data = servermanager.Fetch(proxy)
    fields = {n: np.asarray(dsa.WrapDataObject(data).FieldData[n])
              for n in dsa.WrapDataObject(data).FieldData.keys() if n != "Provenance"}
    return data, fields


def check_closed(data):
    edges = vtkFeatureEdges()
    edges.SetInputData(data)
    edges.FeatureEdgesOff()
    edges.BoundaryEdgesOn()
    edges.NonManifoldEdgesOn()
    edges.Update()
    assert edges.GetOutput().GetNumberOfCells() == 0


phantom = SkullPhantom()
direction = [0, 0, -1]
depth = BSplineIsoRayCaster(Input=phantom, IsoValues=[500], ViewDirection=direction, ComputeThickness=1)
filled = RBFHoleFiller(Input=depth, Smoothing=5)
filled.DefectRegion = "None"
plate = ImplantPlate(Input=filled)

direct = lacuna.vtkLacunaImplantPlate()
for name in ("Thickness", "EdgeClearance", "Bevel", "CornerRadius", "TriangleSize", "HoleDiameter",
             "CountersinkDiameter", "CountersinkAngle", "MinimumBoneThickness", "DrainageSpacing",
             "DrainageDiameter", "Density"):
    assert plate.GetPropertyValue(name) == getattr(direct, "Get" + name)(), name
assert plate.Side == "Inward" and direct.GetSide() == direct.Inward
assert plate.EdgeShape == "Rounded" and direct.GetEdgeShape() == direct.Rounded
assert not plate.BevelBothFaces and not direct.GetBevelBothFaces()
assert len(plate.HolePoints) == 0 and direct.GetNumberOfHolePoints() == 0

with raising():
    data, fields = fetch(plate)
check_closed(data)
points = np.asarray(dsa.WrapDataObject(data).Points)
assert points.dtype == np.float64
volume, mass = fields["Volume"].item(), fields["Mass"].item()
properties = vtkMassProperties()
properties.SetInputData(data)
assert abs(properties.GetVolume() / volume - 1) < 1e-3
assert abs(mass - 1.3e-3 * volume) < 1e-9
assert abs(fields["MinimumThickness"].item() / 3 - 1) < 0.01, fields["MinimumThickness"]
assert fields["MinimumCurvatureRadius"].item() > 3
print("volume %.0f mm3, mass %.2f g, thickness %.4f mm, radius %.1f mm" % (
    volume, mass, fields["MinimumThickness"].item(), fields["MinimumCurvatureRadius"].item()))

# The plate is where the defect is: between the filled surface and 3 mm below it.
filled.UpdatePipeline()
image = servermanager.Fetch(filled)
wrapped = dsa.WrapDataObject(image)
columns, rows, _ = image.GetDimensions()
mask = np.asarray(wrapped.PointData["FilledMask"]).reshape(rows, columns)
fitted = np.asarray(wrapped.PointData["Fitted"]).reshape(rows, columns)
to_world = np.asarray(wrapped.FieldData["ImageToWorld"]).reshape(4, 4)
local = (np.column_stack([points, np.ones(len(points))]) @ np.linalg.inv(to_world).T)[:, :3]
i, j = np.rint(local[:, 0]).astype(int), np.rint(local[:, 1]).astype(int)
near = np.zeros(len(points), bool)
for di in (-1, 0, 1):
    for dj in (-1, 0, 1):
        near |= mask[j + dj, i + di] == 1
assert near.all()
below = local[:, 2] - fitted[j, i]
assert below.min() > -1 and below.max() < 6
faces = np.asarray(dsa.WrapDataObject(data).CellData["PlateFace"])
assert set(faces) == {0, 1, 2}

# Towards the viewer: the other way from the same surface.
plate.Side = "Outward"
plate.EdgeClearance = -4
plate.HolePoints = list(points[np.argmin(local[:, 0])] + [1.5, 0, 0])
plate.HoleDiameter = 1.6
plate.CountersinkDiameter = 2.6
plate.Thickness = 1
warnings = []
with raising(warnings):
    data, fields = fetch(plate)
check_closed(data)
assert fields["HoleCenters"].shape == (1, 3) and fields["HoleBoneThickness"].shape == (1,)
assert abs(np.linalg.norm(fields["HoleAxes"]) - 1) < 1e-9
assert fields["HoleAxes"].ravel() @ direction < 0
print("bone under the screw %.2f mm, land %.2f mm" % (
    fields["HoleBoneThickness"].item(), fields["HoleLand"].item()), warnings)
plate.MinimumBoneThickness = 100
warnings = []
with raising(warnings):
    fetch(plate)
assert any("screw hole 1 lies over" in text for text in warnings), warnings

# Holes picked with the mouse: a selection on the depth map's surface, and the handles of a line.
typed = list(plate.HolePoints)
expected = fields["HoleCenters"]
surface = DepthMapSurface(Input=filled)
surface.UpdatePipeline()
vertices = np.asarray(dsa.WrapDataObject(servermanager.Fetch(surface)).Points)
pixels = np.asarray(dsa.WrapDataObject(servermanager.Fetch(surface)).PointData["PixelId"])
Show(surface, CreateView("RenderView"))
near = pixels[np.argsort(np.linalg.norm(vertices - np.array(typed), axis=1))[:4]]
QuerySelect(QueryString=" | ".join(f"(PixelId == {k})" for k in near), FieldType="POINT",
            Source=surface)
picked = ExtractSelection(Input=surface)
plate.HolePoints = []
plate.HoleMarks = picked
with raising():
    data, fields = fetch(plate)
check_closed(data)
assert fields["HoleCenters"].shape == (1, 3)
assert np.linalg.norm(fields["HoleCenters"] - expected) < 1
line = PolyLineSource(Points=typed + typed)
plate.HoleMarks = line
with raising():
    data, fields = fetch(plate)
assert np.linalg.norm(fields["HoleCenters"] - expected) < 1e-4, fields["HoleCenters"] - expected
plate.HoleMarks = None
plate.HolePoints = typed

# Its screws as IGES; not those of a plate that has been moved, whose field data stay behind.
screws = output("ImplantPlateScrews.igs")
with raising():
    SaveData(screws, plate, SkipUnsupported=1)
with open(screws, encoding="ascii") as file:
    assert "Screw hole 1" in file.read()
os.remove(screws)
for move in ({"Translate": [1, 0, 0]}, {"Scale": [-1, 1, 1]}, {"Rotate": [0, 0, 180]}):
    moved = Transform(Input=plate)
    for name, values in move.items():
        setattr(moved.Transform, name, values)
    try:
        with raising():
            SaveData(screws, moved, SkipUnsupported=1)
        raise AssertionError(move)
    except PipelineError as error:
        assert "screw hole 1 is not where HoleCenters and HoleAxes say" in str(error), error
    assert not os.path.exists(screws)
    Delete(moved)

# Files: ParaView's writers, in the same coordinates, and what says where they come from.
for name in ("plate.stl", "plate.ply", "plate.vtp"):
    path = output(name)
    save_solid(path, plate, **({"DataMode": "Binary"} if name.endswith("vtp") else {}))
    again = OpenDataFile(path)
    again.UpdatePipeline()
    bounds = np.array(again.GetDataInformation().GetBounds())
    assert np.abs(bounds - data.GetBounds()).max() < 2e-5, name
    with open(path + ".json", encoding="utf-8") as file:
        record = json.load(file)
    assert record["file"] == name and record["unit"] == "mm"
    assert record["version"] == lacuna.__version__
    assert "vtkLacunaImplantPlate" in record["steps"][-1] and "Thickness=1 " in record["steps"][-1]
    assert "vtkLacunaSkullPhantom" in record["steps"][0]
    assert abs(record["measures"]["Volume"] - fields["Volume"].item()) < 1e-9

# 3MF: written by Lacuna, read by the consortium's own library (Debian: lib3mf1).
path = output("plate.3mf")
record = save_solid(path, plate)
assert record["file"] == "plate.3mf" and record["unit"] == "mm"
solid = read_3mf(path)
assert solid["unit"] == "millimeter" and solid["objects"] == 1 and solid["name"] == "Implant Plate"
assert solid["points"].shape == (data.GetNumberOfPoints(), 3)
points = np.asarray(dsa.WrapDataObject(data).Points)
assert np.abs(solid["points"] - points).max() <= 1e-6
cells = np.asarray(dsa.WrapDataObject(data).Polygons).reshape(-1, 4)[:, 1:]
assert np.array_equal(solid["triangles"], cells)  # same corners, same way round: not mirrored
assert "Lacuna " + lacuna.__version__ in solid["metadata"]["Application"]
assert "vtkLacunaSkullPhantom" in solid["metadata"]["Description"]
assert "Thickness=1 " in solid["metadata"]["Description"]
judged = judge_3mf(path)
if judged is None:
    print("lib3mf is not there: 3MF files are not judged by another library (Debian: lib3mf1)")
else:
    assert judged["warnings"] == [] and judged["objects"] == 1 and judged["unit"] == MILLIMETER, judged
    assert judged["manifold"], "lib3mf: not manifold and oriented"
    assert np.abs(judged["points"] - points).max() < 2e-5  # single precision there
    assert np.array_equal(judged["triangles"], cells)
    assert judged["metadata"]["Application"] == solid["metadata"]["Application"]
    print("lib3mf:", judged["triangles"].shape[0], "triangles, no warning, manifold and oriented")
try:
    save_solid(output("map.3mf"), filled)
    raise AssertionError("an image as 3MF")
except PipelineError as error:
    assert "surface" in str(error), error
assert not os.path.exists(output("map.3mf"))

plate.HolePoints = [0, 0, 0]
try:
    with raising():
        plate.UpdatePipeline()
    raise AssertionError("a hole in the middle of the head")
except PipelineError as error:
    assert "screw hole 1 at (0.0, 0.0, 0.0)" in str(error), error
plain = ImplantPlate(Input=depth)
try:
    with raising():
        plain.UpdatePipeline()
    raise AssertionError("no fit")
except PipelineError as error:
    assert "RBF Hole Filler" in str(error), error
