# SPDX-License-Identifier: BSD-3-Clause
"""CT Series Reader in ParaView: which files it claims, properties, geometry against pydicom, state files."""
import glob
import os
import shutil
import subprocess
import sys

import lacuna
import lacuna_test
from lacuna.data import open_volume
from lacuna.errors import PipelineError, raising
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
folder = lacuna_test.output("CT series")
shutil.rmtree(folder, ignore_errors=True)
subprocess.run([sys.argv[1], folder], check=True)


def case(name):
    return os.path.join(folder, name)


# Which reader opens what: the list from which the user interface chooses.
factory = servermanager.vtkSMProxyManager.GetProxyManager().GetReaderFactory()
session = servermanager.ActiveConnection.Session


def candidates(path):
    found = factory.GetReaders(path, session)
    return [found.GetString(i) for i in range(1, found.GetLength(), 3)]


axial = sorted(glob.glob(case("axial/*.dcm")))[0]
assert "LacunaCTSeriesReader" in candidates(axial), candidates(axial)
for name in ("IM0001", "I10", "00000012", "1.2.840.113619.2.55.3", "CT.1.2", "slice.ima", "DICOMDIR"):
    copy = os.path.join(case("names"), name)
    os.makedirs(case("names"), exist_ok=True)
    shutil.copy(axial, copy)
    assert "LacunaCTSeriesReader" in candidates(copy), (name, candidates(copy))
for path in (case("axial"), folder):
    assert candidates(path) == ["LacunaCTSeriesReader"], candidates(path)
with open(os.path.join(case("names"), "text.dcm"), "w") as file:
    file.write("no image")
resonance = sorted(glob.glob(case("MR/*.dcm")))[0]
for path in (resonance, os.path.join(case("names"), "text.dcm"), case("MR")):
    assert "LacunaCTSeriesReader" not in candidates(path), (path, candidates(path))
opened = OpenDataFile(case("axial"))
assert opened.SMProxy.GetXMLName() == "LacunaCTSeriesReader"
Delete(opened)
opened = open_volume(sorted(glob.glob(case("body feet first/*")))[0])  # by default that would be another reader
whole = CTSeriesReader(FileName=case("body feet first"))
whole.UpdatePipeline()
assert opened.SMProxy.GetXMLName() == "LacunaCTSeriesReader"
assert opened.GetDataInformation().GetBounds() == whole.GetDataInformation().GetBounds()
Delete(opened)
Delete(whole)

# Defaults in the XML are those of the class.
reader = CTSeriesReader()
plain = lacuna.vtkLacunaCTSeriesReader()
for name in ("Acquisition", "PositionTolerance", "PaddingValue", "KeepPatientIdentity"):
    assert reader.GetPropertyValue(name) == getattr(plain, "Get" + name)(), name
assert reader.MissingSlices == "Error" and plain.GetMissingSlices() == 0
assert reader.GantryTilt == "Correct" and plain.GetGantryTilt() == 0
assert reader.SeriesUID == "" and not plain.GetSeriesUID()
Delete(reader)

# Every pixel that pydicom reads is the voxel at its place, and there are no other voxels.
try:
    import numpy
    import pydicom
except ImportError:
    pydicom = None
    print("pydicom is not there: geometry not compared", flush=True)


def place(data, group):
    """Position, directions of columns and rows and their steps, by the standard's C.7.6.2.1."""
    def find(sequence, tag):
        for groups in ([group] if group else []) + list(data.get("SharedFunctionalGroupsSequence", [])):
            if sequence in groups:
                return groups[sequence][0][tag].value
        return data[tag].value
    position = numpy.array(find("PlanePositionSequence", "ImagePositionPatient"), float)
    axes = numpy.array(find("PlaneOrientationSequence", "ImageOrientationPatient"), float)
    steps = numpy.array(find("PixelMeasuresSequence", "PixelSpacing"), float)
    slope = float(find("PixelValueTransformationSequence", "RescaleSlope"))
    intercept = float(find("PixelValueTransformationSequence", "RescaleIntercept"))
    return position, axes[:3] * steps[1], axes[3:] * steps[0], slope, intercept


def compare(name):
    reader = CTSeriesReader(FileName=case(name))
    reader.UpdatePipeline()
    image = servermanager.Fetch(reader)
    columns, rows, slices = image.GetDimensions()
    voxels = vtk_to_numpy(image.GetPointData().GetArray("HounsfieldUnits"))
    voxels = voxels.reshape(slices, rows, columns)
    to_world = image.GetIndexToPhysicalMatrix()
    matrix = numpy.array([[to_world.GetElement(r, c) for c in range(4)] for r in range(4)])
    assert numpy.linalg.det(matrix) > 0
    to_index = numpy.linalg.inv(matrix)
    seen = set()
    for path in glob.glob(os.path.join(case(name), "*")):
        data = pydicom.dcmread(path)
        pixels = data.pixel_array.reshape(-1, data.Rows, data.Columns)
        groups = data.get("PerFrameFunctionalGroupsSequence", [None])
        for group, frame in zip(groups, pixels):
            position, across, down, slope, intercept = place(data, group)
            for i, j in ((0, 0), (columns - 1, 0), (0, rows - 1), (columns - 1, rows - 1)):
                point = numpy.append(position + i * across + j * down, 1)
                index = to_index @ point
                assert numpy.abs(index[:2] - (i, j)).max() < 1e-5, (name, index)
                k = round(index[2])
                assert abs(index[2] - k) < 1e-5, (name, index)
            assert numpy.abs(voxels[k] - (frame * slope + intercept)).max() < 1e-9, (name, path)
            seen.add(k)
    assert len(seen) == slices, (name, seen)
    Delete(reader)


