# SPDX-License-Identifier: BSD-3-Clause
"""Outline Reader in ParaView: which files it is offered for, markups of 3D Slicer, RT structure sets of pydicom, tables, and volumes of ellipsoids."""
import json
import os
import shutil

import lacuna.plugin

lacuna.plugin.load()
import lacuna_test
import numpy as np
from ct_series_files import write_series
from lacuna.errors import PipelineError, raising
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

try:
    import pydicom
    from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
    from pydicom.sequence import Sequence
except ImportError:
    pydicom = None
    print("pydicom is not there: RT structure sets not compared (Debian: python3-pydicom)", flush=True)

FOLDER = lacuna_test.output("OutlineReader")
SEMIAXES, CENTER = np.array([40.0, 28.0, 20.0]), np.array([12.0, -7.0, 31.0])
# no mirror image or half turn maps these onto themselves; mm, LPS
FLAG = [[1.5, 2, 3.25], [11, 2, 3.25], [11, 7, 3.25], [4, 7, 3.25], [4, 30, 3.25]]


def path(name):
    return os.path.join(FOLDER, name)


def ellipsoid():
    """Nine outlines across x, of points 2 mm apart."""
    outlines = []
    for x in np.linspace(-0.9, 0.9, 9):
        angles = np.linspace(0, 2 * np.pi, 80, endpoint=False)
        ring = np.stack([np.full(80, x), *(np.sqrt(1 - x ** 2) * np.stack([np.cos(angles), np.sin(angles)]))], axis=1)
        outlines.append(CENTER + SEMIAXES * ring)
    return outlines


def write_markups(name, outlines, system, units="mm", more=()):
    """As vtkMRMLMarkupsJsonStorageNode of 3D Slicer 5 writes them: no names, undefined points without a position."""
    sign = np.array([1, 1, 1]) if system == "LPS" else np.array([-1, -1, 1])
    markups = [{
        "type": "ClosedCurve", "coordinateSystem": system, "coordinateUnits": units, "locked": False, "fixedNumberOfControlPoints": False,
        "labelFormat": "%N-%d", "lastUsedControlPointNumber": len(outline),
        "controlPoints": [
            {"id": str(n + 1), "label": f"CC-{n + 1}", "description": "", "associatedNodeID": "vtkMRMLScalarVolumeNode1",
             "position": [float(x) for x in sign * point], "orientation": [-1.0, -0.0, -0.0, -0.0, -1.0, -0.0, 0.0, 0.0, 1.0],
             "selected": True, "locked": False, "visibility": True, "positionStatus": "defined"} for n, point in enumerate(outline)]
        + [{"id": "99", "label": "CC-99", "position": "", "selected": True, "positionStatus": "undefined"}],
        "measurements": [{"name": "length", "enabled": False, "units": "mm", "printFormat": "%-#4.4g%s"}],
        "display": {"visibility": True, "opacity": 1.0, "color": [0.4, 1.0, 1.0], "selectedColor": [1.0, 0.5, 0.0],
                    "activeColor": [0.4, 1.0, 0.0]}} for outline in outlines]
    with open(path(name), "w", encoding="utf-8") as file:
        json.dump({"@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
                              "markups-schema-v1.0.3.json#", "markups": markups + list(more)}, file, indent=4)
    return path(name)


