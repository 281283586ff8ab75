# SPDX-License-Identifier: BSD-3-Clause
"""Marks in the view at the places that errors and warnings of Lacuna's filters name.

    places.listen()            # keeps messages from now on; ParaView's window does so
    places.show(implant)       # a ball at each place, with a line outwards to its millimetres; an outline around each slice that is named
    places.hide(implant)

A place outside of the filter's data is not marked: it may be in other coordinates. Nothing is marked on a remote server.
"""
import re

import numpy as np
import paraview.simple as pv
from paraview import servermanager
from vtkmodules.vtkCommonCore import vtkOutputWindow
from vtkmodules.vtkCommonDataModel import vtkDataSet

from lacuna import coordinates
from lacuna.data import blocks

COLOR = (0.95, 0.25, 0.10)
MOST = 10  # marks of a filter
NUMBER = r"(-?\d+(?:\.\d*)?(?:e[+-]?\d+)?)"
POINT = re.compile(rf"\b(?:at|near|around|is) (?:\({NUMBER}, {NUMBER}, {NUMBER}\)|{NUMBER} {NUMBER} {NUMBER} mm)(?! mm of the)")
VOXEL = re.compile(r"\bat voxel \((-?\d+), (-?\d+), (-?\d+)\)")
SLICES = re.compile(r"(?<!has )\bslices? (\d+(?:(?:, | and | to )\d+\b(?! more))*)(?! x)")  # of a range its ends

_said = {}  # texts by the address of the algorithm that reported them, of its last execution
_watched = {}  # by global ID of a source: when its data were made of which messages were marked
_marks = {}  # by global ID of a source: a list of (view, source, display)


def listen():
    """Keeps what algorithms report from now on. To be called any number of times."""
    if not hasattr(listen, "tag"):
        def keep(_window, _event, text):
            named = re.search(r"^(?:ERROR|Warning): In .*\n|", text or "").end()
            found = re.match(r"vtkLacuna\w+ \(0x([0-9a-f]+)\): ", (text or "")[named:])
            if found:
                _said.setdefault(int(found[1], 16), []).append(text[named + found.end():])
        keep.CallDataType = "string0"
        window = vtkOutputWindow.GetInstance()
        listen.tag = [window.AddObserver(event, keep) for event in ("ErrorEvent", "WarningEvent")]


def find(text):
    """The places that a text names: points in mm, each with its words, (i, j, k) of voxels, and numbers of slices; a list of each."""
    points = []
    for found in POINT.finditer(text):
        numbers = [x for x in found.groups() if x is not None]
        points.append((tuple(map(float, numbers)), f"({', '.join(numbers)}) mm"))
    voxels = [tuple(map(int, found.groups())) for found in VOXEL.finditer(text)]
    slices = [int(number) for found in SLICES.finditer(text) for number in re.findall(r"\d+", found[1])]
    return [list(dict.fromkeys(each)) for each in (points, voxels, slices)]


def show(source, view=None):
    """Marks what a source (a proxy) reported when it was executed last, in place of its former marks. Returns how many marks there are."""
    algorithm = None if servermanager.ActiveConnection.IsRemote() else source.GetClientSideObject()
    if algorithm is None or coordinates.find(source) == coordinates.PRESS:  # whose filter names places in the patient
        return 0
    identity, address = source.SMProxy.GetGlobalID(), int(algorithm.__this__.split("_")[1], 16)
    made = algorithm.GetOutputDataObject(0).GetUpdateTime() if algorithm.GetOutputDataObject(0) else 0
    texts = _said.get(address, [])
    if _watched.get(identity) == (made, len(texts)):
        return len(_marks.get(identity, []))
    if identity not in _watched:
        algorithm.AddObserver("StartEvent", lambda *_: _said.pop(address, None))
    _watched[identity] = made, len(texts)
    hide(source)
    view = view or pv.GetActiveView()
    if not texts or view is None or not hasattr(view, "GetActiveCamera"):
        return 0
    points, voxels, slices = (sum(each, []) for each in zip(*map(find, texts)))
    data = [each for port in range(algorithm.GetNumberOfOutputPorts()) for each in _data_of(algorithm.GetOutputDataObject(port))]
    inputs = [each for port in range(algorithm.GetNumberOfInputPorts()) for index in range(algorithm.GetNumberOfInputConnections(port))
              for each in _data_of(algorithm.GetInputDataObject(port, index))]
    box = _box(data + inputs)
    if box is None:
        return 0
    low, high = box
    size = np.linalg.norm(high - low)
    places = [(np.array(point), words) for point, words in dict.fromkeys(points)]
    places += [(place, "voxel ({}, {}, {})".format(*voxel)) for voxel in dict.fromkeys(voxels) for place in _voxel(inputs, voxel)]
    own = _marks.setdefault(identity, [])
    places = [(place, words) for place, words in places if (place >= low - 0.02 * size).all() and (place <= high + 0.02 * size).all()]
    for index, (place, words) in enumerate(places[:MOST]):
        outwards = place - (low + high) / 2
        end = place + (0.08 + 0.05 * (index % 3)) * size * outwards / (np.linalg.norm(outwards) or 1)
        ball = servermanager.sources.Sphere(Center=list(place), Radius=0.01 * size, ThetaResolution=24, PhiResolution=24)
        own += [show_aside(ball, view), _line([place, end], view), _label(words, end, view)]
    for number in list(dict.fromkeys(slices))[:MOST]:
        for corners in _slice(inputs, number):
            own += [_line(corners, view, closed=1), _label(f"slice {number}", corners[0], view)]
    if own:
        pv.Render(view)
    return len(own)


