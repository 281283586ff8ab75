# SPDX-License-Identifier: BSD-3-Clause
"""The letters at the edges of pictures: known cameras give known letters, and what is drawn lies where they say."""
import os
import tempfile

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna import pictures, views
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkIOImage import vtkPNGReader
from vtkmodules.vtkRenderingCore import vtkCamera

EDGES = ("left", "right", "top", "bottom")


def check(holds, message):
    assert holds, message


def camera_towards(direction, up):
    camera = vtkCamera()
    camera.SetPosition(0, 0, 0)
    camera.SetFocalPoint(*direction)
    camera.SetViewUp(*up)
    return camera


def letters(direction, up, roll=0):
    camera = camera_towards(direction, up)
    camera.Roll(roll)
    return " ".join(views.camera_letters(camera)[edge] for edge in EDGES)


# direction, up: left, right, top, bottom. From the front, the patient's left is on the right.
KNOWN = {
    ((0, 1, 0), (0, 0, 1)): "R L H F",    # from the front
    ((0, -1, 0), (0, 0, 1)): "L R H F",   # from the back
    ((-1, 0, 0), (0, 0, 1)): "A P H F",   # from the patient's left
    ((1, 0, 0), (0, 0, 1)): "P A H F",    # from the patient's right
    ((0, 0, -1), (0, -1, 0)): "L R A P",  # from above
    ((0, 0, 1), (0, -1, 0)): "R L A P",   # from below: an axial slice as radiologists see it
}
for (direction, up), expected in KNOWN.items():
    check(letters(direction, up) == expected, f"{direction}: {letters(direction, up)}, not {expected}")

# roll turns the camera, so the picture the other way round
check(letters((0, 1, 0), (0, 0, 1), 90) in ("H F L R", "F H R L"), "a roll of 90 degrees")
check(letters((0, 1, 0), (0, 0, 1), 180) == "L R F H", "upside down")
check(letters((0, 1, 0), (0, 0, 1), 10) == "R L H F", "ten degrees are an axis still")
check(sorted(letters((0, 1, 0), (0, 0, 1), 40).split()[1]) == sorted("LH")
      or sorted(letters((0, 1, 0), (0, 0, 1), 40).split()[1]) == sorted("LF"), "40 degrees are between")

# oblique: right = (1, -1, 0) / sqrt 2 of a look along (1, 1, 0)
check(letters((1, 1, 0), (0, 0, 1)).split()[:2] in (["RP", "LA"], ["PR", "AL"]), letters((1, 1, 0), (0, 0, 1)))
check(letters((1, 2, 0), (0, 0, 1)).split()[:2] == ["RP", "LA"], letters((1, 2, 0), (0, 0, 1)))
check(letters((2, 1, 0), (0, 0, 1)).split()[:2] == ["PR", "AL"], letters((2, 1, 0), (0, 0, 1)))
check(letters((1, 6, 0), (0, 0, 1)) == "R L H F", "9.5 degrees")
check(views.direction_letters((3, 2, -2.5)) == "LFP", "three letters, nearest first")
for bad in ((0, 0, 0), (np.nan, 0, 1), (1, 0)):
    try:
        views.direction_letters(bad)
        check(False, f"{bad} is taken for a direction")
    except ValueError:
        pass

# a camera that mirrors tells so
camera = camera_towards((0, 1, 0), (0, 0, 1))
mirror = vtkTransform()
mirror.Scale(-1, 1, 1)
camera.SetUserViewTransform(mirror)
check([views.camera_letters(camera)[edge] for edge in EDGES] == ["L", "R", "H", "F"], "a mirrored camera")

# what is drawn: balls on the three axes, seen from five sides and obliquely, lie where the letters say
BALLS = {"L": ((40, 0, 0), (1, 0, 0)), "A": ((0, -40, 0), (0, 1, 0)), "H": ((0, 0, 40), (0, 0, 1))}
OPPOSITE = dict(zip("LRAPHF", "RLPAFH"))
view = pictures.new_view((400, 400))
view.OrientationAxesVisibility = 0
for center, color in BALLS.values():
    display = pictures.show_surface(Sphere(Center=center, Radius=8), view, color)
    display.Ambient, display.Diffuse, display.Specular = 1, 0, 0


def look(direction, up):
    pictures.look(view, direction, up)
    camera = view.GetActiveCamera()
    camera.SetFocalPoint(0, 0, 0)
    camera.SetPosition(*(-200 * np.array(direction) / np.linalg.norm(direction)))
    camera.SetParallelScale(60)


