# SPDX-License-Identifier: BSD-3-Clause
"""A schedule for closed shapes of which most is missing, and one for denser data: volume, mean and largest distance to the truth.

They hold for voxels of any size when the radii are scaled with them.
"""
import os

import lacuna
import numpy as np
from lacuna import occlusion
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())

KUMARA = dict(Shape=5, Dimensions=[105, 75, 53], PresentFraction=0.4, Patches=True, PatchRadii=[2, 5])
# data; largest error of the volume in %, largest mean distance in voxels
CASES = {
    "sphere of 20, 90 % missing": (dict(Shape=4, Dimensions=[65] * 3, PresentFraction=0.1), 5, 0.6),
    "the same, voxels of 0.5 mm": (dict(Shape=4, Dimensions=[65] * 3, PresentFraction=0.1), 5, 0.6),
    "cube of 60, 90 % missing": (dict(Shape=3, Dimensions=[84] * 3, PresentFraction=0.1), 5, 0.6),
    "cube of 20, 90 % missing": (dict(Shape=3, Dimensions=[44] * 3, PresentFraction=0.1), 10, 0.6),
    "kumara, patches missing": (KUMARA, 5, 0.6),
    "kumara, 2 % outliers": (dict(KUMARA, OutlierFraction=0.02), 5, 0.6),
    "dense sphere of 20, 60 % missing": (dict(Shape=4, Dimensions=[65] * 3, PresentFraction=0.4), 4, 0.4),
    "dense kumara, 60 % missing, 10 % outliers": (
        dict(KUMARA, Patches=False, OutlierFraction=0.1), 5, 0.4),
    "dense kumara, complete": (dict(KUMARA, PresentFraction=1), 1, 0.3),
}


def distances(surface, shape, edge):
    """Area-weighted mean and largest distance of the triangles' middles to the true shape, in voxels."""
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    points = shape.GetOutput().GetOrigin() + (points - shape.GetOutput().GetOrigin()) / edge
    corners = points[vtk_to_numpy(surface.GetPolys().GetData()).reshape(-1, 4)[:, 1:]]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    distance = np.array([abs(shape.EvaluateDistance(*middle)) for middle in corners.mean(axis=1)])
    return np.average(distance, weights=areas), distance.max()


for name, (data, most_volume, most_mean) in CASES.items():
    edge = 0.5 if "0.5 mm" in name else 1.0
    shape = lacuna.vtkLacunaIncompleteShape()
    for key, value in data.items():
        getattr(shape, "Set" + key)(*(value if isinstance(value, list) else [value]))
    angle = lacuna.vtkLacunaOccludedAngle()
    shape.Update()
    image = vtkImageData()
    image.ShallowCopy(shape.GetOutput())
    image.SetSpacing(edge, edge, edge)
    angle.SetInputData(image)
    angle.SetMode(angle.Continuous)
    angle.KeepDataOn()
    angle.SetNumberOfDirections(200)
    schedule = occlusion.scaled(occlusion.DENSE if "dense" in name else occlusion.GROW_AND_SNAP, image)
    radii = schedule["LocalRadii"] * (len(schedule["ThresholdsOverPi"]) // len(schedule["LocalRadii"]))
    for i, (threshold, radius) in enumerate(zip(schedule["ThresholdsOverPi"], radii)):
        angle.SetThresholdsOverPi(i, threshold)
        angle.SetLocalRadii(i, radius)
    surface = occlusion.closed_surface(angle)
    truth = shape.GetOutput().GetFieldData().GetArray("CompleteVolume").GetValue(0) * edge ** 3
    error = 100 * (surface.volume / truth - 1)
    mean, largest = distances(surface.data, shape, edge)
    print(f"{name}: volume {error:+.1f} %, mean distance {mean:.2f}, largest {largest:.1f} voxels")
    assert abs(error) < most_volume and mean < most_mean, name
