# SPDX-License-Identifier: BSD-3-Clause
"""What RBF Hole Filler gives, with every kernel, trend and prior of its page, makes a plate, a mould,
a model and an IGES file; the holes are those of the phantom."""
import os

import numpy as np
from lacuna.errors import raising
from lacuna_test import output
from paraview import servermanager
from paraview.simple import Delete, LoadPlugin, SaveData
from vtkmodules.numpy_interface import dataset_adapter as dsa

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())

SMOOTH = dict(NodeSpacing=2, SupportMargin=20, SupportStepMargin=3, CutoffWavelength=10)
SETTINGS = {  # of the table of six places, and those without a cut-off wavelength
    "default": dict(Smoothing=5),
    "thin plate": dict(SMOOTH, Kernel="ThinPlate"),
    "cubic": dict(SMOOTH, Kernel="Cubic"),
    "triharmonic": dict(SMOOTH, Kernel="Triharmonic"),
    "linear": dict(SMOOTH, Kernel="Linear"),
    "ellipsoid": dict(SMOOTH, Kernel="ThinPlate", Trend="Ellipsoid"),
    "cubic ellipsoid": dict(SMOOTH, Kernel="Cubic", Trend="Ellipsoid"),
    "wide": dict(SMOOTH, Kernel="ThinPlate", Trend="Ellipsoid", OutputMargin=15),
}
PRIORS = ("default", "cubic", "thin plate")
folder = output("filled map consumers")
os.makedirs(folder, exist_ok=True)


def use(what, filled, truth, limit):
    """All four consumers; the fill lies within limit mm of the phantom without a hole."""
    with raising():
        filled.UpdatePipeline()
    image = servermanager.Fetch(filled)
    arrays = dsa.WrapDataObject(image).PointData
    fitted, inside = np.asarray(arrays["Fitted"]), np.asarray(arrays["FilledMask"]) == 1
    columns = image.GetDimensions()[0]
    finite = np.isfinite(fitted).reshape(-1, columns)
    box = finite[np.ix_(finite.any(1), finite.any(0))]
    assert box.all(), (what, "Fitted has %d holes" % (~box).sum())
    extent = image.GetExtent()
    height, width = truth.shape
    rows, cols = np.divmod(np.flatnonzero(inside), columns)
    error = np.asarray(arrays["Depth"])[inside] - truth[np.clip(rows + extent[2], 0, height - 1), np.clip(cols + extent[0], 0, width - 1)]
    error = np.abs(error[np.isfinite(error)]).max()
    print("%-28s largest error %.2f mm" % (what, error), flush=True)
    assert error < limit, (what, error)
    for proxy, properties in ((ImplantPlate, dict(Thickness=2)), (DefectModel, dict(Margin=10)),
                              (PressOrientation, dict(PlateMargin=0, FlangeWidth=10, PlaneMethod="LeastSquares"))):
        made = proxy(Input=filled, **properties)
        with raising():
            made.UpdatePipeline()
        assert servermanager.Fetch(made).GetNumberOfPoints() > 1000, (what, proxy)
        Delete(made)
    name = os.path.join(folder, what + ".igs")
    with raising():
        SaveData(name, proxy=filled)
    assert os.path.getsize(name) > 1000, what


for direction, radius, settings, limit in (((0.4, -0.2, 0.9), 30, SETTINGS, 4.5), ((0.9, -0.35, 0.15), 30, PRIORS, 1)):
    view = dict(IsoValues=[500], ViewDirection=[-c for c in direction], Interpolation="InterpolatingBSpline", PixelSpacing=1)
    skull = SkullPhantom(DefectRadius=radius, DefectDirection=direction)
    depth = BSplineIsoRayCaster(Input=skull, **view)
    whole = BSplineIsoRayCaster(Input=SkullPhantom(DefectRadius=0), **view)
    whole.UpdatePipeline()
    image = servermanager.Fetch(whole)
    truth = np.asarray(dsa.WrapDataObject(image).PointData["Depth"]).reshape(image.GetDimensions()[1::-1])
    # a mirror image prior has the phantom's own hole on the other side
    prior = None if settings is SETTINGS else BSplineIsoRayCaster(Input=Mirror(Input=skull), **view)
    for key in settings:
        filled = RBFHoleFiller(Input=depth, PriorSurface=prior, **SETTINGS[key])
        use(key + (" prior" if prior else ""), filled, truth, limit)
        Delete(filled)
