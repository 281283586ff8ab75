# SPDX-License-Identifier: BSD-3-Clause
"""save_solid: strict records, the same for the same solid, nothing old beside a failure, 3MF of solids only."""
import errno
import json
import math
import os
import resource
import shutil
import signal
import stat

import numpy as np
from lacuna.errors import PipelineError
from lacuna.solids import save_solid
from lacuna_test import output as output_of_tests
from paraview import servermanager
from paraview.simple import *
from solid_files import read_3mf
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


FOLDER = output_of_tests("SaveSolid")
shutil.rmtree(FOLDER, ignore_errors=True)  # of an earlier run
os.makedirs(FOLDER)


def output(name):
    return os.path.join(FOLDER, name)


def read_strictly(path):
    def refuse(word):
        raise ValueError(f"{word} is not JSON")
    with open(path, encoding="utf-8") as file:
        return json.load(file, parse_constant=refuse)


def refused(path, proxy, *words, **options):
    try:
        save_solid(path, proxy, **options)
    except PipelineError as error:
        for word in words:
            assert word in str(error), (word, str(error))
    else:
        raise AssertionError((path, words))
    assert not os.path.exists(path) and not os.path.exists(path + ".json"), path
    folder = os.path.dirname(path)
    assert not [name for name in os.listdir(folder) if name.startswith(".")], os.listdir(folder)


def surface(points, triangles, fields=None):
    data = vtkPolyData()
    data.SetPoints(vtkPoints())
    data.GetPoints().SetDataTypeToDouble()
    for point in points:
        data.GetPoints().InsertNextPoint(point)
    data.SetPolys(vtkCellArray())
    for triangle in triangles:
        data.GetPolys().InsertNextCell(3, triangle)
    for name, values in (fields or {}).items():
        if isinstance(values, str):
            array = vtkStringArray()
            array.InsertNextValue(values)
        else:
            array = numpy_to_vtk(np.asarray(values, dtype=float), deep=True)
        array.SetName(name)
        data.GetFieldData().AddArray(array)
    source = TrivialProducer()
    source.GetClientSideObject().SetOutput(data)
    source.UpdatePipeline()
    return source


corners = [(0, 0, 0), (3, 0, 0), (0, 2, 0), (0, 0, 1)]
faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]  # outwards
solid = surface(corners, faces)

# Numbers that JSON has no word for are null; words in texts stay.
step = 'Step one Name="NaN and Infinity, -Infinity" of NaNcy'
strange = surface(corners, faces, {"Provenance": step, "Radius": [math.inf], "Thin": [math.nan, 1.5, -math.inf], "Volume": [1]})
for name in ("SaveSolid.stl", "SaveSolid.3mf", "SaveSolid.vtp"):
    record = save_solid(output(name), strange)
    assert record == read_strictly(output(name) + ".json")
    assert record["steps"] == [step], record["steps"]
    assert record["measures"] == {"Radius": None, "Thin": [None, 1.5, None], "Volume": 1}, record["measures"]
assert step in read_3mf(output("SaveSolid.3mf"))["metadata"]["Description"]

# Control characters of a foreign file's provenance have no place in XML; the rest stays.
foreign = surface(corners, faces, {"Provenance": "a\x01\x02\tb \x1b[31m \x7f\ufffe\uffff <c> & \U0001f9b4"})
record = save_solid(output("SaveSolid.3mf"), foreign)
assert record["steps"][0].startswith("a\x01\x02\tb"), record["steps"]
assert "Made by: a\tb [31m \x7f <c> & \U0001f9b4" in read_3mf(output("SaveSolid.3mf"))["metadata"]["Description"]

# The same solid has the same record, though the time it took is not the same.
depth = BSplineIsoRayCaster(Input=SkullPhantom(Spacing=[4, 4, 4]), IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9])
filled = RBFHoleFiller(Input=depth, Smoothing=5)
fit = DepthMapSurface(Input=filled)
first = save_solid(output("SaveSolid.vtp"), fit)
assert servermanager.Fetch(fit).GetFieldData().HasArray("FitTime") and "FitTime" not in first["measures"]
assert "PlaneNormal" in first["measures"]
filled.Smoothing = 6
filled.UpdatePipeline()
filled.Smoothing = 5
again = save_solid(output("SaveSolid.vtp"), fit)
for record in (first, again):
    del record["sha256"]  # the file itself holds all field data
assert again == first

