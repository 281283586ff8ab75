# SPDX-License-Identifier: BSD-3-Clause
"""What scipy takes for the same: radial basis functions and filters of images.

    python3 Testing/Benchmarks/peers_scipy.py [--benchmark_filter=REGEX]

Rows bear the names of the rows they stand beside. Franke's function as in lacunaScatteredProblem.h, speckle as in
SpeckleFilter.cxx. numpy's linear algebra uses all cores, the filters of images one.
"""
import numpy
from scipy import interpolate, ndimage

from harness.rows import Program


def franke(x, y):
    x, y = 9 * x, 9 * y
    return (0.75 * numpy.exp(-((x - 2)**2 + (y - 2)**2) / 4) + 0.75 * numpy.exp(-(x + 1)**2 / 49 - (y + 1) / 10)
            + 0.5 * numpy.exp(-((x - 7)**2 + (y - 3)**2) / 4) - 0.2 * numpy.exp(-(x - 4)**2 - (y - 7)**2))


def nodes(count):
    i = numpy.arange(1, count + 1)
    places = numpy.stack([i * 0.7548776662466927 % 1, i * 0.5698402909980532 % 1], axis=1)
    return places, franke(places[:, 0], places[:, 1])


def fitted(count):
    places, values = nodes(count)
    return interpolate.RBFInterpolator(places, values, kernel="thin_plate_spline", degree=1)


def fit(count):
    def measured():
        fitted(count)
    return measured


def grid(count, size):
    function = fitted(count)
    along = numpy.linspace(0, 1, size)
    points = numpy.stack(numpy.meshgrid(along, along), axis=-1).reshape(-1, 2)
    return lambda: {"points": float(len(function(points)))}


def warp(count):
    """Three functions of space with the same nodes."""
    places = numpy.random.default_rng(1).random((count, 3))
    values = franke(places[:, 0], places[:, 1]) * numpy.cos(3 * places[:, 2])

    def measured():
        interpolate.RBFInterpolator(places, numpy.stack([values] * 3, axis=1), kernel="thin_plate_spline", degree=1)
    return measured


def speckle(size):
    """Rayleigh distributed around a few grey levels."""
    x, y, z = (numpy.arange(n) for n in size)
    level = 30 + 25 * numpy.sin(x * 0.05)[None, None, :] * numpy.cos(y * 0.04)[None, :, None] * numpy.sin(z * 0.03)[:, None, None]
    return numpy.minimum(255, numpy.random.default_rng(1).rayleigh(size=level.shape) * level).astype(numpy.uint8)


SLAB = (220, 172, 40)


def image_filter(size, function, *arguments, **keywords):
    def prepare():
        image = speckle(size)

        def measured():
            function(image, *arguments, **keywords)
        return measured
    return prepare


program = Program(__doc__)
for number in (700, 1000, 3000, 10000):
    program.add(f"Fit/nodes:{number}", lambda number=number: fit(number))
for number in (700, 1000, 3000):
    program.add(f"Grid/nodes:{number}/grid:512", lambda number=number: grid(number, 512))
program.add("WarpSetUp/pairs:700", lambda: warp(700))
program.add("Size3D/Median_uint8/3", image_filter(SLAB, ndimage.median_filter, 3))
program.add("Size3D/Median_uint8/5", image_filter(SLAB, ndimage.median_filter, 5))
program.add("Size3D/Median_uint8/9", image_filter(SLAB, ndimage.median_filter, 9))
program.add("Size3D/Minimum_uint8/9", image_filter(SLAB, ndimage.minimum_filter, 9))
program.add("Size3D/Opening_uint8/9", image_filter(SLAB, ndimage.grey_opening, 9))
program.add("Size3D/Mean_uint8/9", image_filter(SLAB, ndimage.uniform_filter, 9))
program.add("Gaussian3D/Gaussian_uint8/2", image_filter(SLAB, ndimage.gaussian_filter, 2, truncate=3))
program.add("Image/Median_uint8/11", image_filter((640, 480, 4), ndimage.median_filter, (1, 11, 11)))

if __name__ == "__main__":
    program.main()
