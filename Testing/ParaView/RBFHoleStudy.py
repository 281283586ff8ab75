# SPDX-License-Identifier: BSD-3-Clause
"""What error to expect: discs of 15, 30 and 45 mm cut out of a real skull at six places, filled.

Prints largest error and RMS, mm, each averaged over the six places. Without arguments it compares
the default with the choice of the guide page; with "full" it prints the whole table of that page,
with "elsewhere" it compares at places and in maps that had no part in the choice, and with
"settings" for one hole in 18 maps of it.
"""
import os
import sys

import lacuna
import numpy as np
from lacuna_test import data
from paraview import servermanager
from paraview.simple import LoadPlugin, OpenDataFile
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())

# towards the viewer, and a point of the bone, mm
PLACES = {
    "vertex": ((0, 0, 1), (71.3, 101.1, 131.3)),
    "frontal": ((0, 0.5, 0.86), (72.2, 151, 127.6)),
    "occipital": ((0, -0.6, 0.8), (70.4, 77.3, 122.3)),
    "left": ((0.5, -0.1, 0.86), (105.7, 96.6, 124.4)),
    "right": ((-0.5, -0.1, 0.86), (43.1, 99.1, 125.2)),
    "left frontal": ((0.4, 0.35, 0.85), (95.7, 140.3, 126.2)),
}
RADII = (15, 30, 45)
# kernel, SupportMargin, NodeSpacing, CutoffWavelength, Trend
DEFAULT = ("ThinPlate", 12, 1, 0, "NoTrend")
CHOICE = ("Cubic", 20, 2, 10, "NoTrend")
ELLIPSOID = ("ThinPlate", 20, 2, 10, "Ellipsoid")
OTHERS = [ELLIPSOID] + [setting + ("NoTrend",) for setting in (
    ("ThinPlate", 20, 2, 10), ("Cubic", 20, 2, 0), ("Cubic", 20, 2, 8), ("Cubic", 20, 2, 15),
    ("Cubic", 20, 2, 20), ("Cubic", 8, 2, 10), ("Cubic", 12, 2, 10), ("Cubic", 12, 1, 0),
    ("Linear", 12, 1, 0), ("Linear", 20, 2, 10), ("Triharmonic", 20, 2, 0),
    ("Triharmonic", 20, 2, 10), ("Triharmonic", 20, 2, 20), ("Gaussian", 20, 2, 0),
    ("Multiquadric", 20, 2, 0))]
# interpolation of the ray caster, columns and rows by which the places are moved
ELSEWHERE = [("Trilinear", (7, 4)), ("BSpline", (-6, 7)), ("InterpolatingBSpline", (-5, -8))]


def spread(mask, radius):
    """Pixels whose centres are at most so many pixels from one of mask."""
    grown = mask.copy()
    for i in range(-radius, radius + 1):
        for j in range(-radius, radius + 1):
            if i * i + j * j <= radius * radius:
                grown |= np.roll(mask, (j, i), (0, 1))
    return grown


def find_unsound(depth, spacing):
    """What the saw and the drill left: depth steps over 63 degrees, holes, 3 pixels around them."""
    unsound = ~np.isfinite(depth)
    filled = np.where(unsound, 1e9, depth)
    for axis in (0, 1):
        step = np.abs(np.diff(filled, axis=axis)) > 2 * spacing
        before, after = [(0, 1), (0, 0)], [(1, 0), (0, 0)]
        if axis:
            before, after = before[::-1], after[::-1]
        unsound |= np.pad(step, before) | np.pad(step, after)
    return spread(unsound, 3)


