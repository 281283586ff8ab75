# SPDX-License-Identifier: BSD-3-Clause
"""What real data say about the reconstruction: each slice of the spine sweep predicted from the others.

Real data have no truth, but each slice is a measurement: it is left out, the volume is made of the rest, and the
volume's grey levels at the slice's pixels (interpolated trilinearly) are compared with the slice's own. The pixels
asked for are those that both neighbours see, one before and one behind them; those count as predicted of which all
eight voxels around them are filled."""
import os

import numpy as np
from lacuna_test import data
from paraview.simple import LoadPlugin

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna import vtkLacunaSweptVolume, vtkLacunaTrackedSliceReader
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

SPACING = 0.5  # mm
POSE_INVALID = 1  # SliceStatus
STRIDE = 3  # each third column and row is asked for

reader = vtkLacunaTrackedSliceReader()
reader.SetFileName(data("ultrasound_spine/SpinePhantomFreehand.igs.mha"))
reader.SetCalibrationFileName(data("ultrasound_spine/PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml"))
reader.Update()
sweep = reader.GetOutput()
width, height, count = sweep.GetDimensions()
pixels = vtk_to_numpy(sweep.GetPointData().GetScalars()).reshape(count, height, width)
poses = vtk_to_numpy(sweep.GetFieldData().GetArray("ImageToReference")).reshape(count, 4, 4)
assert count == 21


def to_slice(pose):
    """Matrix from mm to (column, row, signed distance in mm)."""
    normal = np.cross(pose[:3, 0], pose[:3, 1])
    matrix = pose.copy()
    matrix[:3, 2] = normal / np.linalg.norm(normal)
    return np.linalg.inv(matrix)


def reconstruct(without, **properties):
    """Origin, grey levels and mask (z, y, x) of a volume of all slices but one."""
    slices = vtkImageData()
    slices.DeepCopy(sweep)
    slices.GetFieldData().GetArray("SliceStatus").SetValue(without, POSE_INVALID)
    volume = vtkLacunaSweptVolume()
    volume.SetInputData(slices)
    volume.SetOutputSpacing(SPACING, SPACING, SPACING)
    for name, value in properties.items():
        getattr(volume, "Set" + name)(value)
    volume.Update()
    output = volume.GetOutput()
    shape = output.GetDimensions()[::-1]
    arrays = [vtk_to_numpy(output.GetPointData().GetArray(name)).reshape(shape)
              for name in ("Intensity", "vtkValidPointMask")]
    return np.array(output.GetOrigin()), arrays[0].astype(float), arrays[1] != 0


def predict(left, **properties):
    """RMS error and predicted part of the pixels of one slice."""
    rows, columns = np.mgrid[0:height:STRIDE, 0:width:STRIDE]
    image = np.stack([columns, rows, np.zeros_like(rows), np.ones_like(rows)], -1).reshape(-1, 4).astype(float)
    points = image @ poses[left].T
    feet = [points @ to_slice(poses[n]).T for n in (left - 1, left + 1)]
    asked = feet[0][:, 2] * feet[1][:, 2] < 0
    for foot in feet:
        asked &= (foot[:, 0] >= 0) & (foot[:, 0] <= width - 1) & (foot[:, 1] >= 0) & (foot[:, 1] <= height - 1)

    origin, grey, mask = reconstruct(left, **properties)
    index = (points[:, :3] - origin) / SPACING
    base = np.floor(index).astype(int)
    inside = np.all((base >= 0) & (base + 1 < grey.shape[::-1]), axis=1)
    known = asked & inside
    base, part = base[known], (index - base)[known]
    value = np.zeros(len(base))
    filled = np.ones(len(base), bool)
    for corner in np.ndindex(2, 2, 2):
        i, j, k = (base + corner).T
        value += grey[k, j, i] * np.prod(np.where(corner, part, 1 - part), axis=1)
        filled &= mask[k, j, i]
    truth = pixels[left, ::STRIDE, ::STRIDE].reshape(-1)[known]
    error = (value - truth)[filled]
    return np.sqrt(np.mean(error**2)), filled.sum() / asked.sum()


scores = np.array([predict(n) for n in range(1, count - 1)])
rms, coverage = scores.mean(axis=0)
print(f"each slice predicted from the others at {SPACING} mm: RMS {rms:.3f} grey levels, {coverage:.4f} of the pixels")
assert rms <= 18.5, rms
assert coverage >= 0.995, coverage
