# SPDX-License-Identifier: BSD-3-Clause
"""Slice Planes in pvpython: defaults, what a display shows at once, a cropped stack, the real sweep."""
import os

import lacuna
import numpy as np
from lacuna_test import check_defaults
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna import pictures
from lacuna.errors import PipelineError, raising

sweep = PhantomSweep(Motion="Arbitrary", NumberOfSlices=20, ImageSize=[64, 48], PixelSpacing=1.0)
sweep.UpdatePipeline()
stack = servermanager.Fetch(sweep)
poses = vtk_to_numpy(stack.GetFieldData().GetArray("ImageToReference")).reshape(-1, 4, 4)
pixels = vtk_to_numpy(stack.GetPointData().GetScalars()).reshape(20, 48, 64)

# Defaults of the proxy = defaults of the class.
planes = SlicePlanes(Input=sweep)
plain = lacuna.vtkLacunaSlicePlanes()
names = ["Stride", "TranslationAccuracy", "AngularAccuracy", "SpeedLimit", "OutlineOnly", "MaximumNumberOfPoints"]
enumerations = {
    "ColorBy": ["Intensity", "Speed", "RegistrationError"],
    "InvalidSlices": ["LeaveOut", "Outline", "Show"]}
check_defaults(planes, plain, names, enumerations)
assert planes.BadPoses == "LeaveOut" and plain.GetBadPoses() == lacuna.vtkLacunaSliceAlgorithm.LeaveOut
planes.BadPoses = "KeepOutliers"
assert planes.GetClientSideObject().GetBadPoses() == lacuna.vtkLacunaSliceAlgorithm.KeepOutliers
planes.BadPoses = "LeaveOut"
assert set(planes.ListProperties()) - {"PointData", "CellData", "FieldData"} == {"Input", "BadPoses", *names, *enumerations}

# Where the pixels are, and their grey levels.
with raising():
    planes.UpdatePipeline()
data = servermanager.Fetch(planes)
points = vtk_to_numpy(data.GetPoints().GetData()).reshape(20, 48, 64, 3)
column, row = np.meshgrid(np.arange(64), np.arange(48))
image = np.stack([column, row, 0 * column, 1 + 0 * column], axis=-1)
for pose, place in zip(poses, points):
    assert np.abs(image @ pose[:3].T - place).max() < 1e-5
assert np.array_equal(vtk_to_numpy(data.GetPointData().GetArray("Intensity")).reshape(20, 48, 64), pixels)

# Speed by hand: the fastest corner, 25 slices a second.
corners = np.array([[c, r, 0, 1] for c in (0, 63) for r in (0, 47)])
places = np.array([corners @ pose[:3].T for pose in poses])
speed = np.linalg.norm(np.diff(places, axis=0), axis=2).max(axis=1) * 25
own = vtk_to_numpy(data.GetCellData().GetArray("Speed")).reshape(20, -1)
assert np.abs(own[1:, 0] - speed).max() < 1e-3 and abs(own[0, 0] - speed[0]) < 1e-3
fast = vtk_to_numpy(data.GetCellData().GetArray("TooFast")).reshape(20, -1)
assert np.array_equal(fast[1:, 0] == 1, speed > 23)

# A new display is coloured by what ColorBy says; grey levels are grey.
view = CreateView("RenderView")
for color_by, place in (("Intensity", "POINTS"), ("Speed", "CELLS"), ("RegistrationError", "POINTS")):
    planes = SlicePlanes(Input=sweep, ColorBy=color_by, SpeedLimit=0)
    with raising():
        display = Show(planes, view)
    assert list(display.ColorArrayName) == [place, color_by], list(display.ColorArrayName)
    if color_by == "Intensity":
        colours = np.array(display.LookupTable.RGBPoints).reshape(-1, 4)[:, 1:]
        assert np.allclose(colours, colours[:, :1]), colours
    Hide(planes, view)

# The pixels of a slice seen from the front are on the screen as they are in the picture, left and right included.
view = pictures.new_view((320, 240))
flat = ExtractSubset(Input=PhantomSweep(NumberOfSlices=3, ImageSize=[64, 48], PixelSpacing=1.0))
flat.VOI = [0, 63, 0, 47, 1, 1]
planes = SlicePlanes(Input=flat)
display = pictures.show_slices(planes, view)
display.SetScalarBarVisibility(view, False)
view.OrientationAxesVisibility = 0
Render(view)  # the first one places the camera
view.CameraParallelProjection = 1
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, 0, -200], [0, 0, 0], [0, -1, 0]
view.CameraParallelScale = 24
# the window is 48 mm high and 64 mm wide: 5 screen pixels a pixel
screen = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "SlicePlanes.png")
SaveScreenshot(screen, view, ImageResolution=[320, 240])
seen = PNGSeriesReader(FileNames=[screen])
seen.UpdatePipeline()
rgb = vtk_to_numpy(servermanager.Fetch(seen).GetPointData().GetScalars()).reshape(240, 320, -1)[::-1, :, 0].astype(float)
flat.UpdatePipeline()
shown = vtk_to_numpy(servermanager.Fetch(flat).GetPointData().GetScalars()).reshape(48, 64).astype(float)
corner = vtk_to_numpy(servermanager.Fetch(flat).GetFieldData().GetArray("ImageToReference")).reshape(-1, 4, 4)[1, :2, 3]
x = np.round((np.arange(4, 60) + corner[0] + 32) * 5).astype(int)
y = np.round((np.arange(4, 44) + corner[1] + 24) * 5).astype(int)
low, high = shown.min(), shown.max()
expected = (shown[4:44, 4:60] - low) / (high - low) * 255
error = np.abs(rgb[np.ix_(y, x)] - expected).mean()
mirrored = np.abs(rgb[np.ix_(y, x)] - expected[:, ::-1]).mean()
print(f"mean difference on the screen {error:.2f}, mirrored {mirrored:.2f}", flush=True)
assert error < 4 < mirrored

# A stack that was cropped says where it is.
part = ExtractSubset(Input=sweep)
part.VOI = [10, 40, 5, 30, 7, 9]
planes = SlicePlanes(Input=part)
with raising():
    planes.UpdatePipeline()
data = servermanager.Fetch(planes)
assert set(vtk_to_numpy(data.GetCellData().GetArray("SliceNumber"))) == {7, 8, 9}
assert np.abs(np.array(data.GetPoint(0)) - (poses[7] @ [10, 5, 0, 1])[:3]).max() < 1e-5

# Without times there is no speed, and the error says so.
planes = SlicePlanes(Input=ProgrammableFilter(Input=sweep, Script="""
self.GetOutputDataObject(0).GetFieldData().ShallowCopy(inputs[0].VTKObject.GetFieldData())
self.GetOutputDataObject(0).GetPointData().ShallowCopy(inputs[0].VTKObject.GetPointData())
self.GetOutputDataObject(0).GetFieldData().RemoveArray('Timestamp')
"""))
with raising():
    planes.UpdatePipeline()
assert servermanager.Fetch(planes).GetCellData().GetArray("Speed") is None
planes.ColorBy = "Speed"
try:
    with raising():
        planes.UpdatePipeline()
    raise AssertionError("no error without times")
except PipelineError as problem:
    assert "'Timestamp' is missing" in str(problem), problem
print("ok")
