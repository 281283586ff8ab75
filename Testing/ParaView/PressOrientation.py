# SPDX-License-Identifier: BSD-3-Clause
"""From the phantom of a skull to moulds, as a script does it; IGES and STL lead back to the patient."""
import os

import lacuna
import numpy as np
from lacuna.errors import PipelineError, raising
from lacuna.solids import save_solid
from lacuna_test import output
from paraview import servermanager
from paraview.simple import (Calculator, ExtractSubset, ExtractSurface, LoadPlugin, OpenDataFile, PassArrays, SaveData,
                             Transform)
from vtkmodules.numpy_interface import dataset_adapter as dsa

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def fetch(proxy):
    with raising():
        proxy.UpdatePipeline()
    data = servermanager.Fetch(proxy)
    wrapped = dsa.WrapDataObject(data)
    fields = {n: np.asarray(wrapped.FieldData[n]) for n in wrapped.FieldData.keys()
              if n not in ("Provenance", "PlaneSource")}
    return data, wrapped, fields


phantom = SkullPhantom()
depth = BSplineIsoRayCaster(Input=phantom, IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9])
filled = RBFHoleFiller(Input=depth, Smoothing=5)
filled.DefectRegion = "None"
press = PressOrientation(Input=filled)

direct = lacuna.vtkLacunaPressOrientation()
for name in ("PlateThickness", "PlateMargin", "FlangeWidth", "OutputSpacing"):
    assert press.GetPropertyValue(name) == getattr(direct, "Get" + name)(), name
assert list(press.BlockSize) == list(direct.GetBlockSize())
assert press.Mould == "Female" and direct.GetMould() == direct.Female
assert press.Seating == "Onlay" and direct.GetSeating() == direct.Onlay
assert press.ConvexSide == "Automatic" and direct.GetConvexSide() == direct.Automatic

# The true surface, to compare with: Fitted in patient coordinates.
image, wrapped, fields = fetch(filled)
columns, rows, _ = image.GetDimensions()
to_world = fields["ImageToWorld"].reshape(4, 4)
fitted = np.asarray(wrapped.PointData["Fitted"]).reshape(rows, columns)
mask = np.asarray(wrapped.PointData["FilledMask"]).reshape(rows, columns)
down, right = np.gradient(fitted, np.linalg.norm(to_world[:3, 1]), np.linalg.norm(to_world[:3, 0]))


def at(array, points):
    """Values of an array of the map, linear between the pixels, at points of the patient."""
    local = (points - to_world[:3, 3]) @ np.linalg.inv(to_world[:3, :3]).T
    i, j = np.floor(local[:, 0]).astype(int), np.floor(local[:, 1]).astype(int)
    x, y = local[:, 0] - i, local[:, 1] - j
    return ((1 - x) * (1 - y) * array[j, i] + x * (1 - y) * array[j, i + 1]
            + (1 - x) * y * array[j + 1, i] + x * y * array[j + 1, i + 1]), local[:, 2]


moulds = {}
for mould, seating in (("Female", "Onlay"), ("Female", "Inlay"), ("Male", "Onlay"), ("Male", "Inlay")):
    press.Mould, press.Seating, press.OutputSpacing = mould, seating, 0.5
    data, wrapped, fields = fetch(press)
    points = np.asarray(wrapped.Points)
    assert points.dtype == np.float64 and data.GetExtent()[4:] == (0, 0)
    assert fields["SingleValued"].item() == 1
    back = fields["PressToPatient"].reshape(4, 4)
    assert abs(np.linalg.det(back[:3, :3]) - 1) < 1e-14
    assert np.abs(back[:3, :3] @ back[:3, :3].T - np.eye(3)).max() < 1e-14
    z = points[:, 2]
    assert z.max() == 0 if mould == "Female" else z.min() == 0
    assert abs(np.abs(z).max() - fields["Depth"].item()) < 1e-12
    assert np.asarray(wrapped.PointData["WallAngle"]).max() == fields["DraftAngle"].item() < 80
    region = np.asarray(wrapped.PointData["PressRegion"])
    defect = np.asarray(wrapped.PointData["DefectMask"])
    assert set(region) == {0, 1, 2} and (region[defect == 1] == 2).all()
    assert (z[region == 0] == 0).all()
    plate = points[region == 2] @ back[:3, :3].T + back[:3, 3]
    expected, found = at(fitted, plate)
    cosine = 1 / np.sqrt(1 + at(down, plate)[0] ** 2 + at(right, plate)[0] ** 2)
    # the viewer is on the side of lesser depth
    offset = (expected - found) * cosine
    wanted = {"Onlay": 0.7, "Inlay": 0.0}[seating] - (0.7 if mould == "Male" else 0)
    assert abs(fields["SurfaceOffset"].item() - wanted) < 1e-15
    print(f"{mould} {seating}: offset {offset.min():.4f} to {offset.max():.4f} mm, {fields['Depth'].item():.2f} mm "
          f"deep, walls {fields['DraftAngle'].item():.1f} degrees", flush=True)
    assert np.abs(offset - wanted).max() < 0.02 + (0.03 if wanted else 0)
    assert (at(mask.astype(float), points[defect == 1] @ back[:3, :3].T + back[:3, 3])[0] > 0).mean() > 0.98
    moulds[mould, seating] = back
