# SPDX-License-Identifier: BSD-3-Clause
"""Five outlines of an organ become its closed surface and volume; the colours are the error against the truth.

    pvpython outlines_to_volume.py [folder for picture and state file, default: .]

Writes outlines-to-volume.png and outlines-to-volume.pvsm, for File > Load State.
"""
import math
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states
from paraview.simple import *

AXES = (40, 28, 20)  # mm
SLICES = (-27, -13.5, 0, 13.5, 27)  # mm along the normal; the organ ends at 34.9 mm

ball = Sphere(registrationName="Ball", Radius=1, ThetaResolution=160, PhiResolution=120)
organ = Transform(registrationName="Organ", Input=ball)
organ.Transform.Scale = AXES
outlines = Slice(registrationName="Outlines", Input=organ, SliceOffsetValues=SLICES)
outlines.SliceType.Normal = [0.8, 0.5, 0.33]
surface = RBFSurface(registrationName="Surface", Input=outlines, OutputSpacing=1)
q = "sqrt(" + "+".join(f"(coords{c}/{a})^2" for c, a in zip("XYZ", AXES)) + ")"
slope = "sqrt(" + "+".join(f"(coords{c}/{a}^2)^2" for c, a in zip("XYZ", AXES)) + ")"
error = Calculator(registrationName="Error", Input=surface, ResultArrayName="Error", Function=f"({q}-1)*{q}/{slope}")

fields = servermanager.Fetch(surface).GetFieldData()
volume, sigma = (fields.GetArray(name).GetValue(0) for name in ("SurfaceVolume", "SurfaceVolumeError"))
truth = 4 / 3 * math.pi * math.prod(AXES) / 1000
print(f"volume {volume:.2f} ml, standard error {sigma:.2f} ml; truth {truth:.2f} ml")
assert abs(volume / truth - 1) < 0.01

views = []
for title in ("Five outlines", "RBF Surface, error in mm"):
    view = pictures.new_view((800, 650))
    lines = pictures.show_surface(outlines, view, (0.1, 0.3, 0.8))
    lines.LineWidth = 3
    if views:
        body = pictures.show_surface(error, view, pictures.TISSUE)
        pictures.color_by(body, view, "Error", "Surface minus truth (mm)", (-1, 1))
    pictures.add_title(view, title)
    pictures.look(view, (0.3, -1, -0.5), (0, 0, 1), 0.95)
    views.append(view)
cameras = [view.GetActiveCamera() for view in views]  # the same for both
cameras[0].SetFocalPoint(*cameras[1].GetFocalPoint())
cameras[0].SetPosition(*cameras[1].GetPosition())
views[0].CameraParallelScale = views[1].CameraParallelScale
layout = pictures.lay_out(views, "Outlines to volume")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "outlines-to-volume.png"))
states.save(os.path.join(folder, "outlines-to-volume.pvsm"))