# A file that the surface itself is read from: replaced when the new one is whole, and never lost.
again = output("SaveSolidAgain.stl")
save_solid(again, solid)
moved = Transform(Input=STLReader(FileNames=[again]))
moved.Transform.Translate = [5, 0, 0]
save_solid(again, moved)
assert save_solid(again, Transform(Input=STLReader(FileNames=[again])))["bounds"] == [5, 8, 0, 2, 0, 1]
broken = Transform(Input=STLReader(FileNames=[again]))
broken.Transform.Scale = [-1, 1, 1]
refused(again, broken, "mirror image")
kept = STLReader(FileNames=[again + ".old"])
kept.UpdatePipeline()
assert kept.GetDataInformation().GetBounds() == (5, 8, 0, 2, 0, 1)
assert read_strictly(again + ".json.old")["bounds"] == [5, 8, 0, 2, 0, 1]
save_solid(again, solid)
refused(again, broken, "mirror image")
assert os.path.exists(again + ".old2") and kept.GetDataInformation().GetBounds() == (5, 8, 0, 2, 0, 1)
# nor what only ParaView's own writers or nobody can write over
with open(output("SaveSolidAgain.xyz"), "w", encoding="ascii") as file:
    file.write("mine")
refused(output("SaveSolidAgain.xyz"), solid, "xyz")
with open(output("SaveSolidAgain.xyz.old"), encoding="ascii") as file:
    assert file.read() == "mine"
# one without a record before: each solid keeps its own
first = output("SaveSolidFirst.stl")
with open(first, "w", encoding="ascii") as file:
    file.write("mine")
refused(first, broken, "mirror image")
save_solid(first, solid)
refused(first, broken, "mirror image")
assert sorted(name for name in os.listdir(FOLDER) if "First" in name) == [
    "SaveSolidFirst.stl.json.old2", "SaveSolidFirst.stl.old", "SaveSolidFirst.stl.old2"]

# Names that might be taken for temporary ones are the user's.
for name in ("SaveSolidMine.part.stl", "SaveSolidMine.3mf.part", "SaveSolidMine.stl.json.part"):
    with open(output(name), "w", encoding="ascii") as file:
        file.write("mine")
for name in ("SaveSolidMine.stl", "SaveSolidMine.3mf"):
    save_solid(output(name), solid)
    save_solid(output(name), solid)
for name in ("SaveSolidMine.part.stl", "SaveSolidMine.3mf.part", "SaveSolidMine.stl.json.part"):
    with open(output(name), encoding="ascii") as file:
        assert file.read() == "mine"

# Who may do what goes over; a record that is new is as private as its solid.
for name in ("SaveSolidMine.stl", "SaveSolidMine.3mf"):
    private = output(name)
    for mode in (0o600, 0o664):
        os.chmod(private, mode)
        os.remove(private + ".json")
        save_solid(private, solid)
        assert {stat.S_IMODE(os.stat(each).st_mode) for each in (private, private + ".json")} == {mode}

# When a solid cannot take its name its record stays with it, both under other names, and nothing else is left.
replace = os.replace


def refuse_to_replace(source, target):
    raise OSError(errno.EROFS, "Read-only file system")


save_solid(private, solid)
os.replace = refuse_to_replace
try:
    refused(private, moved, "Read-only file system")
finally:
    os.replace = replace
assert read_strictly(private + ".json.old")["bounds"] == [0, 3, 0, 2, 0, 1] and os.path.exists(private + ".old")

# Several files are no solid, and what they would write over stays.
os.makedirs(output("SaveSolidPieces"))
kept = output("SaveSolidPieces/SaveSolidPieces_0.vtp")
with open(kept, "w", encoding="ascii") as file:
    file.write("mine")
refused(output("SaveSolidPieces.pvtp"), solid, "several files")
with open(kept, encoding="ascii") as file:
    assert file.read() == "mine"
for ending in ("vtm", "stl"):
    refused(output("SaveSolidPieces." + ending), GroupDatasets(Input=[solid, Sphere()]), "several blocks")
inner = output("SaveSolidFolder.stl")
os.makedirs(inner, exist_ok=True)
try:
    save_solid(inner, solid)
    raise AssertionError("a folder")
except PipelineError as error:
    assert "is a folder" in str(error) and os.path.isdir(inner), error

# After a failure neither the old solid nor its record is there under its name.
for name in ("SaveSolid.stl", "SaveSolid.3mf"):
    plate = ImplantPlate(Input=filled)
    save_solid(output(name), plate)
    assert os.path.exists(output(name)) and os.path.exists(output(name) + ".json")
    plate.Thickness = -1
    refused(output(name), plate, "Thickness")
    save_solid(output(name), solid)
    refused(output(name), surface([], []), "nothing to write")