turn = np.linalg.inv(moulds["Female", "Onlay"]) @ moulds["Male", "Onlay"]
assert np.abs(turn[:3, :3] - np.diag([1, -1, -1])).max() < 1e-12

# The angles of Carr 1996 lay the plane flat.
plane = fetch(filled)[2]["PlaneNormal"].ravel()
axes = to_world[:3, :3] / np.linalg.norm(to_world[:3, :3], axis=0)
assert np.abs(moulds["Male", "Onlay"][:3, 2] - axes @ plane).max() < 1e-14
theta, psi = np.radians(fields["Angles"].ravel())
c1, c2 = -plane[:2] / plane[2]
assert abs(theta - np.arctan(-c2 / np.sqrt(1 + c1 ** 2))) < 1e-14 and abs(psi - np.arctan(c1)) < 1e-14

# Files: what ParaView and the IGES Writer make of the grid.
surface = ExtractSurface(Input=press)
for name in ("mould.stl", "mould.ply"):
    path = output(name)
    save_solid(path, surface)
    again = OpenDataFile(path)
    again.UpdatePipeline()
    bounds = np.array(again.GetDataInformation().GetBounds())
    assert np.abs(bounds - data.GetBounds()).max() < 5e-6, name
with raising():
    SaveData(output("mould.vts"), press, DataMode="Binary")
    SaveData(output("mould.igs"), press)
again = OpenDataFile(output("mould.vts"))
kept, wrapped, fields = fetch(again)
assert np.abs(np.asarray(wrapped.Points) - points).max() == 0
assert np.abs(fields["PressToPatient"].reshape(4, 4) - moulds["Male", "Inlay"]).max() < 1e-12

# What has been moved since is known: nothing is milled or written from a mirrored or stretched mould.
def judge(proxy, **options):
    """What is said of a mould by Milling Tool Path and by the writer: refused (text) or warned of (list)."""
    answers = []
    file = output("moved.igs")
    if os.path.exists(file):
        os.remove(file)
    path = MillingToolPath(Input=proxy, StepOver=4, RoughingStep=8)
    for run in (path.UpdatePipeline, lambda: SaveData(file, proxy, **options)):
        warnings = []
        try:
            with raising(warnings):
                run()
            answers.append([text for text in warnings if "since it was made" in text])
        except PipelineError as error:
            answers.append(str(error))
    assert os.path.exists(file) == isinstance(answers[1], list)
    return answers


def transformed(proxy, **change):
    transform = Transform(Input=proxy)
    for name, value in change.items():
        setattr(transform.Transform, name, value)
    return transform


press.OutputSpacing = 1
part = ExtractSubset(Input=press, VOI=[10, 60, 5, 50, 0, 0], SampleRateI=2)
for proxy in (press, part, PassArrays(Input=press), transformed(press), Calculator(Input=press, Function="coordsX")):
    assert judge(proxy, Coordinates="Patient") == [[], []]
