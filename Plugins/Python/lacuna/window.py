# SPDX-License-Identifier: BSD-3-Clause
"""How ParaView's window shows data the first time, and the jobs of its menu Lacuna. In scripts, too:

    from lacuna import window
    window.show(reader)        # a CT as bone, upright, with letters at the edges; a sweep as slices in space

The plugin calls show_applied after Apply of what is new, show_places after each further one, offer_calibration for a new Tracked Slice
Reader, place_regions for a new RBF Hole Filler, show_marks while its defect is chosen, and run for the menu.
"""
import functools
import itertools
import math
import os

import numpy as np
import paraview.simple as pv
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkObject
from vtkmodules.vtkFiltersCore import vtkThreshold

from lacuna import vtkLacunaDepthMapSurface, vtkLacunaRBFHoleFiller
from lacuna import coordinates, demo_implant, demo_ultrasound, live, opening, pictures, places, solids, views
from lacuna.data import fetch

AIR, BONE = -200, 300  # Hounsfield units: below the first there is air, above the second bone
SLICES = "Slices in Space"
RELIEF = "Relief in Space"
MARKED = (0.90, 0.35, 0.10)
# Of a volume rendering: Hounsfield units, then colour or opacity. Soft tissue is not seen.
BONE_COLORS = ((150, 0.75, 0.55, 0.45), (350, 0.90, 0.83, 0.70), (1200, 0.97, 0.95, 0.90), (3000, 1, 1, 1))
BONE_OPACITIES = ((250, 0), (400, 0.6), (700, 0.95), (3000, 1))
BONE_SURFACE = 0.5  # of Bone Echo
DARK = 0.03  # part of the range of grey levels that is left out of slices at least, and that is left at least
FRONT, UP = (0, 1, 0), (0, 0, 1)  # the view into the face, in patient coordinates (LPS)


def run(job, *arguments):
    """A job of the menu by its name: one of lacuna.macros on the active source, or one of here. What is wrong is said in Output Messages."""
    from lacuna import macros
    own = {"sample_ct": sample_ct, "sample_sweep": sample_sweep, "save_solid": save_solid, "live_layout": live.show_layout}
    places.listen()
    result = macros.run(functools.partial(own.get(job) or getattr(macros, job), *arguments))
    for source in pv.GetSources().values():
        _mark_places(source)
    return result


def save_solid(path):
    """Writes the active source by lacuna.solids.save_solid."""
    source = pv.GetActiveSource()
    if source is None:
        raise ValueError("nothing is selected in the pipeline browser; select an implant or another closed surface")
    solids.save_solid(path, source)
    print(f"Lacuna: {path} is written")


def sample_ct():
    """A Skull Phantom, shown as one looks into its hole."""
    source = _show_sample(pv.SkullPhantom(registrationName="Sample CT", Spacing=[1, 1, 1], NoiseLevel=10, Sutures=1))
    inwards = -np.array(source.DefectDirection)
    _look(pv.GetActiveView(), inwards, demo_implant.view_up(inwards))
    pv.Render()
    return source


def sample_sweep():
    """A Phantom Sweep, shown."""
    return _show_sample(pv.PhantomSweep(registrationName="Sample sweep", SpeckleLevel=0.2))


def _show_sample(source):
    """Alone: each sample has coordinates of its own."""
    view = pv.GetActiveViewOrCreate("RenderView")
    pv.HideAll(view)
    views.hide_orientation(view)
    places.hide_all()
    show(source, view)
    pv.SetActiveSource(source)
    pv.Render(view)
    return source


def show_applied(identity):
    """Shows a source that was applied for the first time, by the global ID of its proxy. Never raises: ParaView shows it already."""
    try:
        places.listen()
        source = servermanager._getPyProxy(servermanager.ActiveConnection.Session.GetRemoteObject(identity))
        view = pv.GetActiveView()
        if view is not None and hasattr(view, "GetActiveCamera") and pv.GetDisplayProperties(source, view).Visibility:
            show(source, view)
    except Exception as error:  # pylint: disable=broad-exception-caught
        import paraview
        paraview.print_warning(f"Lacuna: the view is ParaView's own, since {error}")
    else:
        _mark_places(source)


