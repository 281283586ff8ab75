# SPDX-License-Identifier: BSD-3-Clause
"""Mirror as a script sees it: properties, defaults, the plane of a phantom, marks that pass on."""
import os

import lacuna
import numpy as np
from lacuna_test import output
from paraview.simple import ExtractSubset, LoadPlugin, SaveData
from paraview import servermanager
from vtkmodules.util.misc import calldata_type
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.util.vtkConstants import VTK_STRING

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna.errors import PipelineError, raising


def fetch(proxy, port=0):
    proxy.UpdatePipeline()
    return servermanager.Fetch(proxy, idx=port)


def field(data, name):
    array = data.GetFieldData().GetArray(name)
    return None if array is None else array.GetTuple(0)


skull = SkullPhantom(Spacing=[2, 2, 2.3], DefectRadius=25, DefectDirection=[1, 0.2, 1])
mirror = Mirror(Input=skull)
direct = lacuna.vtkLacunaMirror()
for name in ("Origin", "Normal"):
    assert tuple(mirror.GetPropertyValue(name)) == tuple(getattr(direct, "Get" + name)()), name
assert mirror.PlaneMethod == "BestSymmetry" and direct.GetPlaneMethod() == direct.BestSymmetry
assert mirror.Interpolation == "BSpline" and direct.GetInterpolation() == direct.BSpline

given = fetch(skull)
mirrored = fetch(mirror)
name = given.GetPointData().GetScalars().GetName()
assert mirrored.GetPointData().GetScalars().GetName() == "Mirrored" + name
assert field(mirrored, "Mirrored") == (1,)
print("score", field(mirrored, "SymmetryScore"), "ambiguity", field(mirrored, "SymmetryAmbiguity"),
      "normal", field(mirrored, "MirrorPlaneNormal"), "origin", field(mirrored, "MirrorPlaneOrigin"))
assert 0.8 < field(mirrored, "SymmetryScore")[0] < 1

# in a given plane between voxels, voxels come to lie on voxels
mirror.PlaneMethod = "Given"
mirror.Normal = [0, 2, 0]
middle = np.array(given.GetCenter())
mirror.Origin = list(middle)
before = vtk_to_numpy(given.GetPointData().GetScalars()).reshape(given.GetDimensions()[::-1])
after = fetch(mirror)
assert np.array_equal(vtk_to_numpy(after.GetPointData().GetScalars()).reshape(before.shape), before[:, ::-1])
asymmetry = vtk_to_numpy(after.GetPointData().GetArray("Asymmetry")).reshape(before.shape)
assert np.array_equal(asymmetry, before.astype(float) - before[:, ::-1])
assert np.allclose(field(after, "MirrorPlaneNormal"), [0, 1, 0])
assert field(after, "SymmetryAmbiguity") is None
assert fetch(mirror, 1).GetNumberOfCells() == 1

# what is cast of it is marked, too, also in a file
caster = BSplineIsoRayCaster(Input=mirror, IsoValues=[400], ViewDirection=[0, 0, -1], ViewUp=[0, 1, 0])
assert field(fetch(caster), "Mirrored") == (1,)
file = output("Mirror.vti")
SaveData(file, proxy=mirror, DataMode="Binary")
with open(file, encoding="latin-1") as stream:
    assert 'Name="Mirrored"' in stream.read()
plain = BSplineIsoRayCaster(Input=skull, IsoValues=[400], ViewDirection=[0, 0, -1], ViewUp=[0, 1, 0])
assert field(fetch(plain), "Mirrored") is None

# a map and its mirror image lie on the same pixels
other = Mirror(Input=plain, PlaneMethod="Given", Origin=list(middle), Normal=[1, 0, 0])
there = fetch(other)
here = fetch(plain)
assert there.GetDimensions() == here.GetDimensions()
assert field(there, "ImageToWorld") == field(here, "ImageToWorld")
depth = vtk_to_numpy(here.GetPointData().GetArray("Depth")).reshape(here.GetDimensions()[1::-1])
turned = vtk_to_numpy(there.GetPointData().GetArray("Depth")).reshape(depth.shape)
both = np.isfinite(depth[:, ::-1]) & np.isfinite(turned)
assert both.mean() > 0.3 and np.abs(depth[:, ::-1] - turned)[both].max() < 1e-6, both.mean()
# it is refused as a plate, and a file of its surface says what it is
errors = []


@calldata_type(VTK_STRING)
def keep(caller, event, text):
    errors.append(text)


plate = lacuna.vtkLacunaImplantPlate()
plate.AddObserver("ErrorEvent", keep)
plate.SetInputData(there)
plate.Update()
assert any("is a mirror image" in text for text in errors), errors
seen = np.lib.stride_tricks.sliding_window_view(np.isfinite(turned), (8, 8)).all(axis=(2, 3))
row, column = np.argwhere(seen)[len(np.argwhere(seen)) // 2]
clip = ExtractSubset(Input=other, VOI=[column, column + 7, row, row + 7, 0, 0])
file = output("Mirror.igs")
if os.path.exists(file):  # of a run before
    os.remove(file)
try:
    with raising():
        SaveData(file, proxy=clip)
    raise AssertionError("a mirror image was written without being asked for")
except PipelineError as error:
    assert "is a mirror image" in str(error) and not os.path.exists(file), error
SaveData(file, proxy=clip, AllowMirrored=1)
with open(file, encoding="ascii") as stream:
    assert "MIRROR IMAGE" in stream.read()
for interpolation in ("Linear", "Nearest"):
    mirror.Interpolation = interpolation
    fetch(mirror)
print("done")
