# SPDX-License-Identifier: BSD-3-Clause
"""Every proxy of the plugin under MPI: ranks make the same as one alone, bit for bit.

Ranks.py NUMBERS as-they-are|modes [program that makes a CT series], with numbers of ranks like 2,3,4

It runs itself in pvbatch, `Ranks.py in pvbatch`: there every rank writes its piece of every output of every pipeline. Pieces are compared
here, put together again, with what one rank makes. modes: so is what each source (but the live one) and filter makes with each other value of its
enumerations and switches, one at a time; where that is an error all numbers of ranks have the same.
"""
import itertools
import os
import re
import shutil
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
import every_proxy
import lacuna_test
import pipelines
from lacuna.errors import PipelineError, raising
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkObject
from vtkmodules.vtkIOXML import vtkXMLGenericDataObjectReader, vtkXMLTableReader

# How ranks divide what each kind makes, in ParaView's words without Lacuna; a new one is listed here after a thought.
# Parts of an image, which overlap in nothing but shared faces
IMAGES = {"AssembleTrackedSlices", "BSplineIsoRayCaster", "BoneEcho", "CTSeriesReader", "DepthMapShader", "GateSlices", "IncompleteShape",
          "Mirror", "OccludedAngle", "PhantomSweep", "ProbeCalibration", "RBFHoleFiller", "RBFImageWarp", "RBFInterpolator",
          "SkullBone", "SkullPhantom", "SkullResection", "SliceRayCaster", "SpeckleFilter", "SweptVolume", "TrackedSliceReader", "VolumeReader"}
# but of these all ranks have the whole
WHOLE = {"OccludedAngle", "ProbeCalibration"}
# Some of the cells of a mesh
MESHES = {"DepthMapSurface", "SlicePlanes"}
# All of it on the first rank; the others make nothing
FIRST = {"ContrastToSpeckle", "DefectModel", "ImplantPlate", "MillingToolPath", "OcclusionSurface", "OutlineReader", "OutlinedStructures",
         "PressOrientation", "RBFSurface", "ScanRegion", "SkullImplant", "SliceOutliner", "TemporalCalibration", "TrackerSelfTest"}
WRITERS = {"GCodeWriter", "IGESWriter", "STEPWriter", "TrackedSliceWriter"}
# Devices belong to one process: it says so
REFUSED = {"PolhemusVideoSource"}

# Provenance has the hash of what a rank was given, which for these is a part
HASHED_PARTS = {"AssembleTrackedSlices", "DepthMapShader", "DepthMapSurface", "GateSlices", "SlicePlanes", "SpeckleFilter"}

# In ParaView's Programmable Filter, on each rank: its piece as a file.
WRITE = """
from vtkmodules.vtkCommonCore import vtkObject
from vtkmodules.vtkIOXML import vtkXMLDataObjectWriter
from vtkmodules.vtkParallelCore import vtkMultiProcessController
rank = vtkMultiProcessController.GetGlobalController().GetLocalProcessId()
data = self.GetInputDataObject(0, 0)
writer = vtkXMLDataObjectWriter.NewWriter(data.GetDataObjectType())
writer.SetDataModeToBinary()
writer.SetCompressorTypeToNone()
for attributes in (data.GetAttributes(0), data.GetAttributes(1), data.GetFieldData()):
    for index in range(attributes.GetNumberOfArrays() if attributes else 0):
        attributes.GetAbstractArray(index).GetInformation().Clear()  # ranges that are NaN cannot be read again
writer.SetInputData(data)
writer.SetFileName({start!r} + str(rank))
writer.Write()
"""


def kind(source):
    return source.GetXMLName().replace("Lacuna", "")


def folder(ranks):
    return lacuna_test.output(f"Ranks/{ranks}")  # by its whole name: ParaView's Programmable Source deletes others


# --- in pvbatch, on the first rank; ParaView runs filters on all of them ---


def write_outputs(source, start):
    for port in range(source.SMProxy.GetNumberOfOutputPorts()):
        script = WRITE.format(start=f"{start}-{port}-")
        writer = ProgrammableFilter(Input=OutputPort(source, port), Script=script, CopyArrays=0)
        writer.UpdatePipeline()
        Delete(writer)


def other_modes(source):
    """(property, value) of enumerations and switches, but those that it has."""
    found, properties = [], source.SMProxy.NewPropertyIterator()
    while not properties.IsAtEnd():
        prop = properties.GetProperty()
        if prop.IsA("vtkSMIntVectorProperty") and prop.GetNumberOfElements() == 1 and not prop.GetInformationOnly():
            words = prop.FindDomain("vtkSMEnumerationDomain")
            values = [words.GetEntryValue(i) for i in range(words.GetNumberOfEntries())] if words else \
                [0, 1] if prop.FindDomain("vtkSMBooleanDomain") else []
            found += [(properties.GetKey(), value) for value in values if value != prop.GetElement(0)]
        properties.Next()
    return found


