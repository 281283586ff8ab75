# SPDX-License-Identifier: BSD-3-Clause
"""Scan Region of the real spine sweep."""
import os

import numpy as np
from paraview.simple import *
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

from lacuna_test import data

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())

reader = TrackedSliceReader(FileName=data("ultrasound_spine/SpinePhantomFreehand.igs.mha"))
proxy = ScanRegion(Input=reader)
proxy.UpdatePipeline()
table = servermanager.Fetch(proxy)
for i in range(table.GetNumberOfRows()):
    print(*(table.GetColumn(c).GetValue(i) for c in range(3)), sep=" | ")


def field(name):
    return vtk_to_numpy(servermanager.Fetch(proxy).GetFieldData().GetArray(name))[0]


box = np.array([187, 12, 445, 590])  # by eye, columns 187 to 631 and rows 12 to 601
assert np.abs(field("ClipRectangle") - box).max() <= 2, field("ClipRectangle")
assert field("Confidence") > 0.9
assert servermanager.Fetch(proxy).GetFieldData().GetArray("FanOrigin") is None
# the recording was cut to the image: there is no ruler on it
assert servermanager.Fetch(proxy).GetFieldData().GetArray("DepthTick") is None

# One slice is enough.
subset = ExtractSubset(Input=reader)
proxy.Input = subset
for slice_number in range(0, 21, 4):
    subset.VOI = [0, 819, 0, 615, slice_number, slice_number]
    proxy.UpdatePipeline()
    print("slice", slice_number, field("ClipRectangle"), field("Confidence"))
    assert np.abs(field("ClipRectangle") - box).max() <= 2
