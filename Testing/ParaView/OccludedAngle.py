# SPDX-License-Identifier: BSD-3-Clause
"""Incomplete Shape and Occluded Angle in pvpython: defaults, schedules, time steps, closed surface and volume."""
import math
import os

import lacuna
import numpy as np
from lacuna import occlusion
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

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

# The suggestion for the data is the first iteration's.
suggestions = servermanager.Fetch(angle).GetFieldData().GetArray("SuggestedThresholdOverPi")
suggestions = [suggestions.GetValue(i) for i in range(3)]
assert len(set(suggestions)) > 1 and occlusion.suggested_threshold(angle) == suggestions[0], suggestions
assert [occlusion.suggested_threshold(angle, i) for i in (0, 1, 2, -1)] == suggestions + suggestions[2:]
for what, iteration, message in ((angle, 3, "no iteration 3"), (source, 0, "give the output of Occluded Angle")):
    try:
        occlusion.suggested_threshold(what, iteration)
        assert False, message
    except ValueError as error:
        assert message in str(error), error

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
voxels = servermanager.Fetch(whole).GetFieldData().GetArray("ObjectVoxels").GetValue(0)
assert voxels > 0.97 * 65 ** 3 and abs(surface.volume / (voxels / 1000) - 1) < 0.01, (surface.volume, voxels)

# Voxels that are not cubes: the closed surface runs through the centres of the outermost ones along each axis.
for spacing in ((1, 1, 1), (0.5, 1, 3)):
    for depth in (20, 1):
        values = np.zeros((depth, 30, 50), np.float32)
        block = (slice(5, 15) if depth > 1 else 0, slice(8, 20), slice(12, 36))
        values[block] = 1
        image = vtkImageData()
        image.SetDimensions(values.shape[::-1])
        image.SetSpacing(spacing)
        image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=1))
        filter = lacuna.vtkLacunaOccludedAngle()
        filter.SetInputData(image)
        filter.SetMode(filter.Binary)
        filter.SetNumberOfDirections(100)
        filter.SetThresholdsOverPi(0, 3.8 if depth > 1 else 1.9)
        points = vtk_to_numpy(occlusion.closed_surface(filter).data.GetPoints().GetData())
        index = np.argwhere(values)[:, ::-1]
        for axis in range(3 if depth > 1 else 2):
            # the middle of the faces: edges and corners are rounded
            low, high = index[:, axis].min() * spacing[axis], index[:, axis].max() * spacing[axis]
            ends = points[:, axis].min(), points[:, axis].max()
            assert abs(ends[0] - low) < 0.25 * spacing[axis] and abs(ends[1] - high) < 0.25 * spacing[axis], (
                spacing, depth, axis, ends, low, high)

# Holes are taken away, and their surface is moved into the object, too.
for depth in (40, 1):
    k, j, i = np.mgrid[:depth, :40, :40] - np.reshape([0.5 * (depth - 1), 19.5, 19.5], (3, 1, 1, 1))
    solid = np.maximum(np.maximum(abs(i), abs(j)), abs(k)) < 15
    solid &= ~((abs(i) < 6) & (abs(j + 2) < 6) & (abs(k) < 6))
    island = (abs(i) < 2.5) & (abs(j + 2) < 2.5) & (abs(k) < 2.5)
    image = vtkImageData()
    image.SetDimensions(solid.shape[::-1])
    array = numpy_to_vtk((solid | island).astype(np.uint8).ravel(), deep=1)
    array.SetName("Object")
    image.GetPointData().AddArray(array)
    surface = occlusion.closed_surface(image, largest=False)
    # between the centres of the outermost voxels: 29 wide, the hole 13, the island in it 3
    truth = (29 ** 3 - 13 ** 3 + 3 ** 3) / 1000 if depth > 1 else 29 ** 2 - 13 ** 2 + 3 ** 2
    assert abs(surface.volume / truth - 1) < 0.02, (depth, surface.volume, truth)
    points = vtk_to_numpy(surface.data.GetPoints().GetData()) - [19.5, 19.5, 19.5 if depth > 1 else 0]
    distance = abs(points + [0, 2, 0]).max(axis=1)
    wall = distance[(distance > 5) & (distance < 8)]
    assert abs(wall.max() - 6.5) < 0.2, (depth, wall.min(), wall.max())
    filled = occlusion.closed_surface(image)
    assert abs(filled.volume / (29 ** 3 / 1000 if depth > 1 else 29 ** 2) - 1) < 0.02, (depth, filled.volume)

