# SPDX-License-Identifier: BSD-3-Clause
"""A real skull from the top: depth map and surface against marching cubes, and a picture."""
import math
import os
import sys

from paraview import servermanager
from paraview.simple import *
from vtkmodules.vtkCommonCore import mutable
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

path = os.path.join(os.environ["LACUNA_TEST_DATA"], "ct_head", "head.mha")
if not os.path.exists(path):
    print("skipped: no", path)
    sys.exit(77)
LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())

head = OpenDataFile(path)  # Volume Reader: a plain CT is no tracked sequence
head.UpdatePipeline()
volume = servermanager.Fetch(head)
assert volume.GetDimensions() == (180, 244, 140), volume.GetDimensions()


def cast(**properties):
    caster = BSplineIsoRayCaster(Input=head, IsoValues=[500], ViewDirection=[0, 0, -1],
                                 **properties)
    caster.UpdatePipeline()
    return caster


def first_hits(surface, points, ray, length):
    """Distance to the first triangle along ray from each point, None where there is none."""
    locator = vtkStaticCellLocator()
    locator.SetDataSet(surface)
    locator.BuildLocator()
    for p in points:
        t, x, pc, sub = mutable(0.0), [0.0] * 3, [0.0] * 3, mutable(0)
        end = [a + length * b for a, b in zip(p, ray)]
        yield length * t.get() if locator.IntersectWithLine(p, end, 1e-6, t, x, pc, sub) else None


edges = vtkFlyingEdges3D()
edges.SetInputData(volume)
edges.SetValue(0, 500)
edges.ComputeNormalsOff()
edges.Update()

# Trilinear rays see what marching cubes sees, up to its flat triangles; the B-spline smooths a
# little, and shrinks by a fraction of a voxel.
for interpolation, least, bias in (("Trilinear", 0.97, 0.1), ("InterpolatingBSpline", 0.95, 0.15),
                                   ("BSpline", 0.93, 0.4)):
    caster = cast(Interpolation=interpolation)
    depth_map = servermanager.Fetch(caster)
    assert depth_map.GetDimensions() == (180, 244, 1), depth_map.GetDimensions()
    depth = depth_map.GetPointData().GetArray("Depth")
    normals = depth_map.GetPointData().GetArray("Normals")
    pixels = range(7, depth_map.GetNumberOfPoints(), 53)
    starts = []
    for i in pixels:
        x, y, z = depth_map.GetPoint(i)
        starts.append((x + 0.01, y + 0.013, z))  # off the edges of marching cubes' triangles
    near = total = 0
    differences = []
    for i, expected in zip(pixels, first_hits(edges.GetOutput(), starts, (0, 0, -1), 150)):
        found = depth.GetTuple1(i)
        # a bone cut by the volume's border is no surface for the caster
        if expected is None or math.isnan(found):
            continue
        # along the normal: on a steep side depths differ by more than the surfaces do
        difference = (found - expected) * normals.GetTuple3(i)[2]
        total += 1
        if abs(difference) < 0.5:
            near += 1
            differences.append(difference)
    mean = sum(differences) / len(differences)
    print(interpolation, "of", total, "hits", near, "within 0.5 mm of marching cubes, mean", mean)
    assert total > 250 and near >= least * total, (interpolation, near, total)
    assert abs(mean) < bias, (interpolation, mean)

valid = sum(not math.isnan(depth.GetTuple1(i)) for i in range(depth.GetNumberOfTuples()))
fraction = valid / depth.GetNumberOfTuples()
assert 0.3 < fraction < 0.9, fraction
# the vault over the planned defect: a smooth dome near the top of the volume
column = lambda x, y: depth.GetTuple1(round(x / 0.90234375) + 180 * (243 - round(y / 0.90234375)))
centre = column(90.2, 97.5)
assert 2 < centre < 30, centre
for dx, dy in ((30, 0), (-30, 0), (0, 30), (0, -30)):
    step = column(90.2 + dx, 97.5 + dy) - centre
    assert -3 < step < 15, (dx, dy, step)

surface = DepthMapSurface(Input=cast(PixelSpacing=0.45))
surface.UpdatePipeline()
bounds = surface.GetDataInformation().GetBounds()
assert 100 < bounds[1] - bounds[0] < 165 and 130 < bounds[3] - bounds[2] < 221, bounds
view = CreateView("RenderView")
view.ViewSize = [900, 1100]
view.UseColorPaletteForBackground = 0
view.Background = [0.1, 0.12, 0.16]
view.OrientationAxesVisibility = 0
shown = Show(surface, view)
ColorBy(shown, None)
shown.DiffuseColor = [0.93, 0.89, 0.8]
shown.Specular = 0.25
shown.SpecularPower = 30
middle = [(bounds[0] + bounds[1]) / 2, (bounds[2] + bounds[3]) / 2, (bounds[4] + bounds[5]) / 2]
view.CameraFocalPoint = middle
view.CameraPosition = [middle[0], middle[1], middle[2] + 500]
view.CameraViewUp = [0, 1, 0]
view.CameraParallelProjection = 1
view.CameraParallelScale = 110
Render(view)
os.makedirs(os.environ["LACUNA_TEST_OUTPUT"], exist_ok=True)
SaveScreenshot(os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "CTHeadDepthMap.png"), view)
view.CameraPosition = [middle[0] + 350, middle[1] + 350, middle[2] + 200]
view.CameraViewUp = [0, 0, 1]
Render(view)
SaveScreenshot(os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "CTHeadDepthMapOblique.png"), view)
print("ok: valid", fraction, "depth over the defect", centre)