folder = output("SaveSolidNoFolder")
for name in ("x.stl", "x.STL", "x.3mf"):
    try:
        save_solid(os.path.join(folder, name), solid)
        raise AssertionError(name)
    except PipelineError:
        assert not os.path.exists(folder)
refused(output("SaveSolid.xyz"), solid, "xyz")
refused(output("SaveSolid"), solid, "xtension")

# Endings in capitals are the same formats.
for ending in ("stl", "ply", "obj", "vtp", "vtk"):
    capital, small = output("SaveSolidCapitals." + ending.upper()), output("SaveSolidCapitals." + ending)
    save_solid(small, solid)
    with open(small, "rb") as file:
        expected = file.read()
    os.remove(small)
    record = save_solid(capital, solid)
    assert record["file"] == os.path.basename(capital) and record == read_strictly(capital + ".json")
    with open(capital, "rb") as file:
        assert file.read() == expected, ending
    assert not os.path.exists(small) and not [n for n in os.listdir(FOLDER) if n.startswith(".")]
save_solid(output("SaveSolidCapitals.3MF"), solid)

# 3MF holds solids.
name = output("SaveSolid.3mf")
save_solid(name, solid)
assert np.array_equal(read_3mf(name)["triangles"], faces)
save_solid(name, Sphere())
refused(name, fit, "open", "triangle on one side only", "mm")
refused(name, surface(corners, faces[1:]), "open", "3 edges")
inside_out = [tuple(reversed(face)) for face in faces]
refused(name, surface(corners, inside_out), "inside out")
refused(name, surface(corners, faces[:3] + inside_out[3:]), "turned over", "3 edges")
refused(name, surface(corners, faces + faces), "branches")
refused(name, surface(corners, faces + [(0, 0, 1)]), "triangle 4 has a corner twice")
refused(name, surface(corners[:3] + [(0, math.nan, 1)], faces), "point 3", "not finite")
split = [corners[k] for face in faces for k in face]  # as Generate Surface Normals leaves edges
refused(name, surface(split, np.arange(12).reshape(4, 3).tolist()), "Clean")
save_solid(name, Clean(Input=surface(split, np.arange(12).reshape(4, 3).tolist())))

# So does STEP; the header says what 3MF says, and a mirrored solid is written when it is wanted.
name = output("SaveSolid.step")
for ending in ("step", "stp", "STEP"):
    record = save_solid(output("SaveSolid." + ending), strange)
    with open(output("SaveSolid." + ending), encoding="ascii") as file:
        text = " ".join(file.read().split())
    for words in ("Coordinates: unknown (mm). Research software, not a medical device.", "Made by: Step one", "4 flat faces",
                  "MANIFOLD_SOLID_BREP", "END-ISO-10303-21;"):
        assert words in text, words
    assert record["steps"] == [step] and record["measures"]["Volume"] == 1
save_solid(name, Sphere(), Tolerance=0.005)
refused(name, fit, "open", "triangle on one side only", "mm")
refused(name, surface(corners, inside_out), "inside out")
refused(name, surface(corners, faces + faces), "branches")
flipped = Transform(Input=solid)
flipped.Transform.Scale = [-1, 1, 1]
refused(name, flipped, "mirror image")

# What no format holds, in any of them.
for ending in ("stl", "ply", "obj", "vtp", "vtk", "3mf", "step"):
    name = output("SaveSolid." + ending)
    save_solid(name, solid)
    refused(name, surface(corners[:3] + [(0, math.inf, 1)], faces), "point 3", "not finite")
    refused(name, Line(), "no polygon")
refused(output("SaveSolid.stl"), Threshold(Input=Wavelet(), LowerThreshold=1e4, UpperThreshold=2e4), "nothing to write")

# A full disk: no file is left that looks whole, at whatever byte it is full.
fine, coarse = Sphere(ThetaResolution=40, PhiResolution=40), Sphere()
for ending in ("stl", "ply", "obj", "vtp", "vtk", "3mf", "step"):
    name = output("SaveSolidFull." + ending)
    fine = coarse if ending == "step" else fine
    save_solid(name, fine)
    size = os.path.getsize(name)
    for room in (0, 100, size // 2, size - 1):
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, resource.RLIM_INFINITY))
        try:
            refused(name, fine)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
print("ok")
