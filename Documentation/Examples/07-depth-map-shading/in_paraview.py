# SPDX-License-Identifier: BSD-3-Clause
"""One depth map drawn in four ways: depth only, stored normals, normals made of depths, and lights that cast shadows.

    pvpython in_paraview.py [folder for picture and state file, default: .]

Writes depth-map-shading.png and depth-map-shading.pvsm, for File > Load State.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states
from paraview.simple import *

# Of your own: lacuna.data.open_volume("folder of DICOM files")
skull = SkullPhantom(registrationName="CT", Spacing=[1, 1, 2])
VIEW = dict(ViewDirection=[-0.45, 0.35, -0.8], ViewUp=[0, 0, 1])
depth = BSplineIsoRayCaster(registrationName="Depth map", Input=skull, IsoValues=[500], PixelSpacing=0.5, **VIEW)

# Lights: x y z, 0 for a direction (1: a place), strength; from the upper left, and weakly from the lower right
LIGHTS = [0.56, -1.35, 1.18, 0, 0.8, -0.41, -1.06, 0.26, 0, 0.3]
shadings = {"Depth only": dict(Shading="DepthOnly"),
            "Stored normals": dict(NormalMethod="Stored", Specular=0),
            "Nine cases (Predicate)": dict(NormalMethod="Predicate", Specular=0),
            "Two lights, shadows": dict(NormalMethod="Stored", Volume=skull, Lights=LIGHTS)}
views = []
for title, settings in shadings.items():
    view = pictures.new_view((420, 480))
    view.OrientationAxesVisibility = 0
    pictures.show_shaded(DepthMapShader(registrationName=title, Input=depth, BackgroundColor=[0.94, 0.95, 0.97], **settings), view)
    pictures.add_title(view, title)
    pictures.look(view, VIEW["ViewDirection"], VIEW["ViewUp"], 2.1)
    views.append(view)
layout = pictures.lay_out(views, "Shadings")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "depth-map-shading.png"))
states.save(os.path.join(folder, "depth-map-shading.pvsm"))