class Place:
    """A view of the head and a point in it."""

    def __init__(self, head, view, point, interpolation="InterpolatingBSpline", shift=(0, 0),
                 up=None, pixel=0):
        caster = BSplineIsoRayCaster(
            Input=head, IsoValues=[500], Interpolation=interpolation,
            ViewDirection=[-c for c in view], PixelSpacing=pixel,
            ViewUp=up or ([0, -1, 0] if view[2] == 1 else [0, 0, 1]))
        caster.UpdatePipeline()
        self.map = servermanager.Fetch(caster)
        columns, rows, _ = self.map.GetDimensions()
        self.spacing = self.map.GetSpacing()[0]
        to_world = vtk_to_numpy(self.map.GetFieldData().GetArray("ImageToWorld")).reshape(4, 4)
        i, j = np.rint(np.linalg.solve(to_world, [*point, 1])[:2]) + shift
        y, x = np.mgrid[:rows, :columns]
        self.distance = np.hypot(x - i, y - j) * self.spacing
        depth = vtk_to_numpy(self.map.GetPointData().GetArray("Depth")).reshape(rows, columns)
        self.sound = ~find_unsound(depth, self.spacing)

    def fill(self, radius, kernel, margin, spacing, cutoff, trend):
        """Largest error and RMS in the disc, against the sound bone that was there."""
        defect = self.distance <= radius
        support = self.sound & ~defect & (self.distance <= radius + margin)
        for name, mask in (("Defect", defect), ("Sound", support)):
            array = numpy_to_vtk(mask.ravel().astype(np.int8), deep=1)
            array.SetName(name)
            self.map.GetPointData().AddArray(array)
        filler = lacuna.vtkLacunaRBFHoleFiller()
        filler.SetInputData(self.map)
        filler.SetDefectArray("Defect")
        filler.SetSupportArray("Sound")
        filler.SetKernel(getattr(filler, kernel))
        filler.SetNodeSpacing(spacing)
        filler.SetCutoffWavelength(cutoff)
        filler.SetTrend(getattr(filler, trend))
        filler.Update()
        error = vtk_to_numpy(filler.GetOutput().GetPointData().GetArray("Deviation"))
        error = error.reshape(defect.shape)[defect & self.sound]
        return np.abs(error).max(), np.sqrt((error ** 2).mean())


head = OpenDataFile(data("ct_head/head.mha"))


def study(places, choice):
    figures = np.array([[place.fill(radius, *choice) for place in places]
                        for radius in RADII])
    means = figures.mean(axis=1)
    print("| %s | %g | %g | %g | %s |" % choice,
          " | ".join("%.2f / %.3f" % tuple(mean) for mean in [*means, means.mean(axis=0)]), "|",
          flush=True)
    return means.mean(axis=0)


def compare(*caster, others=()):
    places = [Place(head, *place, *caster) for place in PLACES.values()]
    default = study(places, DEFAULT)
    gain = 100 * (1 - study(places, CHOICE) / default)
    for other in others:
        study(places, other)
    print("less error: largest %.0f %%, RMS %.0f %%" % tuple(gain), flush=True)
    assert (gain >= 15).all()


print("| kernel | margin | node spacing | cut-off | trend | 15 mm | 30 mm | 45 mm | all |")
print("|---|---|---|---|---|---|---|---|---|")
compare(others=OTHERS if "full" in sys.argv else ())
for maps in ELSEWHERE if "elsewhere" in sys.argv else ():
    print(*maps)
    compare(*maps, others=[ELLIPSOID])

if "settings" in sys.argv:  # each: largest error and RMS, default, choice and ellipsoid
    figures = np.array([
        [Place(head, (0, 0, 1), (90.2, 97.5, 130), name, (0, 0), up, pixel).fill(30, *choice)
         for choice in (DEFAULT, CHOICE, ELLIPSOID)]
        for name in ("BSpline", "InterpolatingBSpline", "Trilinear")
        for up in ([0, -1, 0], [0, 1, 0]) for pixel in (0, 0.5, 1)])
    for statistic in (np.mean, np.std, np.min, np.max):
        print(statistic.__name__, statistic(figures, axis=0).round(3).tolist())