def write_modes(source, start):
    for name, value in other_modes(source):
        prop = source.SMProxy.GetProperty(name)
        usual = prop.GetElement(0)
        for element in (value, usual):
            prop.SetElement(0, element)
            source.SMProxy.UpdateVTKObjects()
            if element == value:
                try:
                    with raising():
                        write_outputs(source, f"{start} {name} {value}")
                except PipelineError as error:
                    with open(f"{start} {name} {value}-written.error", "w", encoding="utf-8") as file:
                        file.write(str(error))


def write(pipeline, ranks, with_modes):
    for name in every_proxy.written():
        os.remove(every_proxy.path(name))
    with raising():
        pipeline()
        ours = [(name, source) for (name, _), source in GetSources().items() if source.GetXMLName().startswith("Lacuna")]
        # those first that shall find nothing done yet
        for name, source in sorted(ours, key=lambda one: kind(one[1]) not in FIRST):
            write_outputs(source, os.path.join(folder(ranks), f"{pipeline.__name__}-{kind(source)}-{name}"))
    for name in every_proxy.written():
        shutil.copy(every_proxy.path(name), os.path.join(folder(ranks), f"{pipeline.__name__}-{name}"))
    if with_modes:
        for name, source in ours:
            write_modes(source, os.path.join(folder(ranks), f"{pipeline.__name__}-{kind(source)}-{name}"))
    ResetSession()


def run(ranks, with_modes):
    every_proxy.use_files("Ranks")
    for pipeline in every_proxy.PIPELINES:
        refused = ranks > 1 and pipeline is every_proxy.live
        try:
            write(pipeline, ranks, with_modes and pipeline is not every_proxy.live)
        except PipelineError as error:
            assert refused and "one process only" in str(error)
            ResetSession()
            refused = False
        assert not refused, "more than one process drives the devices"


# --- in pvpython ---


def read(file):
    with open(file, "rb") as content:
        table = b'<VTKFile type="Table"' in content.read(200)
    reader = vtkXMLTableReader() if table else vtkXMLGenericDataObjectReader()
    reader.SetFileName(file)
    vtkObject.GlobalWarningDisplayOff()  # of meshes without points
    reader.Update()
    vtkObject.GlobalWarningDisplayOn()
    return reader.GetOutput()


def outputs(ranks):
    """(pipeline, kind, name, port) -> the ranks' pieces."""
    found = {}
    for name in sorted(os.listdir(folder(ranks))):
        if re.fullmatch(r".*-\d+-\d+", name):
            found.setdefault(tuple(name.split("-")[:4]), []).append(read(os.path.join(folder(ranks), name)))
    assert all(len(pieces) == ranks for key, pieces in found.items() if key[1] not in REFUSED)
    return found


def share_faces_only(pieces):
    """Whether no two parts of an image have more than a layer of voxels in common."""
    extents = [np.array(piece.GetExtent()).reshape(3, 2) for piece in pieces if piece.GetNumberOfPoints() > 0]
    wide = [axis for axis in range(3) if len({index for extent in extents for index in extent[axis]}) > 1]
    return all(any(min(a[axis, 1], b[axis, 1]) <= max(a[axis, 0], b[axis, 0]) for axis in wide)
               for a, b in itertools.combinations(extents, 2))


def join_image(pieces):
    """extent, geometry and arrays (z, y, x, component) of images that are parts of one."""
    pieces = [piece for piece in pieces if piece.GetNumberOfPoints() > 0]
    if not pieces:
        return {}
    low, high = (np.array([choose(piece.GetExtent()[2 * a + side] for piece in pieces) for a in (2, 1, 0)])
                 for side, choose in ((0, min), (1, max)))
    found = {"extent": np.array([low, high])}
    for piece in pieces:
        extent = np.array(piece.GetExtent()).reshape(3, 2)[::-1]
        where = tuple(slice(first - start, last - start + 1) for (first, last), start in zip(extent, low))
        geometry = np.array([*piece.GetOrigin(), *piece.GetSpacing(), *piece.GetDirectionMatrix().GetData()])
        assert np.array_equal(found.setdefault("geometry", geometry), geometry)
        for index in range(piece.GetPointData().GetNumberOfArrays()):
            array = piece.GetPointData().GetArray(index)
            values = vtk_to_numpy(array).reshape(*(extent[:, 1] - extent[:, 0] + 1), -1)
            filled, whole = found.setdefault(array.GetName(), (np.zeros(high - low + 1, bool),
                                                               np.zeros((*(high - low + 1), values.shape[-1]), values.dtype)))
            again = filled[where]
            assert np.array_equal(whole[where][again], values[again], equal_nan=values.dtype.kind == "f"), (array.GetName(), "at a shared face")
            whole[where], filled[where] = values, True
    for name, value in found.items():
        if isinstance(value, tuple):
            assert value[0].all(), (name, "has holes")
            found[name] = value[1]
    return found


def tuples(attributes, count):
    """What all arrays have at each point or cell, as bytes."""
    arrays = [attributes.GetAbstractArray(i) for i in range(attributes.GetNumberOfArrays())]
    numbers = [vtk_to_numpy(array) if array.IsA("vtkDataArray") else np.array([array.GetValue(i) for i in range(count)]) for array in arrays]
    return [b"".join(array[i].tobytes() for array in numbers) for i in range(count)]


