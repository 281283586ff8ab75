# SPDX-License-Identifier: BSD-3-Clause
"""RBF Interpolator and RBF Image Warp as a script sees them: properties, defaults, results."""
import csv
import os

import lacuna
import numpy as np
from lacuna_test import check_defaults, output
from paraview.simple import CSVReader, LoadPlugin, TableToPoints, Wavelet
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def write_points(name, points, **columns):
    """Points and their values as a data set, through a table."""
    file = output(name + ".csv")
    with open(file, "w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(["x", "y", "z", *columns])
        writer.writerows(np.column_stack([points, *columns.values()]).tolist())
    return TableToPoints(Input=CSVReader(FileName=[file]), XColumn="x", YColumn="y", ZColumn="z")


def fetch(proxy):
    proxy.UpdatePipeline()
    return servermanager.Fetch(proxy)


random = np.random.default_rng(1)
points = np.column_stack([random.uniform(0, 90, 900), random.uniform(0, 60, 900), np.full(900, 7.0)])
height = np.sin(points[:, 0] / 20) + 0.02 * points[:, 1]
scattered = write_points("RBFInterpolator", points, Height=height)
filter = RBFInterpolator(Input=scattered, ScalarArray="Height")

direct = lacuna.vtkLacunaRBFInterpolator()
check_defaults(filter, direct, ["Smoothing", "KernelLength", "Accuracy", "CenterTolerance", "OutputSpacing", "OutputBounds"],
               {"Solver": ["Auto", "Direct", "Fast"]})
assert filter.Kernel == "ThinPlate" and direct.GetKernel() == lacuna.choices(direct, "Kernel")["ThinPlate"]
assert filter.ErrorArray in ("", None) and direct.GetErrorArray() == ""

filter.OutputSpacing = [1, 1, 1]
filter.KernelLength = 4.5
image = fetch(filter)
x = np.array([image.GetPoint(i) for i in range(image.GetNumberOfPoints())])
assert (x[:, 2] == 7).all()
values = vtk_to_numpy(image.GetPointData().GetArray("Height"))
assert np.abs(values - np.sin(x[:, 0] / 20) - 0.02 * x[:, 1]).max() < 0.05
assert image.GetFieldData().GetArray("NodeCount").GetValue(0) == 900
for kernel in ("Linear", "Triharmonic", "Cubic", "Gaussian", "Multiquadric", "Wendland"):
    filter.Kernel = kernel
    filter.KernelLength = 20 if kernel == "Wendland" else 4.5  # a Wendland ends there
    values = vtk_to_numpy(fetch(filter).GetPointData().GetArray("Height"))
    # at the border a Gaussian and a Wendland fall back to their plane
    assert np.median(np.abs(values - np.sin(x[:, 0] / 20) - 0.02 * x[:, 1])) < 0.02, kernel
filter.Kernel = "ThinPlate"
filter.Solver = "Fast"
fast = fetch(filter)
assert fast.GetFieldData().GetArray("Iterations").GetValue(0) > 0
span = np.ptp(height)
assert np.abs(vtk_to_numpy(fast.GetPointData().GetArray("Height")) -
              vtk_to_numpy(image.GetPointData().GetArray("Height"))).max() < 1e-3 * span

filter.CenterTolerance = 0.01
few = fetch(filter)
centers = few.GetFieldData().GetArray("CenterCount").GetValue(0)
assert few.GetFieldData().GetArray("NodeCount").GetValue(0) == 900 and centers < 500, centers
assert few.GetFieldData().GetArray("Residual").GetValue(0) <= 0.01

# A volume of which all landmarks move by (2, -1, 3): what was at x is at x + (2, -1, 3).
volume = Wavelet(WholeExtent=[-10, 10, -8, 8, -6, 6])
places = random.uniform(-6, 6, (12, 3))
warp = RBFImageWarp(Input=volume, Landmarks=write_points("RBFImageWarpFrom", places),
                    Targets=write_points("RBFImageWarpTo", places + [2, -1, 3]))
direct = lacuna.vtkLacunaRBFImageWarp()
for name in ("Smoothing", "OutsideValue", "Accuracy"):
    assert warp.GetPropertyValue(name) == getattr(direct, "Get" + name)(), name
assert warp.Kernel == "ThinPlate" and direct.GetKernel() == direct.ThinPlate
assert warp.Interpolation == "Linear" and direct.GetInterpolation() == direct.LinearInterpolation
before = vtk_to_numpy(fetch(volume).GetPointData().GetArray("RTData")).reshape(13, 17, 21)
result = fetch(warp)
after = vtk_to_numpy(result.GetPointData().GetArray("RTData")).reshape(13, 17, 21)
valid = vtk_to_numpy(result.GetPointData().GetArray("vtkValidPointMask")).reshape(13, 17, 21)
assert np.abs(after[4:, :15, 3:] - before[1:10, 1:16, 1:19]).max() < 1
assert valid[4:, :15, 3:].all() and not valid[:2].any() and not valid[:, :, 0].any()
for interpolation in ("Nearest", "Cubic"):
    warp.Interpolation = interpolation
    after = vtk_to_numpy(fetch(warp).GetPointData().GetArray("RTData")).reshape(13, 17, 21)
    assert np.abs(after[4:, :15, 3:] - before[1:10, 1:16, 1:19]).max() < 1, interpolation
print("done")
