# SPDX-License-Identifier: BSD-3-Clause
"""Writes ScipyTables.h: what scipy.ndimage makes of a small volume. Run: python3 ScipyTables.py > ScipyTables.h"""
import numpy as np
import scipy
from scipy import ndimage

rng = np.random.default_rng(4)
volume = (rng.rayleigh(40, (5, 7, 9)) + 60 * (np.arange(9) > 4)).clip(0, 255).astype(np.uint8)

# Kernels are (x, y, z); scipy's axes are (z, y, x).
kernels = [(3, 3, 1), (5, 5, 1), (3, 3, 3), (4, 2, 3), (7, 5, 1), (2, 2, 2)]
operations = {
    "Median": (0, ndimage.median_filter),
    "Rank": (1, lambda v, size, mode: ndimage.percentile_filter(v, 30, size=size, mode=mode)),
    "Minimum": (2, ndimage.minimum_filter),
    "Maximum": (3, ndimage.maximum_filter),
    "Opening": (4, ndimage.grey_opening),
    "Closing": (5, ndimage.grey_closing),
    "Mean": (10, lambda v, size, mode: np.floor(ndimage.uniform_filter(v.astype(float), size, mode=mode) + 0.5 + 1e-9)),
}


def numbers(values, width=24):
    text = [repr(v) for v in values]
    return ",\n  ".join(", ".join(text[i:i + width]) for i in range(0, len(text), width))


print("// SPDX-License-Identifier: BSD-3-Clause")
print(f"/// @file\n/// Made by ScipyTables.py with scipy {scipy.__version__}.")
print("// clang-format off")
print("#ifndef ScipyTables_h\n#define ScipyTables_h\n\n#include <array>\n#include <vector>\n")
print("namespace scipyTables\n{")
print("constexpr int Size[3] = { 9, 7, 5 };")
print(f"constexpr int Input[] = {{\n  {numbers(volume.ravel().tolist())} }};\n")
print("struct Table\n{\n  const char* Name;\n  int Operation;\n  std::array<int, 3> KernelSize;\n"
      "  std::array<double, 3> Spacing;\n  std::vector<double> Values;\n};\n")
print("const std::vector<Table> Tables = {")
for name, (number, function) in operations.items():
    for x, y, z in kernels:
        result = function(volume, size=(z, y, x), mode="nearest")
        print(f'{{ "{name} {x} {y} {z}", {number}, {{ {x}, {y}, {z} }}, {{ 1, 1, 1 }},\n'
              f"  {{ {numbers(result.astype(int).ravel().tolist())} }} }},")
sigma = 1.3
for spacing in [(1, 1, 1), (1, 0.5, 0.8)]:
    samples = [sigma / s for s in reversed(spacing)]
    blurred = ndimage.gaussian_filter(volume.astype(float), samples, mode="nearest")
    print(f'{{ "Gaussian", 11, {{ 3, 3, 3 }}, {{ {spacing[0]}, {spacing[1]}, {spacing[2]} }},\n'
          f"  {{ {numbers(np.floor(blurred + 0.5).astype(int).ravel().tolist())} }} }},")
laplacian = sum(ndimage.gaussian_filter(volume.astype(float), (0, sigma, sigma), order=order, mode="nearest", truncate=6)
                for order in [(0, 2, 0), (0, 0, 2)])
print(f'{{ "Laplacian", 12, {{ 3, 3, 1 }}, {{ 1, 1, 1 }},\n'
      f"  {{ {numbers([round(v, 5) for v in laplacian.ravel().tolist()], 12)} }} }},")
print("};\n}\n#endif")
