# SPDX-License-Identifier: BSD-3-Clause
"""Closed shapes of about 80 mm with known surfaces: points uniform by area, and exact distances from the surface.

Lengths are in mm, normals leave the solid. Spheres, ellipsoids and the kumara are images of the unit sphere, so that points are uniform by
area when each is kept with the probability of its stretch.
"""
import numpy as np
from scipy.spatial import cKDTree

NAMES = ("sphere", "torus", "ellipsoid", "kumara", "cup")


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


class Ball:
    """The unit sphere moved by map(s), whose derivative is the 3 x 3 matrix jacobian(s)."""

    dense = 60000  # places from which the nearest point is sought

    def __init__(self):
        self.start = None

    def normals(self, s):
        return unit(np.linalg.solve(np.swapaxes(self.jacobian(s), 1, 2), s[..., None])[..., 0])

    def sample(self, count, random):
        """Places and normals, count x 3 each."""
        trial = unit(random.normal(size=(20000, 3)))
        most = 1.05 * self.stretch(trial).max()
        found = np.empty((0, 3))
        while len(found) < count:
            s = unit(random.normal(size=(2 * count, 3)))
            found = np.concatenate([found, s[random.random(len(s)) * most < self.stretch(s)]])
        found = found[:count]
        return self.map(found), self.normals(found)

    def stretch(self, s):
        """Area of the image of a small part of the unit sphere, by its own area."""
        jacobian = self.jacobian(s)
        return np.abs(np.linalg.det(jacobian)) * np.linalg.norm(np.linalg.solve(np.swapaxes(jacobian, 1, 2), s[..., None])[..., 0], axis=1)

    def distance(self, points):
        """Signed, negative inside: Gauss-Newton steps from the nearest of many places."""
        if self.start is None:
            self.start = unit(np.random.default_rng(7).normal(size=(self.dense, 3)))
            self.tree = cKDTree(self.map(self.start))
        s = self.start[self.tree.query(points)[1]]
        best, side = np.full(len(points), np.inf), np.zeros(len(points))
        for _ in range(6):
            miss = points - self.map(s)
            far = np.linalg.norm(miss, axis=1)
            better = far < best
            best = np.where(better, far, best)
            side = np.where(better, np.sum(miss * self.normals(s), axis=1), side)
            across = unit(np.cross(s, np.eye(3)[np.argmin(np.abs(s), axis=1)]))
            basis = np.stack([across, np.cross(s, across)], axis=2)
            tangents = self.jacobian(s) @ basis
            turned = np.swapaxes(tangents, 1, 2)
            step = np.linalg.solve(turned @ tangents, turned @ miss[..., None])
            s = unit(s + (basis @ step)[..., 0])
        return np.copysign(best, side)


class Ellipsoid(Ball):
    def __init__(self, *axes):
        super().__init__()
        self.axes = np.array(axes, float)

    def map(self, s):
        return s * self.axes

    def jacobian(self, s):
        return np.broadcast_to(np.diag(self.axes), (len(s), 3, 3))


class Kumara(Ball):
    """Of Incomplete Shape (Sources/Phantoms/Kernel/lacunaIncompleteShape.cxx), half length 40 mm."""

    half, y, z, bend, shift, taper = 40.0, 0.35, 0.30, 0.53, -0.22, 0.25

    def map(self, s):
        u, v, w = s.T
        width = 1 - self.taper * u
        return self.half * np.stack([u, self.y * width * v + self.bend * u * u + self.shift, self.z * width * w], axis=1)

    def jacobian(self, s):
        u, v, w = s.T
        width, none = 1 - self.taper * u, np.zeros_like(u)
        return self.half * np.stack([np.stack([none + 1, none, none], 1),
                                     np.stack([2 * self.bend * u - self.taper * self.y * v, self.y * width, none], 1),
                                     np.stack([-self.taper * self.z * w, none, self.z * width], 1)], axis=1)


class Sphere(Ellipsoid):
    def __init__(self, radius):
        super().__init__(radius, radius, radius)

    def distance(self, points):
        return np.linalg.norm(points, axis=1) - self.axes[0]


