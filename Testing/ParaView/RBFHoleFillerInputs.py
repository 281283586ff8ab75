# SPDX-License-Identifier: BSD-3-Clause
"""RBF Hole Filler with its optional inputs: selections, handles to drag, a prior; other grids."""
import os

import lacuna
import numpy as np
from depth_map_files import fetch, write_map
from paraview import servermanager
from paraview.selection import SelectIDs, SelectPedigreeIDs
from paraview.simple import (Calculator, CreateRenderView, ExtractSelection, LoadPlugin, PolyLineSource,
                             SetActiveView, Show)
from vtkmodules.util.numpy_support import vtk_to_numpy

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def dome(x, y):
    return 60 - np.sqrt(50 ** 2 - (x - 30) ** 2 - (y - 26) ** 2)


x, y = np.meshgrid(np.arange(70.0), np.arange(50.0))
radius = np.hypot(x - 41, y - 22)
depth = dome(x, y)
depth[radius <= 7] = np.nan
source = write_map("RBFHoleFillerInputs", depth, 1.0, (3, 4, 5), (1, 0, 0), (0, -1, 0))
surface = DepthMapSurface(Input=source)
surface.UpdatePipeline()
filler = RBFHoleFiller(Input=source, Surface=surface)

direct = lacuna.vtkLacunaRBFHoleFiller()
assert list(filler.OutputSpacing) == list(direct.GetOutputSpacing()) == [0, 0, 0]
assert filler.Accuracy == direct.GetAccuracy() and filler.KernelLength == direct.GetKernelLength()
assert filler.Solver == "Auto" and direct.GetSolver() == direct.Auto
assert filler.Trend == "None" and direct.GetTrend() == direct.NoTrend
assert (filler.ControlDepthArray or "") == direct.GetControlDepthArray() == ""

# Ids of points on a ring around the hole: of pixels, and of the surface as the mouse picks them
ring = (radius > 7) & (radius <= 9.5)
pixels = np.flatnonzero(ring.ravel())
data = servermanager.Fetch(surface)
ids = data.GetPointData().GetPedigreeIds()
number_of = {ids.GetValue(i): i for i in range(ids.GetNumberOfTuples())}


SetActiveView(CreateRenderView())
Show(surface)
Show(source)


def active_selection(of):
    """What the button Copy Active Selection copies."""
    return servermanager._getPyProxy(of.SMProxy.GetSelectionInput(0))


def check_disc():
    filled = fetch(filler)[0]["FilledMask"] == 1
    assert (filled == (radius <= 9.5)).all(), filled.sum()


SelectPedigreeIDs([value for pixel in pixels for value in ("PixelId", str(pixel))], Source=surface)
filler.Selection = active_selection(surface)
check_disc()
SelectIDs([value for pixel in pixels for value in (-1, number_of[pixel])], Source=surface)
filler.Selection = active_selection(surface)
check_disc()
extracted = ExtractSelection(Input=surface, Selection=active_selection(surface))
filler.Selection = None
filler.Surface = extracted
check_disc()
filler.Surface = None  # a patch on the map itself
patch = np.flatnonzero((radius <= 8).ravel())
SelectIDs([value for pixel in patch for value in (-1, int(pixel))], Source=source)
filler.Selection = active_selection(source)
assert ((fetch(filler)[0]["FilledMask"] == 1) == (radius <= 8)).all()
filler.Selection = None

# Sound bone painted as the user guide says: selected points of the map, or a formula
sound = (radius > 9.5) & (radius <= 20)
SelectIDs([value for pixel in np.flatnonzero(sound.ravel()) for value in (-1, int(pixel))], Source=source)
painted = ExtractSelection(Input=source, Selection=active_selection(source), PreserveTopology=1)
by_hand = RBFHoleFiller(Input=painted, SupportArray="vtkInsidedness")
formula = Calculator(Input=source, ResultArrayName="Sound",
                     Function="((coordsX-44)^2+(coordsY+18)^2 > 90.25)*((coordsX-44)^2+(coordsY+18)^2 <= 400)")
by_formula = RBFHoleFiller(Input=formula, SupportArray="Sound")
for support in (by_hand, by_formula):
    points = fetch(support)[0]
    assert ((points["SupportMask"] == 1) == sound).all()
    assert ((points["FilledMask"] == 1) == (radius <= 9.5)).all()

# The points of a poly line are handles in the 3-D view; here they are moved by a script.
handles = PolyLineSource()
filler.ControlPoints = handles
filler.Accuracy = 0
patient = DepthMapSurface(Input=filler)
for push in (0, 1, 2.5, -2.5):  # the last one outwards, to larger z
    handles.Points = [3 + 41, 4 - 22, 5 - (dome(41, 22) + push), 3 + 35, 4 - 20, 5 - dome(35, 20)]
    points, fields = fetch(filler)
    assert abs(points["Depth"][22, 41] - dome(41, 22) - push) < 1e-6
    assert abs(points["Depth"][20, 35] - dome(35, 20)) < 1e-6
    patient.UpdatePipeline()
    bone = vtk_to_numpy(servermanager.Fetch(patient).GetPoints().GetData())
    at = bone[np.hypot(bone[:, 0] - 44, bone[:, 1] + 18) < 1e-3]
    assert at.shape == (1, 3) and abs(at[0, 2] - (5 - dome(41, 22) - push)) < 1e-4, at
plain = RBFHoleFiller(Input=source)
before = fetch(plain)[0]
moved = points["Fitted"] - before["Fitted"]
assert np.nanmin(moved) < -2.4 and np.nanargmin(moved) == 22 * 70 + 41
assert fields["FitTime"][0] > 0

# A prior of another grid and another direction of its axes: the dome itself, 5 mm too near
u, v = np.meshgrid(np.arange(0, 120), np.arange(0, 110))
px, py = 75 - 0.7 * v, -5 + 0.6 * u  # its rows run along the map's columns
prior = write_map("RBFHoleFillerPrior", dome(px, py) - 5, [0.6, 0.7], (3 + 75, 4 + 5, 5),
                  (0, -1, 0), (-1, 0, 0))
plain.PriorSurface = prior
with_prior = fetch(plain)[0]
inside = before["FilledMask"] == 1
errors = [np.abs(points["Depth"] - dome(x, y))[inside].max() for points in (before, with_prior)]
print("largest error without and with the prior: %.4f, %.4f mm" % tuple(errors))
assert errors[1] < 0.01 and errors[0] > 3 * errors[1]
assert set(np.unique(with_prior["SupportMask"])) == {0, 1}
plain.PriorSurface = None
plain.Trend = "Ellipsoid"
assert np.abs(fetch(plain)[0]["Depth"] - dome(x, y))[inside].max() < 0.005
plain.Trend = "None"

plain.OutputSpacing = [0.5, 0.5, 0]
plain.OutputMargin = 6
fine = fetch(plain)[0]
assert fine["Depth"].shape == (98 + 1 + 24, 138 + 1 + 24)
assert np.isfinite(fine["Depth"][12:-12, 12:-12]).all() and np.isnan(fine["Depth"][:12]).all()
plain.OutputMargin = 0
for kernel in ("Triharmonic", "Gaussian", "Multiquadric"):
    plain.Kernel = kernel
    assert np.isfinite(fetch(plain)[0]["Depth"]).all()
