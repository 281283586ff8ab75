# SPDX-License-Identifier: BSD-3-Clause
"""A hole of 30 mm radius cut into the CT of a real skull, filled, and compared with what was cut."""
import os
import zlib

import numpy as np
from depth_map_files import fetch, write_map
from lacuna_test import data
from paraview.simple import LoadPlugin

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def head_map(path, iso_value):
    """Depths at which rays from the top, one per column of voxels, first reach the iso-value."""
    with open(path, "rb") as file:
        raw = file.read()
    marker = b"ElementDataFile = LOCAL\n"
    start = raw.index(marker) + len(marker)
    voxels = np.frombuffer(zlib.decompress(raw[start:]), "<i2").reshape(140, 244, 180)
    column = voxels[::-1, ::-1, :].astype(float)  # from the top; rows from +y to -y
    above = column >= iso_value
    k = above.argmax(axis=0)
    depth = np.full(k.shape, np.nan)
    rows, columns = np.nonzero(above.any(axis=0) & (k > 0))
    k = k[rows, columns]
    before, after = column[k - 1, rows, columns], column[k, rows, columns]
    depth[rows, columns] = (k - 1) + (iso_value - before) / (after - before)
    return depth


spacing = 0.90234375
depth = head_map(data("ct_head/head.mha"), 500)
source = write_map("RBFHoleFillerHead", depth, spacing, (0, 243 * spacing, 139),
                   (1, 0, 0), (0, -1, 0))
filler = RBFHoleFiller(Input=source)
filler.DefectRegion = "Cylinder"
filler.DefectRegion.Center = [90.2, 97.5, 100]
filler.DefectRegion.Axis = [0, 0, 1]
filler.DefectRegion.Radius = 30
SHARED = dict(SupportMargin=20, SupportStepMargin=3, NodeSpacing=2, CutoffWavelength=10)
SETTINGS = {  # of the user guide
    "Linear": dict(Kernel="Linear"),
    "ThinPlate": dict(Kernel="ThinPlate"),
    "Cubic as recommended": dict(Kernel="Cubic", **SHARED),
    "Ellipsoid": dict(Kernel="ThinPlate", Trend="Ellipsoid", **SHARED),
}
x, y = np.meshgrid(np.arange(180) * spacing - 90.2, (243 - np.arange(244)) * spacing - 97.5)
inside = np.hypot(x, y) <= 30
figures = {}
fields = {}
for label, settings in SETTINGS.items():
    for name, value in settings.items():
        setattr(filler, name, value)
    points, fields[label] = fetch(filler)
    assert ((points["FilledMask"] == 1) == inside).all()
    error = (points["Depth"] - depth)[inside]
    assert np.array_equal(error, points["Deviation"][inside])
    figures[label] = np.abs(error).max(), np.sqrt((error ** 2).mean())
    print("%s: %d nodes, max %.3f mm, RMS %.3f mm, condition %.2g, residual %.2g mm"
          % (label, fields[label]["NodeCount"][0], *figures[label],
             fields[label]["ConditionEstimate"][0], fields[label]["Residual"][0]))
terms = np.stack([x[inside] ** i * y[inside] ** j / 30 ** (i + j)
                  for i in range(5) for j in range(5 - i)], 1)
error = depth[inside] - terms @ np.linalg.lstsq(terms, depth[inside], rcond=None)[0]
print("polynomial of degree 4 fitted to the missing bone: max %.3f mm, RMS %.3f mm"
      % (np.abs(error).max(), np.sqrt((error ** 2).mean())))
# A plain thin plate fit reaches 0.94 and 0.32.
assert figures["ThinPlate"][0] <= 1.0
assert figures["ThinPlate"][1] <= 0.35
assert figures["Linear"][0] > figures["ThinPlate"][0]
assert figures["Cubic as recommended"][0] <= 0.95 and figures["Cubic as recommended"][1] <= 0.3
assert figures["Ellipsoid"][0] <= 0.95 and figures["Ellipsoid"][1] <= 0.28
fields = fields["ThinPlate"]
# The disc of 30 mm, inclined and domed, is larger than in projection.
assert 2900 < fields["DefectArea"][0] < 3300
assert np.isclose(np.linalg.norm(fields["PlaneNormal"]), 1) and fields["PlaneNormal"][2] < 0
