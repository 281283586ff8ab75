# SPDX-License-Identifier: BSD-3-Clause
"""Incomplete Shape and Occluded Angle in pvpython: defaults, schedules, time steps, closed surface and volume."""
import math
import os

import lacuna
import numpy as np
from lacuna import occlusion
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())

source = IncompleteShape()
plain = lacuna.vtkLacunaIncompleteShape()
for name, value in dict(Shape="Circle", Dimensions=[200, 200, 200], PresentFraction=1.0, Patches=0,
                        PatchRadii=[3.0, 8.0], GapAngle=0.0, TissueFraction=0.0, OutlierFraction=0.0,
                        Seed=0).items():
    assert np.all(np.ravel(getattr(source, name)) == np.ravel(value)), (name, getattr(source, name))
    if name != "Shape":
        assert np.all(np.ravel(getattr(plain, "Get" + name)()) == np.ravel(value)), name

# A circle with a gap of 40 degrees: the threshold pi bridges it by a straight line (Carr 1996, figure 5.13).
source = IncompleteShape(GapAngle=40, Dimensions=[200, 200, 1 + 199])
angle = OccludedAngle(Input=source)
filter = lacuna.vtkLacunaOccludedAngle()
for name, value in dict(ScalarArray="", Mode="Continuous", Attenuation="Linear in Range", NumberOfDirections=1000,
                        ObjectOpacity=0.95, Dilation=0, KeepData=0, MedianKernel=1, KeepIterations=0).items():
    assert getattr(angle, name) == value, (name, getattr(angle, name))
    if not isinstance(value, str):
        assert getattr(filter, "Get" + name)() == value, name
assert list(angle.ThresholdsOverPi) == [0] and filter.GetNumberOfThresholdsOverPi() == 1
assert list(angle.LocalRadii) == [0] and filter.GetNumberOfLocalRadii() == 1
assert filter.GetMode() == 0 and filter.GetAttenuation() == 0

angle.Mode = "Binary"
angle.NumberOfDirections = 200
angle.ThresholdsOverPi = [1.0]
data = servermanager.Fetch(angle)
values = vtk_to_numpy(data.GetPointData().GetArray("OccludedAngle")).reshape(200, 200)
radius = 0.5 * 199 - 12
assert abs(values[100, 99] - (2 * math.pi - math.radians(40))) < 0.1
chord = int(round(99.5 + radius * math.cos(math.radians(20))))
assert abs(values[100, chord] - math.pi) < 0.3, values[100, chord]
suggestion = occlusion.suggested_threshold(angle)
assert 1 < suggestion < 2, suggestion
thresholds, areas = occlusion.volume_against_threshold(angle, [1.1, 1.2])
assert np.all(np.abs(areas / (math.pi * radius ** 2) - 1) < 0.03), areas
surface = occlusion.closed_surface(angle)
# the disc less the segment beyond the chord
truth = radius ** 2 * (math.pi - 0.5 * (math.radians(40) - math.sin(math.radians(40))))
assert abs(surface.volume - truth) < 2 * math.pi * radius, (surface.volume, truth)  # within a pixel all round

# Iterations are time steps.
angle.ThresholdsOverPi = [1.6, 1.3, 1.0]
angle.KeepIterations = 1
angle.UpdatePipelineInformation()
assert list(angle.TimestepValues) == [1, 2, 3]
counts = []
for step in (1, 2, 3):
    angle.UpdatePipeline(step)
    counts.append(servermanager.Fetch(angle).GetFieldData().GetArray("ObjectVoxels").GetValue(step - 1))
assert counts[0] < counts[2], counts

# A reconstruction space, an opacity function.
space = OccludedAngle(Input=source, NumberOfDirections=60, ThresholdsOverPi=[1.0], ReconstructionSpace="Sphere")
space.ReconstructionSpace.Radius = 50
space.UpdatePipeline()  # no data inside: an error, not a crash
function = OccludedAngle(Input=source, NumberOfDirections=60, ThresholdsOverPi=[1.0], Attenuation="Opacity Function")
function.OpacityFunction.Points = [0, 0, 0.5, 0, 1, 1, 0.5, 0]
function.UpdatePipeline()
assert function.PointData["OccludedAngle"].GetRange(0)[1] > 5

# A sphere of which 10 % is seen: a closed surface whose volume is right.
ball = IncompleteShape(Shape="Sphere", Dimensions=[65, 65, 65], PresentFraction=0.1, Seed=3)
shape = OccludedAngle(Input=ball, NumberOfDirections=400, **occlusion.GROW_AND_SNAP)
surface = occlusion.closed_surface(shape)
truth = servermanager.Fetch(ball).GetFieldData().GetArray("CompleteVolume").GetValue(0)
assert abs(surface.volume / truth - 1) < 0.05, (surface.volume, truth)
assert surface.area > 0
print("sphere:", surface.volume, "ml, truth", truth)

# An object that reaches the edge of the image is closed there.
whole = OccludedAngle(Input=ball, NumberOfDirections=40, ThresholdsOverPi=[0.01])
surface = occlusion.closed_surface(whole, compensate=False)
assert abs(surface.volume / (65 ** 3 / 1000) - 1) < 0.03, surface.volume