def show_places(identity):
    """Marks the places that a source has named in errors and warnings since its last Apply, by the global ID of its proxy. Never raises."""
    places.listen()
    source = servermanager._getPyProxy(servermanager.ActiveConnection.Session.GetRemoteObject(identity))
    if source is not None:
        view = pv.GetActiveView()
        source.UpdatePipeline(*[view.ViewTime] * (view is not None and hasattr(view, "ViewTime")))
        _mark_places(source)


def hide_places(identity):
    """Takes the marks of a source away that is being deleted. Never raises."""
    try:
        places.hide(identity)
    except Exception as error:  # pylint: disable=broad-exception-caught
        import paraview
        paraview.print_warning(f"Lacuna: what was marked may still be seen, since {error}; Delete the view to be rid of it")


def _mark_places(source):
    try:
        places.show(source)
    except Exception as error:  # pylint: disable=broad-exception-caught
        import paraview
        paraview.print_warning(f"Lacuna: the places in the message are not marked, since {error}")


def show(source, view=None):
    """Shows a source in a view, by default the active one, as who works with such data expects. Returns the source.

    A volume in Hounsfield units (is_ct): bone, volume rendered; alone in the view it is seen upright from the front, with letters at the
    edges when it is known to be in patient coordinates. Tracked slices with poses: pictures where they lie. A depth map: the surface that
    it is of, where it lies, what is filled apart from bone. Contours in one colour: of a CT that of bone, else that of tissue. The camera
    goes to what it cannot see.
    """
    view = view or pv.GetActiveView() or pv.CreateRenderView()
    display = pv.Show(source, view)
    source.UpdatePipeline()
    fields = source.FieldData
    information = source.GetDataInformation()
    bounds = information.GetBounds()
    is_alone = not any(each is not display for each in _shown(view))
    if is_ct(source):
        _show_bone(source, display, view)
        if is_alone:
            _look(view, FRONT, UP)
            _mark_sides(view)
            return source
    elif fields["ImageToReference"] and information.GetDataSetTypeAsString() == "vtkImageData":
        show_slices(source, view)
        poses = _poses(source)
        bounds = _slice_bounds(poses, bounds)
        if is_alone and len(poses):
            look_at_slices(source, view)
            return source
    elif is_depth_map(source):
        inwards, down, bounds = _show_relief(source, display, view)
        if not _is_seen(bounds, view) or np.dot(view.GetActiveCamera().GetDirectionOfProjection(), inwards) < 0.5:
            _look(view, inwards, -down)
        if is_alone:
            _mark_sides(view)
        return source
    elif source.GetXMLName() == "Contour":
        display.ColorArrayName = [None, ""]
        display.AmbientColor = display.DiffuseColor = list(pictures.BONE if coordinates.is_patient(source) else pictures.TISSUE)
        display.Specular = 0.15
    views.check_orientation(view)
    if bounds and not _is_seen(bounds, view):
        pv.ResetCamera(view)
    return source


def is_ct(source):
    """Whether a source is a volume with one number per voxel in Hounsfield units: an array of that name, or values from air to bone."""
    information = source.GetDataInformation()
    if information.GetDataSetTypeAsString() != "vtkImageData" or source.FieldData["SliceStatus"]:
        return False
    extent = information.GetExtent()
    if min(extent[2 * axis + 1] - extent[2 * axis] for axis in range(3)) < 1:
        return False
    for name in source.PointData.keys():
        grey = source.PointData[name]
        if grey.GetNumberOfComponents() == 1 and (name == "HounsfieldUnits" or (name == "Intensity" and grey.GetRange()[0] <= AIR)):
            return grey.GetRange()[1] > BONE
    return False


def is_depth_map(source):
    """Whether a source is a depth map, and no picture of one."""
    is_map = source.FieldData["ImageToWorld"] and "Depth" in source.PointData.keys() and "Color" not in source.PointData.keys()
    return bool(is_map and source.GetDataInformation().GetDataSetTypeAsString() == "vtkImageData")


def _matrix_of(image):
    """ImageToWorld of a depth map: 4 x 4."""
    return np.array(image.GetFieldData().GetArray("ImageToWorld").GetTuple(0)).reshape(4, 4)


