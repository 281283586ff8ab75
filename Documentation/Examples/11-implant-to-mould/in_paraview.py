# SPDX-License-Identifier: BSD-3-Clause
"""From a CT to plate, mould and milling path in one pipeline.

    pvpython in_paraview.py [folder for picture and state file, default: .]

Writes implant-to-mould.png and implant-to-mould.pvsm, for File > Load State.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states
from paraview.simple import *

# Bone, seen into the hole, and the filled hole
ct = SkullPhantom(registrationName="CT", Spacing=[1, 1, 1])
VIEW = dict(ViewDirection=[-0.4, 0.2, -0.9], ViewUp=[0, -1, 0])
depth = BSplineIsoRayCaster(registrationName="Depth map", Input=ct, IsoValues=[500], Interpolation="InterpolatingBSpline", **VIEW)
filled = RBFHoleFiller(registrationName="Filled", Input=depth, SupportMargin=12, CutoffWavelength=10, DefectRegion="Sphere")
filled.DefectRegion.Center, filled.DefectRegion.Radius = [28, -14, 63], 39

# The plate with drainage holes, on the bone with an overlap of 5 mm, in patient coordinates
plate = ImplantPlate(registrationName="Plate", Input=filled, Thickness=1, Side="Outward", EdgeClearance=-5, DrainageSpacing=9)

# The mould to press it in, lying flat, and the way of the mill, in press coordinates
mould = PressOrientation(registrationName="Mould", Input=filled, Mould="Male")
path = MillingToolPath(registrationName="Milling path", Input=mould, ToolRadius=4, StepOver=2, RoughingStep=4)

skull = pictures.new_view((800, 700))
bone = DepthMapSurface(registrationName="Bone", Input=depth, MaximumAngle=85)
pictures.show_surface(bone, skull, pictures.BONE)
pictures.show_surface(plate, skull, pictures.METAL).Specular = 0.5
pictures.add_title(skull, "Plate, in the patient")
pictures.look(skull, (-0.52, 0.2, -0.8), VIEW["ViewUp"], 2.1)
press = pictures.new_view((800, 700))
block = ExtractSurface(registrationName="Surface of the mould", Input=mould)
pictures.show_surface(block, press, pictures.BONE)
lines = pictures.show_surface(path, press, (0.15, 0.3, 0.6))
lines.LineWidth, lines.Opacity = 1, 0.6
pictures.add_title(press, "Mould and milling path, in the press")
pictures.look(press, (0.2, 0.75, -0.65), (0, 0, 1), 1.2)
views = [skull, press]
layout = pictures.lay_out(views, "Implant to mould")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "implant-to-mould.png"))
states.save(os.path.join(folder, "implant-to-mould.pvsm"))
