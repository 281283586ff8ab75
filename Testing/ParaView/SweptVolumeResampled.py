# SPDX-License-Identifier: BSD-3-Clause
"""The thesis's own check of the swept volume (Carr 1996, 4.2, figures 4.4 and 4.5): a known volume is imaged by the
non-parallel slices of two sweeps and made anew from them; cross-sections and surfaces must agree.

The object is the CT of a head if the real data are there, else the skull phantom. With numbers of slices
as arguments only prints the scores, for the guide."""
import os
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna import pictures
from lacuna_test import compare_with_baseline, output
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import mutable
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkStaticCellLocator
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkImageAppend
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter

SKIN, BONE = -300, 300  # HU
PIXEL = 0.9  # mm, like the object's voxels
SWEEP = dict(NumberOfSweeps=2, Motion="Arbitrary", ImageSize=[200, 250], PixelSpacing=PIXEL, Travel=165,
             OutputScalarType="Float")


def make_object():
    """A volume of HU + 1024, so that air is 0 like what lies outside of it, and whether it is the real head."""
    path = os.path.join(os.environ.get("LACUNA_TEST_DATA", ""), "ct_head", "head.mha")
    is_real = os.path.exists(path)
    source = OpenDataFile(path) if is_real else SkullPhantom(Spacing=[1, 1, 1])
    source.UpdatePipeline()
    name = source.PointData[0].Name
    shifted = Calculator(Input=source, Function=f'"{name}" + 1024', ResultArrayName="Grey")
    shifted.UpdatePipeline()
    return shifted, is_real


def grey_levels(image, name):
    values = vtk_to_numpy(image.GetPointData().GetArray(name))
    return values.reshape(image.GetDimensions()[::-1]).astype(float)


