# SPDX-License-Identifier: BSD-3-Clause
"""Tracked Slice Reader in ParaView: which files it claims, properties, output, state files."""
import os
import sys

import lacuna
from paraview import servermanager
from paraview.simple import *

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
folder = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "TrackedSliceReader")
os.makedirs(folder, exist_ok=True)
COLUMNS, ROWS, FRAMES = 6, 5, 8


def grey(column, row, frame):
    return (7 * column + 31 * row + 17 * frame) % 251


def write(name, text, pixels=b""):
    path = os.path.join(folder, name)
    with open(path, "wb") as file:
        file.write(text.encode() + pixels)
    return path


pixels = bytes(grey(i, j, k) for k in range(FRAMES) for j in range(ROWS) for i in range(COLUMNS))
common = f"""ObjectType = Image
NDims = 3
BinaryData = True
BinaryDataByteOrderMSB = False
CompressedData = False
DimSize = {COLUMNS} {ROWS} {FRAMES}
ElementSpacing = 1 1 1
ElementType = MET_UCHAR
"""
frames = "Kinds = domain domain list\nUltrasoundImageOrientation = MFA\n" + "".join(f"""\
Seq_Frame{k:04}_ProbeToTrackerTransform = 1 0 0 0 0 1 0 0 0 0 1 {k} 0 0 0 1
Seq_Frame{k:04}_ProbeToTrackerTransformStatus = {"INVALID" if k == 5 else "OK"}
Seq_Frame{k:04}_Timestamp = {100 + 0.1 * k}
Seq_Frame{k:04}_ImageStatus = OK
""" for k in range(FRAMES))
local = "ElementDataFile = LOCAL\n"
calibration = write("calibration.xml", """<PlusConfiguration><CoordinateDefinitions>
<Transform From="Image" To="Probe" Matrix="0.2 0 0 0  0 0.2 0 0  0 0 0.2 0  0 0 0 1"/>
</CoordinateDefinitions></PlusConfiguration>
""")
write("pixels.raw", "", pixels)
tracked = [write("sweep.igs.mha", common + frames + local, pixels),
           write("sweep.mha", common + frames + local, pixels),
           write("sweep.igs.mhd", common + frames + "ElementDataFile = pixels.raw\n")]
ordinary = [write("ct.mha", common + local, pixels),
            write("ct.mhd", common + "ElementDataFile = pixels.raw\n"),
            # a reconstructed volume has frame fields too
            write("volume.mha", common + "Kinds = domain domain domain\n"
                  "Seq_Frame0000_ImageStatus = OK\n" + local, pixels)]

# Which reader opens what: with OpenDataFile, and in the list from which the user interface chooses.
factory = servermanager.vtkSMProxyManager.GetProxyManager().GetReaderFactory()
session = servermanager.ActiveConnection.Session


def candidates(path):
    found = factory.GetReaders(path, session)
    return [found.GetString(i) for i in range(1, found.GetLength(), 3)]


data = os.path.join(os.environ["LACUNA_TEST_DATA"], "")
spine = data + "ultrasound_spine/SpinePhantomFreehand.igs.mha"
head = data + "ct_head/head.mha"
real = os.path.exists(spine) and os.path.exists(head)
for path in tracked + ([spine] if real else []):
    reader = OpenDataFile(path)
    assert reader.SMProxy.GetXMLName() == "LacunaTrackedSliceReader", path
    assert reader.FileName == path and not reader.CalibrationFileName
    # ParaView's reader takes any MetaImage, so the user interface asks; ours comes first
    assert candidates(path) == ["LacunaTrackedSliceReader", "MetaImageReader"], candidates(path)
    Delete(reader)
for path in ordinary + ([head] if real else []):
    reader = OpenDataFile(path)
    assert reader.SMProxy.GetXMLName() == "MetaImageReader", path
    assert candidates(path) == ["MetaImageReader"], candidates(path)
    reader.UpdatePipeline()
    assert reader.GetDataInformation().GetNumberOfPoints() > 0
    Delete(reader)

