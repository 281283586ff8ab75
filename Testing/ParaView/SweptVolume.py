# SPDX-License-Identifier: BSD-3-Clause
"""Swept Volume through ParaView: defaults, arrays, state."""
import os

import numpy as np
from paraview.simple import *
from paraview import servermanager

from lacuna_test import check_defaults
from tracked_slice_files import array, open_slices

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna import vtkLacunaSweptVolume


def check_panel():
    """The panel's defaults are the class's own."""
    source = open_slices("SweptVolumeFlat", np.zeros((2, 4, 4), np.uint8), [np.eye(4)] * 2)
    proxy = SweptVolume(Input=source)
    own = vtkLacunaSweptVolume()
    enumerations = {
        "OutputFrame": ["Reference", "Principal"],
        "PixelSampling": ["Footprint", "Bilinear", "Nearest"],
        "Interpolation": ["BetweenSlices", "NearestVoxel"],
        "Compounding": ["Mean", "Maximum"],
        "OutputScalarType": ["Input", "Float"],
        "FanMask": ["Given", "Automatic", "None"],
        "BadPoses": ["Refuse", "LeaveOut", "KeepOutliers"],
    }
    names = ["OutputSpacing", "OutputBounds", "MaximumSliceGap", "ClipRectangle", "FanOrigin",
             "FanAngles", "FanRadii", "FootprintScale", "FootprintAcrossSlices", "UseTooFast",
             "UseGatedOut", "UseImageInvalid", "MemoryLimit"]
    check_defaults(proxy, own, names, enumerations)
    Delete(proxy)


def check_compounding():
    """Two sweeps, averaged; a slice marked invalid is left out; arrays, types, state."""
    def pose(z):
        matrix = np.diag([0.5, 0.5, 1, 1]).astype(float)
        matrix[2, 3] = z
        return matrix
    first = np.full((3, 9, 11), 10, np.uint8)
    first[1] = 200
    second = np.full((2, 9, 11), 40, np.uint8)
    proxy = SweptVolume(Input=[
        open_slices("SweptVolumeFirst", first, [pose(0), pose(1), pose(2)], [0, 2, 0]),
        open_slices("SweptVolumeSecond", second, [pose(0), pose(2)])])
    proxy.OutputSpacing = [0.5, 0.5, 0.5]
    proxy.UpdatePipeline()
    assert proxy.GetDataInformation().GetExtent() == (0, 10, 0, 8, 0, 4)
    assert proxy.GetDataInformation().GetBounds() == (0, 5, 0, 4, 0, 2)
    assert servermanager.Fetch(proxy).GetPointData().GetScalars().GetName() == "Intensity"
    assert array(proxy, "Intensity").dtype == np.uint8
    assert (array(proxy, "Intensity") == 25).all()
    assert (array(proxy, "Contributions") == 2).all()
    assert (array(proxy, "vtkValidPointMask") == 1).all()
    names = [proxy.FieldData[i].GetName() for i in range(proxy.FieldData.GetNumberOfArrays())]
    assert names == ["Provenance"], names
    proxy.Compounding = "Maximum"
    proxy.OutputScalarType = "Float"
    assert array(proxy, "Intensity").dtype == np.float32
    assert (array(proxy, "Intensity") == 40).all()

    state = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "SweptVolume.pvsm")
    SaveState(state)
    ResetSession()
    LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
    LoadState(state)
    loaded = FindSource("SweptVolume1")
    assert loaded.Compounding == "Maximum" and list(loaded.OutputSpacing) == [0.5] * 3
    assert (array(loaded, "Intensity") == 40).all()
    ResetSession()
    LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


check_panel()
check_compounding()
print("ok")
