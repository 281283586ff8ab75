# SPDX-License-Identifier: BSD-3-Clause
"""Ray casters that look as a render view does, and the patient's sides in pictures.

    from lacuna import views
    views.copy_camera(caster)          # the active view's camera, once
    surface = DepthMapSurface(Input=caster)
    views.show_orientation()           # L, R, A, P, H, F at the edges of the active view

B-Spline Iso Ray Caster and Slice Ray Caster. The latter looks along parallel rays whatever the camera does.
"""
import math

import numpy as np

from lacuna import coordinates
from lacuna.data import fetch


def camera_view(camera, size, rows=None):
    """The view properties of a ray caster whose map shows what a camera shows in a window.

    camera: vtkCamera; size: width and height of the window in pixels; rows: of the map, by default as many as the
    window has. The rows and columns of the map are those of the window, or as many times coarser or finer. The rays are
    parallel: of a camera with perspective, the map shows what it shows at the distance of its focal point. Depth is
    measured from the camera's position. Returns a dict of property names and values.
    """
    width, height = size
    if not (width > 0 and height > 0):
        raise ValueError(f"the window has {width} x {height} pixels: it is not shown yet")
    rows = height if rows is None else rows
    if not (rows == int(rows) and rows > 0):
        raise ValueError(f"a map needs at least one row, and a whole number of them, not {rows}")
    position, focus = np.array(camera.GetPosition()), np.array(camera.GetFocalPoint())
    if camera.GetParallelProjection():
        shown = 2 * camera.GetParallelScale()
    else:
        across = width / height if camera.GetUseHorizontalViewAngle() else 1
        shown = 2 * np.linalg.norm(focus - position) * math.tan(math.radians(camera.GetViewAngle()) / 2) / across
    return {
        "ViewDirection": [float(x) for x in focus - position],
        "ViewUp": list(camera.GetViewUp()),
        "FocalPoint": [float(x) for x in focus],
        "PlaneOrigin": [float(x) for x in position],
        "PixelSpacing": float(shown / rows),
        "ImageSize": [max(1, round(width * rows / height)), int(rows)],
    }


def copy_camera(caster, view=None, rows=None):
    """Gives a ray caster (a ParaView proxy) the camera of a render view; by default of the active one.

    All of the map's geometry is set, so that it no longer depends on the data: slices that are added later are cast
    alone. A caster that can have perspective gets it from the camera. rows: see camera_view; 512 is a good size while
    slices arrive.
    """
    import paraview.simple as pv
    view = view or pv.GetActiveView()
    if view is None or not hasattr(view, "GetActiveCamera"):
        raise ValueError("there is no active render view whose camera could be copied; give one")
    camera = view.GetActiveCamera()
    properties = camera_view(camera, view.ViewSize, rows)
    if caster.GetProperty("Projection") is not None:
        properties["Projection"] = "Parallel" if camera.GetParallelProjection() else "Perspective"
        if not camera.GetParallelProjection():
            # the map's plane goes through the focal point, where the spacing of its pixels holds
            properties["EyePosition"] = properties["PlaneOrigin"]
            properties["PlaneOrigin"] = properties["FocalPoint"]
            distance = math.dist(camera.GetPosition(), camera.GetFocalPoint())
            shown = properties["PixelSpacing"] * properties["ImageSize"][1]
            properties["ViewAngle"] = math.degrees(2 * math.atan(shown / 2 / distance))
    for name, value in properties.items():
        setattr(caster, name, value)


# Names of the positive and the negative axes of patient coordinates (LPS).
SIDES = (("L", "R"), ("P", "A"), ("H", "F"))
annotations = set()  # global IDs of sources that are no data, such as scale bars
_marked = {}  # views with marks: their marks by global ID


def direction_letters(direction):
    """Where a direction in patient coordinates (LPS) leads: one to three of L, R, A, P, H, F.

    As DICOM has it (PS3.3, C.7.6.1.1.1): the axis it is nearest to first, others after it, as far as the direction
    leaves the plane across them by 14.5 degrees or more. Raises ValueError when it has no length.
    """
    direction = np.asarray(direction, dtype=float)
    length = np.linalg.norm(direction)
    if direction.shape != (3,) or not np.isfinite(length) or length == 0:
        raise ValueError(f"{direction} is no direction")
    unit = direction / length
    order = sorted(range(3), key=lambda axis: -abs(unit[axis]))
    return "".join(SIDES[axis][int(unit[axis] < 0)] for axis in order if abs(unit[axis]) >= 0.25)


def edge_letters(right, up):
    """The letters at the four edges of a picture of which right and upwards are these directions, by edge."""
    right, up = np.asarray(right, dtype=float), np.asarray(up, dtype=float)
    return {"right": direction_letters(right), "left": direction_letters(-right),
            "top": direction_letters(up), "bottom": direction_letters(-up)}


def camera_letters(camera):
    """edge_letters of what a vtkCamera shows, rolled or mirrored as it may be."""
    forwards, up = np.array(camera.GetDirectionOfProjection()), np.array(camera.GetViewUp())
    right = np.cross(forwards, up)
    # not the camera's own matrix, which is not yet up to date when it says that it was modified
    axes = np.array([right, np.cross(right, forwards), -forwards * (np.linalg.norm(right) or 1)])
    user = camera.GetUserViewTransform()
    if user is not None:
        axes = np.array([[user.GetMatrix().GetElement(i, k) for k in range(3)] for i in range(3)]) @ axes
    return edge_letters(axes[0], axes[1])


