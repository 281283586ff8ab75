# SPDX-License-Identifier: BSD-3-Clause
"""RBF Hole Filler as a script sees it: properties, defaults, ways to mark the defect."""
import os
import re

import lacuna
import numpy as np
from depth_map_files import fetch, write_map
from paraview import servermanager
from paraview.simple import LoadPlugin

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def surface(x, y):
    return 40 + 0.2 * x - 0.1 * y + 0.002 * (x - 20) ** 2


def provenance(proxy):
    return servermanager.Fetch(proxy).GetFieldData().GetAbstractArray("Provenance").GetValue(0)


x, y = np.meshgrid(np.arange(70.0), np.arange(50.0))
depth = surface(x, y)
depth[20:30, 35:50] = np.nan
source = write_map("RBFHoleFiller", depth, 1.0, (3, 4, 5), (1, 0, 0), (0, -1, 0))
filler = RBFHoleFiller(Input=source)

direct = lacuna.vtkLacunaRBFHoleFiller()
for name in ("SupportMargin", "SupportStepMargin", "NodeSpacing", "Smoothing", "CutoffWavelength", "OutputMargin"):
    assert filler.GetPropertyValue(name) == getattr(direct, "Get" + name)(), name
assert filler.Kernel == "ThinPlate" and direct.GetKernel() == lacuna.choices(direct, "Kernel")["ThinPlate"]
assert direct.GetDefectRegion() is None
assert type(filler.DefectRegion).__name__ == "None"
for name in ("DefectArray", "SupportArray"):
    assert filler.GetPropertyValue(name) in ("", "None", None), name
    assert getattr(direct, "Get" + name)() == ""

points, fields = fetch(filler)  # by default the hole, with 2 mm of its rim
filled = points["FilledMask"] == 1
outside = np.hypot(np.maximum(np.abs(x - 42) - 7, 0), np.maximum(np.abs(y - 24.5) - 4.5, 0))
assert (filled == (outside <= 2)).all()
assert np.abs(points["Depth"] - surface(x, y))[filled].max() < 0.05
assert (points["Depth"] == depth)[~filled].all()
assert fields["NodeCount"][0] > 500
assert "ImageToWorld" in fields

for region in ("Sphere", "Box", "Cylinder", "Plane", "None"):
    filler.DefectRegion = region
filler.DefectRegion = "Sphere"
filler.DefectRegion.Center = [3 + 25, 4 - 20, 5 - surface(25, 20)]
filler.DefectRegion.Radius = 6
filled = fetch(filler)[0]["FilledMask"] == 1
inside = np.hypot(x - 25, y - 20)
assert filled[inside < 5].all() and not filled[inside > 6.01].any()

filler.DefectRegion = "Box"
filler.DefectRegion.Position = [3 + 10.5, 4 - 19.5, -100]
filler.DefectRegion.Length = [12, 9, 200]
filled = fetch(filler)[0]["FilledMask"] == 1
assert (filled == ((x > 10.5) & (x < 22.5) & (y > 10.5) & (y < 19.5))).all()

# The provenance names ParaView's cylinder as it was set, without the transform that is in it, and no dump.
centre = np.array([3 + 12.5, 4 - 20, 5 - surface(12.5, 20)])
filler.DefectRegion = "Cylinder"
filler.DefectRegion.Center = list(centre)
filler.DefectRegion.Radius = 6
for axis in ((0, 0, -1), (0, 1, 0), (0.4, -0.2, 0.9)):
    filler.DefectRegion.Axis = axis
    filled = fetch(filler)[0]["FilledMask"] == 1
    record = provenance(filler)
    region = dict(re.findall(r"(\w+)=([-+.e\d,]+)", re.search('DefectRegion="(.*?)" ', record)[1]))
    assert 'DefectRegion="vtkPVCylinder Center=' in record and set(region) == {"Center", "Axis", "Radius"}, record
    told = np.array([float(value) for value in region["Axis"].split(",")])
    assert np.abs(told - axis / np.linalg.norm(axis)).max() < 1e-15, told
    if axis[2] != 0.9:
        assert region["Axis"] == "%g,%g,%g" % axis, record
    centre_told, radius = [float(value) for value in region["Center"].split(",")], float(region["Radius"])
    away = [np.linalg.norm(np.cross(np.dstack([3 + x, 4 - y, 5 - z]) - centre_told, told), axis=2)
            for z in surface(x, y) - np.linspace(0, 40, 801)[:, None, None]]  # towards the viewer
    assert filled[away[0] < radius].all() and not filled[np.min(away, axis=0) > radius].any(), axis
filler.DefectRegion = "Box"
filler.DefectRegion.Rotation = [10, 20, 0]
filler.DefectRegion.Position = [3 + 10.5, 4 - 19.5, -100]
filler.DefectRegion.Length = [30, 30, 200]
assert fetch(filler)[0]["FilledMask"].any() and "Inverse" not in provenance(filler), provenance(filler)

filler.DefectRegion = "Spline Loop"  # round a corner of the hole, and above and below the surface
assert filler.DefectRegion.Closed == 1
corners = [(30, 12, 0), (48, 16, 9), (44, 27, -5), (33, 38, 20)]
filler.DefectRegion.Points = [value for i, j, off in corners
                              for value in (3 + i, 4 - j, 5 - surface(i, j) + off)]
loop = fetch(filler)[0]["FilledMask"] == 1
assert loop[14, 32] and loop[25, 37] and loop[36, 33] and not loop[34, 44] and not loop[8, 30]
assert 300 < loop.sum() < 500
filler.DefectRegion.Closed = 0  # without the bulge from the last corner to the first
straight = fetch(filler)[0]["FilledMask"] == 1
assert not (straight & ~loop)[:, :31].any() and (loop & ~straight)[:, :31].sum() > 20

filler.DefectRegion = "None"
filler.SupportArray = "vtkValidPointMask"  # all that is not a hole
filler.DefectArray = "vtkValidPointMask"
filler.DefectArray = "None"  # as the panel says it
filled = fetch(filler)[0]["FilledMask"] == 1
assert (filled == np.isnan(depth)).all()
for kernel in ("Linear", "Cubic", "ThinPlate"):
    filler.Kernel = kernel
    assert np.isfinite(fetch(filler)[0]["Depth"]).all()
