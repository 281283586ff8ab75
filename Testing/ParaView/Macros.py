# SPDX-License-Identifier: BSD-3-Clause
"""The jobs of the menu Lacuna do their work on the active source, and say what is wrong when it is of another kind."""
import glob
import os
import shutil

import lacuna.plugin

lacuna.plugin.load()
import numpy as np
from lacuna import demo_ultrasound, macros, window
from lacuna.data import fetch
from lacuna.errors import PipelineError, raising
from lacuna_test import output
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

SWEEP, BONE, CT, IMPLANT = "sweep_to_surface", "sweep_to_bone", "ct_to_iges", "ct_to_implant"
home = os.path.abspath(output("Macros"))
shutil.rmtree(home, ignore_errors=True)
os.makedirs(home)
os.environ["HOME"] = home


def run(job):
    """A job as the menu runs it: the errors that it reports, in one text."""
    try:
        with raising():
            window.run(job)
    except PipelineError as error:
        return str(error)
    return ""


def refused(job, words):
    """The job reports this and leaves the pipeline browser and the active source alone."""
    before, active = set(GetSources()), GetActiveSource()
    said = run(job)
    assert words in said, (words, said)
    assert set(GetSources()) == before and GetActiveSource() == active, set(GetSources()) - before
    assert not glob.glob(home + "/*"), os.listdir(home)


def files():
    """Of the home folder, without Mesa's .cache."""
    return sorted(name for name in os.listdir(home) if not name.startswith("."))


def field(data, name):
    return data.GetFieldData().GetArray(name).GetValue(0)


view = CreateRenderView()
view.ViewSize = [500, 400]

# Nothing, and what is of another kind
refused(SWEEP, "nothing is selected in the pipeline browser; open and select a sweep")
refused(CT, "nothing is selected in the pipeline browser; open and select a CT")
refused(IMPLANT, "nothing is selected in the pipeline browser; open and select a CT")
ball = Sphere()
refused(SWEEP, "holds no tracked slices; select a Tracked Slice Reader")
refused(CT, "is no volume; select a CT Series Reader")
wavelet = Wavelet()
refused(SWEEP, "'Wavelet1' holds no tracked slices")
refused(CT, "range from 37.35 to 276.8: bone, at 500 Hounsfield units, is not among them")
refused(IMPLANT, "range from 37.35 to 276.8: bone, at 300 Hounsfield units, is not among them")
sweep = PhantomSweep(registrationName="My sweep", NumberOfSlices=50, ImageSize=[160, 120], PixelSpacing=0.4, Motion="Arbitrary", SpeckleLevel=0.2)
refused(CT, "'My sweep' is a sweep, not a CT: use Sweep to Surface")
uncalibrated = ProgrammableFilter(registrationName="No pose", Input=sweep, Script="""
output.ShallowCopy(inputs[0].VTKObject)
output.GetFieldData().RemoveArray("ImageToReference")
""")
for job in SWEEP, BONE:
    refused(job, "'No pose' is not calibrated")
SetActiveSource(sweep)
refused(BONE, "no bone was found in 'My sweep'")  # organs have no shadow
intact = SkullPhantom(registrationName="Intact", DefectRadius=0, Spacing=[2, 2, 3])
refused(CT, "no hole is seen in 'Intact': turn the 3-D view")
refused(IMPLANT, "no hole")

