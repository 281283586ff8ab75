# SPDX-License-Identifier: BSD-3-Clause
"""Swept Volume of the real spine sweep."""
import os
import re
import xml.etree.ElementTree as ElementTree
import zlib

import numpy as np
from paraview.simple import *
from paraview import servermanager

from lacuna_test import data
from tracked_slice_files import array, open_slices

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def read_spine():
    """The real sweep, by a small parser of its own: pixels and poses."""
    with open(data("ultrasound_spine/SpinePhantomFreehand.igs.mha"), "rb") as file:
        raw = file.read()
    begin = raw.index(b"ElementDataFile = LOCAL\n") + 24
    header = raw[:begin].decode("latin1")
    size = [int(x) for x in re.search(r"DimSize = (.*)", header).group(1).split()]
    pixels = np.frombuffer(zlib.decompress(raw[begin:]), np.uint8).reshape(size[::-1])
    calibration = ElementTree.parse(
        data("ultrasound_spine/PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml"))

    def matrix(text):
        return np.array([float(x) for x in text.split()]).reshape(4, 4)

    def transform(n, what):
        return matrix(re.search("Seq_Frame%04d_%sTransform = (.*)" % (n, what), header).group(1))
    image_to_probe = matrix(
        next(t.get("Matrix") for t in calibration.iter("Transform") if t.get("From") == "Image"))
    poses = [np.linalg.inv(transform(n, "ReferenceToTracker")) @ transform(n, "ProbeToTracker") @
             image_to_probe for n in range(size[2])]
    return pixels, poses


pixels, poses = read_spine()
proxy = SweptVolume(Input=open_slices("SweptVolumeSpine", pixels, poses))
proxy.OutputSpacing = [0.5, 0.5, 0.5]
proxy.UpdatePipeline()
volume = servermanager.Fetch(proxy)
assert volume.GetDimensions() == (147, 106, 105), volume.GetDimensions()
np.testing.assert_allclose(volume.GetOrigin(), (-74.5217, 165.573, 29.072), atol=5e-4)
mask = array(proxy, "vtkValidPointMask")
assert 0.5 < mask.mean() < 0.54, mask.mean()  # the sweep runs askew through its box
grey = array(proxy, "Intensity")[mask == 1]
assert abs(grey.mean() - pixels.mean()) < 3, (grey.mean(), pixels.mean())

# what the probe sees: the rows and columns that are not black in all slices
seen = pixels.max(axis=0) > 0
columns = np.flatnonzero(seen.mean(axis=0) > 0.05)
rows = np.flatnonzero(seen.mean(axis=1) > 0.05)
box = (columns[0], rows[0], columns[-1] - columns[0] + 1, rows[-1] - rows[0] + 1)
proxy.FanMask = "Automatic"
proxy.OutputFrame = "Principal"
proxy.UpdatePipeline()
found = servermanager.Fetch(proxy).GetFieldData()
assert found.GetArray("ClipRectangle").GetTuple4(0) == box, found.GetArray("ClipRectangle")
assert found.GetArray("FanRadii").GetTuple2(0) == (0, 0)  # a linear probe
proxy.UpdatePropertyInformation()
assert proxy.GetProperty("FanDescription").GetData() == "ClipRectangle=%d,%d,%d,%d" % box
assert proxy.GetDataInformation().GetNumberOfPoints() < 0.45 * volume.GetNumberOfPoints()
mask = array(proxy, "vtkValidPointMask")
inside = pixels[:, rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1]
assert abs(array(proxy, "Intensity")[mask == 1].mean() - inside.mean()) < 3  # no black around it
print("ok")
