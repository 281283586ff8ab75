# SPDX-License-Identifier: BSD-3-Clause
"""Ray casters that look as a render view does.

    from lacuna import views
    views.copy_camera(caster)          # the active view's camera, once
    surface = DepthMapSurface(Input=caster)

For B-Spline Iso Ray Caster and Slice Ray Caster. The latter looks along parallel rays whatever the camera does.
"""
import math

import numpy as np


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
