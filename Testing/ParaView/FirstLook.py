# SPDX-License-Identifier: BSD-3-Clause
"""lacuna.window: a CT is seen as bone, upright, with the patient's sides; a sweep as slices in space; nothing else is changed."""
import os
import shutil

import lacuna.plugin

lacuna.plugin.load()
import numpy as np
from lacuna import pictures, views, window
from lacuna.data import fetch
from lacuna_test import output
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter

folder = output("FirstLook")
shutil.rmtree(folder, ignore_errors=True)
os.makedirs(folder)


def new_view():
    view = CreateRenderView()
    view.ViewSize = [400, 300]
    view.OrientationAxesVisibility = view.CenterAxesVisibility = 0
    SetActiveView(view)
    return view


def pixels(view):
    Render(view)
    grab = vtkWindowToImageFilter()
    grab.SetInput(view.GetRenderWindow())
    grab.ReadFrontBufferOff()
    grab.Update()
    image = grab.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, 3).astype(int)


# A CT: the phantom's hole is on the patient's left, in front and on top, so in the picture from the front at the upper right.
view = new_view()
skull = SkullPhantom(Spacing=[2, 2, 2])
window.show(skull, view)
display = GetDisplayProperties(skull, view)
assert display.Representation == "Volume" and display.Shade == 1
camera = view.GetActiveCamera()
assert np.allclose(camera.GetDirectionOfProjection(), (0, 1, 0)) and np.allclose(camera.GetViewUp(), (0, 0, 1))
assert views.camera_letters(camera) == {"left": "R", "right": "L", "top": "H", "bottom": "F"}
texts = sorted(each.Input.Text for each in view.Representations if each.GetProperty("WindowLocation") and each.Input.GetXMLName() == "TextSource")
assert texts == ["F", "H", "L", "R"], texts
seen = pixels(view)
middle = seen[100:200, 150:250].reshape(-1, 3).mean(0)
corner = seen[2, 2]
assert middle[0] > 150 and middle[0] > middle[2] + 20, ("bone is bright and warm", middle)
assert abs(seen[2:30, 2:60] - corner).max() < 8, "air is not seen"
whole = window.show(SkullPhantom(Spacing=[2, 2, 2], DefectRadius=0), new_view())
change = abs(pixels(GetActiveView()) - seen).sum(2)
rows, columns = np.nonzero(change > 60)
assert len(rows) > 50 and rows.mean() > 150 and columns.mean() > 200, ("the hole is at the upper right", rows.mean(), columns.mean())
slice_colors = GetColorTransferFunction("HounsfieldUnits")
assert list(slice_colors.RGBPoints)[1:4] == [0, 0, 0], "slices stay grey"

# Hounsfield units of other readers are known by their range, ultrasound and others are not taken for them
script = """
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
output.SetDimensions(8, 8, 8)
values = numpy_to_vtk(np.linspace(%g, %g, 512))
values.SetName("%s")
output.PointData.SetScalars(values)
"""


def made_volume(low, high, name="Intensity"):
    source = ProgrammableSource(OutputDataSetType="vtkImageData", Script=script % (low, high, name),
                                ScriptRequestInformation="executive = self.GetExecutive(); executive.GetOutputInformation(0).Set(executive.WHOLE_EXTENT(), 0, 7, 0, 7, 0, 7, )")
    source.UpdatePipeline()
    return source


assert window.is_ct(made_volume(-1024, 1500)) and window.is_ct(made_volume(-1024, 1500, "HounsfieldUnits"))
assert not window.is_ct(made_volume(0, 255)) and not window.is_ct(made_volume(-1024, 200)) and not window.is_ct(made_volume(-1024, 1500, "Pressure"))
view = new_view()
wavelet = Wavelet()
window.show(wavelet, view)
assert GetDisplayProperties(wavelet, view).Representation == "Outline"

# A volume of which it is not known that it is the patient's has no letters
view = new_view()
window.show(made_volume(-1024, 1500), view)
assert not [each for each in view.Representations if each.GetProperty("WindowLocation") and each.Input.GetXMLName() == "TextSource"]

# Letters go when what has no known sides joins what is the patient's
view = new_view()
window.show(skull, view)
assert len([each for each in view.Representations if each.GetProperty("WindowLocation") and each.Input.GetXMLName() == "TextSource"]) == 4
window.show(PhantomSweep(NumberOfSlices=3, ImageSize=[32, 24]), view)
assert not [each for each in view.Representations if each.GetProperty("WindowLocation") and each.Input.GetXMLName() == "TextSource"]