def map_letters(source, force=False):
    """edge_letters of a depth map or its shaded picture (a proxy or vtkImageData), whose row 0 is on top.

    Raises ValueError when it is not known to be the patient's or is mirrored, unless force: for those who know.
    """
    image = fetch(source) if hasattr(source, "GetXMLLabel") else source
    to_world = image.GetFieldData().GetArray("ImageToWorld")
    if to_world is None:
        raise ValueError("the image is no depth map: it lacks the field data array ImageToWorld")
    if not force:
        _check_patient(source, "the depth map")
    to_world = np.array(to_world.GetTuple(0)).reshape(4, 4)
    return edge_letters(to_world[:3, 0], -to_world[:3, 1])


def in_patient_coordinates(source):
    """Whether a proxy or data (vtkDataObject) are known to be in patient coordinates (LPS) and not mirrored: marked by
    the CT Series Reader or the Skull Phantom (coordinates.find). Files with the mark are believed; files of other
    formats may be turned or mirrored without telling.
    """
    return coordinates.is_patient(source)


def _check_patient(source, name):
    if not coordinates.is_patient(source):
        place = coordinates.find(source)
        raise ValueError(
            f"{name} is not known to be in the patient's coordinates (it is: {place}), so that letters for left and right "
            "could be wrong. Hide it or leave the letters out; force=True if you know better")


def _check_view(view):
    """Raises ValueError unless all data that a view shows are known to be in patient coordinates."""
    for display in view.Representations:
        if display.GetProperty("Input") is None or display.GetProperty("WindowLocation") is not None:
            continue  # scalar bars and texts
        if display.Visibility and display.Input is not None and \
                display.Input.GetGlobalIDAsString() not in annotations:
            display.Input.UpdatePipeline()
            _check_patient(display.Input, f"what the view shows of {display.Input.GetXMLLabel()}")


def text_color(view):
    """Dark grey or white, whichever is seen better on the background of a view."""
    from paraview.simple import GetSettingsProxy
    back = GetSettingsProxy("ColorPalette").Background if view.UseColorPaletteForBackground else view.Background
    return [0.1] * 3 if sum(back) > 1.5 else [1.0] * 3


def show_orientation(view=None, color=None, font_size=18, force=False):
    """Marks the edges of a render view with L, R, A, P, H, F: where the patient's left is, and so on.

    For data in patient coordinates only (in_patient_coordinates), not for moulds, mirror images or tracked ultrasound,
    whose reference frame knows no patient: raises ValueError when the view shows any such data, unless force. What is
    shown later is not asked. The letters follow the camera. Call it again to change color (by
    default text_color) or size, hide_orientation to take them away. They are not in the pipeline browser and not in state files: loaded from one they would not follow
    the camera any more. Returns the letters by edge.
    """
    import paraview.simple as pv
    from paraview import servermanager
    view = view or pv.GetActiveView()
    if view is None or not hasattr(view, "GetActiveCamera"):
        raise ValueError("there is no active render view that could be marked; give one")
    if not force:
        _check_view(view)
    hide_orientation(view)
    color = color or text_color(view)
    camera = view.GetActiveCamera()
    width, height = view.ViewSize
    marks = {}
    for edge, letters in camera_letters(camera).items():
        # not registered with the proxy manager, which writes the state files
        source = servermanager.sources.Text(Text=letters)
        display = servermanager.CreateRepresentation(source, view)
        display.Color, display.FontSize, display.Bold = list(color), font_size, 1
        display.WindowLocation = "Any Location"
        marks[edge] = (source, display)

    def place(*_):
        try:
            found = camera_letters(camera)
        except ValueError:  # halfway to another view
            return
        for edge, letters in found.items():
            source, display = marks[edge]
            # room for the letters, in parts of the window
            across, along = 0.75 * font_size * len(letters) / width, 1.2 * font_size / height
            position = {"left": [0.01, 0.5 - along / 2], "right": [0.99 - across, 0.5 - along / 2],
                        "top": [0.5 - across / 2, 0.985 - along], "bottom": [0.5 - across / 2, 0.015]}[edge]
            if source.Text != letters or list(display.Position) != position:
                source.Text = letters
                display.Position = position

    place()
    tag = camera.AddObserver("ModifiedEvent", place)
    _marked[view.GetGlobalIDAsString()] = (marks, camera, tag)
    return {edge: source.Text for edge, (source, _) in marks.items()}


def check_orientation(view):
    """Takes the marks of show_orientation away where a view shows what is not known to be the patient's."""
    if view.GetGlobalIDAsString() in _marked:
        try:
            _check_view(view)
        except ValueError:
            hide_orientation(view)


def hide_orientation(view):
    """Takes the marks of show_orientation away."""
    marks, camera, tag = _marked.pop(view.GetGlobalIDAsString(), ({}, None, None))
    if camera is not None:
        camera.RemoveObserver(tag)
    for _, display in marks.values():
        view.Representations.remove(display)
    view.UpdateVTKObjects()


def show_patient_axes(view=None, force=False):
    """Shows ParaView's axes grid with titles that say which way the patient's axes run. Kept in state files.

    For data in patient coordinates, as show_orientation.
    """
    import paraview.simple as pv
    view = view or pv.GetActiveView()
    if view is None or not hasattr(view, "AxesGrid"):
        raise ValueError("there is no active render view that could have axes; give one")
    if not force:
        _check_view(view)
    grid = view.AxesGrid
    for title, (positive, negative) in zip(("XTitle", "YTitle", "ZTitle"), SIDES):
        setattr(grid, title, f"{negative} to {positive}, mm")
    grid.Visibility = 1
