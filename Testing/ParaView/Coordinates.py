# SPDX-License-Identifier: BSD-3-Clause
"""Files and pictures say "patient" only of what is there: not in the press, not mirrored, not moved, not unknown."""
import json
import os
import zipfile

from lacuna import coordinates, views
from lacuna.data import fetch
from lacuna.errors import PipelineError
from lacuna.solids import save_solid
from lacuna_test import output
from paraview import servermanager
from paraview.simple import *

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def check(proxy, expected):
    proxy.UpdatePipeline()
    assert coordinates.find(proxy) == expected, (proxy.GetXMLLabel(), coordinates.find(proxy), expected)
    patient = expected in (coordinates.PATIENT, coordinates.PATIENT + coordinates.AS_FILE)
    assert views.in_patient_coordinates(proxy) == patient, proxy.GetXMLLabel()


def check_files(proxy, expected, **options):
    for name in ("Coordinates.stl", "Coordinates.3mf"):
        assert save_solid(output(name), proxy, **options)["coordinates"] == expected, (name, expected)
        with open(output(name) + ".json", encoding="utf-8") as file:
            assert json.load(file)["coordinates"] == expected
    with zipfile.ZipFile(output("Coordinates.3mf")) as package:
        assert f"Coordinates: {expected} (mm)" in package.read("3D/3dmodel.model").decode()


skull = SkullPhantom(Spacing=[2, 2, 2])
depth = BSplineIsoRayCaster(Input=skull, IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9])
filled = RBFHoleFiller(Input=depth, Smoothing=5, OutputMargin=30)
plate, model, press = ImplantPlate(Input=filled), DefectModel(Input=filled), PressOrientation(Input=filled)
for proxy in (skull, depth, filled, plate, model, DepthMapSurface(Input=filled), DepthMapShader(Input=depth),
              SpeckleFilter(Input=skull), Clip(Input=plate), Triangulate(Input=ExtractSurface(Input=model)),
              Gradient(Input=depth), GroupDatasets(Input=plate), AppendGeometry(Input=[plate, model])):
    check(proxy, coordinates.PATIENT)
check_files(plate, coordinates.PATIENT)
check_files(model, coordinates.PATIENT)

# the press, the grid for the mill, and what is made of them
top = ExtractSurface(Input=OutputPort(model, 1))
mould = ExtractSurface(Input=press)
for proxy in (press, mould, top, MillingToolPath(Input=press)):
    check(proxy, coordinates.PRESS)
assert not views.in_patient_coordinates(servermanager.Fetch(press))
assert save_solid(output("Coordinates.stl"), Triangulate(Input=mould))["coordinates"] == coordinates.PRESS
assert save_solid(output("Coordinates.stl"), Triangulate(Input=top))["coordinates"] == coordinates.PRESS

# each output for itself: the first is the patient's, the second the press's
port = OutputPort(model, 1)
check(port, coordinates.PRESS)
check(GroupDatasets(Input=[model, port]), coordinates.UNKNOWN)
bounds = model.GetClientSideObject().GetOutputDataObject(1).GetBounds()
assert fetch(port).GetBounds() == bounds != fetch(model).GetBounds()
record = save_solid(output("Coordinates.vts"), port, DataMode="Binary")
assert record["coordinates"] == coordinates.PRESS and tuple(record["bounds"]) == bounds, record
assert fetch(OpenDataFile(output("Coordinates.vts"))).GetBounds() == bounds
try:
    save_solid(output("Coordinates.3mf"), port)
    raise AssertionError("a grid in 3MF, or another output")
except PipelineError as error:
    assert "vtkStructuredGrid" in str(error), error

# moved by a filter of ParaView, which passes the field data on
turned = Transform(Input=plate)
turned.Transform.Rotate = [0, 0, 1]
for proxy in (turned, Triangulate(Input=turned), GroupDatasets(Input=[plate, turned]),
              AppendGeometry(Input=[plate, Triangulate(Input=mould)]), AppendGeometry(Input=[plate, Sphere()])):
    check(proxy, coordinates.UNKNOWN)
check_files(turned, coordinates.UNKNOWN)
record = save_solid(output("Coordinates.stl"), turned)
assert record["measures"] == {} and save_solid(output("Coordinates.stl"), plate)["measures"]["Volume"] > 0

# mirrored by one: refused like what Mirror makes
back = Transform(Input=plate)
back.Transform.Scale = [1, -1, 1]
grown = Transform(Input=plate)
grown.Transform.Scale = [2, -1, -1]
check(grown, coordinates.UNKNOWN)
for proxy in (Reflect(Input=plate), back, Triangulate(Input=back)):
    check(proxy, coordinates.UNKNOWN + coordinates.MIRRORED)
    try:
        save_solid(output("Coordinates.stl"), proxy)
        raise AssertionError("a mirrored plate")
    except PipelineError as error:
        assert "mirror image" in str(error), error

