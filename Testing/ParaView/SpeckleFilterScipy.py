# SPDX-License-Identifier: BSD-3-Clause
"""Speckle Filter against scipy.ndimage, where both define the same: every type, odd and even windows, boxes and
ellipsoids, windows larger than the image."""
import sys

import lacuna
import numpy as np
from lacuna_test import SKIPPED
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

try:
    from scipy import ndimage
except ImportError:
    print("skipped: scipy is not installed", flush=True)
    sys.exit(SKIPPED)

TYPES = (np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64, np.float32, np.float64)
SIZES = ((1, 1, 1), (3, 3, 1), (5, 5, 1), (2, 2, 1), (3, 3, 3), (4, 3, 2), (1, 6, 5), (13, 15, 9))  # x, y, z
SHAPE = (6, 9, 11)  # z, y, x


def top_hat(values, **window):
    """ndimage.white_tophat wraps round where integers end."""
    opening = ndimage.grey_opening(values, **window)
    if values.dtype.kind == "f":
        return values - opening
    difference = values.astype(object) - opening.astype(object)
    return np.minimum(difference, np.iinfo(values.dtype).max).astype(values.dtype)


EXACT = {
    "Median": ndimage.median_filter,
    "Rank": lambda v, **window: ndimage.percentile_filter(v, 30, **window),
    "Minimum": ndimage.minimum_filter,
    "Maximum": ndimage.maximum_filter,
    "Opening": ndimage.grey_opening,
    "Closing": ndimage.grey_closing,
    "OpenClose": lambda v, **window: ndimage.grey_closing(ndimage.grey_opening(v, **window), **window),
    "CloseOpen": lambda v, **window: ndimage.grey_opening(ndimage.grey_closing(v, **window), **window),
    "TopHat": top_hat,
}
OPERATIONS = ("Median", "Rank", "Minimum", "Maximum", "Opening", "Closing", "OpenClose", "CloseOpen", "Mode",
              "AdaptiveMedian", "Mean", "Gaussian", "LaplacianOfGaussian", "TopHat")


def lacuna_filter(values, operation, size, ellipsoid=False, deviation=1.0, spacing=(1, 1, 1)):
    image = vtkImageData()
    image.SetDimensions(values.shape[::-1])
    image.SetSpacing(spacing)
    array = numpy_to_vtk(values.ravel(), deep=1)
    array.SetName("Values")
    image.GetPointData().SetScalars(array)
    speckle = lacuna.vtkLacunaSpeckleFilter()
    speckle.SetInputData(image)
    speckle.SetOperation(OPERATIONS.index(operation))
    speckle.SetKernelSize(size)
    speckle.SetKernelShape(int(ellipsoid))
    speckle.SetRank(30)
    speckle.SetStandardDeviation(deviation)
    speckle.Update()
    return vtk_to_numpy(speckle.GetOutput().GetPointData().GetScalars()).reshape(values.shape)


def random_values(dtype, random):
    """Over the range of the type; within 2^50, since scipy ranks in double."""
    if np.dtype(dtype).kind == "f":
        return (random.standard_normal(SHAPE) * 10.0 ** random.integers(-3, 6, SHAPE)).astype(dtype)
    limits = np.iinfo(dtype)
    return random.integers(max(limits.min, -2 ** 50), min(limits.max, 2 ** 50), SHAPE, endpoint=True).astype(dtype)


def ellipsoid_of(size):
    """The footprint, (z, y, x), as the guide defines it."""
    axes = [((np.arange(n) - (n - 1) / 2) / (n / 2)) ** 2 for n in size[::-1]]
    return axes[0][:, None, None] + axes[1][None, :, None] + axes[2][None, None, :] <= 1 + 1e-12


compared = 0
random = np.random.default_rng(7)
for dtype in TYPES:
    values = random_values(dtype, random)
    for size in SIZES:
        for operation, function in EXACT.items():
            truth = function(values, size=size[::-1], mode="nearest")
            result = lacuna_filter(values, operation, size)
            assert result.dtype == values.dtype
            assert np.array_equal(result, truth), (dtype, size, operation)
            truth = function(values, footprint=ellipsoid_of(size), mode="nearest")
            result = lacuna_filter(values, operation, size, ellipsoid=True)
            assert np.array_equal(result, truth), (dtype, size, operation, "ellipsoid")
            compared += 2
        # sums in double have a few digits to spare for values below 100
        small = values % 100 if np.dtype(dtype).kind != "f" else (values % 100).astype(dtype)
        truth = ndimage.uniform_filter(small.astype(float), size[::-1], mode="nearest")
        result = lacuna_filter(small, "Mean", size)
        if np.dtype(dtype).kind == "f":
            assert np.allclose(result, truth, rtol=1e-6 if dtype == np.float32 else 1e-12, atol=1e-9)
        else:
            assert np.array_equal(result, np.floor(truth + 0.5 + 1e-9)), (dtype, size)
        compared += 1
    for spacing in ((1, 1, 1), (0.4, 0.5, 1.25)):
        samples = [1.3 / s for s in spacing[::-1]]
        truth = ndimage.gaussian_filter(values.astype(float), samples, mode="nearest")
        result = lacuna_filter(values, "Gaussian", (3, 3, 3), deviation=1.3, spacing=spacing)
        largest = np.abs(values.astype(float)).max()
        rounding = 0 if np.dtype(dtype).kind == "f" else 0.5
        digits = 1e-6 if dtype == np.float32 or np.dtype(dtype).itemsize <= 2 else 1e-13
        assert np.abs(result - truth).max() <= rounding + digits * largest, (dtype, spacing)
        truth = sum(ndimage.gaussian_filter(values.astype(float), samples, mode="nearest", truncate=6,
                                            order=[2 * (axis == a) for a in range(3)]) / spacing[2 - axis] ** 2
                    for axis in range(3))
        result = lacuna_filter(values, "LaplacianOfGaussian", (3, 3, 3), deviation=1.3, spacing=spacing)
        assert result.dtype == (np.float64 if dtype == np.float64 else np.float32)
        assert np.abs(result - truth).max() <= 5e-5 * largest, (dtype, spacing, np.abs(result - truth).max() / largest)
        compared += 2
print(f"ok: {compared} comparisons")