def _show_relief(source, display, view):
    """Shows a depth map as a surface where it lies. Returns its direction of view, its rows' direction and the surface's bounds (mm)."""
    display.SetRepresentationType(RELIEF)
    if "FilledMask" in source.PointData.keys():
        pv.ColorBy(display, ("POINTS", "FilledMask"))
        display.SetScalarBarVisibility(view, True)
    image = fetch(source)
    matrix = _matrix_of(image)
    surface = vtkLacunaDepthMapSurface()
    surface.SetInputData(image)
    surface.Update()
    return matrix[:3, 2], matrix[:3, 1], surface.GetOutput().GetBounds()


def _show_bone(source, display, view):
    """Volume rendering with colours of its own: slices of the same data stay grey."""
    name = "HounsfieldUnits" if "HounsfieldUnits" in source.PointData.keys() else "Intensity"
    _color_apart(display, view, name, BONE_COLORS, BONE_OPACITIES)
    display.SetRepresentationType("Volume")
    display.Shade = 1


def show_slices(source, view, stride=1):
    """Shows tracked slices with poses as grey pictures where they lie, every stride-th. What is dark is left out; of those that bone
    was found in, all but the bone. Returns the display.
    """
    display = pv.Show(source, view)
    display.SetRepresentationType(SLICES)
    display.SliceStride = stride
    if "BoneEcho" in source.PointData.keys():
        display.Dark = BONE_SURFACE
        # the representation calls what it shows Intensity
        _color_apart(display, view, "Intensity", ((BONE_SURFACE, 0.95, 0.93, 0.88), (1, 0.55, 0.4, 0.3)))
        return display
    grey = source.PointData["Intensity"]
    if grey is not None and grey.GetNumberOfComponents() == 1:
        low, high = grey.GetRange()
        high = max(high, low + 1)
        # tissue without echoes, bath, margins
        display.Dark = min(max(_median(source), low + DARK * (high - low)), low + (1 - DARK) * (high - low))
        _color_apart(display, view, "Intensity", ((low, 0, 0, 0), (high, 1, 1, 1)))
    return display


