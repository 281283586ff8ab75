# SPDX-License-Identifier: BSD-3-Clause
"""The proxies B-Spline Iso Ray Caster and Depth Map Surface, without real data."""
import math
import os

from paraview import servermanager
from paraview.simple import *
from lacuna_test import check_defaults

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
import lacuna  # after the plugin: the wrapped classes, for the C++ defaults

wavelet = Wavelet(WholeExtent=[-20, 20, -20, 20, -20, 20])
wavelet.UpdatePipeline()
caster = BSplineIsoRayCaster(Input=wavelet)
algorithm = lacuna.vtkLacunaBSplineIsoRayCaster()
low, high = wavelet.PointData["RTData"].GetRange()  # not Hounsfield units: the middle is proposed
assert algorithm.GetIsoValue(0) == 500 and list(caster.IsoValues) == [(low + high) / 2], caster.IsoValues
assert algorithm.GetNumberOfIsoValues() == 1
names = ["ViewDirection", "ViewUp", "FocalPoint", "PlaneOrigin", "PixelSpacing", "ImageSize", "EyePosition",
         "ViewAngle", "CapCutAway", "CapBoundary", "ComputeThickness"]
check_defaults(caster, algorithm, names, {
    "Interpolation": ["BSpline", "InterpolatingBSpline", "Trilinear"],
    "SolidSide": ["Above", "Below"],
    "Projection": ["Parallel", "Perspective"],
    "NormalMethod": ["Analytic", "GreyLevel"]})
assert type(caster.CutAway).__name__ == "None" and caster.StartDepthMap is None, caster.CutAway
assert caster.ScalarArray == algorithm.GetScalarArray() == ""
surface = DepthMapSurface(Input=caster)
algorithm = lacuna.vtkLacunaDepthMapSurface()
assert surface.DepthArray == algorithm.GetDepthArray() == "Depth"
check_defaults(surface, algorithm, ["BreakAtDiscontinuities", "MaximumAngle", "MaximumAngleChange",
                                    "ComputeNormalDifference"])
Delete(surface)
Delete(caster)

# The sampled quadratic x^2 + y^2 + z^2 is an exact sphere: r^2 + 1.
quadric = Calculator(Input=wavelet, Function="coordsX^2 + coordsY^2 + coordsZ^2",
                     ResultArrayName="Square")
caster = BSplineIsoRayCaster(Input=quadric, ScalarArray="Square", SolidSide="Below",
                             IsoValues=[101, 226], ViewDirection=[0, 0, -1], PixelSpacing=0.5)
caster.UpdatePipeline()
depth_map = servermanager.Fetch(caster)
assert depth_map.GetDimensions() == (81, 81, 1), depth_map.GetDimensions()
point_data = depth_map.GetPointData()
depth, further, normals, further_normals = (
    point_data.GetArray(n) for n in ("Depth", "Depth_1", "Normals", "Normals_1"))
worst = hits = 0
for i in range(depth_map.GetNumberOfPoints()):
    x, y, z = depth_map.GetPoint(i)
    assert z == 20, "the plane touches the volume"
    for array, radius, directions in ((depth, 10, normals), (further, 15, further_normals)):
        inside = radius * radius - x * x - y * y
        if inside == 0:
            continue  # the ray touches the sphere
        assert math.isnan(array.GetTuple1(i)) == (inside < 0), (x, y)
        if inside > 0:
            worst = max(worst, abs(array.GetTuple1(i) - (20 - math.sqrt(inside))))
            hits += 1
            n = directions.GetTuple3(i)
            assert abs(n[0] - x / radius) + abs(n[1] - y / radius) < 1e-6, (n, x, y)
assert hits > 3000 and worst < 1e-9, (hits, worst)
assert depth_map.GetFieldData().GetArray("IsoValues").GetNumberOfTuples() == 2

surface = DepthMapSurface(Input=caster)
surface.UpdatePipeline()
mesh = servermanager.Fetch(surface)
assert mesh.GetPointData().GetPedigreeIds().GetName() == "PixelId"
assert mesh.GetPointData().GetNormals().GetName() == "Normals"
bounds = mesh.GetBounds()
assert abs(bounds[5] - 10) < 1e-9 and bounds[4] > -1e-9, bounds

# The same sphere cut by a plane through its middle, from an eye, and its far side.
view = dict(Input=quadric, ScalarArray="Square", SolidSide="Below", IsoValues=[101])
cut = BSplineIsoRayCaster(ComputeThickness=1, CutAway="Plane", ViewDirection=[0, 0, -1], PixelSpacing=0.5, **view)
cut.CutAway.Origin = [0, 0, 2]
cut.CutAway.Normal = [0, 0, -1]
cut.UpdatePipeline()
middle = 81 * 40 + 40
data = servermanager.Fetch(cut).GetPointData()
assert abs(data.GetArray("Depth").GetTuple1(middle) - 18) < 1e-9
assert abs(data.GetArray("Thickness").GetTuple1(middle) - 12) < 1e-6
cut.CutAway = "Box"
cut.CutAway.Position = [-3, -3, 5]
cut.CutAway.Length = [6, 6, 30]
cut.UpdatePipeline()
data = servermanager.Fetch(cut).GetPointData()
assert abs(data.GetArray("Depth").GetTuple1(middle) - 15) < 1e-9, data.GetArray("Depth").GetTuple1(middle)
cut.CutAway = "None"
behind = BSplineIsoRayCaster(StartDepthMap=cut, ViewDirection=[0, 0, -1], PixelSpacing=0.5, **view)
behind.SolidSide = "Above"
behind.UpdatePipeline()
data = servermanager.Fetch(behind).GetPointData()
assert abs(data.GetArray("Depth").GetTuple1(middle) - 30) < 1e-9, "the far side"
seen = BSplineIsoRayCaster(Projection="Perspective", EyePosition=[0, -50, 0], ViewDirection=[0, 1, 0],
                           ViewUp=[0, 0, 1], ViewAngle=40, ImageSize=[31, 31], **view)
seen.UpdatePipeline()
eye_map = servermanager.Fetch(seen)
assert eye_map.GetFieldData().GetArray("EyePosition").GetTuple3(0) == (0, -50, 0)
plane = eye_map.GetPoint(15 * 31 + 15)
depth_at = eye_map.GetPointData().GetArray("Depth").GetTuple1(15 * 31 + 15)
assert abs(plane[1] + depth_at + 10) < 1e-9, (plane, depth_at)
for proxy in (seen, behind, cut):
    Delete(proxy)

# A selection made on the surface means pixels of the map.
pixel = 81 * 40 + 45
SelectPoints("id >= 0 and PixelId == %d" % pixel, surface)
chosen = ExtractSelection(Input=surface)
chosen.UpdatePipeline()
assert servermanager.Fetch(chosen).GetPoint(0)[:2] == depth_map.GetPoint(pixel)[:2]

# State and back: the new session's caster gives the same map.
state = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "BSplineIsoRayCaster.pvsm")
os.makedirs(os.path.dirname(state), exist_ok=True)
SaveState(state)
ResetSession()
LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
LoadState(state)
casters = [p for p in GetSources().values() if p.GetXMLName() == "LacunaBSplineIsoRayCaster"]
assert len(casters) == 1 and list(casters[0].IsoValues) == [101, 226], casters
assert casters[0].SolidSide == "Below" and casters[0].PixelSpacing == 0.5
print("ok: worst error of", hits, "hits", worst)
