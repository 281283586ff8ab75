# SPDX-License-Identifier: BSD-3-Clause
"""The hole in a skull is filled by the smooth surface that continues the bone around it.

    pvpython hole_in_a_skull.py [folder for picture, state file and implant, default: .]

Writes hole-in-a-skull.png, hole-in-a-skull.pvsm and implant.igs.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states, views
from paraview.simple import *

# A CT with a hole of 30 mm radius; of your own: lacuna.data.open_volume("folder of DICOM files")
ct = SkullPhantom(registrationName="CT")

# Bone from 500 Hounsfield units, seen so that the hole is face on
VIEW = dict(IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9], ViewUp=[0, -1, 0], FocalPoint=[0, 0, 0], PlaneOrigin=[60, -30, 135],
            PixelSpacing=0.6, ImageSize=[320, 360], Interpolation="InterpolatingBSpline")
depth = BSplineIsoRayCaster(registrationName="Depth map", Input=ct, **VIEW)

# The defect is what lies in a ball over the hole; the fit rests on 12 mm of sound bone around it
filled = RBFHoleFiller(registrationName="Filled", Input=depth, SupportMargin=12, DefectRegion="Sphere")
filled.DefectRegion.Center, filled.DefectRegion.Radius = [28, -14, 63], 39

# How far the filling is from the bone that was there: the same skull without a hole and in finer slices, seen in the same way
whole = SkullPhantom(registrationName="Intact CT", DefectRadius=0, Spacing=[1, 1, 1])
intact = BSplineIsoRayCaster(registrationName="Intact depth map", Input=whole, **VIEW)
compared = PythonCalculator(registrationName="Filled minus intact", Input=[filled, intact], ArrayName="Error", CopyArrays=1,
                            Expression="inputs[0].PointData['Depth'] - inputs[1].PointData['Depth']")

# Triangles to look at: bone, and the filling coloured by its error
surface = DepthMapSurface(registrationName="Surface", Input=compared, MaximumAngle=80)
mask = ["POINTS", "FilledMask"]
bone = Threshold(registrationName="Bone", Input=surface, Scalars=mask, ThresholdMethod="Below Lower Threshold", LowerThreshold=0.5, AllScalars=0)
filling = Threshold(registrationName="Filling", Input=surface, Scalars=mask, ThresholdMethod="Above Upper Threshold", UpperThreshold=0.5)
view = pictures.new_view()
pictures.show_surface(bone, view, pictures.BONE)
pictures.color_by(pictures.show_surface(filling, view, pictures.METAL), view, "Error", "Filling minus intact bone (mm)", (-0.6, 0.6))
pictures.look(view, VIEW["ViewDirection"], VIEW["ViewUp"], 1.1)
pictures.add_scale_bar(view, 50, aside=True)

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
states.save(os.path.join(folder, "hole-in-a-skull.pvsm"))
SaveData(os.path.join(folder, "implant.igs"), proxy=filled)
views.show_orientation(view)  # left and right of the patient; not kept in state files
pictures.save(view, os.path.join(folder, "hole-in-a-skull.png"))
