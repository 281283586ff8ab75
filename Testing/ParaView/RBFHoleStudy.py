# SPDX-License-Identifier: BSD-3-Clause
"""What error to expect: discs of 15, 30 and 45 mm cut out of a real skull at six places, filled.

The discs are cut and filled by properties of the filters only, as in ParaView. Prints largest error
and RMS, mm, each averaged over the six places. Without arguments it compares the default with the
choices of the guide page; with "full" it prints the whole table of that page, with "elsewhere" it
compares at places and in maps that had no part in the choice, and with "settings" for one hole in
18 maps of it, and how well polynomials fit the bone that was cut out there.
"""
import os
import sys

import numpy as np
from depth_map_files import find_unsound
from lacuna_test import data
from paraview import servermanager
from paraview.simple import LoadPlugin, OpenDataFile
from vtkmodules.util.numpy_support import vtk_to_numpy

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
COLUMNS = ("Kernel", "SupportMargin", "SupportStepMargin", "NodeSpacing", "CutoffWavelength", "Trend")
DEFAULT = ("ThinPlate", 12, 0, 1, 0, "None")
CHOICE = ("Cubic", 20, 3, 2, 10, "None")
ELLIPSOID = ("ThinPlate", 20, 3, 2, 10, "Ellipsoid")
OTHERS = [
    ("Cubic", 20, 0, 2, 10, "None"), ("ThinPlate", 20, 0, 2, 10, "Ellipsoid")] + [
    (kernel, margin, 3, spacing, cutoff, "None") for kernel, margin, spacing, cutoff in (
        ("ThinPlate", 12, 1, 0), ("ThinPlate", 20, 2, 10), ("Cubic", 20, 2, 0), ("Cubic", 20, 2, 8),
        ("Cubic", 20, 2, 15), ("Cubic", 20, 2, 20), ("Cubic", 8, 2, 10), ("Cubic", 12, 2, 10),
        ("Cubic", 30, 2, 10), ("Cubic", 12, 1, 0), ("Linear", 12, 1, 0), ("Linear", 20, 2, 10),
        ("Triharmonic", 20, 2, 0), ("Triharmonic", 20, 2, 10), ("Triharmonic", 20, 2, 20),
        ("Gaussian", 20, 2, 0), ("Multiquadric", 20, 2, 0))] + [
    ("Cubic", 20, 2, 2, 10, "None"), ("Cubic", 20, 4, 2, 10, "None"),
    ("Cubic", 20, 3, 2, 10, "Ellipsoid"), ("ThinPlate", 30, 3, 2, 20, "Ellipsoid")]
# interpolation of the ray caster, columns and rows by which the places are moved
ELSEWHERE = [("Trilinear", (7, 4)), ("BSpline", (-6, 7)), ("InterpolatingBSpline", (-5, -8))]


