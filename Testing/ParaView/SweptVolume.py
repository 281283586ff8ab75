# SPDX-License-Identifier: BSD-3-Clause
"""Swept Volume through ParaView: defaults, arrays, state."""
import os
import xml.etree.ElementTree as ET

import numpy as np
from paraview.simple import *
from paraview import servermanager

from lacuna_test import check_defaults, output
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
        "GapMethod": ["Automatic", "Given", "Unlimited"],
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
    assert sorted(names) == ["Provenance", "SweepGap", "Sweeps"], names
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


def check_sweeps():
    """Two strips in one input, 20 mm of air between them; states from before GapMethod, also of Slice Ray Caster."""
    poses = np.tile(np.diag([0.5, 0.5, 1, 1]), (12, 1, 1))
    poses[:, 2, 3] = [0, 1, 2, 3, 4, 5, 25, 26, 27, 28, 29, 30]
    pixels = np.full((12, 9, 11), 40, np.uint8)
    pixels[6:] = 80
    strips = open_slices("SweptVolumeStrips", pixels, poses)
    proxy = SweptVolume(Input=strips, OutputSpacing=[0.5] * 3)
    caster = SliceRayCaster(Input=strips, IsoValue=60, ViewDirection=[0, 0, 1], ViewUp=[0, -1, 0])
    filled = np.arange(61) / 2
    filled = (filled <= 5) | (filled >= 25)

    def layers(volume):
        return array(volume, "vtkValidPointMask")[:, 4, 5]

    def depth(caster):
        return array(caster, "Depth")[0, 4, 5]

    assert proxy.GapMethod == "Automatic" and (layers(proxy) == filled).all()
    assert caster.GapMethod == "Automatic" and depth(caster) == 25  # the second strip begins there
    proxy.UpdatePropertyInformation()
    description = proxy.GetProperty("SweepDescription").GetData()
    assert "not joined: 20 mm and 0.1 s from slice 5 to 6" in description, description
    state = output("SweptVolumeSweeps.pvsm")
    SaveState(state)
    tree = ET.parse(state)
    for element in list(tree.iter("Proxy")):
        for child in list(element):
            if child.get("name") == "GapMethod":
                element.remove(child)
    tree.write(output("SweptVolumeSweepsBefore.pvsm"))
    for file, method, truth, surface in ((state, "Automatic", filled, 25), (output("SweptVolumeSweepsBefore.pvsm"), "Given", True, 15)):
        ResetSession()
        LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
        LoadState(file)
        loaded = FindSource("SweptVolume1")
        assert loaded.GapMethod == method and loaded.MaximumSliceGap == 0, (file, loaded.GapMethod)
        assert (layers(loaded) == truth).all(), file
        caster = FindSource("SliceRayCaster1")
        assert caster.GapMethod == method and caster.MaximumGap == 0 and depth(caster) == surface, (file, caster.GapMethod, depth(caster))
    loaded.GapMethod = caster.GapMethod = "Unlimited"
    assert layers(loaded).all() and depth(caster) == 15
    # scripts from before: a limit still limits, and 0 no longer joins what a lift parts
    strips = loaded.Input[0]
    assert not layers(SweptVolume(Input=strips, OutputSpacing=[0.5] * 3, MaximumSliceGap=0.9))[[1, 30]].any()
    explicit = SweptVolume(Input=strips, OutputSpacing=[0.5] * 3, MaximumSliceGap=0)
    assert explicit.GapMethod == "Automatic" and (layers(explicit) == filled).all()


check_panel()
check_compounding()
check_sweeps()
print("ok")
