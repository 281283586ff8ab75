# SPDX-License-Identifier: BSD-3-Clause
"""Slice Ray Caster under MPI: the ranks share the map, and make the same one together.

Run without arguments it is the test; it runs itself in pvbatch with the name of the map to write.
"""
import os
import sys

import numpy as np
from lacuna_test import output, run_ranks
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPImageDataReader


def cast(name):
    LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
    sweep = PhantomSweep(Motion="Arbitrary", NumberOfSlices=30, ImageSize=[80, 60], PixelSpacing=0.8, SpeckleLevel=0.3)
    proxy = SliceRayCaster(Input=sweep, IsoValue=120, ViewDirection=[0.3, 0.2, 1], MaximumGap=3)
    proxy.UpdatePipeline()
    SaveData(name, proxy=proxy, DataMode="Binary")


def read_map(name):
    reader = vtkXMLPImageDataReader()
    reader.SetFileName(name)
    reader.Update()
    points = reader.GetOutput().GetPointData()
    return {array: vtk_to_numpy(points.GetArray(array)) for array in ("Depth", "vtkValidPointMask", "Normals")}


def main():
    maps = []
    for ranks in (1, 3):  # three split along two axes
        name = output("SliceRayCasterRanks%d.pvti" % ranks)
        run_ranks(ranks, __file__, name)
        with open(name) as file:
            assert file.read().count("<Piece") == ranks
        maps.append(read_map(name))
    assert maps[0]["vtkValidPointMask"].mean() > 0.1
    for name, values in maps[0].items():
        np.testing.assert_array_equal(values, maps[1][name], err_msg=name)
    print("ok")


if len(sys.argv) == 2:
    cast(sys.argv[1])
else:
    main()
