# SPDX-License-Identifier: BSD-3-Clause
"""A kumara of which 60 % of the surface is missing, with outliers: the data, and the smooth surface through them.

    pvpython in_paraview.py [folder for picture and state file, default: .]

Writes occlusion-surface.png and occlusion-surface.pvsm, for File > Load State.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import occlusion, pictures, states
from paraview.simple import *

data = IncompleteShape(registrationName="Kumara", Shape="Kumara", Dimensions=[105, 75, 53], PresentFraction=0.4, Patches=1, PatchRadii=[2, 5],
                       OutlierFraction=0.02)
angle = OccludedAngle(registrationName="Angle", Input=data, NumberOfDirections=200, **occlusion.scaled(occlusion.GROW_AND_SNAP, data))
surface = OcclusionSurface(registrationName="Surface", Input=angle, Data=data)
seen = pictures.marked_points(data, "Data", "Voxels", "Seen")
views = []
for title in ("Data: 40 % of the surface, 2 % outliers", "Occlusion Surface"):
    view = pictures.new_view((800, 650))
    if not views:
        pictures.show_surface(seen, view, (0.1, 0.3, 0.8)).PointSize = 4
    else:
        pictures.show_surface(surface, view, pictures.TISSUE).Specular = 0.3
    pictures.add_title(view, title)
    pictures.look(view, (-0.5, -2, -1), (0, 0, 1), 0.95)
    views.append(view)
cameras = [view.GetActiveCamera() for view in views]  # the same for both
cameras[1].SetFocalPoint(*cameras[0].GetFocalPoint())
cameras[1].SetPosition(*cameras[0].GetPosition())
views[1].CameraParallelScale = views[0].CameraParallelScale = 44
layout = pictures.lay_out(views, "Occlusion surface")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "occlusion-surface.png"))
states.save(os.path.join(folder, "occlusion-surface.pvsm"))
