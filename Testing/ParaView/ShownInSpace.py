# SPDX-License-Identifier: BSD-3-Clause
"""What is selected with the mouse on a depth map or on slices that are shown where they lie means the points and cells under the mouse."""
import lacuna.plugin

lacuna.plugin.load()
import numpy as np
from lacuna import demo_ultrasound, window
from lacuna.data import fetch
from paraview import servermanager
from paraview.simple import (BSplineIsoRayCaster, ClearSelection, CreateRenderView, ExtractSelection, ExtractSubset, GetDisplayProperties,
                             PhantomSweep, Render, ResetCamera, SelectSurfaceCells, SelectSurfacePoints, SkullPhantom)
from vtkmodules.util.numpy_support import vtk_to_numpy

LOW, HIGH = np.array([330, 310]), np.array([350, 335])  # pixels of the view


def on_map(image, index, data):
    """Places of pixels (column, row) in space, by their depths."""
    matrix = np.array(image.GetFieldData().GetArray("ImageToWorld").GetTuple(0)).reshape(4, 4)
    depth = vtk_to_numpy(data.GetPointData().GetArray("Depth"))[:, None]
    return matrix[:3, 3] + index[:, :2] @ matrix[:3, :2].T + depth * matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])


def on_slices(image, index, _data):
    poses = demo_ultrasound.slice_poses(image)
    return np.array([(poses[int(k)] @ [u, v, 0, 1])[:3] for u, v, k in index])


def select(source, view, places, by):
    """Selects in the rectangle. Where in the view what was selected lies, and how many there are."""
    ClearSelection()
    by(Rectangle=[*LOW, *HIGH], View=view)
    extract = ExtractSelection(Input=source, Selection=servermanager._getPyProxy(source.SMProxy.GetSelectionInput(0)))
    found, image = fetch(extract), fetch(source)
    points = np.array([found.GetPoint(i) for i in range(found.GetNumberOfPoints())])
    index = index_of(image, points)
    renderer, seen = view.GetRenderer(), []
    for place in places(image, index, found):
        renderer.SetWorldPoint(*place, 1)
        renderer.WorldToDisplay()
        seen.append(renderer.GetDisplayPoint()[:2])
    seen = np.array(seen)
    return seen[np.isfinite(seen).all(axis=1)], found.GetNumberOfCells()  # a corner of a square of pixels may have no depth


def index_of(image, points):
    """Of points of an image: N x 3 whole numbers."""
    direction = np.array([[image.GetDirectionMatrix().GetElement(i, k) for k in range(3)] for i in range(3)])
    return np.rint((points - image.GetOrigin()) @ direction / image.GetSpacing()).astype(int)


skull = SkullPhantom(Spacing=[4, 4, 4])
depth_map = BSplineIsoRayCaster(Input=skull, IsoValues=[500], ViewDirection=[-0.3, 0.2, -0.9], PixelSpacing=2)
sweep = PhantomSweep(NumberOfSlices=12)
part = ExtractSubset(Input=sweep, VOI=[60, 250, 30, 200, 3, 9])  # its numbers do not begin at 0
for source, places, kind in ((depth_map, on_map, "Relief in Space"), (sweep, on_slices, "Slices in Space"), (part, on_slices, "Slices in Space")):
    view = CreateRenderView()
    view.ViewSize = [600, 600]
    window.show(source, view)
    assert GetDisplayProperties(source, view).Representation == kind
    ResetCamera(view)
    Render(view)
    seen, count = select(source, view, places, SelectSurfacePoints)
    assert count >= 10, count
    assert (seen > LOW - 6).all() and (seen < HIGH + 6).all(), (seen.min(0), seen.max(0))  # neighbours are 5 pixels apart
    seen, count = select(source, view, places, SelectSurfaceCells)
    # cells reach beyond the rectangle, those of a stack to the next slice
    inside = (seen > LOW - 15).all(axis=1) & (seen < HIGH + 15).all(axis=1)
    print(f"{kind}: {count} cells, {inside.mean():.2f} of their points under the mouse")
    assert count >= 5 and inside.mean() >= (0.99 if places is on_map else 0.45), (count, inside.mean(), seen)