# Defaults in the XML are those of the class.
reader = TrackedSliceReader()
plain = lacuna.vtkLacunaTrackedSliceReader()
for name in ("ImageFrame", "ReferenceFrame", "FrameStride", "DropInvalidSlices", "MemoryLimit"):
    assert reader.GetPropertyValue(name) == getattr(plain, "Get" + name)(), name
assert tuple(reader.FrameRange) == plain.GetFrameRange()
assert not reader.FileName and not plain.GetFileName()
assert not reader.CalibrationFileName and not plain.GetCalibrationFileName()
Delete(reader)

# Properties reach the class, and the output is tracked slices.
reader = OpenDataFile(tracked[0], CalibrationFileName=calibration, ReferenceFrame="Tracker")
reader.UpdatePipeline()
assert reader.GetDataInformation().GetExtent() == (0, COLUMNS - 1, 0, ROWS - 1, 0, FRAMES - 1)
assert reader.PointData.keys() == ["Intensity"]
assert reader.FieldData["ImageToReference"].GetNumberOfComponents() == 16
image = servermanager.Fetch(reader)
fields = image.GetFieldData()
pose = fields.GetArray("ImageToReference")
assert pose.GetNumberOfTuples() == FRAMES
assert [pose.GetComponent(3, c) for c in (0, 5, 10, 11)] == [0.2, 0.2, 0.2, 3]
status = fields.GetArray("SliceStatus")
assert [status.GetTuple1(k) for k in range(FRAMES)] == [0, 0, 0, 0, 0, 1, 0, 0]
assert abs(fields.GetArray("Timestamp").GetTuple1(4) - 100.4) < 1e-12
for name in ("FrameNumber", "ProbeToTracker", "ImageToProbe", "Provenance",
             "ProbeToTrackerTransformStatus"):
    assert fields.GetAbstractArray(name), name

reader.DropInvalidSlices = 0
reader.FrameRange = [1, 7]
reader.FrameStride = 3
reader.UpdatePipeline()
image = servermanager.Fetch(reader)
assert image.GetDimensions() == (COLUMNS, ROWS, 3)
assert image.GetOrigin()[2] == 1 and image.GetSpacing()[2] == 3
for index, frame in enumerate((1, 4, 7)):
    for j in range(ROWS):
        for i in range(COLUMNS):
            assert image.GetScalarComponentAsDouble(i, j, index, 0) == grey(i, j, frame)
assert image.GetFieldData().GetArray("SliceStatus").GetTuple1(5) == 0

# A saved state brings it back, also from another folder.
state = os.path.join(folder, "state.pvsm")
SaveState(state)
ResetSession()
LoadState(state, data_directory=folder)
restored = [source for source in GetSources().values()
            if source.SMProxy.GetXMLName() == "LacunaTrackedSliceReader"]
assert len(restored) == 1
restored = restored[0]
assert restored.FileName == tracked[0] and restored.CalibrationFileName == calibration
assert restored.ReferenceFrame == "Tracker" and list(restored.FrameRange) == [1, 7]
restored.UpdatePipeline()
assert restored.GetDataInformation().GetExtent()[5] == 2
Delete(restored)

# The real sweep lies where PLUS puts it.
if not real:
    print("no real data in", data, "- the rest of the test is skipped")
    sys.exit(77)
reader = OpenDataFile(spine, CalibrationFileName=data +
                      "ultrasound_spine/PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml")
image = servermanager.Fetch(reader)
assert image.GetDimensions() == (820, 616, 21)
poses = image.GetFieldData().GetArray("ImageToReference")
corners = []
for k in range(21):
    m = poses.GetTuple(k)
    corners += [[m[4 * r] * x + m[4 * r + 1] * y + m[4 * r + 3] for r in range(3)]
                for x in (0, 819) for y in (0, 615)]
for axis, (low, size) in enumerate(((-74.5217, 147), (165.573, 106), (29.072, 105))):
    values = [corner[axis] for corner in corners]
    assert abs(min(values) - low) < 1e-3
    assert round((max(values) - min(values)) / 0.5) + 1 == size