if pydicom:
    for name in ("axial", "prone", "feet first", "descending", "coronal", "sagittal", "oblique", "12 bits",
                 "signed 13 bits", "16 bits unsigned", "fractions", "MONOCHROME1", "multi-frame", "implicit",
                 "RLE", "multi-frame RLE", "Schädel gerät 1"):
        compare(name)

# Two series: nothing is guessed, the list names them, a line of the list chooses.
reader = CTSeriesReader(FileName=case("two"))
try:
    with raising():
        reader.UpdatePipeline()
    raise AssertionError("two series are no error")
except PipelineError as error:
    assert "there are 2 CT series; set SeriesUID to one of these" in str(error), error
lines = list(reader.SeriesList)
assert len(lines) == 2 and '1.2.3.77  series 4, "Other", 4 images of 44 x 36' in lines, lines
domain = reader.SMProxy.GetProperty("SeriesUID").FindDomain("vtkSMStringListDomain")
assert [domain.GetString(i) for i in range(domain.GetNumberOfStrings())] == [""] + lines
for choice in ("1.2.3.77", lines[[line.startswith("1.2.3.77") for line in lines].index(True)]):
    reader.SeriesUID = choice
    reader.UpdatePipeline()
    assert reader.GetDataInformation().GetExtent() == (0, 43, 0, 35, 0, 3)
Delete(reader)

# A script that sets several properties at once gets no error of those that came first.
for settings in (dict(FileName=case("missing"), MissingSlices="Interpolate"), dict(FileName=case("two"), SeriesUID="1.2.3.77"),
                 dict(FileName=case("two"), PositionTolerance=0.1, SeriesUID=lines[0])):
    with raising():
        reader = CTSeriesReader(**settings)
        reader.UpdatePipeline()
    assert reader.GetDataInformation().GetNumberOfPoints() > 0
    Delete(reader)

# The error comes with the data, also to who asks through a filter later.
with raising():
    reader = CTSeriesReader(FileName=case("missing"))
    behind = SpeckleFilter(Input=reader)
for proxy in (reader, behind):
    try:
        with raising():
            proxy.UpdatePipeline()
        raise AssertionError("a missing slice is no error")
    except PipelineError as error:
        assert "1 slice is missing at -10 mm" in str(error), error
assert "images of 44 x 36" in list(reader.SeriesList)[0]
with raising():
    reader.MissingSlices = "Interpolate"
    behind.UpdatePipeline()
assert behind.GetDataInformation().GetExtent()[5] == 6
Delete(behind)
Delete(reader)

# A file that leaves a gap is named.
shutil.copytree(case("axial"), case("gap"))
victim = sorted(glob.glob(case("gap/*")))[6]
os.truncate(victim, 300)
reader = CTSeriesReader(FileName=case("gap"))
try:
    with raising():
        reader.UpdatePipeline()
    raise AssertionError("a missing slice is no error")
except PipelineError as error:
    assert "1 slice is missing at" in str(error) and victim + ": is cut off or damaged" in str(error), error
Delete(reader)

# Missing slices and tilt are told.
reader = CTSeriesReader(FileName=case("missing"), MissingSlices="Interpolate")
reader.UpdatePipeline()
assert reader.GetDataInformation().GetExtent()[5] == 6
assert reader.FieldData["InterpolatedSlices"].GetRange() == (3, 3)
assert any("1 slice is missing at -10 mm" in note for note in reader.Notes), list(reader.Notes)
Delete(reader)
reader = CTSeriesReader(FileName=case("tilted"))
reader.UpdatePipeline()
assert abs(reader.FieldData["GantryTilt"].GetRange()[0] - 20) < 1e-6
assert any("sheared by 20 degrees" in note for note in reader.Notes), list(reader.Notes)
Delete(reader)

# Nobody's name, also not in a file that is saved.
reader = CTSeriesReader(FileName=case("oblique"))
saved = os.path.join(folder, "oblique.vti")
SaveData(saved, proxy=reader, DataMode="Ascii")
with open(saved, "rb") as file:
    text = file.read()
for secret in (b"Secret", b"SECRET", b"19010203", b"1.2.826", folder.encode()):
    assert secret not in text, secret

# The saved file brings it back at its place.
back = XMLImageDataReader(FileName=[saved])
back.UpdatePipeline()
first, second = servermanager.Fetch(reader), servermanager.Fetch(back)
for i in range(9):
    assert abs(first.GetDirectionMatrix().GetData()[i] - second.GetDirectionMatrix().GetData()[i]) < 1e-12
assert max(abs(a - b) for a, b in zip(first.GetOrigin(), second.GetOrigin())) < 1e-9
Delete(back)

# A saved state brings it back.
reader.MissingSlices = "Interpolate"
reader.SeriesUID = "1.2.826.0.1.3680043.2.1125.1"
state = os.path.join(folder, "state.pvsm")
SaveState(state)
ResetSession()
LoadState(state)
restored = [source for source in GetSources().values()
            if source.SMProxy.GetXMLName() == "LacunaCTSeriesReader"]
assert len(restored) == 1
assert restored[0].MissingSlices == "Interpolate"
assert restored[0].SeriesUID == "1.2.826.0.1.3680043.2.1125.1"
restored[0].UpdatePipeline()
assert restored[0].GetDataInformation().GetExtent() == (0, 43, 0, 35, 0, 16)
