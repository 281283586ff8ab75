# SPDX-License-Identifier: BSD-3-Clause
"""One pipeline to every format: the filled surface as IGES, and its triangles through ParaView's own writers.

Read back, all of them show the same surface at the same place, on the same side of the head.
"""
import os

import numpy as np
from lacuna_test import output
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())

phantom = SkullPhantom(Spacing=[3, 3, 3])
depth = BSplineIsoRayCaster(Input=phantom, IsoValues=[500], ViewDirection=[-0.2, 0.3, -1])
filled = RBFHoleFiller(Input=depth)
surface = DepthMapSurface(Input=filled)
surface.UpdatePipeline()


def corners_of(proxy):
    """The corners of all triangles, three rows each, whichever points they share."""
    proxy.UpdatePipeline()
    data = servermanager.Fetch(proxy)
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
    return points[vtk_to_numpy(data.GetPolys().GetConnectivityArray())]


expected = corners_of(surface)
bounds = np.array([expected.min(axis=0), expected.max(axis=0)])
triangles = servermanager.Fetch(surface).GetNumberOfCells()
assert triangles > 1000

for extension in ("stl", "ply", "obj", "vtk", "vtp"):
    name = output("FabricationFormats." + extension)
    if os.path.exists(name):
        os.remove(name)
    # Debian 12's libexpat breaks ParaView 5.11's reading of its default, appended (coordinates.md)
    SaveData(name, surface, **({"DataMode": "Binary"} if extension == "vtp" else {}))
    assert os.path.getsize(name) > 1000, extension
    back = OpenDataFile(name)
    corners = corners_of(back)
    assert len(corners) == 3 * triangles, extension
    # asymmetric: every mirror image has other bounds and another centre
    assert np.abs(np.array([corners.min(axis=0), corners.max(axis=0)]) - bounds).max() < 1e-3, extension
    assert np.abs(corners.mean(axis=0) - expected.mean(axis=0)).max() < 1e-3, extension

name = output("FabricationFormats.igs")
SaveData(name, filled)
assert os.path.getsize(name) > 1000
print("ok")
