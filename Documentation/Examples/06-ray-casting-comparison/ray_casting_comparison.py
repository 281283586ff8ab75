# SPDX-License-Identifier: BSD-3-Clause
"""One skull, one view, slices 3 mm apart: the surface between the voxels by a B-spline, and as marching cubes sees it.

    pvpython ray_casting_comparison.py [folder for picture and state file, default: .]

Writes ray-casting-comparison.png and ray-casting-comparison.pvsm.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states
from paraview.simple import *

# Coarse slices, as many scans have; of your own: lacuna.data.open_volume("folder of DICOM files")
skull = SkullPhantom(registrationName="CT", Spacing=[1, 1, 3], DefectRadius=0)
VIEW = dict(ViewDirection=[0.6, 0.75, -0.55], ViewUp=[0, 0, 1], PixelSpacing=0.5, IsoValues=[500])
spline = BSplineIsoRayCaster(registrationName="B-spline", Input=skull, Interpolation="BSpline", **VIEW)
linear = BSplineIsoRayCaster(registrationName="Trilinear", Input=skull, Interpolation="Trilinear", **VIEW)

# Depth maps of one view have the same pixels, so they are compared one by one
difference = PythonCalculator(registrationName="Trilinear minus B-spline", Input=[spline, linear], ArrayName="Difference",
                              Expression="inputs[1].PointData['Depth'] - inputs[0].PointData['Depth']", CopyArrays=1)

# Three views side by side, with one camera
views = []
for source, title in ((linear, "Trilinear, as marching cubes"), (spline, "B-spline"), (difference, "Trilinear minus B-spline")):
    view = pictures.new_view((600, 600))
    view.OrientationAxesVisibility = 0
    surface = DepthMapSurface(registrationName="Surface of " + title, Input=source, MaximumAngle=88)
    display = pictures.show_surface(surface, view, pictures.BONE)
    display.Specular = 0.4
    if source is difference:
        pictures.color_by(display, view, "Difference", "Difference of depth (mm)", (-0.8, 0.8))
    pictures.add_title(view, title)
    pictures.look(view, VIEW["ViewDirection"], VIEW["ViewUp"], 1.1)
    if views:
        AddCameraLink(view, views[0], f"camera {len(views)}")
    views.append(view)
layout = pictures.lay_out(views, "Comparison")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "ray-casting-comparison.png"))
states.save(os.path.join(folder, "ray-casting-comparison.pvsm"))
