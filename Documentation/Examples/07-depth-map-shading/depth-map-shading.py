# SPDX-License-Identifier: BSD-3-Clause
"""The shadings of Depth Map Shader side by side, as in Carr 1996, figures 3.6 and 3.10.

    pvpython depth-map-shading.py [folder for the pictures, default: .] [CT of a head, default: Skull Phantom]

shadings: depth only, stored normals, central differences, nine cases. edge: an occluding edge by stored normals,
central differences, Gordon's weights, nine cases. lights: Phong with depth cue, one light from the upper left with
shadows, two lights with shadows. opened: the calotte cut away; light from the upper left with the calotte's shadow,
without it, a lamp inside the skull. tears: Depth Map Surface from a side, joined everywhere and torn at discontinuities.
"""
import os
import sys

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna.pictures import BONE, mark_pixels, new_view, read_pixels, shaded_pixels, show_surface, side_by_side, write_pixels
from lacuna.views import in_patient_coordinates, map_letters, show_orientation
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

UP = np.array([0.0, 0.0, 1.0])


def write(name, panels, depth_map=None):
    """One PNG of pictures (row, column, color) by their titles, side by side; row 0 on top.

    Framed by the patient's sides where the depth map that they show is known to be in patient coordinates.
    """
    image = depth_map and servermanager.Fetch(depth_map)
    if image and in_patient_coordinates(image):
        panels = {title: mark_pixels(pixels, map_letters(image)) for title, pixels in panels.items()}
    write_pixels(name, side_by_side(list(panels.items())))