class Place:
    """A view of the head and a point in it."""

    def __init__(self, head, view, point, interpolation="InterpolatingBSpline", shift=(0, 0),
                 up=None, pixel=0):
        caster = BSplineIsoRayCaster(
            Input=head, IsoValues=[500], Interpolation=interpolation,
            ViewDirection=[-c for c in view], PixelSpacing=pixel,
            ViewUp=up or ([0, -1, 0] if view[2] == 1 else [0, 0, 1]))
        caster.UpdatePipeline()
        depth_map = servermanager.Fetch(caster)
        columns, rows, _ = depth_map.GetDimensions()
        spacing = depth_map.GetSpacing()[0]
        to_world = vtk_to_numpy(depth_map.GetFieldData().GetArray("ImageToWorld")).reshape(4, 4)
        i, j = np.linalg.solve(to_world, [*point, 1])[:2] + shift
        y, x = np.mgrid[:rows, :columns]
        self.position = (x - i) * spacing, (y - j) * spacing
        self.depth = vtk_to_numpy(depth_map.GetPointData().GetArray("Depth")).reshape(rows, columns)
        self.sound = ~find_unsound(self.depth, spacing)
        self.filler = RBFHoleFiller(Input=caster)
        self.filler.DefectRegion = "Cylinder"
        self.filler.DefectRegion.Center = (to_world @ [i, j, 0, 1])[:3]
        self.filler.DefectRegion.Axis = view

    def fill(self, radius, setting):
        """Largest error and RMS in the disc, against the sound bone that was there."""
        self.filler.DefectRegion.Radius = radius
        for name, value in zip(COLUMNS, setting):
            setattr(self.filler, name, value)
        filled = servermanager.Fetch(self.filler).GetPointData()
        defect, error = (vtk_to_numpy(filled.GetArray(name)).reshape(self.sound.shape)
                         for name in ("FilledMask", "Deviation"))
        assert ((defect == 1) == (np.hypot(*self.position) <= radius)).all()
        return summarize(error[(defect == 1) & self.sound])

    def fit_polynomial(self, radius, degree):
        """Largest residual and RMS of the polynomial that fits the sound bone in the disc best."""
        inside = (np.hypot(*self.position) <= radius) & self.sound
        x, y = (coordinate[inside] / radius for coordinate in self.position)
        terms = np.stack([x ** i * y ** j for i in range(degree + 1) for j in range(degree + 1 - i)], 1)
        solution = np.linalg.lstsq(terms, self.depth[inside], rcond=None)[0]
        return summarize(self.depth[inside] - terms @ solution)


def summarize(error):
    return np.abs(error).max(), np.sqrt((error ** 2).mean())


head = OpenDataFile(data("ct_head/head.mha"))


def study(places, setting):
    figures = np.array([[place.fill(radius, setting) for place in places]
                        for radius in RADII])
    means = figures.mean(axis=1)
    print("| %s | %g | %g | %g | %g | %s |" % setting,
          " | ".join("%.2f / %.3f" % tuple(mean) for mean in [*means, means.mean(axis=0)]), "|",
          flush=True)
    return means.mean(axis=0)


def compare(*caster, others=()):
    places = [Place(head, *place, *caster) for place in PLACES.values()]
    default = study(places, DEFAULT)
    gains = [100 * (1 - study(places, choice) / default) for choice in (CHOICE, ELLIPSOID)]
    for other in others:
        study(places, other)
    for choice, gain in zip((CHOICE, ELLIPSOID), gains):
        print(choice, "less error: largest %.0f %%, RMS %.0f %%" % tuple(gain), flush=True)
    assert (gains[0] >= 15).all()


print("|", " | ".join(COLUMNS), "| 15 mm | 30 mm | 45 mm | all |")
print("|" + 10 * "---|")
compare(others=OTHERS if "full" in sys.argv else ())
for maps in ELSEWHERE if "elsewhere" in sys.argv else ():
    print(*maps)
    compare(*maps)

if "settings" in sys.argv:
    STEPS = (0, 0.5, 1)
    rows = [(name, up) for name in ("BSpline", "InterpolatingBSpline", "Trilinear")
            for up in ([0, -1, 0], [0, 1, 0])]
    maps = [Place(head, (0, 0, 1), (90.2, 97.5, 130), name, (0, 0), up, pixel)
            for name, up in rows for pixel in STEPS]
    figures = {str(setting): np.array([place.fill(30, setting) for place in maps])
               for setting in (DEFAULT, CHOICE, ELLIPSOID)}
    for degree in (2, 4, 6):
        figures["polynomial of degree %d" % degree] = np.array(
            [place.fit_polynomial(30, degree) for place in maps])
    for row, values in zip(rows, figures[str(DEFAULT)].reshape(len(rows), len(STEPS), 2)):
        print(*row, *("| %.3f / %.3f" % tuple(value) for value in values))
    for label, values in figures.items():
        print(label, *("%s %.3f / %.3f" % (name, *statistic(values, axis=0)) for name, statistic in (
            ("mean", np.mean), ("deviation", np.std), ("best", np.min), ("worst", np.max))))