def render():
    name = os.path.join(tempfile.gettempdir(), f"lacuna-marks-{os.getpid()}.png")
    pictures.save(view, name)
    reader = vtkPNGReader()
    reader.SetFileName(name)
    reader.Update()
    os.remove(name)
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[..., :3].astype(float) / 255


def texts(window):
    return [each for each in window.Representations if each.Input is not None and each.Input.GetXMLName() == "TextSource"]


def shown():
    """Texts in the window by the edge that they stand at."""
    found = {}
    for display in texts(view):
        if display.Visibility:
            x, y = display.Position
            edge = ("left" if x < 0.2 else "right" if x > 0.8 else "") or ("bottom" if y < 0.5 else "top")
            found[edge] = display.Input.Text
    return found


def check_balls(what):
    pixels = render()
    marks = shown()
    check(sorted(marks) == sorted(EDGES), f"{what}: marks at {sorted(marks)}")
    for letter, (_, color) in BALLS.items():
        mask = (np.abs(pixels - np.array(color)) < 0.2).all(axis=2)
        if mask.sum() < 20:
            continue  # behind another
        y, x = np.argwhere(mask).mean(axis=0) - 199.5
        for edge, offset in (("right", x), ("left", -x), ("top", y), ("bottom", -y)):
            if letter in marks[edge]:
                check(offset > 20, f"{what}: {letter} is marked {edge}, but its ball lies {offset:.0f} pixels there")
            elif OPPOSITE[letter] in marks[edge]:
                check(offset < -20, f"{what}: {letter} is not where {marks[edge]} is marked")


look((0, 1, 0), (0, 0, 1))
check(views.show_orientation(view, force=True) == {"left": "R", "right": "L", "top": "H", "bottom": "F"}, "marks from the front")
for direction, up in KNOWN:
    look(direction, up)
    check_balls(f"{direction}")
for direction, up, roll in (((1, 1, 0), (0, 0, 1), 0), ((-1, 2, -1), (0, 0, 1), 35), ((0.3, -1, 0.4), (1, 0, 1), -70)):
    look(direction, up)
    view.GetActiveCamera().Roll(roll)  # the marks follow
    check_balls(f"{direction} rolled by {roll}")
view.GetActiveCamera().SetUserViewTransform(mirror)
check_balls("mirrored")
view.GetActiveCamera().SetUserViewTransform(None)

# again replaces, hide takes away
views.show_orientation(view, font_size=24, force=True)
check(len(shown()) == 4 and len(texts(view)) == 4, "no marks twice")

# letters that do not follow the camera would lie: they are not in state files, and can be shown again after loading one
look((0, 1, 0), (0, 0, 1))
check(len(GetSources()) == len(BALLS), "letters are not in the pipeline")
before = GetRenderViews()
for ending in (".pvsm", ".py"):
    state = os.path.join(tempfile.gettempdir(), f"lacuna-marks-{os.getpid()}{ending}")
    SaveState(state)
    with open(state, encoding="utf-8") as file:
        content = file.read()
    check("TextSource" not in content and "Text(" not in content, f"letters in a state file ({ending})")
    if ending == ".pvsm":
        LoadState(state)
    os.remove(state)
loaded, = [each for each in GetRenderViews() if each not in before]
check(len(loaded.Representations) == len(BALLS) and not texts(loaded), "letters come back with a state file")
pictures.look(loaded, (0, -1, 0), (0, 0, 1))
check(views.show_orientation(loaded, force=True) == {"left": "L", "right": "R", "top": "H", "bottom": "F"}, "marks from behind")
check(sorted(each.Input.Text for each in texts(loaded)) == list("FHLR") and shown()["left"] == "R", "marks of two views")
views.hide_orientation(loaded)
check(not texts(loaded) and len(shown()) == 4, "hidden in one of two views")
Delete(loaded)

marked = render()
views.hide_orientation(view)
check(not shown() and not texts(view), "hidden")
ink = (render() - marked > 0.3).all(axis=2)
strips = (ink[190:210, :40], ink[190:210, -40:], ink[:30, 180:220], ink[-30:, 180:220])
check(all(20 < strip.sum() for strip in strips) and ink.sum() == sum(strip.sum() for strip in strips),
      "the letters have gone from the picture, and nothing else")
views.show_patient_axes(view, force=True)
check(view.AxesGrid.Visibility and view.AxesGrid.XTitle == "R to L, mm", "titles of the axes")
check(view.AxesGrid.YTitle == "A to P, mm" and view.AxesGrid.ZTitle == "F to H, mm", "titles of the axes")

