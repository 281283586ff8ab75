# SPDX-License-Identifier: BSD-3-Clause
"""Swept Volume under MPI: the ranks share the volume, and make the same one together.

Run without arguments it is the test; it runs itself in pvbatch with the names of the slices
and of the volume to write, and with what to set.
"""
import os
import sys

import numpy as np
from lacuna_test import output, run_ranks
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter, vtkXMLPImageDataReader


def reconstruct(slices, volume, frame, mask):
    LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
    proxy = SweptVolume(Input=XMLImageDataReader(FileName=[slices]), OutputSpacing=[0.31] * 3,
                        OutputFrame=frame, FanMask=mask)
    proxy.UpdatePipeline()
    SaveData(volume, proxy=proxy, DataMode="Binary")


def write_slices(name):
    """Noise in a fan on slices that turn and intersect."""
    n, height, width = 30, 60, 80
    random = np.random.default_rng(1)
    stack = vtkImageData()
    stack.SetDimensions(width, height, n)
    y, x = np.mgrid[:height, :width]
    radius, angle = np.hypot(x - 40, y + 20), np.arctan2(x - 40, y + 20)
    fan = (radius > 25) & (radius < 76) & (np.abs(angle) < 0.5)
    pixels = np.where(fan, random.integers(1, 256, (n, height, width)), 0).astype(np.uint8)
    grey = numpy_to_vtk(pixels.ravel(), deep=1)
    grey.SetName("Grey")
    stack.GetPointData().SetScalars(grey)
    poses = []
    for k in range(n):
        angle = 0.2 + 0.3 * np.sin(k)
        poses.append([0.2 * np.cos(angle), 0, 0, 0, 0, 0.2, 0, 0,
                      -0.2 * np.sin(angle), 0, 1, 0.4 * k, 0, 0, 0, 1])
    for name_, values in (("ImageToReference", np.array(poses)),
                          ("Timestamp", 0.1 * np.arange(n)),
                          ("SliceStatus", np.zeros(n, np.uint8)),
                          ("FrameNumber", np.arange(n, dtype=np.int32))):
        array = numpy_to_vtk(values, deep=1)
        array.SetName(name_)
        stack.GetFieldData().AddArray(array)
    writer = vtkXMLImageDataWriter()
    writer.SetDataModeToBinary()  # raw appended data is unreadable with recent libexpat
    writer.SetInputData(stack)
    writer.SetFileName(name)
    writer.Write()


def read_volume(name):
    reader = vtkXMLPImageDataReader()
    reader.SetFileName(name)
    reader.Update()
    image = reader.GetOutput()
    volume = {array: vtk_to_numpy(image.GetPointData().GetArray(array))
              for array in ("Intensity", "Contributions", "vtkValidPointMask")}
    volume["corner"] = np.array(image.GetPoint(image.GetNumberOfPoints() - 1))
    return volume


def main():
    slices = output("SweptVolumeRanks.vti")
    write_slices(slices)
    for frame, mask in (("Reference", "None"), ("Principal", "Automatic")):
        volumes = []
        for ranks in (1, 3):  # three split along two axes
            name = output("SweptVolumeRanks%s%d.pvti" % (frame, ranks))
            run_ranks(ranks, __file__, slices, name, frame, mask)
            with open(name) as file:
                assert file.read().count("<Piece") == ranks
            volumes.append(read_volume(name))
        assert volumes[0]["vtkValidPointMask"].mean() > 0.3
        for other in volumes[1:]:
            for name, values in volumes[0].items():
                assert values.dtype == other[name].dtype, (frame, name)
                assert (values == other[name]).all(), (frame, name)
    print("ok")


if len(sys.argv) > 1:
    reconstruct(*sys.argv[1:])
else:
    main()