def _median(source):
    """Of some grey levels; those of a remote server are not fetched for it."""
    if servermanager.ActiveConnection.IsRemote():
        return -math.inf
    grey = vtk_to_numpy(fetch(source).GetPointData().GetArray("Intensity"))
    return float(np.median(grey[::max(1, len(grey) // 100000)])) if len(grey) else -math.inf


def _color_apart(display, view, name, colors, opacities=None):
    """Colours a display by a point array with functions of its own: (value, red, green, blue) and, of a volume, (value, opacity)."""
    if display.ColorArrayName[1]:
        display.SetScalarBarVisibility(view, False)
    display.UseSeparateColorMap = 1
    pv.ColorBy(display, ("POINTS", name), separate=True)
    table = pv.GetColorTransferFunction(name, display, separate=True)
    table.AutomaticRescaleRangeMode = "Never"
    table.ColorSpace = "RGB"
    table.RGBPoints = list(itertools.chain(*colors))
    display.LookupTable = table
    if opacities:
        opacity = pv.GetOpacityTransferFunction(name, display, separate=True)
        opacity.Points = list(itertools.chain(*((value, each, 0.5, 0) for value, each in opacities)))
        display.ScalarOpacityFunction = opacity
    display.SetScalarBarVisibility(view, False)


def _shown(view):
    """The displays of data that a view shows."""
    return [each for each in view.Representations if each.GetProperty("Input") and each.GetProperty("WindowLocation") is None
            and each.Visibility and each.Input is not None]


def _mark_sides(view):
    try:
        views.show_orientation(view)
    except ValueError:  # not known to be the patient's, or something else is shown
        pass


def look_at_slices(source, view):
    """From the probe into the tissue and from aside, so that tracked slices are not seen head-on."""
    poses = _poses(source)
    if not len(poses):
        pv.ResetCamera(view)
        return
    middle = poses[len(poses) // 2][:3, :2]
    lateral, depth = (middle / np.linalg.norm(middle, axis=0)).T
    _look(view, depth + 0.5 * lateral + 1.2 * np.cross(lateral, depth), -depth)


def look_onto_slices(source, view):
    """From the probe onto what is shown, a little from aside, with the first slice at the top."""
    poses = _poses(source)
    middle = poses[len(poses) // 2]
    lateral, depth = (middle[:3, :2] / np.linalg.norm(middle[:3, :2], axis=0)).T
    onwards = np.cross(lateral, depth)
    if onwards @ (poses[-1] - poses[0])[:3, 3] < 0:
        onwards = -onwards
    _look(view, depth + 0.5 * onwards + 0.3 * lateral, -onwards)


def look_live(identity):
    """Turns the cameras of views that show a live source in space to its slices: before the first ones nothing is there to see."""
    source = servermanager._getPyProxy(servermanager.ActiveConnection.Session.GetRemoteObject(identity))
    for view in pv.GetRenderViews():
        if any(each.GetProperty("Representation") and each.Representation == SLICES and each.Input.SMProxy == source.SMProxy for each in _shown(view)):
            look_at_slices(source, view)
            pv.Render(view)


def _poses(source):
    """Of the slices that have one: N x 4 x 4. Of the pixels one alone is fetched."""
    extent = source.GetDataInformation().GetExtent()
    one = servermanager.filters.ExtractSubset(Input=source, VOI=[each for low in extent[::2] for each in (low, low)])
    poses = demo_ultrasound.slice_poses(fetch(one))
    return poses[np.isfinite(poses).all(axis=(1, 2))]


def _slice_bounds(poses, bounds):
    """The box (mm) around slices with these poses, of which the bounds in pixels are given; None without."""
    corners = np.array([[u, v, 0, 1] for u in bounds[:2] for v in bounds[2:4]], float)
    points = np.concatenate([corners @ pose.T for pose in poses] or [np.empty((0, 4))])[:, :3]
    return [f(points[:, axis]) for axis in range(3) for f in (np.min, np.max)] if len(points) else None


def _look(view, direction, up):
    """As pictures.look, but parallel or in perspective as the view was."""
    projection = view.CameraParallelProjection
    pictures.look(view, direction, up)
    view.CameraParallelProjection = projection
    pv.ResetCamera(view)


def _is_seen(bounds, view):
    """Whether the camera of a view has a box in sight, neither as a speck nor from within."""
    camera = view.GetActiveCamera()
    low, high = np.array(bounds[::2]), np.array(bounds[1::2])
    if not (low <= high).all():
        return True  # empty
    forwards = np.array(camera.GetDirectionOfProjection())
    to = (low + high) / 2 - np.array(camera.GetPosition())
    depth = to @ forwards
    half = camera.GetParallelScale() if camera.GetParallelProjection() else depth * math.tan(math.radians(camera.GetViewAngle()) / 2)
    size = np.linalg.norm(high - low) / 2
    aside = np.linalg.norm(to - depth * forwards)
    return bool(half > 0 and aside < 1.5 * half and 0.1 * half < size < 5 * half)


def offer_calibration(identity):
    """Fills in CalibrationFileName of a new Tracked Slice Reader when the sweep has no calibration and one lies beside it.

    That is the only device set configuration (XML of PLUS) in the folder with a transform from Image to Probe. The panel shows it
    before Apply. The files of a remote server are not looked at.
    """
    if servermanager.ActiveConnection.IsRemote():
        return
    reader = servermanager._getPyProxy(servermanager.ActiveConnection.Session.GetRemoteObject(identity))
    if reader.CalibrationFileName or _is_calibrated(reader.FileName):
        return
    found = opening.calibrations(os.path.dirname(reader.FileName) or ".")
    if len(found) == 1:
        reader.CalibrationFileName = found[0]
        print(f"Lacuna: CalibrationFileName is {found[0]}, which lies beside the sweep. Another probe's would give wrong millimetres: look at it before Apply")


def _is_calibrated(path):
    """Whether the header of a sweep names a transform from or to its images."""
    try:
        with open(path, "rb") as file:
            head = file.read(1 << 16)
    except OSError:
        return False
    return any(word in head for word in (b"ImageTo", b"ToImageTransform", b"ToCroppedImageTransform"))


def place_regions(identity):
    """Puts the regions that a new RBF Hole Filler offers, before one is chosen, on the largest hole of its map: a loop around it, and
    sphere, box and cylinder over it. Without a hole they stand in the middle of the map. Never raises; the maps of a remote server are
    not fetched for it.
    """
    try:
        filler = servermanager._getPyProxy(servermanager.ActiveConnection.Session.GetRemoteObject(identity))
        if not servermanager.ActiveConnection.IsRemote():
            _place_regions(filler, *hole_of_map(filler.Input))
    except Exception as error:  # pylint: disable=broad-exception-caught
        import paraview
        paraview.print_warning(f"Lacuna: regions are where ParaView puts them, since {error}")


def hole_of_map(source):
    """The rim of the largest hole that the main surface of a depth map encloses, in order around it (N x 3), its middle on the surface that
    would fill it, and the direction of the view; patient coordinates, mm. Without a hole: a circle of 15 mm around the middle.
    """
    image = fetch(source)
    matrix = _matrix_of(image)
    right, down, view = (matrix[:3, axis] for axis in range(3))
    extent = image.GetExtent()
    shape = extent[3] - extent[2] + 1, extent[1] - extent[0] + 1
    spacing = np.array([np.linalg.norm(right), np.linalg.norm(down)])
    depth = vtk_to_numpy(image.GetPointData().GetArray("Depth")).reshape(shape).astype(float)
    seen = np.isfinite(depth)
    hole = _largest_hole(image, shape)
    rows, columns = np.nonzero(hole) if hole.any() else np.nonzero(seen)
    middle = np.array([columns.mean(), rows.mean()]) if len(rows) else np.array(shape[::-1]) / 2
    reach = 15.0
    offsets = (np.stack([columns, rows], 1) - middle) * spacing
    points, depths = [], []
    for angle in np.linspace(0, 2 * np.pi, 8, endpoint=False):
        way = np.array([np.cos(angle), np.sin(angle)])
        if hole.any():  # the rim lies 2 mm beyond what is empty
            aside = np.abs(offsets @ [-way[1], way[0]])
            along = offsets @ way
            reach = max(along[(aside <= 2 * spacing.max()) & (along >= 0)], default=0) + 2
        pixel = middle + reach * way / spacing
        points.append(pixel)
        column, row = np.clip(np.rint(pixel).astype(int), 0, np.array(shape[::-1]) - 1)
        depths.append(depth[row, column])
    known = np.isfinite(depths)
    usual = np.median(np.array(depths)[known]) if known.any() else np.median(depth[seen]) if seen.any() else 0.0
    depths = np.where(known, depths, usual)
    view = view / np.linalg.norm(view)

    def place(pixel, level):
        return matrix[:3, 3] + (pixel[0] + extent[0]) * right + (pixel[1] + extent[2]) * down + level * view
    rim = np.array([place(pixel, level) for pixel, level in zip(points, depths)])
    return rim, rim.mean(axis=0), view


def show_marks(identity, region=0):
    """Shows what a new RBF Hole Filler would replace, before Apply: the filler's global ID, and that of its region, or 0.

    Regions, arrays and selections count as its panel shows them. Nothing is shown of a remote server. Never raises.
    """
    hide_marks()
    try:
        session, view = servermanager.ActiveConnection.Session, pv.GetActiveView()
        if servermanager.ActiveConnection.IsRemote() or view is None or not hasattr(view, "GetActiveCamera"):
            return
        filler = servermanager._getPyProxy(session.GetRemoteObject(identity))
        region = session.GetRemoteObject(region) if region else None
        filled = _fill_coarsely(fetch(filler.Input), region and region.GetClientSideObject(), filler)
        if filled.GetPointData().GetArray("FilledMask") is None:
            return  # nothing is marked; Apply says why
        surface = vtkLacunaDepthMapSurface()
        surface.SetInputData(filled)
        surface.SetMaximumAngle(80)
        marked = vtkThreshold()
        marked.SetInputConnection(surface.GetOutputPort())
        marked.SetInputArrayToProcess(0, 0, 0, 0, "FilledMask")
        marked.SetThresholdFunction(vtkThreshold.THRESHOLD_UPPER)
        marked.SetUpperThreshold(0.5)
        marked.Update()
        source = servermanager.sources.TrivialProducer()
        source.GetClientSideObject().SetOutput(marked.GetOutput())
        _marks.append(places.show_aside(source, view, MARKED))
        display = _marks[-1][2]
        towards = -_matrix_of(filled)[:3, 2]
        place = "Translation" if display.SMProxy.GetProperty("Translation") else "Position"  # the names since ParaView 5.13, and before
        setattr(display, place, list(towards / np.linalg.norm(towards)))  # 1 mm before bone that it covers
        pv.Render(view)
    except Exception as error:  # pylint: disable=broad-exception-caught
        hide_marks()
        import paraview
        paraview.print_warning(f"Lacuna: Apply shows what is replaced; beforehand it cannot be shown, since {error}")


_marks = []  # view, source and display of what show_marks shows


def hide_marks():
    """Takes away what show_marks shows. Never raises: the view may be closed."""
    while _marks:
        try:
            places.hide_aside(*_marks.pop())
        except Exception as error:  # pylint: disable=broad-exception-caught
            import paraview
            paraview.print_warning(f"Lacuna: what was marked may still be seen, since {error}; Delete the view to be rid of it")


def update_quietly(algorithm):
    """Updates a VTK algorithm, whose errors and warnings are not shown."""
    display = vtkObject.GetGlobalWarningDisplay()
    vtkObject.GlobalWarningDisplayOff()
    try:
        algorithm.Update()
    finally:
        vtkObject.SetGlobalWarningDisplay(display)


def _fill_coarsely(image, region=None, settings=None):
    """A depth map that is filled in a moment; without FilledMask where there is nothing to fill. settings: a proxy of RBF Hole Filler,
    whose arrays and selection mark the defect, too, as its panel shows them before Apply."""
    filler = vtkLacunaRBFHoleFiller()
    filler.SetInputData(image)
    filler.SetDefectRegion(region)
    filler.SetNodeSpacing(5)
    if settings is not None:
        filler.SetDefectArray(_unapplied(settings, "DefectArray").GetAsString())
        filler.SetSupportArray(_unapplied(settings, "SupportArray").GetAsString())
        for port, name in enumerate(("Surface", "Selection"), 1):
            data = _unapplied_data(settings, name)
            if data is not None:
                filler.SetInputData(port, data)
    update_quietly(filler)  # that there is none is no error here
    return filler.GetOutput()


def _unapplied(proxy, name):
    """A property as the panel shows it."""
    helper = servermanager.vtkSMPropertyHelper(proxy.SMProxy, name)
    helper.SetUseUnchecked(True)
    return helper


def _unapplied_data(proxy, name):
    """The data of an input as the panel shows it, or None."""
    helper = _unapplied(proxy, name)
    chosen = helper.GetAsProxy(0) if helper.GetNumberOfElements() else None
    if chosen is None:
        return None
    chosen.UpdatePipeline()
    return chosen.GetClientSideObject().GetOutputDataObject(helper.GetOutputPort(0))


def _largest_hole(image, shape):
    """Pixels of the largest hole: what RBF Hole Filler finds by itself, coarsely filled."""
    mask = _fill_coarsely(image).GetPointData().GetArray("FilledMask")
    found = np.zeros(shape, bool) if mask is None else vtk_to_numpy(mask).reshape(shape) != 0
    if not found.any():
        return found
    # each pixel takes the largest number beside it until all of a part have the same
    parts = np.where(found, np.arange(1, found.size + 1).reshape(shape), 0)
    while True:
        around = np.pad(parts, 1)
        grown = np.where(found, np.max([parts, around[:-2, 1:-1], around[2:, 1:-1], around[1:-1, :-2], around[1:-1, 2:]], axis=0), 0)
        if (grown == parts).all():
            break
        parts = grown
    numbers, counts = np.unique(parts[found], return_counts=True)
    return parts == numbers[counts.argmax()]


def _place_regions(filler, rim, middle, view):
    radius = float(np.linalg.norm(rim - middle, axis=1).max())
    places = {"Sphere": dict(Center=middle, Radius=[radius]), "Cylinder": dict(Center=middle, Axis=view, Radius=[radius]),
              "Box": dict(Position=middle - radius, Rotation=np.zeros(3), Scale=np.full(3, 2 * radius)),
              "Plane": dict(Origin=middle, Normal=view), "LacunaSplineLoop": dict(Points=rim.ravel())}
    regions = filler.GetProperty("DefectRegion").SMProperty.FindDomain("vtkSMProxyListDomain")
    for index in range(regions.GetNumberOfProxies()):
        proxy = regions.GetProxy(index)
        for name, value in places.get(proxy.GetXMLName(), {}).items():
            if proxy.GetProperty(name):
                helper = servermanager.vtkSMPropertyHelper(proxy, name)
                helper.SetNumberOfElements(len(value))
                for element, number in enumerate(value):
                    helper.Set(element, float(number))
        proxy.UpdateVTKObjects()