# a depth map has the letters of a camera that looks as it does, and its pixels lie there
skull = SkullPhantom(Spacing=[4, 4, 4])
for direction, up in ((0, 1, 0), (0, 0, 1)), ((-1, 0.2, -0.1), (0, 0.1, 1)), ((1, 1, -1), (1, 0, 1)):
    depth = BSplineIsoRayCaster(Input=skull, IsoValues=[500], ViewDirection=direction, ViewUp=up)
    image = servermanager.Fetch(depth)
    found = views.map_letters(image)
    check(" ".join(found[edge] for edge in EDGES) == letters(direction, up), f"depth map along {direction}: {found}")
    width, height, _ = image.GetDimensions()
    corner, right, down = (np.array(image.GetPoint(k)) for k in (0, width - 1, (height - 1) * width))
    check(found["right"] == views.direction_letters(right - corner), "the last column is on the right")
    check(found["bottom"] == views.direction_letters(down - corner), "the last row is at the bottom")
try:
    views.map_letters(servermanager.Fetch(skull))
    check(False, "a volume is no depth map")
except ValueError:
    pass

# what is not known to be the patient's gets no letters
def refused(what, mark, *arguments):
    try:
        mark(*arguments)
    except ValueError as error:
        check("force=True" in str(error), str(error))
        mark(*arguments, force=True)
        return
    check(False, f"letters for {what}")


front = dict(IsoValues=[500], ViewDirection=[0, 1, 0], ViewUp=[0, 0, 1], PixelSpacing=2)
known = DepthMapSurface(Input=BSplineIsoRayCaster(Input=skull, **front))
mirrored = BSplineIsoRayCaster(Input=Mirror(Input=skull, PlaneMethod="Given", Origin=[0, 0, 0], Normal=[1, 0, 0]), **front)
above = BSplineIsoRayCaster(Input=SkullPhantom(Spacing=[2, 2, 2]), IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9])
press = PressOrientation(Input=RBFHoleFiller(Input=above, Smoothing=5, OutputMargin=25))
view = pictures.new_view((300, 200))
pictures.color_by(pictures.show_surface(known, view, pictures.BONE), view, "Depth", "mm", (0, 9))
pictures.add_title(view, "known")
pictures.look(view, (0, 1, 0), (0, 0, 1))
pictures.add_scale_bar(view, 20)
check(len(views.show_orientation(view)) == 4, "a known surface, beside a scalar bar, a title and a scale bar")
views.show_patient_axes(view)
for what, source in (("a mould", press), ("a moved surface", Reflect(Input=known)), ("no patient", Wavelet()),
                     ("a mirror image", DepthMapSurface(Input=mirrored))):
    display = Show(source, view)
    refused(what, views.show_orientation, view)
    refused(what, views.show_patient_axes, view)
    display.Visibility = 0
    check(len(views.show_orientation(view)) == 4, f"{what}, hidden")
    Delete(source)
mirrored.UpdatePipeline()
refused("a mirrored map", views.map_letters, mirrored)
refused("a mirrored map's data", views.map_letters, servermanager.Fetch(mirrored))
shaded = DepthMapShader(Input=mirrored)
name = os.path.join(tempfile.gettempdir(), f"lacuna-shaded-{os.getpid()}.png")
try:
    pictures.save_shaded(shaded, name, marks=True)
    check(False, "a mirrored picture")
except ValueError:
    check(not os.path.exists(name), "a picture beside an error")
pictures.save_shaded(shaded, name)
plain = pictures.read_pixels(name).shape
shaded.Input = BSplineIsoRayCaster(Input=skull, **front)
pictures.save_shaded(shaded, name, marks=True)
check(pictures.read_pixels(name).shape[1] > plain[1], "the frame")
os.remove(name)

# the letters get onto the picture, and the picture is not moved
picture = np.full((60, 90, 3), 200, dtype=np.uint8)
picture[5, 80] = (255, 0, 0)
framed = pictures.mark_pixels(picture, {"left": "R", "right": "LA", "top": "H", "bottom": "F"})
margin = (framed.shape[0] - 60) // 2
check(framed.shape == (60 + 2 * margin, 90 + 2 * margin, 3), "the frame")
check((framed[margin:-margin, margin:-margin] == picture).all(), "the picture in its frame")
middle = framed.shape[0] // 2
ink = {"left": framed[middle - 10:middle + 10, :margin], "right": framed[middle - 10:middle + 10, -margin:],
       "top": framed[:margin, framed.shape[1] // 2 - 10:framed.shape[1] // 2 + 10],
       "bottom": framed[-margin:, framed.shape[1] // 2 - 10:framed.shape[1] // 2 + 10]}
dark = {edge: int((part < 128).all(axis=2).sum()) for edge, part in ink.items()}
check(min(dark.values()) > 10 and dark["right"] > dark["left"], f"letters in the frame: {dark}")
print("passed")
