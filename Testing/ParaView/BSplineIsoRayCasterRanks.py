# SPDX-License-Identifier: BSD-3-Clause
"""Depth maps and their pictures under MPI: the ranks share the map, and make the same one together.

Run without arguments it is the test; it runs itself in pvbatch with the start of the names of the maps to write.
"""
import os
import sys

import numpy as np
from lacuna_test import output, run_ranks
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPImageDataReader

ARRAYS = {"outside": ("Depth", "vtkValidPointMask", "Normals", "Depth_1", "Normals_1", "Thickness"),
          "behind": ("Depth", "vtkValidPointMask", "Normals"),
          "shaded": ("Depth", "Color")}


def cast(start):
    LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
    skull = SkullPhantom(Spacing=[2, 2, 2.3])
    view = dict(Input=skull, ViewDirection=[-0.4, 0.2, -0.9], PixelSpacing=1)
    outside = BSplineIsoRayCaster(IsoValues=[500, 900], ComputeThickness=1, **view)
    behind = BSplineIsoRayCaster(IsoValues=[500], StartDepthMap=outside, SolidSide="Below", **view)
    shaded = DepthMapShader(Input=outside, Volume=skull, Lights=[-1, -1, 2, 0, 1], NormalMethod="Predicate", DepthCue=0.6)
    for name, proxy in (("outside", outside), ("behind", behind), ("shaded", shaded)):
        proxy.UpdatePipeline()
        SaveData(start + name + ".pvti", proxy=proxy, DataMode="Binary")


def read_maps(start, ranks):
    maps = {}
    for name, arrays in ARRAYS.items():
        with open(start + name + ".pvti") as file:
            assert file.read().count("<Piece") == ranks, name
        reader = vtkXMLPImageDataReader()
        reader.SetFileName(start + name + ".pvti")
        reader.Update()
        points = reader.GetOutput().GetPointData()
        maps.update({(name, array): vtk_to_numpy(points.GetArray(array)) for array in arrays})
    return maps


def main():
    maps = []
    for ranks in (1, 2):
        start = output("BSplineIsoRayCasterRanks%d-" % ranks)
        run_ranks(ranks, __file__, start)
        maps.append(read_maps(start, ranks))
    assert maps[0]["outside", "vtkValidPointMask"].mean() > 0.1
    assert maps[0]["behind", "vtkValidPointMask"].mean() > 0.1
    assert maps[0]["shaded", "Color"].std() > 10
    for name, values in maps[0].items():
        np.testing.assert_array_equal(values, maps[1][name], err_msg=str(name))
    print("ok")


if len(sys.argv) == 2:
    cast(sys.argv[1])
else:
    main()