def write_structures(name, structures, syntax=None):
    """An RT structure set by pydicom: structures is a list of (name, colour, outlines)."""
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.481.3"
    meta.MediaStorageSOPInstanceUID = pydicom.uid.generate_uid()
    meta.TransferSyntaxUID = syntax or pydicom.uid.ExplicitVRLittleEndian
    data = FileDataset(path(name), {}, file_meta=meta, preamble=bytes(128))
    data.SOPClassUID, data.SOPInstanceUID = meta.MediaStorageSOPClassUID, meta.MediaStorageSOPInstanceUID
    data.is_little_endian, data.is_implicit_VR = True, meta.TransferSyntaxUID == pydicom.uid.ImplicitVRLittleEndian
    data.SpecificCharacterSet, data.Modality, data.PatientName, data.PatientID = "ISO_IR 192", "RTSTRUCT", "Doe^Jane", "J4711"
    data.StudyInstanceUID, data.SeriesInstanceUID, data.StructureSetLabel = "1.2.4", "1.2.5", "Plan"
    data.StructureSetROISequence, data.ROIContourSequence = Sequence(), Sequence()
    for n, (label, color, outlines) in enumerate(structures, 1):
        roi, contours = Dataset(), Dataset()
        roi.ROINumber, roi.ROIName, roi.ReferencedFrameOfReferenceUID = n, label, "1.2.3"
        contours.ReferencedROINumber, contours.ROIDisplayColor, contours.ContourSequence = n, color, Sequence()
        for outline in outlines:
            contour = Dataset()
            contour.ContourGeometricType, contour.NumberOfContourPoints = "CLOSED_PLANAR", len(outline)
            contour.ContourData = [f"{x:.9g}" for point in outline for x in point]
            contours.ContourSequence.append(contour)
        data.StructureSetROISequence.append(roi)
        data.ROIContourSequence.append(contours)
    data.save_as(path(name), write_like_original=False)
    return path(name)


def write_table(name, outlines):
    with open(path(name), "w", encoding="utf-8") as file:
        file.write("structure,outline,slice,column,row,x,y,z\n")
        for number, outline in enumerate(outlines):
            file.writelines(f"Liver,{number},{number + 3},0,0,{','.join(repr(float(x)) for x in point)}\n" for point in outline)
    return path(name)


def fetch(source):
    with raising():
        source.UpdatePipeline()
    return servermanager.Fetch(source)