def resample(source, count):
    """The two sweeps, and the volume made of them on the object's own grid."""
    image = servermanager.Fetch(source)
    sweep = PhantomSweep(Input=source, NumberOfSlices=count, **SWEEP)
    columns, rows = SWEEP["ImageSize"]
    # two sweeps, two inputs: the last slice of the first one is no neighbour of the first of the second
    sweeps = [ExtractSubset(Input=sweep, VOI=[0, columns - 1, 0, rows - 1, first, first + count // 2 - 1])
              for first in (0, count // 2)]
    volume = SweptVolume(Input=sweeps, OutputSpacing=image.GetSpacing(), OutputBounds=image.GetBounds())
    volume.UpdatePipeline()
    return volume


def isosurface(image, grey, level):
    data = vtkImageData()
    data.CopyStructure(image)
    data.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(grey, np.float32).ravel(), deep=1))
    contour = vtkFlyingEdges3D()
    contour.SetInputData(data)
    contour.SetValue(0, level)
    contour.Update()
    return contour.GetOutput()


def distances(surface, other, count=4000):
    """From points of one surface to the nearest ones of the other, mm."""
    locator = vtkStaticCellLocator()
    locator.SetDataSet(other)
    locator.BuildLocator()
    points = vtk_to_numpy(surface.GetPoints().GetData())
    points = points[np.random.default_rng(1).choice(len(points), count)]
    nearest, cell, sub, square = [0.0] * 3, mutable(0), mutable(0), mutable(0.0)
    result = []
    for point in points:
        locator.FindClosestPoint(point, nearest, cell, sub, square)
        result.append(square.get() ** 0.5)
    return np.array(result)


def compare(source, volume):
    """Coverage, error in grey levels, and for each surface the mean distances there and back, mm."""
    image, made = servermanager.Fetch(source), servermanager.Fetch(volume)
    assert image.GetDimensions() == made.GetDimensions()
    truth, grey = grey_levels(image, "Grey"), grey_levels(made, "Intensity")
    mask = grey_levels(made, "vtkValidPointMask") != 0
    score = dict(filled=mask.mean(), RMS=np.sqrt(np.mean((grey - truth)[mask] ** 2)))
    for name, level in (("skin", SKIN), ("bone", BONE)):
        original = isosurface(image, np.where(mask, truth, 0), level + 1024)
        reconstructed = isosurface(image, np.where(mask, grey, 0), level + 1024)
        score[name] = (distances(reconstructed, original).mean(), distances(original, reconstructed).mean())
    return score


def print_score(count, score):
    surfaces = ", ".join(f"{name} {score[name][0]:.2f} and {score[name][1]:.2f} mm" for name in ("skin", "bone"))
    print(f"{count} slices: {100 * score['filled']:.1f} % filled, RMS {score['RMS']:.0f} HU, "
          f"mean distance of surfaces (there and back) {surfaces}", flush=True)


def append(files, axis, name):
    """Pictures side by side (axis 0), or one above the other (1: the first one below)."""
    whole = vtkImageAppend()
    whole.SetAppendAxis(axis)
    for file in files:
        reader = vtkPNGReader()
        reader.SetFileName(file)
        whole.AddInputConnection(reader.GetOutputPort())
    writer = vtkPNGWriter()
    writer.SetFileName(name)
    writer.SetInputConnection(whole.GetOutputPort())
    writer.Write()


def show(columns, name):
    """Columns of pictures: a sagittal section above the skull from the front and the side."""
    files = []
    for title, proxy, array in columns:
        view = pictures.new_view((480, 480))
        view.OrientationAxesVisibility = 0
        display = Show(proxy, view)
        display.Representation = "Slice"
        display.SliceMode = "YZ Plane"
        display.Slice = servermanager.Fetch(proxy).GetDimensions()[0] // 2 - 8
        ColorBy(display, ("POINTS", array))
        table = GetColorTransferFunction(array, display, separate=True)
        table.ApplyPreset("Grayscale", True)
        table.RescaleTransferFunction(0, 2200)
        display.LookupTable = table
        display.SetScalarBarVisibility(view, False)
        text = Show(Text(Text=title), view)
        text.Color, text.FontSize, text.WindowLocation = [0.1, 0.1, 0.1], 16, "Upper Left Corner"
        pictures.look(view, (-1, 0, 0), (0, 0, 1), 1.35)
        section = output(f"resampled-section-{len(files)}.png")
        pictures.save(view, section)

        view = pictures.new_view((480, 480))
        view.OrientationAxesVisibility = 0
        surface = Contour(Input=proxy, ContourBy=["POINTS", array], Isosurfaces=[BONE + 1024])
        pictures.show_surface(surface, view, pictures.BONE)
        pictures.look(view, (-0.75, -1, -0.25), (0, 0, 1), 1.3)
        skull = output(f"resampled-skull-{len(files)}.png")
        pictures.save(view, skull)
        column = output(f"resampled-column-{len(files)}.png")
        append([skull, section], 1, column)
        files.append(column)
    append(files, 0, output(name))


source, is_real = make_object()
counts = [int(argument) for argument in sys.argv[1:]]
for count in counts:
    print_score(count, compare(source, resample(source, count)))
if counts:
    sys.exit(0)

fine, coarse = resample(source, 200), resample(source, 50)
scores = {200: compare(source, fine), 50: compare(source, coarse)}
for count, score in scores.items():
    print_score(count, score)
# Slices are 1.65 mm apart with 200, voxels 0.9 mm: the surfaces agree to half a voxel on average, also where bone is
# thinner than that.
assert scores[200]["filled"] > 0.985  # the box's corners lie outside of the turned slices
assert max(scores[200]["skin"]) < 0.25 and max(scores[200]["bone"]) < 0.45, scores[200]
# Four times as far apart, as coarse as the thesis's: thin bone is lost, as it says, but nothing moves.
assert scores[50]["skin"][0] < 0.9 and scores[50]["bone"][0] < 0.9, scores[50]
assert scores[50]["RMS"] > 1.5 * scores[200]["RMS"]

if is_real:
    show([("original", source, "Grey"), ("of 200 slices", fine, "Intensity"), ("of 50 slices", coarse, "Intensity")],
         "resampled.png")
    compare_with_baseline(output("resampled.png"), "resampled.png", 30)
