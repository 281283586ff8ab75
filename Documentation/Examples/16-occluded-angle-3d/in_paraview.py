# SPDX-License-Identifier: BSD-3-Clause
"""A cube and a kumara of which most of the surface is missing, closed by the occluded angle (Carr 1996, chapter 5).

    pvpython in_paraview.py [folder for picture and state file, default: .]

Writes occluded-angle-3d.png and occluded-angle-3d.pvsm, for File > Load State.
"""
import math
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import occlusion, pictures, states
from paraview.simple import *

CASES = (
    ("a cube, 80 % missing", dict(Shape="Cube", Dimensions=[44, 44, 44], PresentFraction=0.2), occlusion.CUBE, (-1, -2, -0.8)),
    ("a kumara, 60 % missing", dict(Shape="Kumara", Dimensions=[105, 75, 53], PresentFraction=0.4, Patches=1, PatchRadii=[2, 5],
                                    OutlierFraction=0.02), occlusion.GROW_AND_SNAP, (-0.5, -2, -1)),
)
views = []
for title, shape, schedule, direction in CASES:
    data = IncompleteShape(registrationName=title.capitalize(), **shape)
    angle = OccludedAngle(registrationName="Angle of " + title, Input=data, NumberOfDirections=400, **occlusion.scaled(schedule, data))
    # The angle of the solid within four voxels smooths its surface: half of all directions just outside, all inside
    solid = OccludedAngle(registrationName="Solid of " + title, Input=angle, ScalarArray="Object", Mode="Binary", LocalRadii=[4],
                          ThresholdsOverPi=[3], NumberOfDirections=400)
    surface = Contour(registrationName="Surface of " + title, Input=solid, ContourBy=["POINTS", "OccludedAngle"], Isosurfaces=[3 * math.pi],
                      ComputeScalars=0)
    body = Connectivity(registrationName="Largest piece of " + title, Input=surface, ExtractionMode="Extract Largest Region", ColorRegions=0)
    seen = pictures.marked_points(data, "Data", "Voxels of " + title, "Data of " + title)
    view = pictures.new_view((800, 650))
    pictures.show_surface(body, view, pictures.TISSUE).Opacity = 0.75
    pictures.show_surface(seen, view, (0.1, 0.3, 0.8)).PointSize = 4
    pictures.add_title(view, title.capitalize())
    pictures.look(view, direction, (0, 0, 1), 0.95)
    views.append(view)
layout = pictures.lay_out(views, "Occluded angle, 3-D")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "occluded-angle-3d.png"))
states.save(os.path.join(folder, "occluded-angle-3d.pvsm"))