# An object that the border cuts ends at the centres of the border's voxels, and is not smaller near by.
for depth in (41, 1):
    k, j, i = np.mgrid[:depth, :41, :41] - np.reshape([(depth - 1) // 2, 20, 20], (3, 1, 1, 1))
    ball = (i ** 2 + j ** 2 + k ** 2 < 12.5 ** 2).astype(np.uint8)
    volumes = []
    for values in (ball, np.ascontiguousarray(ball[:, :, 20:])):
        image = vtkImageData()
        image.SetExtent(3, 2 + values.shape[2], 0, 40, 0, depth - 1)
        array = numpy_to_vtk(values.ravel(), deep=1)
        array.SetName("Object")
        image.GetPointData().AddArray(array)
        surface = occlusion.closed_surface(image)
        volumes.append(surface.volume)
    assert abs(2 * volumes[1] / volumes[0] - 1) < 0.01, (depth, volumes)
    assert abs(surface.data.GetBounds()[0] - 3) < 0.1, surface.data.GetBounds()

# Half of a ray is taken, and so Binary and KeepData begin, at ln 2 / ln 20 = 0.231 of the range.
for level, kept in ((0.22, 0), (0.24, 1)):
    values = np.zeros((30, 30), np.float32)
    values[15, 15], values[5, 5] = 1, level
    image = vtkImageData()
    image.SetDimensions(30, 30, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=1))
    for mode, keep in ((0, 1), (1, 0)):
        filter = lacuna.vtkLacunaOccludedAngle()
        filter.SetInputData(image)
        filter.SetMode(mode)
        filter.SetKeepData(bool(keep))
        filter.SetNumberOfDirections(20)
        filter.SetThresholdsOverPi(0, 1.9)
        filter.Update()
        found = vtk_to_numpy(filter.GetOutput().GetPointData().GetArray("Object")).reshape(30, 30)
        assert found[15, 15] == 1 and found[5, 5] == kept, (level, mode)

# Everything object is closed at the edge of the image; nothing object and other images are said to be so.
image = vtkImageData()
image.SetDimensions(12, 12, 12)
image.GetPointData().SetScalars(numpy_to_vtk(np.full(12 ** 3, 5.0), deep=1))
filter = lacuna.vtkLacunaOccludedAngle()
filter.SetInputData(image)
filter.SetAttenuation(filter.ByArray)
filter.SetNumberOfDirections(40)
surface = occlusion.closed_surface(filter, compensate=False)
assert abs(surface.volume / (12 ** 3 / 1000) - 1) < 0.02, surface.volume
empty = vtkImageData()
empty.CopyStructure(image)
array = numpy_to_vtk(np.zeros(12 ** 3, np.uint8), deep=1)
array.SetName("Object")
empty.GetPointData().AddArray(array)
thin = vtkImageData()
thin.CopyStructure(image)
values = np.zeros((12, 12, 12), np.uint8)
values[5, 2:9, 2:9] = values[2:9, 5, 8] = 1
array = numpy_to_vtk(values.ravel(), deep=1)
array.SetName("Object")
thin.GetPointData().AddArray(array)
for what, message in ((empty, "no voxel reached"), (thin, "nowhere is it two voxels wide"), (image, "give the output of Occluded Angle")):
    try:
        occlusion.closed_surface(what)
        assert False, message
    except ValueError as error:
        assert message in str(error), error

# Of an input with time steps of its own every step is its own shape; kept iterations are those of the first step.
def frames(a, b):
    return ProgrammableSource(OutputDataSetType="vtkImageData", ScriptRequestInformation=f"""
information, executive = self.GetExecutive().GetOutputInformation(0), self.GetExecutive()
information.Set(executive.WHOLE_EXTENT(), [0, 24, 0, 24, 0, 0], 6)
information.Set(executive.TIME_STEPS(), [{a}, {b}], 2)
information.Set(executive.TIME_RANGE(), [{a}, {b}], 2)
""", Script="""
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
information, executive = self.GetExecutive().GetOutputInformation(0), self.GetExecutive()
time = information.Get(executive.UPDATE_TIME_STEP()) if information.Has(executive.UPDATE_TIME_STEP()) else -1
values, k = np.zeros((25, 25), np.float32), 4 if time < 0 else int(time)
values[k:-k, k] = values[k:-k, -k - 1] = values[k, k:-k] = values[-k - 1, k:-k] = 1
output = self.GetOutput()
output.SetExtent(0, 24, 0, 24, 0, 0)
output.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=1))
output.GetInformation().Set(output.DATA_TIME_STEP(), time)
""")


def voxels_at(proxy, time, iteration=0):
    proxy.UpdatePipeline(time)
    return servermanager.Fetch(proxy).GetFieldData().GetArray("ObjectVoxels").GetValue(iteration)


# (the script's imports come into this name space)
moving = frames(5, 8)
following = OccludedAngle(Input=moving, NumberOfDirections=60, Mode="Binary", ThresholdsOverPi=[1.3, 1.3])
following.UpdatePipelineInformation()
assert list(following.TimestepValues) == [5, 8]
sizes = [voxels_at(following, time) for time in (5, 8, 5, 8)]
assert sizes == [15 ** 2, 9 ** 2, 15 ** 2, 9 ** 2], sizes
assert servermanager.Fetch(following).GetInformation().Get(servermanager.Fetch(following).DATA_TIME_STEP()) == 8
following.KeepIterations = 1
following.UpdatePipelineInformation()
assert list(following.TimestepValues) == [1, 2]
sizes = [voxels_at(following, time) for time in (1, 2, 1, 8)]
assert sizes == [15 ** 2] * 4, sizes
following.KeepIterations = 0
following.UpdatePipelineInformation()
assert list(following.TimestepValues) == [5, 8] and voxels_at(following, 8) == 9 ** 2
