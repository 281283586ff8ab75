# SPDX-License-Identifier: BSD-3-Clause
"""Tracked Slice Reader on a real sweep: it is recognised and lies where PLUS puts it; what is written comes back."""
import os

from lacuna_test import data, output
from paraview import servermanager
from paraview.simple import *

SPINE = data("ultrasound_spine/SpinePhantomFreehand.igs.mha")
CALIBRATION = data("ultrasound_spine/PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml")
LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())

reader = OpenDataFile(SPINE, CalibrationFileName=CALIBRATION)
assert reader.SMProxy.GetXMLName() == "LacunaTrackedSliceReader"
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

# A CT is not claimed.
head = OpenDataFile(data("ct_head/head.mha"))
assert head.SMProxy.GetXMLName() == "LacunaVolumeReader"

# Written and read again, without the calibration file, it is the same.
for extension in ("igs.mha", "igs.nrrd", "mhd", "nhdr"):
    copy = output("SpineCopy." + extension)
    SaveData(copy, reader)
    again = OpenDataFile(copy)
    assert again.SMProxy.GetXMLName() == "LacunaTrackedSliceReader", copy
    other = servermanager.Fetch(again)
    assert other.GetDimensions() == (820, 616, 21)
    assert bytes(memoryview(image.GetPointData().GetScalars())) == bytes(
        memoryview(other.GetPointData().GetScalars()))
    for name in ("ImageToReference", "ProbeToTracker", "ReferenceToTracker", "StylusToTracker",
                 "Timestamp", "SliceStatus"):
        a, b = (data.GetFieldData().GetArray(name) for data in (image, other))
        assert [a.GetTuple(k) for k in range(21)] == [b.GetTuple(k) for k in range(21)], name
    Delete(again)
