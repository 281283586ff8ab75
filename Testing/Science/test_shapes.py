# SPDX-License-Identifier: BSD-3-Clause
"""The shapes that judge surfaces: points lie on them, uniform by area, and distances are right. Exit code 77: without numpy or scipy."""
import sys

try:
    import numpy as np
    import scipy.spatial
    import shapes
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

random = np.random.default_rng(3)


def check(condition, what):
    if not condition:
        sys.exit(f"wrong: {what}")


for name in shapes.NAMES:
    shape = shapes.make(name)
    points, normals = shape.sample(4000, random)
    check(np.abs(shape.distance(points)).max() < 1e-6, f"{name}: points are on the surface")
    check(np.abs(np.linalg.norm(normals, axis=1) - 1).max() < 1e-9, f"{name}: normals have length 1")
    for offset in (-0.3, 0.3):  # but near the cup's edges
        error = np.abs(shape.distance(points + offset * normals) - offset)
        check(np.quantile(error, 0.97) < 1e-3, f"{name}: {offset} mm from the surface, outside positive")
    across = shapes.unit(np.cross(normals, random.normal(size=normals.shape)))
    check(np.quantile(np.abs(shape.distance(points + 0.01 * across)) / 0.01, 0.99) < 0.005, f"{name}: normals are normal to the surface")
    # far from the surface, by the nearest of many points
    places = random.uniform(-50, 50, (200, 3))
    nearest = scipy.spatial.cKDTree(shape.sample(100000, random)[0]).query(places)[0]
    check(np.abs(np.abs(shape.distance(places)) - nearest).max() < 0.6, f"{name}: distances of any points")
    # uniform by area: the halves that a plane makes, against a grid of the parameters with the area of each cell
    if isinstance(shape, shapes.Ball):
        v, u = np.meshgrid((np.arange(400) + 0.5) * np.pi / 400, (np.arange(400) + 0.5) * np.pi / 200, indexing="ij")
        s = np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)], axis=-1).reshape(-1, 3)
        area = np.sin(v).ravel() * shape.stretch(s)
        share = area[shape.map(s)[:, 0] > 10].sum() / area.sum()
    elif name == "torus":
        u, v = np.meshgrid((np.arange(400) + 0.5) * np.pi / 200, (np.arange(400) + 0.5) * np.pi / 200, indexing="ij")
        area = 28 + 12 * np.cos(v)
        share = area[area * np.cos(u) > 10].sum() / area.sum()
    else:
        share = None
    if share is not None:
        many = shape.sample(40000, random)[0]
        check(abs((many[:, 0] > 10).mean() - share) < 4 * np.sqrt(share * (1 - share) / 40000), f"{name}: uniform by area")

wall = 2 * np.pi * 36 * 80
whole = wall + 2 * np.pi * 28 * 72 + np.pi * (36**2 + 28**2 + 36**2 - 28**2)
points, normals = shapes.make("cup").sample(40000, random)
share = (np.abs(np.hypot(points[:, 0], points[:, 1]) - 36) < 1e-9).mean()
check(abs(share - wall / whole) < 0.01, "cup: uniform by area")

points, normals = shapes.case("kumara", 0.2, True)
error = shapes.make("kumara").distance(points)
check(len(points) == 7000, "30 % are missing")
check(abs(np.sqrt(np.mean(error**2)) - 0.2) < 0.006, "errors of 0.2 mm")
check((shapes.case("kumara", 0.2, True)[0] == points).all(), "the same each time")
print("shapes are right")
