# SPDX-License-Identifier: BSD-3-Clause
"""An implant of 120 mm to a mould, an IGES file and a milling program."""
import re

import lacuna.plugin

lacuna.plugin.load()
import numpy as np
from lacuna import coordinates
from lacuna.data import fetch
from lacuna.errors import raising
from lacuna_test import output
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance

warnings = []
phantom = SkullPhantom(Spacing=[2, 2, 2], DefectRadius=0)
head = fetch(phantom)
truth = phantom.GetClientSideObject()
direction = np.array([0.7, 0.1, 0.7]) / np.linalg.norm([0.7, 0.1, 0.7])
middle = np.array(phantom.Center) + direction * truth.IntersectOuterSurface(phantom.Center, direction)
values = vtk_to_numpy(head.GetPointData().GetScalars())  # a ball of 60 mm around a point of the skull has no bone
places = np.stack(np.meshgrid(*(np.arange(n) for n in head.GetDimensions()), indexing="ij"), axis=-1) * head.GetSpacing() + head.GetOrigin()
within = np.linalg.norm(places - middle, axis=-1) < 60
values[within.ravel(order="F") & (values > 100)] = 40
cut = TrivialProducer()
cut.GetClientSideObject().SetOutput(head)
cut.UpdatePipeline()
with raising(warnings):
    bone = SkullBone(Input=cut)
    implant = SkullImplant(Input=bone)
    press = PressOrientation(Input=implant, Seating="Inlay", FlangeWidth=25, PlateMargin=2)
    press.UpdatePipeline()
    solid, grid = fetch(implant), fetch(press)
print(warnings)


def field(data, name):
    return vtk_to_numpy(data.GetFieldData().GetArray(name)).ravel()


# The mould is the outer face, in the patient
faces = vtk_to_numpy(solid.GetCellData().GetArray("ImplantFace"))
triangles = vtk_to_numpy(solid.GetPolys().GetConnectivityArray()).reshape(-1, 3)[faces == 0]
places = vtk_to_numpy(solid.GetPoints().GetData())
size = places[np.unique(triangles)]
span = np.linalg.norm(size[:, None, :][::5] - size[None, :, :][:, ::5], axis=2).max()
assert 110 < span < 130, span
outer, cells = vtkPolyData(), vtkCellArray()
for triangle in triangles:
    cells.InsertNextCell(3, triangle)
outer.SetPoints(solid.GetPoints())
outer.SetPolys(cells)
distance = vtkImplicitPolyDataDistance()
distance.SetInput(outer)
to_patient = field(grid, "PressToPatient").reshape(4, 4)
assert abs(np.linalg.det(to_patient[:3, :3]) - 1) < 1e-9
assert field(grid, "SingleValued")[0] == 1 and coordinates.find(press) == "press", coordinates.find(press)
points = vtk_to_numpy(grid.GetPoints().GetData())
defect = vtk_to_numpy(grid.GetPointData().GetArray("DefectMask")) != 0
angles = vtk_to_numpy(grid.GetPointData().GetArray("WallAngle"))
back = points @ to_patient[:3, :3].T + to_patient[:3, 3]
dimensions = [0, 0, 0]
grid.GetDimensions(dimensions)
columns, rows, _ = dimensions
wide = defect.reshape(rows, columns)
within = wide[2:-2, 2:-2].copy()  # not beside the rim, where the face ends
for i in range(5):
    for j in range(5):
        within &= wide[j:rows - 4 + j, i:columns - 4 + i]
off = np.array([abs(distance.EvaluateFunction(p)) for p in back.reshape(rows, columns, 3)[2:-2, 2:-2][within][::7]])
print(f"{span:.0f} mm; mould {off.max():.3f} mm off the outer face, RMS {np.sqrt((off ** 2).mean()):.4f}; walls of the plate up to {angles[defect].max():.0f}, "
      f"of the mould up to {field(grid, 'DraftAngle')[0]:.0f} degrees; {field(grid, 'Depth')[0]:.1f} mm deep; face {field(grid, 'FaceDeviation')[0]:.4f} mm")
assert off.max() < 0.01, off.max()
assert defect.sum() * np.prod(np.ptp(points[:, :2], axis=0)) / len(points) > 8000  # mm²

# on to CAD and the mill, as from a depth map
igs, program = output("ImplantMould.igs"), output("ImplantMould.nc")
with raising():
    SaveData(igs, proxy=press)
    path = MillingToolPath(Input=press, StepOver=4, MapSpacing=2)
    SaveData(program, proxy=path)
with open(igs, encoding="ascii") as file:
    text = file.read()
assert "Coordinates of the press" in text and re.search("PressOrientation", text)
with open(program, encoding="ascii") as file:
    text = file.read()
assert "G21" in text and text.count("\n") > 500
print("done")
