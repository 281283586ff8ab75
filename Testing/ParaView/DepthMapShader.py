# SPDX-License-Identifier: BSD-3-Clause
"""The proxy Depth Map Shader on the skull phantom: defaults, lights from scripts, shadows, colours on the surface."""
import math
import os

from paraview import servermanager
from paraview.simple import *

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
import lacuna  # after the plugin: the wrapped classes, for the C++ defaults
from lacuna import pictures, views
from lacuna_test import output
from vtkmodules.vtkIOImage import vtkPNGReader

skull = SkullPhantom(Spacing=[2, 2, 2.3])
depth_map = BSplineIsoRayCaster(Input=skull, IsoValues=[500], ViewDirection=[0, 1, -0.2], ViewUp=[0, 0, 1],
                                PixelSpacing=2)
shader = DepthMapShader(Input=depth_map)
algorithm = lacuna.vtkLacunaDepthMapShader()
for name in ("MaximumAngle", "MaximumAngleChange", "Ambient", "Diffuse", "Specular", "SpecularPower", "DepthCue",
             "SurfaceColor", "BackgroundColor", "CastShadows", "CapCutAway", "CapBoundary", "ShadowBias"):
    shown, actual = getattr(shader, name), getattr(algorithm, "Get" + name)()
    assert (tuple(shown) if hasattr(shown, "__len__") else shown) == actual, name
assert shader.DepthArray == algorithm.GetDepthArray() == "Depth"
assert shader.VolumeArray == algorithm.GetVolumeArray() == ""
enumerations = {"NormalMethod": "Stored", "Shading": "Phong", "DepthLaw": "InverseSquare", "Interpolation": "BSpline",
                "SolidSide": "Above"}
for name, text in enumerations.items():
    assert getattr(shader, name) == text, name
    assert getattr(algorithm, "Get" + name)() == 0, name
assert type(shader.CutAway).__name__ == "None" and algorithm.GetCutAway() is None
assert list(shader.Lights) == [] and algorithm.GetNumberOfLights() == 0


def picture(**properties):
    for name, value in properties.items():
        setattr(shader, name, value)
    shader.UpdatePipeline()
    return servermanager.Fetch(shader)


def mean(image, component=0, columns=(0, 1)):
    """Of the pixels that have a depth, within a part of the columns."""
    width = image.GetDimensions()[0]
    data = image.GetPointData()
    colors, mask = data.GetArray("Color"), data.GetArray("vtkValidPointMask")
    chosen = [colors.GetComponent(i, component) for i in range(image.GetNumberOfPoints())
              if mask.GetTuple1(i) and columns[0] <= i % width / width < columns[1]]
    return sum(chosen) / len(chosen)


front = picture()
scalars = front.GetPointData().GetScalars()
assert scalars.GetName() == "Color" and scalars.GetNumberOfComponents() == 3
assert scalars.GetDataTypeAsString() == "unsigned char"
assert 60 < mean(front) < 230, mean(front)