# A sweep: the same picture as Slice Planes makes of it; the box around it is that of the slices' corners
view = new_view()
sweep = PhantomSweep(NumberOfSlices=9, ImageSize=[64, 48], PixelSpacing=0.8, Motion="Arbitrary")
window.show(sweep, view)
display = GetDisplayProperties(sweep, view)
assert display.Representation == window.SLICES
Render(view)
image = fetch(sweep)
poses = vtk_to_numpy(image.GetFieldData().GetArray("ImageToReference")).reshape(-1, 4, 4)
corners = np.array([pose @ (u, v, 0, 1) for pose in poses for u in (0, 63) for v in (0, 47)])[:, :3]
bounds = np.array(view.GetRenderer().ComputeVisiblePropBounds()).reshape(3, 2)
assert (bounds[:, 0] >= corners.min(0) - 1e-3).all() and (bounds[:, 1] <= corners.max(0) + 1e-3).all(), "what is dark is left out"
as_slices = pixels(view)
assert abs(as_slices - as_slices[2, 2]).max() > 60
Hide(sweep, view)
planes = SlicePlanes(Input=sweep)
bright = Threshold(Input=planes, Scalars=["POINTS", "Intensity"], ThresholdMethod="Above Upper Threshold", UpperThreshold=display.Dark + 1e-4, AllScalars=0)
assert image.GetPointData().GetScalars().GetRange()[0] < display.Dark < image.GetPointData().GetScalars().GetRange()[1]
shown = Show(bright, view, "UnstructuredGridRepresentation")
shown.SetRepresentationType("Surface")
ColorBy(shown, ("POINTS", "Intensity"))
shown.LookupTable = display.LookupTable
shown.Ambient, shown.Diffuse = 1, 0
HideScalarBarIfNotNeeded(display.LookupTable, view)
assert abs(pixels(view) - as_slices).max() <= 2, "Slice Planes shows the same"
Hide(bright, view)
window.show(sweep, view)
assert abs(pixels(view) - as_slices).max() <= 2
display.SliceStride = 4
Render(view)
corners = np.array([pose @ (u, v, 0, 1) for pose in poses[::4] for u in (0, 63) for v in (0, 47)])[:, :3]
bounds = np.array(view.GetRenderer().ComputeVisiblePropBounds()).reshape(3, 2)
assert (bounds[:, 0] >= corners.min(0) - 1e-3).all() and (bounds[:, 1] <= corners.max(0) + 1e-3).all(), bounds
display.SliceStride, display.Dark = 1, -1

Render(view)
bounds = np.array(view.GetRenderer().ComputeVisiblePropBounds()).reshape(3, 2)
corners = np.array([pose @ (u, v, 0, 1) for pose in poses for u in (0, 63) for v in (0, 47)])[:, :3]
assert np.allclose(bounds, np.stack([corners.min(0), corners.max(0)], 1), atol=1e-3), bounds

# From pixels to millimetres: the camera goes along, and stays where it sees what is new
view = new_view()
Show(PhantomSweep(NumberOfSlices=9, ImageSize=[640, 480], PixelSpacing=0.1), view).SetRepresentationType("Slice")
ResetCamera(view)
ball = Sphere(Center=[2000, 0, 0], Radius=3)
window.show(ball, view)
assert np.allclose(view.GetActiveCamera().GetFocalPoint()[0] > 500, True)
position = view.GetActiveCamera().GetPosition()
HideAll(view)
near = Sphere(Center=[2000, 1, 0], Radius=3)
window.show(ball, view)
position = view.GetActiveCamera().GetPosition()
window.show(near, view)
assert view.GetActiveCamera().GetPosition() == position

# Contours: of a CT bone, of a sweep tissue
for source, color in ((skull, pictures.BONE), (SweptVolume(Input=sweep), pictures.TISSUE)):
    source.UpdatePipeline()
    name = [each for each in source.PointData.keys() if each in ("HounsfieldUnits", "Intensity")][0]
    surface = Contour(Input=source, ContourBy=["POINTS", name], Isosurfaces=[sum(source.PointData[name].GetRange()) / 2])
    window.show(surface, view)
    assert np.allclose(GetDisplayProperties(surface, view).DiffuseColor, color), source.GetXMLName()

# The calibration beside a sweep: one is offered; of none, of two, and for a sweep that has its own, none is
calibration = '<PlusConfiguration><CoordinateDefinitions><Transform From="%s" To="Probe" Matrix="0.2 0 0 0 0 0.2 0 0 0 0 0.2 0 0 0 0 1"/></CoordinateDefinitions></PlusConfiguration>'
sweep_file = os.path.join(folder, "sweep.igs.mha")
with open(sweep_file, "wb") as file:
    file.write(b"ObjectType = Image\nNDims = 3\nSeq_Frame0000_ProbeToTrackerTransform = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\nElementDataFile = LOCAL\n")


def offered():
    reader = TrackedSliceReader(FileName=sweep_file)
    window.offer_calibration(reader.GetGlobalID())
    return reader.CalibrationFileName


assert offered() == ""
for name, text in (("notes.xml", "<notes/>"), ("broken.xml", "<PlusConfiguration>"), ("stylus.xml", calibration % "Stylus")):
    with open(os.path.join(folder, name), "w", encoding="ascii") as file:
        file.write(text)
assert offered() == ""
with open(os.path.join(folder, "device.xml"), "w", encoding="ascii") as file:
    file.write(calibration % "Image")
assert offered() == os.path.join(folder, "device.xml")
shutil.copy(os.path.join(folder, "device.xml"), os.path.join(folder, "other.xml"))
assert offered() == ""
os.remove(os.path.join(folder, "other.xml"))
SaveData(sweep_file, proxy=sweep)
assert offered() == "", "the phantom's sweep is calibrated"
print("ok")