# mirrored: refused, or named
mirror = Mirror(Input=skull, PlaneMethod="Given", Origin=[0, 0, 0], Normal=[1, 0, 0])
surface = DepthMapSurface(Input=BSplineIsoRayCaster(Input=mirror, IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9]))
for proxy in (mirror, surface):
    check(proxy, coordinates.PATIENT + coordinates.MIRRORED)
    assert not views.in_patient_coordinates(servermanager.Fetch(proxy))
try:
    save_solid(output("Coordinates.stl"), surface)
    raise AssertionError("a mirrored surface")
except PipelineError as error:
    assert "mirror image" in str(error) and "allow_mirrored" in str(error), error
assert not os.path.exists(output("Coordinates.stl"))
record = save_solid(output("Coordinates.stl"), surface, allow_mirrored=True)
assert record["coordinates"] == "patient, DICOM LPS, mirrored"

# also behind filters of ParaView that drop field data, and so the mark; in other views and on second outputs, too
dropped = CellDatatoPointData(Input=mirror)
without = BSplineIsoRayCaster(Input=dropped, IsoValues=[500], ViewDirection=[0.4, 0.2, -0.9])
lost = ImplantPlate(Input=RBFHoleFiller(Input=without, Smoothing=5))
for proxy in (dropped, lost, AppendGeometry(Input=[surface, DepthMapSurface(Input=depth)]), Elevation(Input=surface)):
    proxy.UpdatePipeline()
    assert coordinates.find(proxy) == coordinates.UNKNOWN + coordinates.MIRRORED, proxy.GetXMLLabel()
assert not fetch(lost).GetFieldData().HasArray("Mirrored") and not coordinates.is_mirrored(fetch(lost))
for name in ("Coordinates.stl", "Coordinates.3mf"):
    try:
        save_solid(output(name), lost)
        raise AssertionError("a mirrored plate whose mark is lost")
    except PipelineError as error:
        assert "mirror image" in str(error), error
    assert not os.path.exists(output(name))
    assert save_solid(output(name), lost, allow_mirrored=True)["coordinates"] == "unknown, mirrored"
# a mirror image as the pattern of a fill mirrors nothing
pattern = BSplineIsoRayCaster(Input=mirror, IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9])
check(RBFHoleFiller(Input=depth, Smoothing=5, PriorSurface=pattern), coordinates.PATIENT)

# landmarks warp an image to where their targets are; what comes from elsewhere is unknown
points = PointSource(NumberOfPoints=20, Radius=40)
check(RBFImageWarp(Input=skull, Landmarks=points, Targets=points), coordinates.UNKNOWN)
# tracked slices have columns, rows and slice numbers, also of a patient's volume
for proxy in (Wavelet(), Sphere(), PhantomSweep(Input=skull, NumberOfSlices=3)):
    check(proxy, coordinates.UNKNOWN)
assert save_solid(output("Coordinates.stl"), Sphere())["coordinates"] == coordinates.UNKNOWN

# the mark is in files of ParaView's own formats, and is told as theirs: nobody knows what was done before writing
for name, proxy, expected in (("Coordinates.vti", skull, coordinates.PATIENT), ("Coordinates.vts", press, coordinates.PRESS),
                              ("Coordinates.vtp", plate, coordinates.PATIENT)):
    SaveData(output(name), proxy=proxy, DataMode="Binary")
    check(OpenDataFile(output(name)), expected + coordinates.AS_FILE)
    assert coordinates.find(fetch(OpenDataFile(output(name)))) == expected
SaveData(output("Coordinates.vtp"), proxy=turned, DataMode="Binary")
opened = OpenDataFile(output("Coordinates.vtp"))
for proxy in (Triangulate(Input=opened), AppendGeometry(Input=[plate, opened])):
    check(proxy, "patient, DICOM LPS, as the file says")
assert save_solid(output("Coordinates.stl"), Triangulate(Input=opened))["coordinates"].endswith("as the file says")
SaveData(output("Coordinates.vtp"), proxy=surface, DataMode="Binary")
check(OpenDataFile(output("Coordinates.vtp")), "patient, DICOM LPS, as the file says, mirrored")
check(Transform(Input=OpenDataFile(output("Coordinates.vti"))), "patient, DICOM LPS, as the file says")
check(Reflect(Input=OpenDataFile(output("Coordinates.vtp"))), "unknown, mirrored")
print("ok")
