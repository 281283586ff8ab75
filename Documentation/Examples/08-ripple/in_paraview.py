# SPDX-License-Identifier: BSD-3-Clause
"""Every third slice of a skull: how far the surface is off, by interpolation.

    pvpython in_paraview.py [folder for picture and state file, default: .]

Writes ripple.png and ripple.pvsm, for File > Load State. ripple.py measures the same.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states
from paraview.simple import *

# All slices, 1 mm apart, and every third of them; the same part of both
skull = SkullPhantom(registrationName="CT", Spacing=[1, 1, 1], DefectRadius=0)
skull.UpdatePipeline()
bounds, extent = skull.GetDataInformation().GetBounds(), list(skull.GetDataInformation().GetExtent())
extent[5] -= (extent[5] - extent[4]) % 3
fine = ExtractSubset(registrationName="All slices", Input=skull, VOI=extent)
coarse = ExtractSubset(registrationName="Every third slice", Input=skull, VOI=extent, SampleRateK=3)

# Depth maps with the same pixels, seen from the side
VIEW = dict(IsoValues=[500], ViewDirection=[1, 0, 0], ViewUp=[0, 0, 1], PixelSpacing=0.5, ImageSize=[440, 330],
            FocalPoint=[sum(bounds[a:a + 2]) / 2 for a in (0, 2, 4)], PlaneOrigin=[bounds[0], 0, 0])
truth = BSplineIsoRayCaster(registrationName="Truth", Input=fine, Interpolation="InterpolatingBSpline", **VIEW)
views = []
for name in ("Trilinear", "BSpline", "InterpolatingBSpline"):
    caster = BSplineIsoRayCaster(registrationName=name, Input=coarse, Interpolation=name, **VIEW)
    difference = PythonCalculator(registrationName=name + " minus truth", Input=[caster, truth], ArrayName="Difference",
                                  Expression="inputs[0].PointData['Depth'] - inputs[1].PointData['Depth']", CopyArrays=1)
    view = pictures.new_view((560, 460))
    pictures.show_image(difference, view, "Difference", "Difference of depth (mm)", (-0.5, 0.5), "Cool to Warm")
    pictures.add_title(view, name)
    pictures.look(view, VIEW["ViewDirection"], VIEW["ViewUp"], 1.3)
    views.append(view)
layout = pictures.lay_out(views, "Ripple")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "ripple.png"))
states.save(os.path.join(folder, "ripple.pvsm"))
