# SPDX-License-Identifier: BSD-3-Clause
"""A kumara of which 60 % of the surface is missing, with outliers: data, threshold of the angle, refined surface.

Usage: pvpython occlusion_surface.py [folder for the pictures]
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import occlusion, pictures
from paraview.simple import *

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)


def show(name, title, surface=None, data=None):
    view = pictures.new_view((900, 700))
    if surface is not None:
        body = Show(surface, view)
        body.AmbientColor = body.DiffuseColor = list(pictures.TISSUE)
        body.Interpolation = "Gouraud"
        body.Specular = 0.3
    if data is not None:
        points = TrivialProducer()
        points.GetClientSideObject().SetOutput(occlusion.data_points(data))
        seen = Show(points, view)
        seen.AmbientColor = seen.DiffuseColor = [0.1, 0.3, 0.8]
        seen.PointSize = 4
    pictures.add_title(view, title)
    pictures.look(view, (-0.5, -2, -1), (0, 0, 1), 0.95)
    pictures.save(view, os.path.join(folder, name + ".png"))
    Delete(view)


data = IncompleteShape(Shape="Kumara", Dimensions=[105, 75, 53], PresentFraction=0.4, Patches=1, PatchRadii=[2, 5],
                       OutlierFraction=0.02)
truth = servermanager.Fetch(data).GetFieldData().GetArray("CompleteVolume").GetValue(0)
angle = OccludedAngle(Input=data, NumberOfDirections=200, **occlusion.scaled(occlusion.GROW_AND_SNAP, data))
surface = OcclusionSurface(Input=angle, Data=data)
coarse = occlusion.closed_surface(angle)
threshold = TrivialProducer()
threshold.GetClientSideObject().SetOutput(coarse.data)
volume = servermanager.Fetch(surface).GetFieldData().GetArray("SurfaceVolume").GetValue(0)
print(f"threshold {100 * (coarse.volume / truth - 1):+.1f} %, refined {100 * (volume / truth - 1):+.1f} % of the volume")
show("data", "Data: 40 % of the surface, 2 % outliers", data=data)
show("threshold", "Occluded Angle, last threshold", surface=threshold)
show("refined", "Occlusion Surface", surface=surface)
