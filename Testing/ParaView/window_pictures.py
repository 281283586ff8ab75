# SPDX-License-Identifier: BSD-3-Clause
"""Compares pictures of the window with small baselines, tolerant of fonts, anti-aliasing and drivers."""
import os

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter

WIDTH = 160  # pixels of a baseline


def read(path):
    """(rows, columns, 3), 0 to 255, the first row uppermost."""
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutput()
    columns, rows, _ = data.GetDimensions()
    return vtk_to_numpy(data.GetPointData().GetScalars()).reshape(rows, columns, -1)[::-1, :, :3].astype(float)


def write(path, pixels):
    data = vtkImageData()
    data.SetDimensions(pixels.shape[1], pixels.shape[0], 1)
    values = np.ascontiguousarray(np.rint(pixels)[::-1].astype(np.uint8)).reshape(-1, 3)
    data.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
    writer = vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputData(data)
    writer.SetCompressionLevel(9)
    writer.Write()


def reduce(pixels):
    """The means of squares, so many that about WIDTH columns are left."""
    size = max(1, round(pixels.shape[1] / WIDTH))
    rows, columns = pixels.shape[0] // size, pixels.shape[1] // size
    return pixels[:rows * size, :columns * size].reshape(rows, size, columns, size, 3).mean(axis=(1, 3))


def compare(path, baseline, difference, likeness, renew):
    """difference: of grey levels, on average at most; likeness: correlation of the brightness, at least."""
    found = reduce(read(path))
    if renew:
        os.makedirs(os.path.dirname(baseline), exist_ok=True)
        write(baseline, found)
        print(f"written: {baseline}; look at it", flush=True)
        return
    assert os.path.exists(baseline), f"no baseline {baseline}; look at {path} and renew it"
    expected = read(baseline)
    assert found.shape == expected.shape, f"{path} is {found.shape}, its baseline {expected.shape}"
    mean = np.abs(found - expected).mean()
    correlation = np.corrcoef(found.mean(axis=2).ravel(), expected.mean(axis=2).ravel())[0, 1]
    print(f"{os.path.basename(baseline)}: {mean:.2f} grey levels (at most {difference}), likeness {correlation:.4f} (at least {likeness})", flush=True)
    assert mean <= difference and correlation >= likeness, f"{path} looks unlike {baseline}"
