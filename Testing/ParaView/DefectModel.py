# SPDX-License-Identifier: BSD-3-Clause
"""From the phantom of a skull to a model of its defect, as a script does it; the plate fits in it."""
import os

import lacuna
import numpy as np
from lacuna.errors import PipelineError, raising
from lacuna.solids import save_solid
from lacuna_test import output
from paraview import servermanager
from paraview.simple import LoadPlugin, OpenDataFile, SaveData, Transform
from solid_files import MILLIMETER, judge_3mf, read_3mf
from vtkmodules.numpy_interface import dataset_adapter as dsa
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def fetch(proxy, port=0):
    proxy.UpdatePipeline()
    return servermanager.Fetch(proxy, idx=port)


def field(data, name):
    return np.asarray(dsa.WrapDataObject(data).FieldData[name])


phantom = SkullPhantom()
depth = BSplineIsoRayCaster(Input=phantom, IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9])
filled = RBFHoleFiller(Input=depth, Smoothing=5)
filled.DefectRegion = "None"
model = DefectModel(Input=filled)
direct = lacuna.vtkLacunaDefectModel()
for name in ("Margin", "DefectDepth", "BaseThickness", "MaximumHeight"):
    assert model.GetPropertyValue(name) == getattr(direct, "Get" + name)(), name
assert model.FloorShape == "Flat" and direct.GetFloorShape() == direct.Flat

warnings = []
with raising(warnings):
    solid = fetch(model)
    top = fetch(model, 1)
print("warnings:", warnings)
edges = vtkFeatureEdges()
edges.SetInputData(solid)
edges.FeatureEdgesOff()
edges.BoundaryEdgesOn()
edges.NonManifoldEdgesOn()
edges.Update()
assert edges.GetOutput().GetNumberOfCells() == 0
properties = vtkMassProperties()
properties.SetInputData(solid)
assert abs(properties.GetVolume() / field(solid, "Volume").item() - 1) < 1e-3
assert set(np.asarray(dsa.WrapDataObject(solid).CellData["ModelFace"])) == {0, 1, 2, 3, 4}
print("volume %.0f mm3, block %s mm" % (field(solid, "Volume").item(), field(solid, "BlockSize").ravel()))

# The grid for the mill is the solid's upper side: back in the patient every pixel of bone is on it.
press = np.asarray(dsa.WrapDataObject(top).Points)
assert press.dtype == np.float64 and press[:, 2].max() <= 1e-9
matrix = field(top, "PressToPatient").reshape(4, 4)
assert abs(np.linalg.det(matrix) - 1) < 1e-9
patient = press @ matrix[:3, :3].T + matrix[:3, 3]
faces = np.asarray(dsa.WrapDataObject(top).PointData["ModelFace"])
filled.UpdatePipeline()
image = servermanager.Fetch(filled)
wrapped = dsa.WrapDataObject(image)
columns, rows, _ = image.GetDimensions()
mask = np.asarray(wrapped.PointData["FilledMask"]).reshape(rows, columns)
measured = np.asarray(wrapped.PointData["Depth"]).reshape(rows, columns)
to_world = field(image, "ImageToWorld").reshape(4, 4)
local = np.column_stack([patient, np.ones(len(patient))]) @ np.linalg.inv(to_world).T
i, j = np.rint(local[:, 0]).astype(int), np.rint(local[:, 1]).astype(int)
assert np.abs(local[:, :2] - np.column_stack([i, j])).max() < 1e-9
bone = (faces == 0) & (mask[j, i] == 0) & np.isfinite(measured[j, i])
assert bone.sum() > 1000
assert np.abs(local[bone, 2] - measured[j, i][bone]).max() < 1e-9
assert np.array_equal(np.unique(press[faces == 1, 2].round(9)), field(top, "FloorHeight").ravel().round(9))

# The plate of the same map lies in the block's rectangle, above its base.
plate = ImplantPlate(Input=filled)
with raising():
    points = np.asarray(dsa.WrapDataObject(fetch(plate)).Points)
there = (points - matrix[:3, 3]) @ matrix[:3, :3]
assert (np.abs(there[:, :2]).max(axis=0) < field(top, "BlockSize").ravel()[:2] / 2 - 14).all()
assert there[:, 2].min() > field(top, "FloorHeight").item()

# Files.
for name in ("model.stl", "model.3mf"):
    record = save_solid(output(name), model)
    assert "vtkLacunaDefectModel" in record["steps"][-1] and "Margin=15" in record["steps"][-1]
    assert "vtkLacunaSkullPhantom" in record["steps"][0]
written = read_3mf(output("model.3mf"))
assert written["name"] == "Defect Model" and len(written["points"]) == solid.GetNumberOfPoints()
judged = judge_3mf(output("model.3mf"))
if judged:
    assert judged["warnings"] == [] and judged["unit"] == MILLIMETER and judged["manifold"], judged
again = OpenDataFile(output("model.stl"))
again.UpdatePipeline()
assert np.abs(np.array(again.GetDataInformation().GetBounds()) - solid.GetBounds()).max() < 2e-5
# Recessed by the plate's thickness, for a plate that rests on the floor.
model.FloorShape = "Parallel"
model.DefectDepth = 3
model.Margin = 8
with raising():
    recessed = fetch(model)
assert field(recessed, "Volume").item() < field(solid, "Volume").item()
# a shallow recess is a surface that IGES can hold; a deep one is refused by the writer
surface = output("model-top.igs")
if os.path.exists(surface):
    os.remove(surface)
with raising():
    SaveData(surface, servermanager.OutputPort(model, 1), Tolerance=0.2)
with open(surface, encoding="ascii") as file:
    text = "".join(line[:72] for line in file.readlines()[:60])
assert "vtkLacunaDefectModel" in text
mirror = Transform(Input=servermanager.OutputPort(model, 1))
mirror.Transform.Scale = [-1, 1, 1]
os.remove(surface)
try:
    with raising():
        SaveData(surface, mirror, Tolerance=0.2)
    raise AssertionError("mirrored")
except PipelineError as error:
    assert "it is mirrored" in str(error) and not os.path.exists(surface), error

model.DefectDepth = 0
try:
    with raising():
        model.UpdatePipeline()
    raise AssertionError("no depth")
except PipelineError as error:
    assert "DefectDepth is 0" in str(error), error
try:
    with raising():
        DefectModel(Input=depth).UpdatePipeline()
    raise AssertionError("no fit")
except PipelineError as error:
    assert "RBF Hole Filler" in str(error), error
