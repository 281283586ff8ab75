# SPDX-License-Identifier: BSD-3-Clause
"""A surface of which a few hundred scattered points are known, and how far off it is.

    pvpython scattered_data.py [folder for picture and state file, default: .]

Writes scattered-data.png and scattered-data.pvsm.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states
from paraview.simple import *

# The truth: how deep a skull lies under a plane above it, in 0.5 mm steps
ct = SkullPhantom(registrationName="CT", DefectRadius=0, Spacing=[1, 1, 1])
truth = BSplineIsoRayCaster(registrationName="Truth", Input=ct, IsoValues=[500], ViewDirection=[0, 0, -1], PixelSpacing=0.5,
                            ImageSize=[180, 180], FocalPoint=[10, -10, 0], PlaneOrigin=[0, 0, 90])

# What is known: some 300 places, as if touched with a tracked pointer: chosen by a formula, the same each time
CHANCE = "frac(abs(sin(coordsX*12.9898 + coordsY*78.233)*43758.5453))"
chosen = Calculator(registrationName="Chosen", Input=truth, ResultArrayName="Chosen", Function=f"if({CHANCE} < 0.01, 1, 0)*vtkValidPointMask")
touched = pictures.marked_points(chosen, "Chosen", "Pixels", "Touched")
# A thin plate through all of them, on the pixels of the truth
truth.UpdatePipeline()
fit = RBFInterpolator(registrationName="Fit", Input=touched, ScalarArray="Depth", Kernel="ThinPlate", OutputSpacing=[0.5, 0.5, 0.5],
                      OutputBounds=list(truth.GetDataInformation().GetBounds()))

# The fit minus the truth, on the truth's pixels, and where the known places are in space
there = ResampleWithDataset(registrationName="Fit on the truth's pixels", SourceDataArrays=fit, DestinationMesh=truth)
error = PythonCalculator(registrationName="Fit minus truth", Input=[truth, there], ArrayName="Error", CopyArrays=1,
                         Expression="inputs[1].PointData['Depth'] - inputs[0].PointData['Depth']")
surface = DepthMapSurface(registrationName="Skull", Input=error, MaximumAngle=80)
places = WarpByScalar(registrationName="Places in space", Input=touched, Scalars=["POINTS", "Depth"], UseNormal=1, Normal=[0, 0, -1])
dots = Glyph(registrationName="Dots", Input=places, GlyphType="Sphere", ScaleArray=["POINTS", "No scale array"], ScaleFactor=1.2,
             GlyphMode="All Points")

view = pictures.new_view()
display = pictures.show_surface(surface, view, pictures.BONE)
pictures.color_by(display, view, "Error", "Fit minus truth (mm)", (-0.3, 0.3))
pictures.show_surface(dots, view, (0.1, 0.1, 0.1))
pictures.look(view, (0.3, 1, -1.2), (0, 0, 1), 1.3)
pictures.add_scale_bar(view, 20)

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save(view, os.path.join(folder, "scattered-data.png"))
states.save(os.path.join(folder, "scattered-data.pvsm"))