# A sweep: its surface is closed and encloses what is there
Show(sweep, view)
SetActiveSource(sweep)
assert run(SWEEP) == ""
surface = GetActiveSource()
assert surface.GetXMLName() == "Contour" and FindSource("Surface of My sweep") == surface
assert abs(surface.Isosurfaces[0] - 120) < 1e-9  # the phantom knows its level
shown = {display.Input.GetXMLName() for display in view.Representations if display.Visibility and display.GetProperty("Input") and display.Input}
assert shown == {"Contour", "LacunaPhantomSweep", "TextSource"}, shown
assert GetDisplayProperties(sweep, view).Representation == window.SLICES and GetDisplayProperties(sweep, view).SliceStride == 16
largest = ExtractSurface(Input=Connectivity(Input=surface, ExtractionMode="Extract Largest Region"))
enclosed, open_edges = demo_ultrasound.measure(largest)
true = sweep.GetClientSideObject().GetTrueVolume() / 1000
print(f"{enclosed:.2f} ml, {true:.2f} ml in truth")
assert open_edges == 0 and abs(enclosed / true - 1) < 0.04, (enclosed, true)
# a recording does not know its level
SaveData(os.path.join(home, "sweep.nhdr"), proxy=sweep)
recorded = TrackedSliceReader(registrationName="Recorded", FileName=os.path.join(home, "sweep.nhdr"))
assert run(SWEEP) == ""
assert 100 < GetActiveSource().Isosurfaces[0] < 140, GetActiveSource().Isosurfaces[0]
for name in files():
    os.remove(os.path.join(home, name))

# A CT: what the view looks into is filled and written; a second run does not overwrite the first
ct = SkullPhantom(registrationName="My CT", Spacing=[1.5, 1.5, 2])
camera = view.GetActiveCamera()
camera.SetPosition(0, 0, -500)
camera.SetFocalPoint(0, 0, 0)
camera.SetViewUp(0, 1, 0)
refused(CT, "no hole is seen in 'My CT'")  # from below
camera.SetPosition(*(500 * np.array([0.4, -0.2, 0.9])))
assert run(CT) == ""
filled = GetActiveSource()
assert FindSource("Filled My CT") == filled
image, truth = fetch(filled), ct.GetClientSideObject()
mask = vtk_to_numpy(image.GetPointData().GetArray("FilledMask")) > 0
depth = vtk_to_numpy(image.GetPointData().GetArray("Depth"))
to_world = np.array(image.GetFieldData().GetArray("ImageToWorld").GetTuple(0)).reshape(4, 4)
width = image.GetDimensions()[0]
error = []
for pixel in np.flatnonzero(mask)[::25]:
    start = to_world @ (pixel % width, pixel // width, 0, 1)
    error.append(depth[pixel] - truth.IntersectOuterSurface(start[:3], to_world[:3, 2]))
print(f"filling: {np.abs(error).max():.2f} mm from the truth at most, {mask.sum()} pixels")
assert np.abs(error).max() < 1.5 and field(image, "DefectArea") > 2000
assert files() == ["implant.igs"], files()
with open(os.path.join(home, "implant.igs"), encoding="ascii") as file:
    assert file.read()[72] == "S"
SetActiveSource(filled)  # a filled map is written as it is
sources = len(GetSources())
assert run(CT) == ""
assert files() == ["implant-2.igs", "implant.igs"]
with open(os.path.join(home, "implant-2.igs"), encoding="ascii") as second, open(os.path.join(home, "implant.igs"), encoding="ascii") as first:
    data = [[line for line in file if line[72] in "DP"] for file in (first, second)]
assert data[0] == data[1], "the same surface is written twice"
SetActiveSource(FindSource("Depth map of My CT"))
result, name = macros.ct_to_iges(folder=home)
assert name == os.path.join(home, "implant-3.igs") and os.path.getsize(name) > 10000

# A CT: its hole gets an implant, whatever the view; bone and implant are shown, coloured by the predicted error
SetActiveSource(ct)
assert run(IMPLANT) == ""
plate = GetActiveSource()
assert FindSource("Implant of My CT") == plate and FindSource("Bone of My CT") and FindSource("Bone surface of My CT")
shown = {display.Input for display in view.Representations if display.Visibility and display.GetProperty("Input") and display.Input}
assert {plate, FindSource("Bone surface of My CT")} <= shown and ct not in shown
assert GetDisplayProperties(plate, view).ColorArrayName[1] == "PredictedError"
direction = np.array(ct.DefectDirection) / np.linalg.norm(ct.DefectDirection)
assert np.dot(fetch(plate).GetFieldData().GetArray("InsertionDirection").GetTuple(0), direction) < -0.9
assert np.linalg.norm(np.array(fetch(plate).GetCenter()) - direction * truth.IntersectOuterSurface([0, 0, 0], direction)) < 12