def main(folder, head=None):
    os.makedirs(folder, exist_ok=True)
    if head:
        volume = OpenDataFile(head)  # its face is towards +y
        view = np.array([-0.35, -1, -0.15])
        edge = (0.56, 0.86, 0.1, 0.46)  # rows and columns of the map, as parts
    else:
        volume = SkullPhantom()
        view = np.array([-0.45, 0.35, -0.8])
        edge = (0.2, 0.5, 0.42, 0.72)
    depth_map = BSplineIsoRayCaster(Input=volume, IsoValues=[500], ViewDirection=view, ViewUp=UP, PixelSpacing=0.5)
    shader = DepthMapShader(Input=depth_map, Volume=volume)

    def picture(**properties):
        """Red, green and blue of the map's pixels that show something; row 0 on top."""
        for name, value in properties.items():
            setattr(shader, name, value)
        colors = shaded_pixels(shader)
        mask = vtk_to_numpy(servermanager.Fetch(shader).GetPointData().GetArray("vtkValidPointMask"))
        mask = mask.reshape(colors.shape[:2])
        rows, columns = (np.nonzero(mask.sum(axis=axis) > 20)[0] for axis in (1, 0))
        return colors[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1]

    def differences():
        """Degrees between the normals stored in the map and those that the last picture was made with."""
        degrees = vtk_to_numpy(servermanager.Fetch(shader).GetPointData().GetArray("NormalDifference"))
        return degrees[~np.isnan(degrees)]

    def enlarged(rgb, factor=4):
        height, width, _ = rgb.shape
        part = rgb[int(edge[0] * height):int(edge[1] * height), int(edge[2] * width):int(edge[3] * width)]
        return part.repeat(factor, axis=0).repeat(factor, axis=1)

    depth = picture(Shading="DepthOnly")
    shader.Shading = "Phong"
    shader.Specular = 0  # diffuse shading
    diffuse = {"Stored": picture(NormalMethod="Stored")}
    print("degrees from the stored normals: median, mean, part above 30")
    for method in ("CentralDifference", "Gordon", "Predicate"):
        diffuse[method] = picture(NormalMethod=method)
        degrees = differences()
        print(f"{method}: {np.median(degrees):.2f} {degrees.mean():.2f} {100 * (degrees > 30).mean():.2f} %")
    write(os.path.join(folder, "shadings.png"),
          {"Depth only": depth, "Stored normals": diffuse["Stored"],
           "Central differences": diffuse["CentralDifference"], "Nine cases (Predicate)": diffuse["Predicate"]},
          depth_map)
    titles = {"Stored": "Stored normals", "CentralDifference": "Central differences", "Gordon": "Gordon's weights",
              "Predicate": "Nine cases (Predicate)"}
    write(os.path.join(folder, "edge.png"), {titles[method]: enlarged(rgb) for method, rgb in diffuse.items()},
          depth_map)

    right = np.cross(view, UP)
    right /= np.linalg.norm(right)
    towards_viewer = -view / np.linalg.norm(view)
    upper_left = -0.8 * right + 0.8 * UP + 0.9 * towards_viewer
    lower_right = 0.9 * right - 0.2 * UP + 0.6 * towards_viewer
    lights = [picture(NormalMethod="Stored", Specular=0.2, DepthCue=0.7, SurfaceColor=[0.95, 0.9, 0.8]),
              picture(DepthCue=0, Lights=[*upper_left, 0, 1]),
              picture(Lights=[*upper_left, 0, 0.8, *lower_right, 0, 0.3])]
    write(os.path.join(folder, "lights.png"),
          dict(zip(("Phong, depth cue", "One light, shadows", "Two lights, shadows"), lights)), depth_map)

    # the calotte cut away; without its cut-away the shader does not know
    bounds = volume.GetDataInformation().GetBounds()
    middle = np.array([sum(bounds[a:a + 2]) / 2 for a in (0, 2, 4)])
    top = middle + [0, 0, 0.2 * (bounds[5] - bounds[4])]
    depth_map.ViewDirection = view + [0, 0, -0.9]
    depth_map.CutAway = "Plane"
    depth_map.CutAway.Origin, depth_map.CutAway.Normal = top, [0, 0, -1]
    opened = [picture(Lights=[*upper_left, 0, 1])]
    shader.CutAway = "Plane"
    shader.CutAway.Origin, shader.CutAway.Normal = top, [0, 0, -1]
    opened += [picture(), picture(Lights=[*middle, 1, 1, *towards_viewer, 0, 0.3])]
    write(os.path.join(folder, "opened.png"),
          dict(zip(("Shadow of what is cut away", "Cut away for the light too", "Lamp inside"), opened)), depth_map)
    assert opened[1].mean() > opened[0].mean() + 5, "less is in shadow"
    depth_map.CutAway = shader.CutAway = "None"
    depth_map.ViewDirection = view

    surface = DepthMapSurface(Input=depth_map)
    scene = new_view((480, 480))
    show_surface(surface, scene, BONE)
    scene.OrientationAxesVisibility = 0
    tears = []
    for joined in (True, False):
        surface.BreakAtDiscontinuities = not joined
        Render(scene)
        scene.CameraParallelProjection = 1
        aside = view / np.linalg.norm(view) + 0.9 * right
        scene.CameraFocalPoint = middle
        scene.CameraPosition = middle - 400 * aside
        scene.CameraViewUp = UP
        scene.CameraParallelScale = 0.37 * np.linalg.norm(np.subtract(bounds[1::2], bounds[::2]))
        if in_patient_coordinates(servermanager.Fetch(depth_map)):
            show_orientation(scene)
        Render(scene)
        name = os.path.join(folder, "tears.png")
        SaveScreenshot(name, scene, ImageResolution=scene.ViewSize)
        tears.append(read_pixels(name))
    write(os.path.join(folder, "tears.png"), dict(zip(("Joined everywhere", "Torn at discontinuities"), tears)))
    assert (tears[0] != tears[1]).any(axis=2).mean() > 0.01, "skins hide what is behind them"

    # a light takes from no pixel what it had
    assert depth.shape == diffuse["Stored"].shape == lights[0].shape
    assert (lights[2].astype(int) >= (0.8 * lights[1]).astype(int) - 1).all()


if __name__ == "__main__":
    main(*(sys.argv[1:] or ["."]))
