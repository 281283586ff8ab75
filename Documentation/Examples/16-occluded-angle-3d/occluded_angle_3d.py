# SPDX-License-Identifier: BSD-3-Clause
"""The thesis's 3-D cases of the occluded angle (Carr 1996, section 5.8), each with its picture.

Usage: pvpython occluded_angle_3d.py [folder for the pictures]
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import occlusion, pictures
from paraview.simple import *

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)


def show(name, title, data, schedule, direction, seen=None, truth=None):
    """The data in blue (seen: an image of those that count), the closed surface made of them; truth in ml."""
    angle = OccludedAngle(Input=data, NumberOfDirections=400, **occlusion.scaled(schedule, data))
    surface = occlusion.closed_surface(angle)
    view = pictures.new_view((900, 700))
    producer = TrivialProducer()
    producer.GetClientSideObject().SetOutput(surface.data)
    body = Show(producer, view)
    body.AmbientColor = body.DiffuseColor = list(pictures.TISSUE)
    body.Opacity = 0.7
    points = TrivialProducer()
    points.GetClientSideObject().SetOutput(occlusion.data_points(seen or data))
    dots = Show(points, view)
    dots.AmbientColor = dots.DiffuseColor = [0.1, 0.3, 0.8]
    dots.PointSize = 4
    pictures.add_title(view, title)
    pictures.look(view, direction, (0, 0, 1), 0.95)
    pictures.save(view, os.path.join(folder, name + ".png"))
    truth = truth or servermanager.Fetch(data).GetFieldData().GetArray("CompleteVolume").GetValue(0)
    print(f"{name}: {surface.volume:.2f} ml, truth {truth:.2f} ml ({100 * (surface.volume / truth - 1):+.1f} %), "
          f"threshold suggested for one iteration {occlusion.suggested_threshold(angle):.2f} pi", flush=True)
    occlusion.plot_volume(angle, os.path.join(folder, name + "-volume.png"))
    Delete(view)


show("cube", "20-cube, 80 % missing: 2.5 2.5 2 2 pi",
     IncompleteShape(Shape="Cube", Dimensions=[44, 44, 44], PresentFraction=0.2), occlusion.CUBE, (-1, -2, -0.8))
show("sparse-cube", "20-cube, 90 % missing",
     IncompleteShape(Shape="Cube", Dimensions=[44, 44, 44], PresentFraction=0.1), occlusion.SPARSE_CUBE, (-1, -2, -0.8))
show("kumara", "Kumara, 60 % missing in patches, 2 % outliers",
     IncompleteShape(Shape="Kumara", Dimensions=[105, 75, 53], PresentFraction=0.4, Patches=1, PatchRadii=[2, 5],
                     OutlierFraction=0.02),
     occlusion.GROW_AND_SNAP, (-0.5, -2, -1))

# Slices in any order, pixels in the nearest voxels, ten empty voxels all round. Water (20) lets everything through.
sweep = PhantomSweep(Anatomy="Kumara", Motion="Arbitrary", NumberOfSlices=50, ImageSize=[300, 280], PixelSpacing=0.4,
                     Travel=210, SpeckleLevel=0.2)
volume = SweptVolume(Input=sweep, Interpolation="NearestVoxel", OutputSpacing=[2, 2, 2])
volume.UpdatePipeline()
volume.OutputBounds = [b + 20 * (-1) ** (i + 1) for i, b in enumerate(volume.GetDataInformation().GetBounds())]
opacity = CreatePiecewiseFunction(Points=[0, 0, 0.5, 0, 60, 0, 0.5, 0, 200, 1, 0.5, 0])
sweep.UpdatePropertyInformation()
show("kumara-slices", "Kumara from 50 slices in any order: 2 pi", volume,
     dict(Attenuation="Opacity Function", OpacityFunction=opacity, ThresholdsOverPi=[2]), (-0.5, -2, -1),
     Calculator(Input=volume, ResultArrayName="Seen", Function="if(Intensity > 130, 1, 0)"),
     sweep.GetProperty("TrueVolume").GetData() / 1000)
