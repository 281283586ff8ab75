# SPDX-License-Identifier: BSD-3-Clause
"""Skull Phantom in pvpython: proxy, defaults, properties, truth."""
import math
import os

import lacuna
import numpy as np
from lacuna_test import check_defaults
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())


def fetch(proxy):
    proxy.UpdatePipeline()
    data = proxy.GetClientSideObject().GetOutputDataObject(0)
    nx, ny, nz = data.GetDimensions()
    return data, vtk_to_numpy(data.GetPointData().GetScalars()).reshape(nz, ny, nx)


skull = SkullPhantom()
assert skull.SMProxy.GetXMLName() == "LacunaSkullPhantom"
plain = lacuna.vtkLacunaSkullPhantom()
names = ["Spacing", "DefectRadius", "DefectDirection", "NoiseLevel", "Seed", "Sutures", "Center"]
check_defaults(skull, plain, names)
assert set(skull.ListProperties()) - {"PointData", "CellData", "FieldData"} == set(names)

data, defect = fetch(skull)
assert data.GetDimensions() == (169, 204, 67) and defect.dtype == np.int16
client = skull.GetClientSideObject()

# The intact skull is the truth at every voxel tried; the defect only takes bone away.
_, intact = fetch(SkullPhantom(DefectRadius=0))
rng = np.random.default_rng(5)
for _ in range(4000):
    i, j, k = (int(rng.integers(0, n)) for n in data.GetDimensions())
    p = [0.0, 0.0, 0.0]
    data.TransformIndexToPhysicalPoint(i, j, k, p)
    assert abs(intact[k, j, i] - client.EvaluateTruth(*p)) <= 0.5 + 1e-9
changed = defect != intact
assert (defect <= intact).all() and changed.sum() > 5000
k, j, i = np.nonzero(changed & (intact > 900) & (defect < 36))
for a in range(0, len(i), 50):
    p = [0.0, 0.0, 0.0]
    data.TransformIndexToPhysicalPoint(int(i[a]), int(j[a]), int(k[a]), p)
    assert client.IsInDefect(*p)

# A depth map seen from the top: 500 HU at the intersection, also over the defect.
hits = holes = 0
for x in range(-80, 81, 8):
    for y in range(-100, 101, 8):
        depth = client.IntersectOuterSurface([x, y, 120.0], [0.0, 0.0, -1.0])
        if not math.isnan(depth):
            hits += 1
            assert abs(plain.EvaluateTruth(x, y, 120 - depth) - 500) < 1e-5
            holes += client.IsInDefect(x, y, 120 - depth)
assert hits > 250 and holes > 30, (hits, holes)

# Left and right: the defect and the bump lie on the patient's left (+x).
assert client.IsInDefect(30, -15, 60) and not client.IsInDefect(-30, -15, 60)
bump = client.IntersectOuterSurface((0, 0, 0), (0.42, -0.80, 0.43))
assert bump > client.IntersectOuterSurface((0, 0, 0), (-0.42, -0.80, 0.43)) + 2

coarse = dict(Spacing=[3, 3, 3])
_, base = fetch(SkullPhantom(**coarse))
for change in (
        dict(DefectRadius=20), dict(DefectDirection=[0, 0, 1]), dict(NoiseLevel=10),
        dict(NoiseLevel=10, Seed=2)):
    _, other = fetch(SkullPhantom(**coarse, **change))
    assert not np.array_equal(other, base), change
moved, _ = fetch(SkullPhantom(Spacing=[2, 2, 2.3], Center=[7, 8, 9]))
assert moved.GetDimensions() == (85, 103, 67) and moved.GetOrigin() == (-76.0, -93.0, -62.0)
print("passed")
