# SPDX-License-Identifier: BSD-3-Clause
"""A distorted picture is put right by landmarks of which the true places are known.

    pvpython image_warp.py [folder for picture and state file, default: .]

Writes image-warp.png and image-warp.pvsm.
"""
import os
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna import pictures, states
from lacuna.data import fetch
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

# The truth: a slice of a skull, with a grid of 25 mm to see by
ct = SkullPhantom(registrationName="CT", Spacing=[1, 1, 1], DefectRadius=0)
ct.UpdatePipeline()
low_x, high_x, low_y, high_y, low_z, high_z = ct.GetDataInformation().GetExtent()
layer = (low_z + high_z) // 2
plane = ExtractSubset(registrationName="Slice", Input=ct, VOI=[low_x, high_x, low_y, high_y, layer, layer])
name = fetch(plane).GetPointData().GetScalars().GetName()
truth = Calculator(registrationName="Truth", Input=plane, ResultArrayName="Grey",
                   Function=f"if(cos(coordsX*0.2513274) > 0.985 | cos(coordsY*0.2513274) > 0.985, 900, {name})")

# 25 marks, and where the machine shows them: farther out the farther from the middle (pincushion), and shifted a little
marks = np.array([(x, y, 0) for y in (-100, -50, 0, 50, 100) for x in (-75, -37, 0, 37, 75)], dtype=float)
radius = np.linalg.norm(marks, axis=1, keepdims=True)
shown = marks * (0.9 + 0.12 * (radius / 100) ** 2) + (3, -2, 0)
true_places = PolyLineSource(registrationName="True places", Points=marks.ravel().tolist())
seen_places = PolyLineSource(registrationName="Seen places", Points=shown.ravel().tolist())
distorted = RBFImageWarp(registrationName="Distorted", Input=truth, Landmarks=true_places, Targets=seen_places, OutsideValue=-1000)

# The correction: what is seen at the marks comes to lie where they are
corrected = RBFImageWarp(registrationName="Corrected", Input=distorted, Landmarks=seen_places, Targets=true_places, OutsideValue=-1000)

views = []
for index, (image, points, title) in enumerate(((truth, true_places, "Truth"), (distorted, seen_places, "As the machine shows it"),
                                                (corrected, true_places, "Corrected by 25 marks"))):
    view = pictures.new_view((600, 700))
    display = pictures.show_image(image, view, "Grey", "Hounsfield units", (-1000, 1500))
    display.LookupTable.NanOpacity = 1
    display.SetScalarBarVisibility(view, index == 2)
    dots = Glyph(registrationName="Dots of " + title, Input=points, GlyphType="Sphere", ScaleArray=["POINTS", "No scale array"],
                 ScaleFactor=5, GlyphMode="All Points")
    pictures.show_surface(dots, view, (0.9, 0.2, 0.1))
    pictures.add_title(view, title)
    pictures.look(view, (0, 0, 1), (0, -1, 0), 1)
    views.append(view)
layout = pictures.lay_out(views, "Image warp")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "image-warp.png"))
states.save(os.path.join(folder, "image-warp.pvsm"))


def grey(image):
    return vtk_to_numpy(fetch(image).GetPointData().GetArray("Grey")).astype(float)


shown = vtk_to_numpy(fetch(corrected).GetPointData().GetArray("vtkValidPointMask")) > 0  # the rest left the machine's picture
for name, image in (("distorted", distorted), ("corrected", corrected)):
    print(f"{name}: {abs(grey(image) - grey(truth))[shown].mean():.0f} HU from the truth in the mean")
