# SPDX-License-Identifier: BSD-3-Clause
"""Tracked Slice Reader in ParaView: which files it claims, properties, output, replay, state files."""
import os

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
nrrd = f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {COLUMNS} {ROWS} {FRAMES}\nencoding: raw\n"
keys = "kinds: domain domain list\nultrasound image orientation:=MFA\n" + "".join(f"""\
Seq_Frame{k:04}_ProbeToTrackerTransform:=1 0 0 0 0 1 0 0 0 0 1 {k} 0 0 0 1
Seq_Frame{k:04}_ProbeToTrackerTransformStatus:=OK
Seq_Frame{k:04}_Status:=OK
""" for k in range(FRAMES))
tracked = [write("sweep.igs.mha", common + frames + local, pixels),
           write("sweep.mha", common + frames + local, pixels),
           write("sweep.igs.mhd", common + frames + "ElementDataFile = pixels.raw\n"),
           write("sweep.igs.nrrd", nrrd + keys + "\n", pixels),
           write("sweep.nhdr", nrrd + "data file: pixels.raw\n" + keys)]
ordinary = [write("ct.mha", common + local, pixels),
            write("ct.mhd", common + "ElementDataFile = pixels.raw\n"),
            # a reconstructed volume has frame fields too
            write("volume.mha", common + "Kinds = domain domain domain\n"
                  "Seq_Frame0000_ImageStatus = OK\n" + local, pixels),
            write("ct.nrrd", nrrd + "spacings: 1 1 1\nkinds: domain domain domain\n\n", pixels),
            write("ct.nhdr", nrrd + "data file: pixels.raw\nSeq_Frame0000_Status:=OK\n"
                  "spacings: 1 1 1\nkinds: domain domain domain\n")]

# Which reader opens what: with OpenDataFile, and in the list from which the user interface chooses.
factory = servermanager.vtkSMProxyManager.GetProxyManager().GetReaderFactory()
session = servermanager.ActiveConnection.Session


def candidates(path):
    found = factory.GetReaders(path, session)
    return [found.GetString(i) for i in range(1, found.GetLength(), 3)]


for path in tracked:
    reader = OpenDataFile(path)
    assert reader.SMProxy.GetXMLName() == "LacunaTrackedSliceReader", path
    assert reader.FileName == path and not reader.CalibrationFileName
    # ParaView's reader takes any such image, so the user interface asks; ours comes first
    own = "NrrdReader" if path.endswith(("nrrd", "nhdr")) else "MetaImageReader"
    assert candidates(path) == ["LacunaTrackedSliceReader", own], candidates(path)
    reader.ReferenceFrame = "Tracker"
    reader.UpdatePipeline()
    assert reader.GetDataInformation().GetExtent() == (0, COLUMNS - 1, 0, ROWS - 1, 0, FRAMES - 1)
    Delete(reader)
for path in ordinary:
    own = "NrrdReader" if path.endswith(("nrrd", "nhdr")) else "MetaImageReader"
    reader = OpenDataFile(path)
    assert reader.SMProxy.GetXMLName() == "LacunaVolumeReader", path
    assert candidates(path) == ["LacunaVolumeReader", own], candidates(path)
    reader.UpdatePipeline()
    assert reader.GetDataInformation().GetNumberOfPoints() > 0
    Delete(reader)

# Defaults in the XML are those of the class.
reader = TrackedSliceReader()
plain = lacuna.vtkLacunaTrackedSliceReader()
for name in ("ImageFrame", "ReferenceFrame", "FrameStride", "DropInvalidSlices", "ReplayInTime",
             "MemoryLimit"):
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

# The animation replays the sweep: slices appear in time, through any filter.
reader.DropInvalidSlices = 1
reader.FrameRange = [0, -1]
reader.FrameStride = 1
reader.UpdatePipelineInformation()
assert not len(reader.TimestepValues)
reader.ReplayInTime = 1
reader.UpdatePipelineInformation()
assert len(reader.TimestepValues) == FRAMES and abs(reader.TimestepValues[7] - 100.7) < 1e-9
scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
assert abs(scene.StartTime - 100) < 1e-9 and abs(scene.EndTime - 100.7) < 1e-9
scene.PlayMode = "Snap To TimeSteps"
filtered = Calculator(Input=reader, Function="Intensity*1", ResultArrayName="Same")
scene.GoToFirst()
for shown in range(1, FRAMES + 1):
    filtered.UpdatePipeline(scene.TimeKeeper.Time)
    image = servermanager.Fetch(filtered)
    assert image.GetDimensions() == (COLUMNS, ROWS, FRAMES)
    status = image.GetFieldData().GetArray("SliceStatus")
    expected = [(1 if k == 5 else 0) + (2 if k >= shown else 0) for k in range(FRAMES)]
    assert [status.GetTuple1(k) for k in range(FRAMES)] == expected, (shown, scene.TimeKeeper.Time)
    for k in range(FRAMES):
        value = image.GetScalarComponentAsDouble(2, 3, k, 0)
        assert value == (grey(2, 3, k) if k < shown else 0), (shown, k, value)
    scene.GoToNext()
volume = SweptVolume(Input=reader, OutputSpacing=[0.2, 0.2, 0.2], OutputBounds=[0, 1, 0, 0.8, 0, 7])
filled = []
for time in (100.3, 100.7, 100.4):
    volume.UpdatePipeline(time)
    mask = servermanager.Fetch(volume).GetPointData().GetArray("vtkValidPointMask")
    filled.append(sum(mask.GetTuple1(i) for i in range(mask.GetNumberOfTuples())))
assert 0 < filled[0] < filled[2] < filled[1], filled
Delete(volume)
Delete(filtered)
reader.ReplayInTime = 0
reader.DropInvalidSlices = 0
reader.FrameRange = [1, 7]
reader.FrameStride = 3
reader.UpdatePipeline()

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