class Torus:
    def __init__(self, radius, tube):
        self.radius, self.tube = radius, tube

    def sample(self, count, random):
        across = np.empty(0)
        while len(across) < count:
            v = 2 * np.pi * random.random(2 * count)
            keep = random.random(len(v)) * (self.radius + self.tube) < self.radius + self.tube * np.cos(v)
            across = np.concatenate([across, v[keep]])
        v, u = across[:count], 2 * np.pi * random.random(count)
        normals = np.stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)], axis=1)
        return self.radius * np.stack([np.cos(u), np.sin(u), 0 * u], axis=1) + self.tube * normals, normals

    def distance(self, points):
        return np.hypot(np.hypot(points[:, 0], points[:, 1]) - self.radius, points[:, 2]) - self.tube


class Cup:
    """Turned about z: a wall and a floor of 8 mm with sharp edges."""

    outline = np.array([[0, -40], [36, -40], [36, 40], [28, 40], [28, -32], [0, -32]], float)  # radius, z

    def sample(self, count, random):
        begin, end = self.outline[:-1], self.outline[1:]
        length = np.linalg.norm(end - begin, axis=1)
        area = length * (begin[:, 0] + end[:, 0])
        face = random.choice(len(begin), count, p=area / area.sum())
        share = random.random(count)
        a, b = begin[face, 0], end[face, 0]
        flat = a != b  # uniform in the square of the radius
        radius = np.where(flat, np.sqrt(a * a + share * (b * b - a * a)), a)
        z = np.where(flat, begin[face, 1], begin[face, 1] + share * (end[face, 1] - begin[face, 1]))
        along = (end - begin) / length[:, None]
        out = np.stack([along[:, 1], -along[:, 0]], axis=1)[face]
        u = 2 * np.pi * random.random(count)
        return (np.stack([radius * np.cos(u), radius * np.sin(u), z], axis=1),
                np.stack([out[:, 0] * np.cos(u), out[:, 0] * np.sin(u), out[:, 1]], axis=1))

    def distance(self, points):
        flat = np.stack([np.hypot(points[:, 0], points[:, 1]), points[:, 2]], axis=1)
        least = np.full(len(points), np.inf)
        for begin, end in zip(self.outline[:-1], self.outline[1:]):
            along = end - begin
            share = np.clip((flat - begin) @ along / (along @ along), 0, 1)
            least = np.minimum(least, np.linalg.norm(flat - begin - share[:, None] * along, axis=1))
        r, z = flat.T
        is_inside = (r < 36) & (np.abs(z) < 40) & ~((r < 28) & (z > -32))
        return np.where(is_inside, -least, least)


def make(name):
    return {"sphere": lambda: Sphere(40), "torus": lambda: Torus(28, 12), "ellipsoid": lambda: Ellipsoid(40, 28, 20),
            "kumara": Kumara, "cup": Cup}[name]()


def without_patches(points, normals, random, missing=0.3, patches=12):
    """Which points are left when patches of 7 to 19 mm radius are missing, each on one side only: a share of 0.3 in all."""
    def lost(factor):
        return (far < np.clip(factor * radii, 7, 19)).any(axis=1)
    while True:  # until the patches overlap so little that they can take that much
        centers = random.choice(len(points), patches, replace=False)
        radii = random.uniform(7, 19, patches)
        far = np.linalg.norm(points[:, None] - points[centers], axis=2)
        far[normals @ normals[centers].T <= 0] = np.inf
        if lost(3).mean() >= missing:
            break
    low, high = 0.3, 3.0
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (low, middle) if lost(middle).mean() > missing else (middle, high)
    return ~lost(low)


def case(name, sigma, has_patches, count=10000, tilt=5.0):
    """Points and normals as they are measured: off by sigma (mm, RMS on each axis) and tilt (degrees, RMS). The same each time."""
    random = np.random.default_rng([NAMES.index(name), round(1000 * sigma), int(has_patches), count])
    points, normals = make(name).sample(count, random)
    if has_patches:
        left = without_patches(points, normals, random)
        points, normals = points[left], normals[left]
    points = points + sigma * random.normal(size=points.shape)
    turn = np.radians(tilt) / np.sqrt(2) * random.normal(size=normals.shape)
    turn -= np.sum(turn * normals, axis=1)[:, None] * normals
    return points, unit(normals + turn)
