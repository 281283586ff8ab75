# SPDX-License-Identifier: BSD-3-Clause
"""A letter F goes from DICOM through the ray caster to a surface and comes out where it was in the
patient (LPS), whatever the orientation of the scan, from five views."""
import os
import shutil
import subprocess
import sys

import lacuna_test
import numpy as np
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
folder = lacuna_test.output("CT orientation")
shutil.rmtree(folder, ignore_errors=True)
subprocess.run([sys.argv[1], folder], check=True)

# The bars of the letter in patient coordinates, as in CTTestSeries.cxx.
BARS = np.array([[-12.55, -12.45, -12.35, -4.55, -3.45, 12.65],
                 [-12.55, -12.45, 5.35, 11.45, -3.45, 12.65],
                 [-12.55, -18.45, -3.85, 6.45, -8.45, 3.65]])
VIEWS = [(0, 0, -1), (0, 1, 0), (-1, 0, 0), (1, 0.5, 0.3), (-0.4, -0.7, 0.6)]
ISO_VALUE = 300


def distance(points):
    """Distance from the surface of the letter, negative inside."""
    all_bars = []
    for bar in BARS:
        beyond = np.maximum(bar[:3] - points, points - bar[3:])
        all_bars.append(np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0))
    return np.min(all_bars, axis=0)


def expected(axis):
    """How far the letter reaches towards a viewer who looks along axis."""
    corners = np.array([[bar[3 * a], bar[3 * b + 1], bar[3 * c + 2]] for bar in BARS
                        for a in (0, 1) for b in (0, 1) for c in (0, 1)])
    return (corners @ axis).min()


for name in ("body axial", "body feet first", "body oblique", "body tilted"):
    scan = CTSeriesReader(FileName=os.path.join(folder, name))
    for view in VIEWS:
        depth = BSplineIsoRayCaster(Input=scan, IsoValues=[ISO_VALUE], PixelSpacing=0.5, ViewDirection=view,
                                    ViewUp=[0.1, 0.2, 1] if view[2] == 0 else [0, -1, 0])
        surface = DepthMapSurface(Input=depth)
        surface.UpdatePipeline()
        data = servermanager.Fetch(surface)
        points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
        off = np.abs(distance(points))
        axis = np.array(view) / np.linalg.norm(view)
        nearest = (points @ axis).min()
        # The field is linear at flat faces, and smoothed within two voxels of edges.
        print(f"{name}, view {view}: {len(points)} points, off by {np.percentile(off, 30):.4f} mm (30 %), "
              f"{np.percentile(off, 90):.2f} (90 %), {off.max():.2f} (all)", flush=True)
        assert len(points) > 600
        assert np.percentile(off, 30) < 0.01 and np.percentile(off, 90) < 0.4 and off.max() < 1.2
        assert abs(nearest - expected(axis)) < 1.5, (nearest, expected(axis))
        # A mirrored letter would not pass, about whichever plane through its middle.
        middle = (BARS[:, :3].min(axis=0) + BARS[:, 3:].max(axis=0)) / 2
        for mirrored in range(3):
            image = points.copy()
            image[:, mirrored] = 2 * middle[mirrored] - image[:, mirrored]
            beside = (np.abs(distance(image)) > 1.5).mean()
            assert beside > 0.03, (name, view, mirrored, beside)
        Delete(surface)
        Delete(depth)
    Delete(scan)
