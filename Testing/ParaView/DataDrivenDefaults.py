# SPDX-License-Identifier: BSD-3-Clause
"""Defaults that come from the data: iso-values lie in the range, and regions, planes and boxes on the data.

Each proxy is made as a user makes it: of data that are there, without setting anything.
"""
import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna.data import fetch
from lacuna.errors import raising
from paraview.simple import *

# Iso-values: bone for a CT, the middle of the range for anything else
skull = SkullPhantom(Spacing=[3, 3, 3])
sweep = PhantomSweep(NumberOfSlices=20, ImageSize=[80, 60], PixelSpacing=0.8)
for source in (skull, sweep):
    source.UpdatePipeline()
volume = SweptVolume(Input=sweep)
volume.UpdatePipeline()
bone = BSplineIsoRayCaster(Input=skull)
assert list(bone.IsoValues) == [500], list(bone.IsoValues)
warnings = []
for source, kind in ((volume, BSplineIsoRayCaster), (sweep, SliceRayCaster)):
    low, high = source.PointData["Intensity"].GetRange()
    caster = kind(Input=source)
    level = caster.IsoValues[0] if kind is BSplineIsoRayCaster else caster.IsoValue
    assert level == (low + high) / 2, (caster, level, low, high)
    with raising(warnings):
        caster.UpdatePipeline()
    assert fetch(caster).GetPointData().GetArray("vtkValidPointMask").GetRange()[1] == 1, caster
assert not warnings, warnings
assert list(BSplineIsoRayCaster(Input=volume, IsoValues=[77, 88]).IsoValues) == [77, 88]
without = BSplineIsoRayCaster(Input=SkullPhantom(Spacing=[4, 4, 4]))  # of no data yet
assert list(without.IsoValues) == [500], list(without.IsoValues)


# Regions
def check_region(region, kind, bounds):
    middle = [(bounds[2 * axis] + bounds[2 * axis + 1]) / 2 for axis in range(3)]
    if kind == "Box":
        assert list(region.Position) == list(bounds[::2]), list(region.Position)
        sizes = [high - low for low, high in zip(bounds[::2], bounds[1::2])]
        assert list(region.Length) == sizes, list(region.Length)
    else:
        place = region.Origin if kind == "Plane" else region.Center
        assert all(abs(a - b) < 1e-9 for a, b in zip(place, middle)), (kind, list(place), middle)


bone.UpdatePipeline()
shape = IncompleteShape(Shape="Sphere", Dimensions=[28, 28, 28])
shape.UpdatePipeline()
filler, angle = RBFHoleFiller(Input=bone), OccludedAngle(Input=shape)
for proxy, name, data in ((bone, "CutAway", skull), (filler, "DefectRegion", bone), (angle, "ReconstructionSpace", shape)):
    bounds = data.GetDataInformation().GetBounds()
    kinds = [kind for kind in ("Plane", "Box", "Sphere", "Cylinder") if kind in proxy.GetProperty(name).Available]
    assert len(kinds) >= 3, kinds
    for kind in kinds:
        setattr(proxy, name, kind)
        check_region(getattr(proxy, name), kind, bounds)
    setattr(proxy, name, "None")

# A loop: around the middle of the map, in its plane
for direction in ([0, 0, -1], [-1, 0.1, 0.2], [-0.4, 0.2, -0.9]):
    seen = BSplineIsoRayCaster(Input=skull, ViewDirection=direction, PixelSpacing=4)
    seen.UpdatePipeline()
    filler = RBFHoleFiller(Input=seen, NodeSpacing=4, DefectRegion="Spline Loop")
    columns, rows, _ = fetch(seen).GetDimensions()
    world = np.reshape(fetch(seen).GetFieldData().GetArray("ImageToWorld").GetTuple(0), (4, 4))
    points = np.array(filler.DefectRegion.Points).reshape(-1, 3)
    middle = world @ [(columns - 1) / 2, (rows - 1) / 2, 0, 1]
    assert np.allclose(points.mean(0), middle[:3]), (direction, points)
    assert np.allclose((points - middle[:3]) @ direction, 0), (direction, points)
    inside = np.linalg.solve(world, np.c_[points, np.ones(4)].T)[:2].T / [columns - 1, rows - 1]
    assert np.allclose(inside, [[1 / 3, 1 / 3], [2 / 3, 1 / 3], [2 / 3, 2 / 3], [1 / 3, 2 / 3]]), (direction, inside)
with raising(warnings):
    filler.UpdatePipeline()  # the last direction looks into the hole
assert not warnings, warnings
assert fetch(filler).GetPointData().GetArray("FilledMask").GetRange() == (0, 1)
loop = RBFHoleFiller(Input=BSplineIsoRayCaster(Input=skull), DefectRegion="Spline Loop").DefectRegion
assert list(loop.Points) == [0, 0, 0, 10, 0, 0, 10, 10, 0, 0, 10, 0], "of no data yet"
mirror = Mirror(Input=bone)
check_region(mirror, "Plane", bone.GetDataInformation().GetBounds())
