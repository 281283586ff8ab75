# SPDX-License-Identifier: BSD-3-Clause
"""Mirror on a skull with a defect on one side: the plane of symmetry, the mirror image, and where the two differ.

    pvpython mirror_image.py [folder for the picture, default: .] [CT of a head as .mha with its face towards +y, default: Skull Phantom]

mirror.png: the skull with its plane of symmetry; from the front, its mirror image in the same view, and given minus mirrored
depth, -4 mm (blue) to 4 mm (red), yellow where there is no counterpart. The patient's sides are marked, unless a file
does not tell them.
"""
import os
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna.pictures import BONE, METAL, color_bar, mark_pixels, new_view, read_pixels, show_surface, side_by_side, write_pixels
from lacuna.views import in_patient_coordinates, map_letters, show_orientation
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

LIMIT = 4  # mm
NOTHING = (250, 205, 60)  # where bone has no counterpart


def colors(values):
    """Blue below 0, grey at 0, red above; as far as LIMIT."""
    stops = np.array([[59, 76, 192], [221, 221, 221], [180, 4, 38]])
    return np.stack([np.interp(values, [-LIMIT, 0, LIMIT], stop) for stop in stops.T], axis=-1)


def pixels_of(image, name):
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetArray(name)).reshape(height, width)


def lit(image, base):
    """A depth map in colours (one for all, or one for each pixel), lit from the viewer; row 0 on top."""
    width, height, _ = image.GetDimensions()
    axis = np.array(image.GetFieldData().GetArray("ImageToWorld").GetTuple(0)).reshape(4, 4)[:3, 2]
    facing = -(vtk_to_numpy(image.GetPointData().GetNormals()).reshape(height, width, 3) @ (axis / np.linalg.norm(axis)))
    light = 0.55 + 0.45 * np.clip(facing, 0, 1)
    picture = np.broadcast_to(base, (height, width, 3)) * light[..., None]
    picture[np.isnan(pixels_of(image, "Depth"))] = 255
    return np.clip(picture, 0, 255).astype(np.uint8)


def show_plane(skull, origin, normal, size, viewer, letters):
    """The skull, cut by the plane, which ends a little outside of it."""
    view = new_view(size)
    view.OrientationAxesVisibility = 0
    view.BackgroundColorMode, view.Background = "Single Color", [1, 1, 1]
    show_surface(skull, view, BONE).Specular = 0
    skull.UpdatePipeline()
    bounds = np.array(skull.GetDataInformation().GetBounds()).reshape(3, 2)
    middle, half = bounds.mean(axis=1), 0.5 * (bounds[:, 1] - bounds[:, 0]) + 12
    middle -= (middle - origin) @ normal * np.array(normal)
    up = np.array([0, 0, 1.0]) - normal[2] * np.array(normal)
    along = half[1] * np.cross(normal, up) / np.linalg.norm(up)
    up *= half[2] / np.linalg.norm(up)
    show_surface(Plane(Origin=list(middle - along - up), Point1=list(middle + along - up),
                       Point2=list(middle - along + up)), view, METAL).Ambient = 0.4
    camera = view.GetActiveCamera()
    camera.SetFocalPoint(*middle)
    camera.SetPosition(*(middle + 500 * np.array(viewer)))
    camera.SetViewUp(0, 0, 1)
    view.CameraParallelProjection = 1
    ResetCamera(view)
    view.CameraParallelScale = 1.3 * half[2]
    if letters:
        show_orientation(view, font_size=13, force=True)  # the plane of symmetry has no mark
    return view


def main(folder, head=None):
    os.makedirs(folder, exist_ok=True)
    if head:
        volume, front = MetaFileSeriesReader(FileNames=[head]), [0, -1, 0]
    else:
        volume = SkullPhantom(Spacing=[1, 1, 1], DefectRadius=20, DefectDirection=[-0.8, -0.7, 0.05])
        front = [0, 1, 0]
    given = BSplineIsoRayCaster(Input=volume, IsoValues=[500], ViewDirection=front, ViewUp=[0, 0, 1], PixelSpacing=0.45)
    plane = Mirror(Input=volume)
    plane.UpdatePipeline()
    fields = servermanager.Fetch(plane).GetFieldData()
    origin, normal = (list(fields.GetArray("MirrorPlane" + name).GetTuple(0)) for name in ("Origin", "Normal"))
    print("plane", origin, normal, "score", fields.GetArray("SymmetryScore").GetTuple1(0),
          "ambiguity", fields.GetArray("SymmetryAmbiguity").GetTuple1(0))
    mirror = Mirror(Input=given, PlaneMethod="Given", Origin=origin, Normal=normal)
    mirror.UpdatePipeline()
    skull, image = servermanager.Fetch(given), servermanager.Fetch(mirror)
    letters = map_letters(skull) if in_patient_coordinates(skull) else None

    asymmetry = pixels_of(image, "Asymmetry")
    both = ~np.isnan(asymmetry)
    tinted = colors(np.where(both, asymmetry, 0))
    tinted[~both] = NOTHING
    bone = 255 * np.array(BONE)
    panels = {"Given": lit(skull, bone), "Mirror image: a pattern, not the patient": lit(image, bone),
              "Given minus mirrored depth": lit(skull, tinted)}
    known = ~np.isnan(pixels_of(skull, "Depth"))
    rows, columns = (np.nonzero(known.any(axis=axis))[0] for axis in (1, 0))
    part = slice(max(rows[0] - 4, 0), rows[-1] + 5), slice(max(columns[0] - 4, 0), columns[-1] + 5)
    panels = {title: pixels[part] for title, pixels in panels.items()}
    if letters:
        panels = {title: mark_pixels(pixels, letters) for title, pixels in panels.items()}
    height = next(iter(panels.values())).shape[0]
    name = os.path.join(folder, "mirror.png")
    name_of_greys = servermanager.Fetch(volume).GetPointData().GetScalars().GetName()
    surface = Contour(Input=volume, ContourBy=["POINTS", name_of_greys], Isosurfaces=[500])
    view = show_plane(surface, origin, normal, (height, height), [-0.5, -0.8 * front[1], 0.25], letters)
    SaveScreenshot(name, view, ImageResolution=view.ViewSize)
    panels = [("Plane of symmetry", read_pixels(name)), *panels.items(),
              ("", color_bar(colors, -LIMIT, LIMIT, "mm", height))]
    write_pixels(name, side_by_side(panels, gap=24))

    if letters:
        # The left side is the larger one: what the right one makes of it lies deeper, and left is on the right here.
        assert letters["left"] == "R" and letters["right"] == "L", letters
        half = asymmetry.shape[1] // 2
        assert np.nanmedian(asymmetry[:, :half]) > 0 > np.nanmedian(asymmetry[:, half:])
    assert image.GetFieldData().GetArray("Mirrored").GetTuple1(0) == 1


if __name__ == "__main__":
    main(*(sys.argv[1:] or ["."]))
