# SPDX-License-Identifier: BSD-3-Clause
"""Seven outlines of an organ become its closed surface and volume; the colours are the error against the truth.

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

AXES = (56, 30, 23)  # mm
SLICES = (-50, -36, -18, 0, 18, 36, 50)  # mm along the normal; the organ ends at about 55 mm
NORMAL = (0.95, 0.05, 0.3)
BEND, ITS_SLOPE = "(0.0062*coordsX^2-0.00002*coordsX^3)", "(0.0124*coordsX-0.00006*coordsX^2)"  # mm along y; it keeps the volume

ball = Sphere(registrationName="Ball", Radius=1, ThetaResolution=96, PhiResolution=72)
straight = Transform(registrationName="Straight", Input=ball)
straight.Transform.Scale = AXES
organ = Calculator(registrationName="Organ", Input=straight, CoordinateResults=1, Function=f"coordsX*iHat+(coordsY+{BEND})*jHat+coordsZ*kHat")
outlines = Slice(registrationName="Outlines", Input=organ, SliceOffsetValues=SLICES)
outlines.SliceType.Normal = NORMAL
surface = RBFSurface(registrationName="Surface", Input=outlines, OutputSpacing=1)

# q is 1 on the true surface; (q - 1) by its gradient is about the distance
x, y, z = (f"({place}/{axis}^2)" for place, axis in zip(("coordsX", f"(coordsY-{BEND})", "coordsZ"), AXES))
q = f"sqrt({x}*coordsX+{y}*(coordsY-{BEND})+{z}*coordsZ)"
error = Calculator(registrationName="Error", Input=surface, ResultArrayName="Error",
                   Function=f"({q}-1)*{q}/sqrt(({x}-{y}*{ITS_SLOPE})^2+{y}^2+{z}^2)")

fields = servermanager.Fetch(surface).GetFieldData()
volume, sigma = (fields.GetArray(name).GetValue(0) for name in ("SurfaceVolume", "SurfaceVolumeError"))
truth = 4 / 3 * math.pi * math.prod(AXES) / 1000
print(f"volume {volume:.2f} ml, standard error {sigma:.2f} ml; truth {truth:.2f} ml")
assert abs(volume / truth - 1) < 0.005
error.UpdatePipeline()
low, high = error.PointData["Error"].GetRange()
print(f"error {low:.2f} to {high:.2f} mm")
assert -1 < low < 0 < high < 1

# the planes of the slices, for the picture
block = Transform(registrationName="Block", Input=FastUniformGrid(registrationName="Unit Block", WholeExtent=[-1, 1] * 3))
block.Transform.Scale, block.Transform.Translate = [75, 33, 25], [0, 1, 0]
planes = Slice(registrationName="Planes", Input=block, SliceOffsetValues=SLICES)
planes.SliceType.Origin, planes.SliceType.Normal = [0, 0, 0], NORMAL
# ParaView 5.13 and later hide half of a thick line that lies in a surface, but not a tube
tubes = Tube(registrationName="Outline tubes", Input=outlines, Scalars=["POINTS", ""], Vectors=["POINTS", ""], Radius=0.65, NumberofSides=12)

views = []
for title in ("Seven outlines", "RBF Surface", "Its error"):
    view = pictures.new_view((560, 470))
    view.OrientationAxesVisibility = 0
    pictures.show_surface(tubes, view, (0.15, 0.4, 0.9)).Ambient = 0.35
    if not views:
        pictures.show_surface(planes, view, (0.45, 0.6, 0.85)).Opacity = 0.3
    elif len(views) == 1:
        body = pictures.show_surface(surface, view, pictures.TISSUE)
        body.Specular, body.SpecularPower = 0.4, 40
    else:
        body = pictures.show_surface(error, view, pictures.TISSUE)
        pictures.color_by(body, view, "Error", "Surface minus truth (mm)", (-0.6, 0.6))
    pictures.add_title(view, title)
    pictures.look(view, (-0.6, 0.35, -0.8), (0, 1, 0.3))
    views.append(view)
cameras = [view.GetActiveCamera() for view in views]  # the same for all
scale = 0.79 * views[1].CameraParallelScale
for view, camera in zip(views, cameras):
    camera.SetFocalPoint(*cameras[1].GetFocalPoint())
    camera.SetPosition(*cameras[1].GetPosition())
    view.CameraParallelScale = scale
layout = pictures.lay_out(views, "Outlines to volume")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "outlines-to-volume.png"))
states.save(os.path.join(folder, "outlines-to-volume.pvsm"))
