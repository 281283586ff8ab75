# SPDX-License-Identifier: BSD-3-Clause
"""Three outlines of which parts are missing, closed by the occluded angle (Carr 1996, chapter 5).

    pvpython in_paraview.py [folder for picture and state file, default: .]

Writes occluded-angle-2d.png and occluded-angle-2d.pvsm, for File > Load State.
"""
import math
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import pictures, states
from paraview.simple import *

CASES = (
    ("a gap of 40 degrees", dict(GapAngle=40), dict(Mode="Binary", NumberOfDirections=100, ThresholdsOverPi=[1])),
    ("a quarter of the pixels", dict(PresentFraction=0.25), dict(Mode="Binary", NumberOfDirections=150, ThresholdsOverPi=[0.6], MedianKernel=5)),
    ("a blob with outliers", dict(Shape="Blob", PresentFraction=0.4, OutlierFraction=0.1, Seed=2),
     dict(NumberOfDirections=100, ThresholdsOverPi=[1.6, 1.6, 1.3, 1.3])),
)
views = []
for title, shape, settings in CASES:
    data = IncompleteShape(registrationName=title.capitalize(), Dimensions=[200, 200, 200], **shape)
    angle = OccludedAngle(registrationName="Angle of " + title, Input=data, **settings)
    lines = Contour(registrationName="Threshold of " + title, Input=angle, ContourBy=["POINTS", "OccludedAngle"],
                    Isosurfaces=[settings["ThresholdsOverPi"][-1] * math.pi])
    outline = Connectivity(registrationName="Outline of " + title, Input=lines, ExtractionMode="Extract Largest Region", ColorRegions=0)
    seen = pictures.marked_points(data, "Data", "Voxels of " + title, "Data of " + title)
    last = title == CASES[-1][0]
    view = pictures.new_view((700 if last else 560, 560))  # with a scalar bar
    pictures.show_image(angle, view, "OccludedAngle", "Occluded angle (rad)", (0, 2 * math.pi)).SetScalarBarVisibility(view, last)
    pictures.show_surface(seen, view, (0.2, 0.5, 1)).PointSize = 3
    pictures.show_surface(outline, view, (0.9, 0.1, 0.1)).LineWidth = 3
    pictures.add_title(view, title.capitalize())
    pictures.look(view, (0, 0, -1), (0, 1, 0), 1.15)
    views.append(view)
layout = pictures.lay_out(views, "Occluded angle, 2-D")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "occluded-angle-2d.png"))
states.save(os.path.join(folder, "occluded-angle-2d.pvsm"))