def points(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def strings(data, name):
    array = data.GetAbstractArray(name)
    return [array.GetValue(n) for n in range(array.GetNumberOfValues())]


def column(data, name):
    return vtk_to_numpy(data.GetCellData().GetArray(name)).tolist()


def readers(file):
    """That File > Open offers, in its order."""
    factory = servermanager.vtkSMProxyManager.GetProxyManager().GetReaderFactory()
    if factory.GetNumberOfRegisteredPrototypes() == 0:
        factory.UpdateAvailableReaders()
    found = factory.GetReaders(file, servermanager.ActiveConnection.Session)
    return [found.GetString(n + 1) for n in range(0, found.GetNumberOfStrings(), 3)]


def refused(source, *texts):
    try:
        fetch(source)
    except PipelineError as error:
        for text in texts:
            assert text in str(error), (text, str(error))
        return
    raise AssertionError(f"{source.FileName} was read")


def check_volume(source):
    surface = RBFSurface(Input=source, OutputSpacing=2)
    volume = fetch(surface).GetFieldData().GetArray("SurfaceVolume").GetValue(0)
    expected = 4 / 3 * np.pi * SEMIAXES.prod() / 1000
    print(f"{os.path.basename(source.FileName)}: {volume:.3f} ml, expected {expected:.3f} ml", flush=True)
    assert abs(volume / expected - 1) < 0.01, (source.FileName, volume, expected)
    bounds = np.reshape(surface.GetDataInformation().GetBounds(), (3, 2))
    assert np.abs(bounds.mean(axis=1) - CENTER).max() < 0.5, bounds
    Delete(surface)


shutil.rmtree(FOLDER, ignore_errors=True)
os.makedirs(FOLDER)

# markups: LPS and RAS lie in the same place
for system in ("LPS", "RAS"):
    file = write_markups(f"Liver {system}.mrk.json", [FLAG], system, more=[{"type": "Line", "controlPoints": []}])
    assert readers(file) == ["LacunaOutlineReader"], readers(file)
    source = OpenDataFile(file)
    data = fetch(source)
    assert np.abs(points(data) - FLAG).max() < 1e-12, (system, points(data))
    assert strings(data.GetCellData(), "StructureName") == [f"Liver {system}"]
    assert column(data, "StructureColor") == [[255, 128, 0]] and column(data, "SliceNumber") == [-1]
    assert strings(data.GetFieldData(), "Coordinates") == ["Patient"]
    Delete(source)
refused(OutlineReader(FileName=write_markups("um.mrk.json", [FLAG], "LPS", ["um", "UCUM", "micrometer"])), "coordinateUnits 'um'", "only mm is read")
with open(path("other.json"), "w", encoding="ascii") as file:
    file.write('{"version": 2}')
assert "LacunaOutlineReader" not in readers(path("other.json"))

# tables: those of outlines are offered, others are ParaView's alone
table = write_table("liver.csv", [FLAG, np.array(FLAG) + [0, 0, 4]])
assert readers(table)[0] == "CSVReader" and "LacunaOutlineReader" in readers(table), readers(table)
data = fetch(OutlineReader(FileName=table))
assert np.abs(points(data) - [*FLAG, *(np.array(FLAG) + [0, 0, 4])]).max() < 1e-12
assert column(data, "SliceNumber") == [3, 4] and column(data, "Outline") == [0, 1] and column(data, "Structure") == [1, 1]
with open(path("other.csv"), "w", encoding="ascii") as file:
    file.write("x,y,z\n1,2,3\n")
assert "LacunaOutlineReader" not in readers(path("other.csv"))

# what is saved as .vtp comes back
SaveData(path("saved.vtp"), proxy=OutlineReader(FileName=table))
again = fetch(XMLPolyDataReader(FileName=[path("saved.vtp")]))
assert strings(again.GetCellData(), "StructureName") == ["Liver", "Liver"] and column(again, "SliceNumber") == [3, 4]
assert again.GetNumberOfLines() == 2 and np.array_equal(points(again), points(data))

# DICOM: images stay with CT Series Reader
os.makedirs(path("ct"))
write_series(path("ct"), [np.full((8, 9), n) for n in range(4)])
image = path("ct/000.dcm")
assert "LacunaCTSeriesReader" in readers(image) and "LacunaOutlineReader" not in readers(image), readers(image)
refused(OutlineReader(FileName=image), "is a DICOM file, but no RT structure set: modality CT", "open it with CT Series Reader")

whole = ellipsoid()
check_volume(OutlineReader(FileName=write_markups("ellipsoid.mrk.json", whole, "RAS")))
check_volume(OutlineReader(FileName=write_table("ellipsoid.csv", whole)))
if pydicom:
    for name, syntax in (("RS.1.dcm", pydicom.uid.ImplicitVRLittleEndian), ("structures.dcm", None)):
        file = write_structures(name, [("Liver", [255, 0, 16], [FLAG]), ("L\u00e9sion", [0, 255, 0], whole)], syntax)
        assert "LacunaOutlineReader" in readers(file) and "LacunaCTSeriesReader" not in readers(file), readers(file)
        data = fetch(OutlineReader(FileName=file))
        assert np.abs(points(data)[:5] - FLAG).max() < 1e-7, points(data)[:5]
        assert np.abs(points(data)[5:] - np.concatenate(whole)).max() < 1e-6
        assert strings(data.GetCellData(), "StructureName") == ["Liver"] + 9 * ["L\u00e9sion"]
        assert column(data, "Structure") == [1] + 9 * [2] and column(data, "StructureColor")[0] == [255, 0, 16]
        assert column(data, "Outline") == list(range(1, 11))
    SaveData(path("saved.vtp"), proxy=OutlineReader(FileName=file), DataMode="Ascii")
    with open(path("saved.vtp"), encoding="utf-8") as saved:
        text = saved.read()
    assert "StructureName" in text and not any(word in text for word in ("Doe", "4711", "PatientName"))
    refused(CTSeriesReader(FileName=file), "is an RT structure set, not CT", "open it with Outline Reader")
    only = OutlineReader(FileName=write_structures("RS.ellipsoid.dcm", [("Liver", [255, 0, 16], whole)]))
    check_volume(only)
    # a planning system's file of one structure beside the images
    shutil.copy(path("RS.ellipsoid.dcm"), path("ct"))
    with raising():
        CTSeriesReader(FileName=path("ct")).UpdatePipeline()
print("ok")
