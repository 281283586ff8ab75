# SPDX-License-Identifier: BSD-3-Clause
"""Holes cut beside the middle of a real skull, filled with and without its own mirror image as prior.

The bone that is cut out is unknown to the filters: the map that is mirrored has the hole, too. The
table of the guide page is compared: largest error and RMS on sound bone, mm.
"""
import os

import numpy as np
from depth_map_files import fetch, find_unsound, write_map
from lacuna_test import data
from paraview.simple import LoadPlugin, MetaFileSeriesReader

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())

PLACES = {  # column and row in the map, radius in mm, and whether the bone bends as its margin does not tell
    "brow": (118, 215, 20, True),
    "temple": (128, 180, 30, True),
    "forehead": (118, 145, 20, False),
    "side": (118, 110, 20, False),
}
TITLES = {"side": "side, near the vertex"}  # in the guide
THIN_PLATE = dict(Kernel="ThinPlate", SupportMargin=12, SupportStepMargin=0, NodeSpacing=1, CutoffWavelength=0)
CUBIC = dict(Kernel="Cubic", SupportMargin=20, SupportStepMargin=3, NodeSpacing=2, CutoffWavelength=10)
VIEW = (0, 0.5, 0.86)  # from above the forehead

head = MetaFileSeriesReader(FileNames=[data("ct_head/head.mha")])
caster = BSplineIsoRayCaster(Input=head, IsoValues=[500], Interpolation="InterpolatingBSpline",
                             ViewDirection=[-c for c in VIEW], ViewUp=[0, 0, 1])
points, fields = fetch(caster)
to_world = fields["ImageToWorld"].reshape(4, 4)
spacing = np.linalg.norm(to_world[:3, :2], axis=0)
axes = to_world[:3, :2] / spacing
depth = points["Depth"]
unsound = find_unsound(depth, spacing[0])
rows, columns = np.indices(depth.shape)
figures = {}
for place, (column, row, radius, _) in PLACES.items():
    disc = np.hypot(rows - row, columns - column) * spacing[0] <= radius
    cut = write_map("MirrorPriorHead-" + place, np.where(disc, np.nan, depth), spacing, to_world[:3, 3], *axes.T)
    pattern = RBFHoleFiller(Input=Mirror(Input=cut), SupportStepMargin=0)  # the sound side, burr holes in it filled
    filler = RBFHoleFiller(Input=cut, DefectRegion="Cylinder")
    filler.DefectRegion.Center = list(to_world[:3, 3] + to_world[:3, 0] * column + to_world[:3, 1] * row)
    filler.DefectRegion.Axis = list(VIEW)
    filler.DefectRegion.Radius = radius + 0.01
    for label, prior, settings in (("ThinPlate", None, THIN_PLATE), ("Cubic", None, CUBIC),
                                   ("prior, ThinPlate", pattern, THIN_PLATE), ("prior, Cubic", pattern, CUBIC)):
        filler.PriorSurface = prior
        for name, value in settings.items():
            setattr(filler, name, value)
        filled, report = fetch(filler)
        assert ((filled["FilledMask"] == 1) == disc).all() and "Mirrored" not in report
        error = (filled["Depth"] - depth)[disc & ~unsound]
        figures[place, label] = np.abs(error).max(), np.sqrt((error ** 2).mean())
        print("%-9s %2d mm %-16s %.2f / %.2f mm" % (place, radius, label, *figures[place, label]), flush=True)
with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Documentation", "UserGuide", "mirror.md"), encoding="utf-8") as file:
    guide = file.read()
for place, (_, _, radius, _) in PLACES.items():
    row = "| %s | %d mm |" % (TITLES.get(place, place), radius)
    row += "".join(" %.2f / %.2f |" % figures[place, label] for label in ("ThinPlate", "Cubic", "prior, ThinPlate", "prior, Cubic"))
    assert row in guide, row
for place, (*_, bends) in PLACES.items():
    plain, mirrored = ([figures[place, prefix + label] for label in ("ThinPlate", "Cubic")]
                       for prefix in ("", "prior, "))
    # Where the margin does not tell the shape the mirror image does; elsewhere it costs no more than
    # a skull's two sides differ.
    for prior, own in zip(mirrored, plain):
        if bends:
            assert prior[1] < 0.65 * own[1], (place, prior, own)
        assert prior[0] < 2.2 and prior[1] < 0.6, (place, prior)