# each method gives another picture; NormalDifference says by how many degrees the normals differ
darkest = {}
for method in ("CentralDifference", "Gordon", "Predicate"):
    image = picture(NormalMethod=method)
    difference = image.GetPointData().GetArray("NormalDifference")
    values = [difference.GetTuple1(i) for i in range(image.GetNumberOfPoints())]
    known = [v for v in values if not math.isnan(v)]
    assert len(known) == sum(image.GetPointData().GetArray("vtkValidPointMask").GetTuple1(i)
                             for i in range(image.GetNumberOfPoints()))
    assert max(known) <= 180 and sorted(known)[len(known) // 2] < 5, sorted(known)[len(known) // 2]
    darkest[method] = sum(known) / len(known)
print("mean degrees from the stored normals:", darkest)
assert darkest["Predicate"] < darkest["CentralDifference"], darkest

# light from the viewer's right: the map looks along +y with z up, so right is +x
right = picture(NormalMethod="Stored", Specular=0, Lights=[1, 0, 0, 0, 1])
assert mean(right, columns=(0.5, 1)) > 2 * mean(right, columns=(0, 0.5)), "light from the right"
left = picture(Lights=[-1, 0, 0, 0, 1])
assert mean(left, columns=(0, 0.5)) > 2 * mean(left, columns=(0.5, 1)), "light from the left"
both = picture(Lights=[1, 0, 0, 0, 1, -1, 0, 0, 0, 1])
assert abs(mean(both) - (mean(left) + mean(right) - 25.5)) < 2, "lights add up"
lamp = picture(Lights=[300, -300, 0, 1, 0.5])
assert mean(lamp, columns=(0.5, 1)) > mean(lamp, columns=(0, 0.5))

# with the volume, the rim of the hole throws its shadow into the skull; light from the viewer's left
depth_map.ViewDirection = [-0.4, 0.2, -0.9]
slanting = picture(Lights=[-2.0, -1.0, 2.5, 0, 1])
shaded = picture(Volume=skull)
columns, rows, _ = shaded.GetDimensions()
before, after = (image.GetPointData().GetArray("Color") for image in (slanting, shaded))
darker = [i for i in range(columns * rows) if after.GetComponent(i, 0) < before.GetComponent(i, 0)]
assert not any(after.GetComponent(i, 0) > before.GetComponent(i, 0) for i in range(columns * rows))
print(len(darker), "pixels in shadow")
assert 150 < len(darker) < 0.2 * columns * rows, len(darker)
off = picture(CastShadows=0)
assert mean(off) == mean(slanting)

# what is cut away throws no shadow, if the shader is told; lamps may stand inside the skull
shader.CastShadows = 1
depth_map.CutAway = "Plane"
depth_map.CutAway.Origin, depth_map.CutAway.Normal = [0, 0, 0], [0, 0, -1]
unaware = mean(picture(Specular=0))
shader.CutAway = "Plane"
shader.CutAway.Origin, shader.CutAway.Normal = [0, 0, 0], [0, 0, -1]
aware = mean(picture())
print("mean brightness inside an opened skull:", unaware, "with the calotte's shadow,", aware, "without it")
assert aware > unaware + 10, (aware, unaware)
off = mean(picture(CastShadows=0))
assert aware < off, "the side of the skull throws its shadow still"
depth_map.CutAway = shader.CutAway = "None"
inside = mean(picture(CastShadows=1, Lights=[0, 0, 0, 1, 1]))
assert inside > 25.5, "a lamp in the skull shows through its hole"

# the depth cue darkens what is far, and colours are colours
cue = picture(Lights=[], DepthCue=1, SurfaceColor=[1, 0.5, 0])
plain = picture(DepthCue=0)
assert mean(cue) < mean(plain) - 20 and mean(plain, 2) == 0 and abs(mean(plain, 1) - 0.5 * mean(plain)) < 1
only = picture(Shading="DepthOnly", SurfaceColor=[1, 1, 1])
near_far = [only.GetPointData().GetArray("Color").GetComponent(i, 0) for i in range(only.GetNumberOfPoints())
            if only.GetPointData().GetArray("vtkValidPointMask").GetTuple1(i)]
assert 0 < min(near_far) < max(near_far) < 255, "the skull lies within the sphere around its volume"

# the surface has the same colours
picture(Shading="Phong", Specular=0.2)
surface = DepthMapSurface(Input=shader)
surface.UpdatePipeline()
mesh = servermanager.Fetch(surface)
assert mesh.GetPointData().GetScalars().GetName() == "Color"
image = servermanager.Fetch(shader)
ids, colors = mesh.GetPointData().GetArray("PixelId"), mesh.GetPointData().GetArray("Color")
for i in range(0, mesh.GetNumberOfPoints(), 97):
    assert colors.GetTuple3(i) == image.GetPointData().GetArray("Color").GetTuple3(int(ids.GetTuple1(i)))
view = CreateView("RenderView")
view.ViewSize = [500, 500]
view.UseColorPaletteForBackground = 0
view.Background = [0, 0, 0]
view.OrientationAxesVisibility = 0


def compare(what, name, size, colors):
    """That a screenshot, four pixels for each of the map's, looks like the map's colours and not like their mirror image."""
    reader = vtkPNGReader()
    reader.SetFileName(name)
    reader.Update()
    seen = reader.GetOutput().GetPointData().GetScalars()
    width, height, _ = reader.GetOutput().GetDimensions()
    assert (width, height) == (4 * size[0], 4 * size[1]), (width, height)
    differences, upside_down, swapped = [], [], []
    for row in range(2, size[1] - 2, 3):
        for column in range(2, size[0] - 2, 3):
            expected = colors.GetComponent(column + size[0] * row, 0)
            x, y = 4 * column + 2, height - 1 - (4 * row + 2)
            if expected > 0:
                for found, i, j in ((differences, x, y), (upside_down, x, height - 1 - y), (swapped, width - 1 - x, y)):
                    found.append(abs(seen.GetComponent(i + width * j, 0) - expected))
    medians = [sorted(found)[len(found) // 2] for found in (differences, upside_down, swapped)]
    print(what, "against the picture: median difference", medians[0], "if mirrored", medians[1:])
    assert len(differences) > 300 and medians[0] <= 2 < 10 < min(medians[1:]), what


# seen along the map's own rays, the surface and the map look like the picture
size = image.GetDimensions()
middle = [(a + b) / 2 for a, b in zip(image.GetPoint(0), image.GetPoint(image.GetNumberOfPoints() - 1))]
direction = [-0.4, 0.2, -0.9]
map_colors = image.GetPointData().GetArray("Color")
for proxy in (surface, shader):
    pictures.show_shaded(proxy, view)
    Render(view)  # the first one resets the camera
    view.CameraParallelProjection = 1
    view.CameraFocalPoint = [m + 100 * d for m, d in zip(middle, direction)]
    view.CameraPosition = [m - 100 * d for m, d in zip(middle, direction)]
    view.CameraViewUp = [0, 0, 1]
    view.ViewSize = [4 * size[0], 4 * size[1]]
    view.CameraParallelScale = size[1]  # half of the height, at 2 mm for each pixel
    Render(view)
    name = output(f"DepthMapShader{proxy.GetXMLLabel().split()[-1]}.png")
    SaveScreenshot(name, view, ImageResolution=view.ViewSize)
    compare(proxy.GetXMLLabel(), name, size, map_colors)
    Hide(proxy, view)

# the same in perspective: the map takes the camera over, and its surface looks like its picture
view.CameraParallelProjection, view.ViewSize = 0, [800, 640]
view.CameraPosition, view.CameraViewAngle = [m - 330 * d + 40 for m, d in zip(middle, direction)], 40
views.copy_camera(depth_map, view, rows=160)
picture(Lights=[-2.0, -1.0, 2.5, 0, 1])
Show(surface, view)
pictures.show_shaded(surface, view)
Render(view)
name = output("DepthMapShaderPerspective.png")
SaveScreenshot(name, view, ImageResolution=view.ViewSize)
seen_in_perspective = servermanager.Fetch(shader)
assert seen_in_perspective.GetFieldData().GetArray("EyePosition") is not None
compare("in perspective, the surface", name, seen_in_perspective.GetDimensions(),
        seen_in_perspective.GetPointData().GetArray("Color"))

# a file shows what the viewer sees: row 0 of the map on top (VTK counts a picture's rows from below)
pictures.save_shaded(shader, output("DepthMapShader.png"))
reader = vtkPNGReader()
reader.SetFileName(output("DepthMapShader.png"))
reader.Update()
file = reader.GetOutput()
width, height, _ = file.GetDimensions()
image = servermanager.Fetch(shader)
map_colors = image.GetPointData().GetArray("Color")
assert (width, height, 1) == image.GetDimensions()
assert all(file.GetPointData().GetScalars().GetTuple3(column + width * (height - 1 - row)) ==
           map_colors.GetTuple3(column + width * row)
           for row in range(0, height, 3) for column in range(0, width, 3))
print("ok")