def join_mesh(pieces):
    """The cells of surfaces as bytes, the corners with what is on them, in an order of their own."""
    cells = []
    for piece in pieces:
        if piece.GetNumberOfCells() == 0:
            continue
        places = vtk_to_numpy(piece.GetPoints().GetData())
        points = [place.tobytes() + values for place, values in zip(places, tuples(piece.GetPointData(), len(places)))]
        for c, values in enumerate(tuples(piece.GetCellData(), piece.GetNumberOfCells())):
            cell = piece.GetCell(c).GetPointIds()
            cells.append(b"".join(points[cell.GetId(i)] for i in range(cell.GetNumberOfIds())) + values)
    return sorted(cells)


def check_field_data(key, pieces):
    """Those that have something say the same of it."""
    field, *others = [{name: values for name, values in pipelines.values(piece).items() if name[0] == "FieldData"}
                      for piece in pieces if piece.GetNumberOfPoints() > 0] or [{}]  # nothing is asked for, such as no guide
    for other in others:
        assert set(field) == set(other), (key, set(field) ^ set(other))
        for name, values in field.items():
            if name[1] != "Provenance" or key[1] not in HASHED_PARTS:
                assert np.array_equal(values, other[name], equal_nan=values.dtype.kind == "f"), (key, name)


def check(key, alone, data):
    what = key[1]
    one, = alone
    if what in FIRST or one.IsA("vtkTable"):
        texts = pipelines.differences(one, data[0])
        assert not texts, (key, texts)
        for piece in data[1:]:
            assert sum(piece.GetNumberOfElements(kind) for kind in (0, 1, 6)) == 0, (key, "not on the first rank only")
    elif one.IsA("vtkPolyData"):
        assert join_mesh(data) == join_mesh([one]), key
        check_field_data(key, [one, *data])
    else:
        assert what in WHOLE or share_faces_only(data), (key, [piece.GetExtent() for piece in data])
        whole, parts = join_image([one]), join_image(data)
        assert set(whole) == set(parts), (key, set(whole) ^ set(parts))
        for name, values in whole.items():
            assert values.dtype == parts[name].dtype and np.array_equal(values, parts[name], equal_nan=values.dtype.kind == "f"), (key, name)
        check_field_data(key, [one, *data])


def files(ranks):
    found = {}
    for name in sorted(os.listdir(folder(ranks))):
        if "-written." in name:
            with open(os.path.join(folder(ranks), name), "rb") as file:
                found[name] = every_proxy.without_time(file.read())
    return found


def main():
    numbers = [int(number) for number in sys.argv[1].split(",")]
    with_modes = {"as-they-are": False, "modes": True}[sys.argv[2]]
    shutil.rmtree(lacuna_test.output("Ranks"), ignore_errors=True)
    every_proxy.make_files("Ranks", *sys.argv[3:])
    for ranks in [1, *numbers]:
        os.makedirs(folder(ranks))
        printed = lacuna_test.run_ranks(ranks, __file__, "in pvbatch", str(ranks), sys.argv[2], timeout=1500 if with_modes else 600)
        errors = [line for line in printed.splitlines() if "ERR|" in line and not any(f"vtkLacuna{name} " in line for name in REFUSED)]
        assert with_modes or not errors, errors
    alone = outputs(1)
    seen = {what for _, what, _, _ in alone} | {
        writer.replace("Lacuna", "") for ending, writer in every_proxy.WRITERS.items() if any(name.endswith("." + ending) for name in files(1))}
    missing = {name.replace("Lacuna", "") for name in every_proxy.every_kind()} - seen
    assert missing <= ({"CTSeriesReader"} if len(sys.argv) < 4 else set()), f"no pipeline has {sorted(missing)}"
    listed = IMAGES | MESHES | FIRST | WRITERS | REFUSED
    assert seen <= listed, f"not listed here: {sorted(seen - listed)}"
    empty = {what for _, what, _, _ in alone} - {
        key[1] for key, pieces in alone.items() for data in pieces if any(data.GetNumberOfElements(kind) for kind in (0, 1, 6))}
    assert empty <= REFUSED, f"nothing to compare of {sorted(empty)}"
    faults = []
    for ranks in numbers:
        together = outputs(ranks)
        expected = {key for key in alone if key[1] not in REFUSED}
        assert expected <= set(together), expected - set(together)
        one, several = files(1), files(ranks)
        assert several == one, (ranks, {name: (one.get(name), several.get(name)) for name in set(one) | set(several)
                                        if one.get(name) != several.get(name) and name.endswith(".error")})
        for key in sorted(expected):
            try:
                check(key, alone[key], together[key])
            except AssertionError as fault:
                faults.append(f"{ranks} ranks: {fault}")
    assert not faults, "\n".join(faults)
    refused = sum(name.endswith(".error") for name in files(1))
    print(f"{len(alone)} outputs{f' and {refused} errors' if with_modes else ''} of {len(seen)} kinds are the same on 1 and {sys.argv[1]} ranks")


if sys.argv[1:2] == ["in pvbatch"]:
    run(int(sys.argv[2]), sys.argv[3] == "modes")
else:
    main()