for proxy, change, words in ((press, {"Scale": [-1, 1, 1]}, "it is mirrored"), (part, {"Scale": [1, 1, -1]}, "it is mirrored"),
                             (press, {"Scale": [1.01] * 3}, "distances in it"), (press, {"Scale": [1 / 25.4] * 3}, "distances in it")):
    for text in judge(transformed(proxy, **change)):
        assert isinstance(text, str) and words in text, (change, text)
for change, words in (({"Rotate": [10, 0, 0]}, "tilted by 10 degrees"), ({"Translate": [0, 0, 5]}, "lies up to 5 mm elsewhere")):
    for [text] in judge(transformed(press, **change)):
        assert words in text, (change, text)
    milled, text = judge(transformed(press, **change), Coordinates="Patient")
    assert len(milled) == 1 and isinstance(text, str) and "AsGiven" in text, text
# Of a depth map Transform keeps the plane of its pixels, and not its depths: that is no surface.
for change in ({}, {"Translate": [0, 0, 5]}, {"Rotate": [10, 0, 0]}):
    for text in judge(transformed(filled, **change)):
        assert isinstance(text, str) and "plane of a depth map's pixels" in text and "Take Transform out" in text, text

# No mould, but the way out, which works.
hurt = SkullPhantom(DefectRadius=40)
view = [-0.1, 0.2, -0.9]
wide = BSplineIsoRayCaster(Input=hurt, IsoValues=[500], ViewDirection=view)
filled = RBFHoleFiller(Input=wide, Smoothing=5, SupportStepMargin=0)  # also the steep rim, which this view has
press = PressOrientation(Input=filled, FlangeWidth=20)


def undercut():
    """The fields and the warning when there is no mould."""
    warnings = []
    with raising(warnings):
        press.UpdatePipeline()
    data = servermanager.Fetch(press)
    assert data.GetNumberOfPoints() == 0
    fields = dsa.WrapDataObject(data).FieldData
    assert np.asarray(fields["SingleValued"]).item() == 0
    [text] = [text for text in warnings if "the mill does not see" in text]
    return fields, text


for kernel, method in (("Cubic", "Fit"), ("Triharmonic", "LeastSquares"), ("Triharmonic", "Fit")):
    filled.Kernel, press.PlaneMethod, wide.ViewDirection = kernel, method, view
    fields, text = undercut()
    if kernel == "Cubic":  # this plane is 50 degrees off; the plate's own will do
        assert "Set PlaneMethod to LeastSquares" in text and "SuggestedViewDirection" not in fields.keys(), text
    else:
        suggested = np.asarray(fields["SuggestedViewDirection"]).ravel()
        assert abs(np.linalg.norm(suggested) - 1) < 1e-14 and suggested @ view > 0
        assert "OutputMargin of RBF Hole Filler of at least 5" in text, text
        assert "SuggestedViewDirection" in text and ("PlaneMethod" in text) == (method == "Fit"), text
        wide.ViewDirection = list(suggested)
    press.PlaneMethod = "LeastSquares"
    fields = fetch(press)[2]
    print(kernel, method, "from", list(wide.ViewDirection), "walls of", fields["DraftAngle"].item(), flush=True)
    assert fields["SingleValued"].item() == 1 and "SuggestedViewDirection" not in fields

# With a wide margin Fitted reaches too little from the new view, unless the advice is followed.
wide.ViewDirection, filled.Kernel, press.PlateMargin = [-0.1, -0.1, -0.9], "Triharmonic", 9.5
fields, text = undercut()
wide.ViewDirection = list(np.asarray(fields["SuggestedViewDirection"]).ravel())
assert "OutputMargin of RBF Hole Filler of at least 10" in text, text
try:
    fetch(press)
    raise AssertionError("without a margin")
except PipelineError as error:
    assert "the fitted surface reaches only" in str(error), error
filled.OutputMargin = 10
assert fetch(press)[2]["SingleValued"].item() == 1
filled.OutputMargin, press.PlateMargin = 0, 5

# From the side there is nothing to tell a better view from.
filled.Input = BSplineIsoRayCaster(Input=phantom, IsoValues=[500], ViewDirection=[0.5, -0.6, -0.62])
filled.Kernel, press.FlangeWidth = "ThinPlate", 25
fields, text = undercut()
assert "looks along the bone" in text and "SuggestedViewDirection" not in fields.keys(), text
