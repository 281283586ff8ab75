# SPDX-License-Identifier: BSD-3-Clause
"""Assemble Tracked Slices and Slice Planes under MPI: every rank has the whole table and its part of the slices.

Run without arguments it is the test; it runs itself in pvbatch with the folder of pictures and poses.
"""
import os
import sys

import numpy as np
from lacuna_test import output, run_ranks
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPImageDataReader, vtkXMLPPolyDataReader

SLICES = 17


def assemble(folder, ranks):
    LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
    names = [os.path.join(folder, f"{number:02}.png") for number in range(SLICES)]
    for stacked in (0, 1):
        slices = AssembleTrackedSlices(
            Input=PNGSeriesReader(FileNames=names, ReadAsImageStack=stacked),
            Poses=CSVReader(FileName=[os.path.join(folder, "poses.csv")]), PixelSpacing=0.3)
        slices.UpdatePipeline()
        SaveData(os.path.join(folder, f"slices{ranks}-{stacked}.pvti"), proxy=slices, DataMode="Binary")
    SaveData(os.path.join(folder, f"planes{ranks}.pvtp"), proxy=SlicePlanes(Input=slices), DataMode="Binary")


def read(reader, name):
    reader = reader()
    reader.SetFileName(name)
    reader.Update()
    return reader.GetOutput()


def main():
    import own_pictures_files as files
    folder = output("AssembleTrackedSlicesRanks")
    os.makedirs(folder, exist_ok=True)
    random = np.random.default_rng(3)
    pixels = random.integers(0, 256, (SLICES, 20, 30)).astype(np.uint8)
    poses = []
    for number, picture in enumerate(pixels):
        files.write_png(os.path.join(folder, f"{number:02}.png"), picture)
        pose = np.eye(4)
        angle = 0.1 * number
        pose[:3, :3] = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
        pose[:3, 3] = [1, 2, 0.5 * number]
        poses.append(pose)
    files.write_poses(os.path.join(folder, "poses.csv"), "Matrix", poses)
    for ranks in (1, 3):
        assert "ERR|" not in run_ranks(ranks, __file__, folder, str(ranks))
        for stacked in (0, 1):
            data = read(vtkXMLPImageDataReader, os.path.join(folder, f"slices{ranks}-{stacked}.pvti"))
            grey = vtk_to_numpy(data.GetPointData().GetArray("Intensity")).reshape(pixels.shape)
            assert np.array_equal(grey, pixels), (ranks, stacked)
    whole, parts = (read(vtkXMLPPolyDataReader, os.path.join(folder, f"planes{ranks}.pvtp")) for ranks in (1, 3))
    assert whole.GetNumberOfPoints() == parts.GetNumberOfPoints() == pixels.size
    order = [np.lexsort(vtk_to_numpy(data.GetPoints().GetData()).T) for data in (whole, parts)]
    for array in (lambda d: d.GetPoints().GetData(), lambda d: d.GetPointData().GetArray("Intensity")):
        assert np.array_equal(*(vtk_to_numpy(array(d))[o] for d, o in zip((whole, parts), order)))
    print("ok")


if len(sys.argv) > 2:
    assemble(sys.argv[1], int(sys.argv[2]))
else:
    main()
