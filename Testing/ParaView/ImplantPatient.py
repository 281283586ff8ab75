# SPDX-License-Identifier: BSD-3-Clause
"""An implant for a hole of 70 mm that is cut into a patient's skull (Debian package invesalius-examples): the command gets the whole
CT and a point in the hole, and the bone that was cut out shows how far the implant is off.
"""
import os
import plistlib
import sys
import tarfile

import lacuna.plugin
import numpy as np
from lacuna import implant
from lacuna_test import SKIPPED, output
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkStaticCellLocator
from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkFeatureEdges, vtkFlyingEdges3D
from vtkmodules.vtkIOGeometry import vtkSTLReader

PROJECT = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3"
LEVEL, TISSUE = 300, 40  # Hounsfield units
CENTER = np.array([124, 104, 71])  # mm, about the middle of the vault; the file has the face at +y and the crown at +z
AXIS = np.array([-0.75, -0.05, 0.65]) / np.linalg.norm([0.75, 0.05, 0.65])
ANGLE = np.radians(24)
RAYS = 0.5  # mm between rays, at the bone
BLURRED = 2  # mm from the edge of the hole: bone that the cut has blurred is not compared

if not os.path.exists(PROJECT):
    print(f"skipped: {PROJECT} is not there (Debian: invesalius-examples)", flush=True)
    sys.exit(SKIPPED)
lacuna.plugin.load()

# The CT in the project: a property list beside voxels
with tarfile.open(PROJECT) as project:
    folder = project.getmembers()[0].name.split("/")[0]
    matrix = plistlib.load(project.extractfile(f"{folder}/main.plist"))
    spacing = np.array(matrix["spacing"])
    voxels = np.frombuffer(project.extractfile(f"{folder}/{matrix['matrix']['filename']}").read(), matrix["matrix"]["dtype"])
    voxels = voxels.reshape(matrix["matrix"]["shape"])  # by k, j, i

# The hole: bone in a cone becomes tissue
across = np.cross(AXIS, [0, 1, 0])
across /= np.linalg.norm(across)
aside = np.cross(AXIS, across)
k, j, i = np.indices(voxels.shape)
ray = np.stack([i, j, k], -1) * spacing - CENTER
angle = np.arccos(np.clip(ray @ AXIS / np.maximum(np.linalg.norm(ray, axis=-1), 1e-9), -1, 1))
bone = np.clip(0.5 + (angle - ANGLE) * np.linalg.norm(ray, axis=-1) / 1.5, 0, 1)  # the edge is about a voxel wide
cut = np.where(voxels > TISSUE, TISSUE + bone * (voxels - TISSUE), voxels).round().astype("<i2")
folder = output("ImplantPatient")
os.makedirs(folder, exist_ok=True)
ct, stl = os.path.join(folder, "cut.mha"), os.path.join(folder, "implant.stl")
header = ["ObjectType = Image", "NDims = 3", "DimSize = {} {} {}".format(*voxels.shape[::-1]), "Offset = 0 0 0",
          "ElementSpacing = {} {} {}".format(*spacing), "ElementType = MET_SHORT", "ElementDataFile = LOCAL"]
with open(ct, "wb") as file:
    file.write(("\n".join(header) + "\n").encode() + cut.tobytes())

# The implant
said = []
implant._say = lambda text: (said.append(text), print(text, flush=True))
assert implant.main([ct, "--output", stl, "--hole", *map(str, CENTER + 85 * AXIS)]) == 0
reader = vtkSTLReader()
reader.SetFileName(stl)
solid = vtkCleanPolyData()
solid.SetInputConnection(reader.GetOutputPort())
edges = vtkFeatureEdges()
edges.SetInputConnection(solid.GetOutputPort())
edges.FeatureEdgesOff()
edges.NonManifoldEdgesOn()
edges.Update()
assert solid.GetOutput().GetNumberOfCells() > 1000 and edges.GetOutput().GetNumberOfCells() == 0, "the implant is not closed"

# The bone that was there, and what is left of it
image = vtkImageData()
image.SetDimensions(voxels.shape[::-1])
image.SetSpacing(spacing)
image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel(), deep=True))
surface = vtkFlyingEdges3D()
surface.SetInputData(image)
surface.SetValue(0, LEVEL)
surface.Update()


def tables(data, directions):
    """Radii at which rays leave and enter a surface: the outermost crossing, and the innermost within 20 mm of it; NaN without one."""
    tree = vtkStaticCellLocator()
    tree.SetDataSet(data)
    tree.BuildLocator()
    points, cells = vtkPoints(), vtkIdList()
    points.SetDataTypeToDouble()
    radii = np.full((len(directions), 2), np.nan)
    for n, direction in enumerate(directions):
        tree.IntersectWithLine(CENTER + 110 * direction, CENTER + 40 * direction, 0, points, cells)
        found = np.array([np.linalg.norm(points.GetPoint(p) - CENTER) for p in range(points.GetNumberOfPoints())])
        if len(found) > 1:
            radii[n] = found.max(), found[found > found.max() - 20].min()
    return radii.T


def directions(least, most):
    """Of a regular grid, with angles from the axis of the hole; and the solid angle of each."""
    step = RAYS / 85
    x = np.arange(-most, most, step)
    a, b = (each.ravel() for each in np.meshgrid(x, x))
    angle, turn = np.hypot(a, b), np.arctan2(b, a)
    rays = np.outer(np.cos(angle), AXIS) + np.sin(angle)[:, None] * (np.outer(np.cos(turn), across) + np.outer(np.sin(turn), aside))
    inside = (angle >= least) & (angle < most)
    return rays[inside], step ** 2 * (np.sin(angle) / np.maximum(angle, 1e-9))[inside]


rays, _ = directions(0, ANGLE - BLURRED / 85)
outer, inner = tables(surface.GetOutput(), rays)
made, back = tables(solid.GetOutput(), rays)
truth, covered = np.isfinite(outer), np.isfinite(outer) & np.isfinite(made)
diameter = 2 * np.tan(ANGLE) * np.median(outer[truth])
off = (made - outer)[covered]
thickness = (made - back - outer + inner)[covered]
rms, largest, thickness = np.sqrt(np.mean(off ** 2)), np.abs(off).max(), np.sqrt(np.mean(thickness ** 2))
part = covered.sum() / truth.sum()
rays, share = directions(ANGLE + 0.5 / 85, ANGLE + 12 / 85)
(outer, inner), (made, back) = tables(surface.GetOutput(), rays), tables(solid.GetOutput(), rays)
depth = np.nan_to_num(np.minimum(made, outer) - np.maximum(back, inner))
intrusion = (np.where(depth > 0.1, depth, 0) * np.nan_to_num(outer) ** 2 * share).sum()
print(f"{diameter:.0f} mm across: outer RMS {rms:.3f} mm, largest {largest:.2f}; thickness RMS {thickness:.2f}; covered {part:.4f}; "
      f"{intrusion:.1f} mm^3 in bone", flush=True)
assert truth.mean() > 0.98 and 65 < diameter < 85, (truth.mean(), diameter)
assert rms <= 0.5 and largest <= 2, (rms, largest)
assert thickness <= 0.85 and part >= 0.985 and intrusion <= 20, (thickness, part, intrusion)
