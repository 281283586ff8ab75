# SPDX-License-Identifier: BSD-3-Clause
"""Lacuna as a script uses it: load, open whatever it is, errors that stop it and name what was meant, help, and the stubs of editors."""
import ast
import builtins
import contextlib
import io
import os
import shutil
import sys

from paraview.simple import *  # before lacuna.load(), as many scripts do
import lacuna
import numpy as np
import paraview.simple
from ct_series_files import write_series
from lacuna import errors, guide, opening, session
from lacuna.data import fetch
from lacuna.errors import PipelineError, raise_errors, raising
from lacuna_test import output
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkObject

FOLDER = output("Scripts")
shutil.rmtree(FOLDER, ignore_errors=True)
os.makedirs(FOLDER)


def path(name):
    return os.path.join(FOLDER, name)


def write(name, content):
    with open(path(name), "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())
    return path(name)


def refused(call, kind, *texts):
    """What an error of that kind says; it has all the texts."""
    try:
        call()
    except kind as error:
        missing = [text for text in texts if text not in str(error)]
        assert not missing, (missing, str(error))
        return str(error)
    raise AssertionError(f"no error with {texts}")


# --- load ---
message = refused(lambda: lacuna.SkullImplantt, AttributeError, "did you mean SkullImplant")
if not hasattr(paraview.simple, "SkullImplant"):
    refused(lambda: lacuna.SkullImplant, AttributeError, "call lacuna.load() first")
there = {name: sys.modules.pop(name) for name in ("paraview.simple",)}
sys.modules["paraview.simple"] = None  # a Python with VTK alone
refused(lacuna.load, ImportError, "pvpython", "lacuna.vtkLacunaSkullImplant()")
refused(lambda: lacuna.open("head.mha"), ImportError, "pvpython")
sys.modules.update(there)
own = [Show]
lacuna.load()
assert SkullImplant is paraview.simple.SkullImplant is lacuna.SkullImplant
assert SweptVolume is lacuna.SweptVolume and "SkullImplant" in dir(lacuna)
assert Show is paraview.simple.Show and Show is not own[0], "what the script had imported raises, too"
assert "open" not in lacuna.__all__ and "help" not in lacuna.__all__ and "vtkLacunaSkullImplant" in lacuna.__all__
assert open is builtins.open and "open" not in vars(lacuna.data) and "open" not in vars(lacuna.files)
assert lacuna.solids.save_solid and lacuna.macros.ct_to_iges  # without an import of their own

# --- errors stop a script, each time, until they are mended ---
sweep = PhantomSweep(NumberOfSlices=1)
volume = SweptVolume(Input=sweep)
refused(volume.UpdatePipeline, PipelineError, "slices are too few")
refused(volume.UpdatePipeline, PipelineError, "slices are too few")  # though ParaView does not execute it again
refused(lambda: Show(volume), PipelineError, "slices are too few")
refused(lambda: servermanager.Fetch(volume), PipelineError, "slices are too few")
refused(lambda: SaveData(path("never.vti"), volume), PipelineError, "slices are too few")
both = AppendGeometry(Input=[Contour(Input=volume, Isosurfaces=[50]), Sphere()])  # which passes on what is left
refused(both.UpdatePipeline, PipelineError, "slices are too few")
behind = Contour(Input=volume, Isosurfaces=[50])
refused(behind.UpdatePipeline, PipelineError, "slices are too few")
with contextlib.suppress(PipelineError), raising():
    volume.UpdatePipeline()
    raise AssertionError("within raising() the call itself raises as well")
raise_errors(False)
volume.UpdatePipeline()  # prints only
with contextlib.suppress(PipelineError), raising(proxies=[volume]):
    volume.UpdatePipeline()
    reached = True
assert reached, "an error was raised before the end of the block"
raise_errors()
view = CreateRenderView()
shown = Show(Sphere(), view)
hidden = lacuna.SweptVolume(Input=lacuna.PhantomSweep(NumberOfSlices=12), OutputSpacing=[2, 2, 2])
Show(hidden, view)
hidden.Input[0].NumberOfSlices = 1
refused(lambda: Render(view), PipelineError, "slices are too few")
refused(Render, PipelineError, "slices are too few")  # of the active view, again
Delete(hidden)
sweep.NumberOfSlices = 12
for mended in (volume, behind):
    mended.UpdatePipeline()
SaveData(path("volume.vti"), volume, DataMode="Binary")
assert os.path.getsize(path("volume.vti")) > 1000
assert errors._default["depth"] == 0

# --- names that are nearly right ---
refused(lambda: lacuna.SkullImplant(Input=volume, Thicknes=4), AttributeError, "Skull Implant has no property Thicknes; did you mean Thickness")
implant = lacuna.SkullImplant(Input=volume)
refused(lambda: setattr(implant, "Edge_clearance", 1), AttributeError, "did you mean EdgeClearance?")
refused(lambda: implant.thickness, AttributeError, "did you mean Thickness")
refused(lambda: lacuna.SpeckleFilter(Input=volume, Operation="Mediane"), ValueError, "'Mediane' is not a value of Operation; did you mean 'Median'",
        "'Mode'")
refused(lambda: setattr(lacuna.SpeckleFilter(Input=volume), "Operation", "xyz"), ValueError, "of Operation. It can be 'Median'")
filler = lacuna.RBFHoleFiller(Input=lacuna.BSplineIsoRayCaster(Input=lacuna.SkullPhantom()))
refused(lambda: setattr(filler, "DefectRegion", "Spher"), ValueError, "did you mean 'Sphere'?", "'Cylinder'")
filler.DefectRegion = "Sphere"
refused(lambda: setattr(filler.DefectRegion, "Radious", 3), AttributeError, "did you mean Radius")
refused(lambda: lacuna.BsplineRayCaster, AttributeError, "BSplineIsoRayCaster")
refused(lambda: lacuna.solid, AttributeError, "did you mean solids")
filler.DefectRegion.Radius = 30
assert filler.DefectRegion.Radius == 30 and hasattr(filler, "GetXMLLabel") and not hasattr(filler, "nothing")

# --- open ---
SIZE, MATRIX = (9, 7, 6), np.array([[0, -1.5, 0, 10], [0.5, 0, 0, -20], [0, 0, 2, 30], [0, 0, 0, 1.0]])  # turned, in LPS
values = np.zeros(SIZE[::-1], np.int16)
values[4, 1, 7] = 1000  # k, j, i
TRUTH = (MATRIX @ [7, 1, 4, 1])[:3]
os.makedirs(path("scan"))
write_series(path("scan"), values, MATRIX)
direction = MATRIX[:3, :3] / [0.5, 1.5, 2]


def numbers(of):
    return " ".join(f"{value:g}" for value in np.ravel(of))


HEAD = f"ObjectType = Image\nNDims = 3\nDimSize = {numbers(SIZE)}\nElementType = MET_SHORT\nElementSpacing = 0.5 1.5 2\n"
volumes = [
    (path("scan"), "CT Series Reader"), (path("scan/003.dcm"), "CT Series Reader"),
    (write("turned.mha", (HEAD + f"Offset = 10 -20 30\nTransformMatrix = {numbers(direction.T)}\nElementDataFile = LOCAL\n").encode() +
           values.tobytes()), "Volume Reader"),
    (write("TURNED.NRRD", (f"NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: {numbers(SIZE)}\nendian: little\n"
                           "encoding: raw\nspace origin: (10,-20,30)\nspace directions: (0,0.5,0) (-1.5,0,0) (0,0,2)\n\n").encode() +
           values.tobytes()), "Volume Reader")]
for name, reader in volumes:
    opened = lacuna.open(name)
    assert opened.GetXMLLabel() == reader, (name, opened.GetXMLLabel())
    image = fetch(opened)
    bright = image.GetPoint(int(vtk_to_numpy(image.GetPointData().GetScalars()).argmax()))
    assert np.allclose(bright, TRUTH), (name, bright, TRUTH)
opened = lacuna.open(path("volume.vti"))
assert fetch(opened).GetBounds() == fetch(volume).GetBounds()

# sweeps: by the ending, and a plain file that has poses
truth = fetch(sweep).GetFieldData().GetArray("ImageToReference")
for name in ("sweep.igs.mha", "sweep.seq.nrrd"):
    SaveData(path(name), sweep)
shutil.copy(path("sweep.igs.mha"), path("plain.mha"))
shutil.copy(path("sweep.seq.nrrd"), path("plain.nrrd"))
for name in ("sweep.igs.mha", "sweep.seq.nrrd", "plain.mha", "plain.nrrd"):
    opened = lacuna.open(path(name))
    assert opened.GetXMLLabel() == "Tracked Slice Reader", name
    assert np.allclose(vtk_to_numpy(fetch(opened).GetFieldData().GetArray("ImageToReference")), vtk_to_numpy(truth), atol=1e-6), name

FRAMES = "".join(f"Seq_Frame000{n}_ProbeToTrackerTransform = 1 0 0 0 0 1 0 0 0 0 1 {n} 0 0 0 1\nSeq_Frame000{n}_ProbeToTrackerTransformStatus = OK\n"
                 for n in range(2))
bare = write("bare.mha", f"ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n{FRAMES}ElementDataFile = LOCAL\n01234567")
refused(lambda: lacuna.open(bare), ValueError, "without a calibration", "CalibrationFileName=", "lacuna.TrackedSliceReader")
CALIBRATION = write("probe.xml", '<PlusConfiguration><CoordinateDefinitions><Transform From="Image" To="Probe" Matrix="0.1 0 0 5 0 0.1 0 0 0 0 0.1 0 '
                    '0 0 0 1"/></CoordinateDefinitions></PlusConfiguration>')
refused(lambda: lacuna.open(bare), ValueError, f"Beside it there is {CALIBRATION}")
opened = lacuna.open(bare, CalibrationFileName=CALIBRATION, ReferenceFrame="Tracker")
poses = vtk_to_numpy(fetch(opened).GetFieldData().GetArray("ImageToReference"))
assert np.allclose(poses.reshape(-1, 4, 4)[1], [[0.1, 0, 0, 5], [0, 0.1, 0, 0], [0, 0, 0.1, 1], [0, 0, 0, 1]]), poses
refused(lambda: lacuna.open(bare, CalibrationFilename=CALIBRATION), AttributeError, "did you mean CalibrationFileName?")

# solids: a cone whose tip is at x = 12, which no half turn and no mirror image leaves where it is
cone = Cone(Center=[10, 20, 30], Height=4, Resolution=12)
cone.UpdatePipeline()
bounds = np.array(fetch(cone).GetBounds())
solid = Triangulate(Input=ExtractSurface(Input=cone))
clean = Clean(Input=solid)
for name in ("cone.stl", "cone.ply", "cone.3mf", "CONE.STL"):
    lacuna.solids.save_solid(path(name), clean)
write("cone.obj", "".join(f"v {x} {y} {z}\n" for x, y, z in vtk_to_numpy(fetch(clean).GetPoints().GetData())) +
      "".join("f {} {} {}\n".format(*(fetch(clean).GetCell(n).GetPointId(k) + 1 for k in range(3))) for n in range(fetch(clean).GetNumberOfCells())))
SaveData(path("cone.vtp"), clean, DataMode="Binary")
for name in ("cone.stl", "cone.ply", "cone.3mf", "CONE.STL", "cone.obj", "cone.vtp"):
    data = fetch(lacuna.open(path(name)))
    assert np.allclose(data.GetBounds(), bounds, atol=1e-4), (name, data.GetBounds())
    tip = vtk_to_numpy(data.GetPoints().GetData())[:, 0].argmax()
    assert np.allclose(data.GetPoint(int(tip)), (12, 20, 30), atol=1e-4), name
with open(path("cone.obj"), encoding="ascii") as file:
    text = file.read()
data = fetch(lacuna.open(write("old.obj", "# 3D Slicer output. SPACE=RAS\n" + text)))
assert np.allclose(data.GetBounds(), [*-bounds[1::-1], *-bounds[3:1:-1], *bounds[4:]], atol=1e-4), data.GetBounds()

# outlines
FLAG = [[1.5, 2, 3.25], [11, 2, 3.25], [11, 7, 3.25], [4, 7, 3.25], [4, 30, 3.25]]
table = write("liver.csv", "structure,outline,x,y,z\n" + "".join(f"Liver,0,{x},{y},{z}\n" for x, y, z in FLAG))
markup = write("liver.mrk.json", '{"markups": [{"type": "ClosedCurve", "coordinateSystem": "RAS", "controlPoints": [' + ", ".join(
    f'{{"position": [{-x}, {-y}, {z}], "positionStatus": "defined"}}' for x, y, z in FLAG) + "]}]}")
for name in (table, markup):
    opened = lacuna.open(name)
    assert opened.GetXMLLabel() == "Outline Reader"
    assert np.allclose(np.array(fetch(opened).GetBounds()), (1.5, 11, 2, 30, 3.25, 3.25), atol=0.5), (name, fetch(opened).GetBounds())

structures = write("structures.dcm", bytes(128) + b"DICM" + bytes(60) + b"\x08\0\x60\0CS\x08\0RTSTRUCT")
assert opening.find_reader(structures)[0] == "OutlineReader" and opening.find_reader(path("scan/003.dcm"))[0] == "CTSeriesReader"

# what cannot be opened, and what to do
before = len(GetSources())
os.makedirs(path("nothing/in it"))
os.makedirs(path("others"))
shutil.copy(path("sweep.igs.mha"), path("others"))
JPEG = b"\xff\xd8\xff\xe0\0\x10JFIF\0" + bytes(200)
for call, kind, *texts in (
        (lambda: lacuna.open(path("nothing")), ValueError, "nothing is empty"),
        (lambda: lacuna.open(path("others")), ValueError, "no DICOM file", "sweep.igs.mha"),
        (lambda: lacuna.open(write("scan.dcm", JPEG)), ValueError, "is a JPEG picture, whatever its name says", "Export the series as DICOM"),
        (lambda: lacuna.open(write("scan.zip", b"PK\3\4" + bytes(30))), ValueError, "ZIP archive. Unpack it"),
        (lambda: lacuna.open(write("notes.txt", "hello")), ValueError, "is not known", ".igs.mha", "OpenDataFile"),
        (lambda: lacuna.open(write("none.stl", "")), ValueError, "is empty"),
        (lambda: lacuna.open(CALIBRATION), ValueError, "calibration of PLUS", "CalibrationFileName="),
        (lambda: lacuna.open(write("turned.raw", "0000")), ValueError, ".mhd"),
        (lambda: lacuna.open(path("trned.mha")), FileNotFoundError, "trned.mha; did you mean turned.mha"),
        (lambda: lacuna.open(path("nowhere/turned.mha")), FileNotFoundError, "there is no"),
        (lambda: lacuna.open(write("cut.nii", bytes(100))), PipelineError, "cut.nii"),
        (lambda: lacuna.open(write("words.stl", "solid words\nendsolid words\n")), (ValueError, PipelineError), ""),
        (lambda: lacuna.open(write("bad.mha", HEAD.replace("ElementSpacing = 0.5 1.5 2\n", "TransformMatrix = 1 0 0 0 1 0 0 0 1\n") +
                                   "ElementDataFile = LOCAL\n" + 2 * 9 * 7 * 6 * "0")), PipelineError, "ElementSpacing is missing")):
    print("refused:", refused(call, kind, *texts), flush=True)
assert len(GetSources()) == before, "a reader was left behind"

# --- help ---
with contextlib.redirect_stdout(io.StringIO()) as printed:
    lacuna.help("hole")
text = " ".join(printed.getvalue().split())
for words in ("RBFHoleFiller (RBF Hole Filler, filter) Fill a hole in a depth map", "SupportMargin = ", "mm", "SkullImplant (Skull Implant, filter)"):
    assert words in text, words
assert text.index("RBFHoleFiller") < text.index("SkullImplant"), "those that are called so come first"
assert "EdgeClearance = 0.5 (0 to 5): Gap between" in " ".join(guide.describe("Skull Implant").split())
assert guide.describe(implant) == guide.describe("SkullImplant") == guide.describe("vtkLacunaSkullImplant") == guide.describe(lacuna.SkullImplant)
assert "DefectChoice = Largest (Largest, Nearest to Point)" in guide.describe("skull implant")
assert "'RBFHoleFiller'" in guide.describe("RBFHoleFiler") and "'thickness'" in guide.describe("thicnkess").lower()
assert "Did you mean" not in guide.describe("qqqqqq") and "lacuna.help() lists all" in guide.describe("qqqqqq")
every = guide.describe()
for name in session.constructors():
    assert f"  {name} " in every, f"{name} has no job in lacuna.guide"

# --- the XML beside the package and the stubs are those of the proxies that ParaView has ---
with open(os.path.join(os.path.dirname(lacuna.__file__), "__init__.pyi"), encoding="utf-8") as file:
    stub = {node.name: node for node in ast.parse(file.read()).body if isinstance(node, ast.ClassDef)}
del stub["Proxy"]
iterator = servermanager.ProxyManager().SMProxyManager.GetProxyDefinitionManager().NewIterator()
iterator.InitTraversal()
live = {}
while not iterator.IsDoneWithTraversal():
    if iterator.GetProxyName().startswith("Lacuna") and iterator.GetGroupName() in ("sources", "filters", "writers"):
        prototype = servermanager.ProxyManager().GetPrototypeProxy(iterator.GetGroupName(), iterator.GetProxyName())
        live[paraview.make_name_valid(prototype.GetXMLLabel())] = iterator.GetGroupName(), iterator.GetProxyName()
    iterator.GoToNextItem()
assert set(stub) == set(live) == set(session.constructors()), set(stub) ^ set(live)


def same(written, own):
    """A default of the stub is that of the proxy."""
    if written is ... or own is None:
        return True
    if isinstance(written, tuple):
        return len(written) == len(own) and all(map(same, written, own))
    return written == own if isinstance(written, str) or isinstance(own, str) else abs(written - own) <= 1e-12 * abs(own)


vtkObject.GlobalWarningDisplayOff()  # of filters without an input
compared, controller = 0, servermanager.ParaViewPipelineController()
for name, node in stub.items():
    assert ast.get_docstring(node).startswith(session.proxies()[name].label), name
    proxy = servermanager._createClass(*live[name])(no_update=True)
    controller.PreInitializeProxy(proxy)
    controller.PostInitializeProxy(proxy)
    attributes = {key for kind in type(proxy).__mro__[:1] for key, value in vars(kind).items() if isinstance(value, property)}
    commands = {key for key in attributes if type(proxy.GetProperty(key)) is servermanager.Property}
    listed = {each.target.id for each in node.body if isinstance(each, ast.AnnAssign)}
    assert listed == attributes - commands, (name, listed ^ (attributes - commands))
    arguments = next(each for each in node.body if isinstance(each, ast.FunctionDef)).args
    keywords = {each.arg: default for each, default in zip(arguments.kwonlyargs, arguments.kw_defaults)}
    del keywords["registrationName"]
    settable = {key for key in listed if not proxy.GetProperty(key).GetInformationOnly()}
    assert set(keywords) | {each.arg for each in arguments.args[1:]} == settable, (name, set(keywords) ^ settable)
    for key, default in keywords.items():
        written, own = ast.literal_eval(default), proxy.GetProperty(key)
        given = own.GetData() if not isinstance(own, servermanager.ProxyProperty) else None
        if isinstance(written, tuple):
            given = list(own)
        assert same(written, given), (name, key, written, given)
        compared += written is not ...
assert compared > 250, compared
print(f"{len(stub)} constructors, {compared} defaults are those of the proxies")
