# SPDX-License-Identifier: BSD-3-Clause
"""A skull with a hole on one side, its mirror image, and where the two differ.

    pvpython in_paraview.py [folder for picture and state file, default: .]

Writes mirrored.png and mirrored.pvsm, for File > Load State.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states
from lacuna.data import fetch
from paraview.simple import *

# The hole is in the right temple; of your own: lacuna.data.open_volume("folder of DICOM files")
skull = SkullPhantom(registrationName="CT", Spacing=[1, 1, 1], DefectRadius=20, DefectDirection=[-0.8, -0.7, 0.05])
VIEW = dict(ViewDirection=[0, 1, 0], ViewUp=[0, 0, 1])
depth = BSplineIsoRayCaster(registrationName="Depth map", Input=skull, IsoValues=[500], PixelSpacing=0.6, **VIEW)

# The plane of best symmetry is found in the volume, and the map is mirrored there
plane = Mirror(registrationName="Plane of symmetry", Input=skull)
fields = fetch(plane).GetFieldData()
origin, normal = (list(fields.GetArray("MirrorPlane" + name).GetTuple(0)) for name in ("Origin", "Normal"))
mirror = Mirror(registrationName="Mirror image", Input=depth, PlaneMethod="Given", Origin=origin, Normal=normal)

views = []
for source, title in ((depth, "Given"), (mirror, "Mirror image: not the patient"), (mirror, "Given minus mirrored")):
    view = pictures.new_view((560, 600))
    view.OrientationAxesVisibility = 0
    surface = DepthMapSurface(registrationName="Surface, " + title.lower(), Input=source, MaximumAngle=85)
    display = pictures.show_surface(surface, view, pictures.BONE)
    if title == "Given minus mirrored":
        pictures.color_by(display, view, "Asymmetry", "Difference of depth (mm)", (-4, 4))
    pictures.add_title(view, title)
    pictures.look(view, VIEW["ViewDirection"], VIEW["ViewUp"], 1.1)
    views.append(view)
layout = pictures.lay_out(views, "Mirror")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "mirrored.png"))
states.save(os.path.join(folder, "mirrored.pvsm"))