def hide(source):
    """Takes the marks of a source away: of its proxy or global ID."""
    for mark in _marks.pop(source if isinstance(source, int) else source.SMProxy.GetGlobalID(), []):
        hide_aside(*mark)


def hide_all():
    """Takes all marks away."""
    for identity in list(_marks):
        hide(identity)


def show_aside(source, view, color=COLOR):
    """Shows a source that is in no pipeline browser and in no state file, in one colour. Returns view, source and display for hide_aside."""
    source.UpdatePipeline()
    display = servermanager.CreateRepresentation(source, view)
    view.SMProxy.GetProperty("Representations").RemoveProxy(display.SMProxy)
    view.SMProxy.UpdateVTKObjects()
    view.SMProxy.GetProperty("HiddenRepresentations").AddProxy(display.SMProxy)  # not part of a state
    view.SMProxy.UpdateVTKObjects()
    if display.SMProxy.GetProperty("Representation"):
        display.Representation = "Surface"
        display.ColorArrayName = [None, ""]
        display.AmbientColor = display.DiffuseColor = list(color)
        display.Pickable = 0
    return view, source, display


def hide_aside(view, _source, display):
    """Takes away what show_aside shows; the view may be closed."""
    if view.SMProxy in [each.SMProxy for each in pv.GetRenderViews()]:
        for name in ("Representations", "HiddenRepresentations"):
            view.SMProxy.GetProperty(name).RemoveProxy(display.SMProxy)
        view.SMProxy.UpdateVTKObjects()
        pv.Render(view)


def _line(points, view, closed=0):
    mark = show_aside(servermanager.sources.PolyLineSource(Points=np.ravel(points).tolist(), Closed=closed), view)
    mark[2].LineWidth = 3
    return mark


def _label(words, place, view):
    """Words at a place in space, which face the viewer."""
    mark = show_aside(servermanager.sources.Text(Text=words), view)
    display = mark[2]
    display.TextPropMode, display.BillboardPosition = "Billboard 3D Text", list(place)
    display.Color, display.FontSize, display.Bold, display.Shadow = [1.0, 1.0, 1.0], 16, 1, 1
    return mark


def _data_of(data):
    return [each for each in blocks(data) if isinstance(each, vtkDataSet)] if data else []


def _box(data):
    """Two corners around data; tracked slices lie where their poses say."""
    corners = []
    for each in data:
        slices = _matrices(each)
        bounds = np.array(each.GetBounds()).reshape(3, 2)
        if slices is not None:
            corners += [_corners(each, matrix) for matrix in slices if np.isfinite(matrix).all()]
        elif (bounds[:, 0] <= bounds[:, 1]).all():
            corners.append(bounds.T)
    return (np.concatenate(corners).min(0), np.concatenate(corners).max(0)) if corners else None


def _matrices(data):
    array = data.GetFieldData().GetArray("ImageToReference") if data.IsA("vtkImageData") else None
    return None if array is None else np.array([array.GetTuple(k) for k in range(array.GetNumberOfTuples())]).reshape(-1, 4, 4)


def _corners(data, matrix):
    low, high = np.array(data.GetBounds()).reshape(3, 2).T
    square = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    return square @ matrix[:3, :2].T + matrix[:3, 3]


def _slice(inputs, number):
    """The corners of a slice of the first tracked slices among the inputs that have a pose of this number."""
    for each in inputs:
        matrices = _matrices(each)
        if matrices is not None and number < len(matrices) and np.isfinite(matrices[number]).all():
            return [_corners(each, matrices[number])]
    return []


def _voxel(inputs, index):
    """Where a voxel of the first volume among the inputs is."""
    for each in inputs:
        if each.IsA("vtkImageData") and _matrices(each) is None:
            place = [0.0, 0.0, 0.0]
            each.TransformContinuousIndexToPhysicalPoint(*map(float, index), place)
            return [np.array(place)]
    return []
