# SPDX-License-Identifier: BSD-3-Clause
"""Phantom Sweep in pvpython: proxy, defaults, properties, truth."""
import math
import os

import lacuna
import numpy as np
from lacuna_test import check_defaults
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def fetch(proxy):
    """The output with pixels [slice, row, column] and poses [slice, 4, 4]."""
    proxy.UpdatePipeline()
    data = proxy.GetClientSideObject().GetOutputDataObject(0)
    columns, rows, slices = data.GetDimensions()
    pixels = vtk_to_numpy(data.GetPointData().GetScalars()).reshape(slices, rows, columns)
    poses = vtk_to_numpy(data.GetFieldData().GetArray("ImageToReference")).reshape(-1, 4, 4)
    return data, pixels, poses


# The active source must not become the input unasked.
wavelet = Wavelet()
SetActiveSource(wavelet)
sweep = PhantomSweep()
assert sweep.SMProxy.GetXMLName() == "LacunaPhantomSweep"
assert sweep.Input is None, sweep.Input

# Defaults of the proxy = defaults of the class.
plain = lacuna.vtkLacunaPhantomSweep()
names = [
    "NumberOfSlices", "ImageSize", "PixelSpacing", "NumberOfSweeps", "SpeckleLevel", "PoseNoise",
    "Seed", "Travel", "SweepAngle", "TwistAngle", "FanAngle", "Wander", "EdgeWidth", "Center"]
enumerations = {
    "Motion": ["Sweep", "Fan", "Twist", "Arbitrary"],
    "Anatomy": ["Ellipsoids", "Kumara", "Vessels", "Linear"],
    "OutputScalarType": ["UnsignedChar", "Float"]}
check_defaults(sweep, plain, names, enumerations)
listed = set(names) | set(enumerations) | {"Input", "TrueIsoValue", "TrueVolume"}
assert set(sweep.ListProperties()) - {"PointData", "CellData", "FieldData"} == listed, (
    sweep.ListProperties())

data, pixels, poses = fetch(sweep)
assert pixels.shape == (60, 240, 320) and pixels.dtype == np.uint8
assert poses.shape == (60, 4, 4)
for name in ("Timestamp", "SliceStatus", "FrameNumber", "ProbeToReference"):
    assert data.GetFieldData().GetArray(name).GetNumberOfTuples() == 60, name
assert data.GetFieldData().GetArray("ImageToProbe").GetNumberOfTuples() == 1

# Information properties.
sweep.UpdatePipelineInformation()
assert sweep.TrueIsoValue == 120
assert abs(sweep.TrueVolume - 4 / 3 * math.pi * 17 * 12 * 15) < 1e-6

# Every property changes the result; pixels are the truth at their place for each of the texts.
rng = np.random.default_rng(3)
for motion in ("Sweep", "Fan", "Twist", "Arbitrary"):
    for anatomy in ("Ellipsoids", "Kumara", "Vessels", "Linear"):
        other = PhantomSweep(
            Motion=motion, Anatomy=anatomy, NumberOfSlices=24, NumberOfSweeps=2,
            ImageSize=[64, 48], PixelSpacing=1.0, Center=[0.5, -1, 2])
        _, pixels, poses = fetch(other)
        assert pixels.shape == (24, 48, 64)
        client = other.GetClientSideObject()
        for k in range(24):
            for column, row in zip(rng.integers(0, 64, 25), rng.integers(0, 48, 25)):
                x, y, z, _ = poses[k] @ [column, row, 0, 1]
                truth = min(255, max(0, client.EvaluateTruth(x, y, z)))
                assert abs(float(pixels[k, row, column]) - truth) <= 0.5 + 1e-9
        Delete(other)

base = dict(Motion="Arbitrary", NumberOfSlices=9, ImageSize=[40, 30], PixelSpacing=1.5)
_, pixels, poses = fetch(PhantomSweep(**base))
for change in (
        dict(Travel=30), dict(TwistAngle=3), dict(FanAngle=1), dict(Wander=0),
        dict(Center=[3, 0, 0]), dict(PixelSpacing=1.4), dict(Motion="Fan"),
        dict(Motion="Fan", SweepAngle=90), dict(NumberOfSweeps=3), dict(PoseNoise=[1, 1]),
        dict(PoseNoise=[1, 1], Seed=4)):
    _, _, other = fetch(PhantomSweep(**{**base, **change}))
    assert not np.array_equal(other, poses), change
for change in (
        dict(Anatomy="Vessels"), dict(EdgeWidth=3.5), dict(SpeckleLevel=0.1),
        dict(SpeckleLevel=0.1, Seed=4), dict(OutputScalarType="Float")):
    _, other, _ = fetch(PhantomSweep(**{**base, **change}))
    assert not np.array_equal(other, pixels), change
_, jittered, _ = fetch(PhantomSweep(**{**base, "PoseNoise": [1, 1]}))
assert np.array_equal(jittered, pixels)

# Vessels and Linear have no closed-form volume.
vessels = PhantomSweep(Anatomy="Vessels")
vessels.UpdatePipelineInformation()
assert vessels.TrueIsoValue == 87.5 and math.isnan(vessels.TrueVolume)

# The truth on a grid.
grid = vtkImageData()
grid.SetDimensions(9, 8, 7)
grid.SetOrigin(-20, -14, -12)
grid.SetSpacing(5, 4, 4)
assert plain.AddTruth(grid)
truth = grid.GetPointData().GetArray("Truth")
for i in range(grid.GetNumberOfPoints()):
    assert abs(truth.GetValue(i) - plain.EvaluateTruth(*grid.GetPoint(i))) < 1e-4

# A volume instead of the scene: the wavelet's own values come back, 0 outside.
sampled = PhantomSweep(
    Input=wavelet, NumberOfSlices=21, ImageSize=[31, 21], PixelSpacing=1.0, Travel=20,
    OutputScalarType="Float")
data, pixels, poses = fetch(sampled)
volume = wavelet.GetClientSideObject().GetOutputDataObject(0)
values = vtk_to_numpy(volume.GetPointData().GetScalars()).reshape(21, 21, 21)
assert np.allclose(pixels[:, :, 5:26], values, atol=1e-3)
assert not pixels[:, :, :5].any() and not pixels[:, :, 26:].any()
assert math.isnan(sampled.GetClientSideObject().EvaluateTruth(0, 0, 0))
sampled.Input = None
_, pixels, _ = fetch(sampled)
assert pixels[10, 10, 15] == sweep.GetClientSideObject().EvaluateTruth(0, 0, 0)
print("passed")
