# SPDX-License-Identifier: BSD-3-Clause
"""What the scripts of this folder share: a simulated probe whose image lies in a known place, its scans, and how they are shown."""
import numpy as np
from paraview import servermanager
from paraview.simple import TrivialProducer
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData, vtkTable

WIDTH, HEIGHT, SPACING = 300, 240, 0.3  # pixels, mm: 90 x 72 mm


def rotation(axis, degrees):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    angle = np.radians(degrees)
    cross = np.cross(np.eye(3), -axis)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def pose(turn=np.eye(3), origin=(0, 0, 0)):
    matrix = np.eye(4)
    matrix[:3, :3] = turn
    matrix[:3, 3] = origin
    return matrix


# image in mm to receiver: the receiver is 180 mm behind the image's middle, as in Carr's figure A.1, and askew
SCAN_TO_PROBE = pose(rotation([1, 2, -0.5], 70), [30, -95, 150])
IMAGE_TO_PROBE = SCAN_TO_PROBE @ np.diag([SPACING, SPACING, 1, 1])
PHANTOM_TO_TRACKER = pose(rotation([0.3, -1, 0.4], 130), [200, -80, 350])


def probe_to_tracker(scan_to_phantom):
    return PHANTOM_TO_TRACKER @ scan_to_phantom @ np.linalg.inv(SCAN_TO_PROBE)


def looking_down(random, degrees):
    """Image axes in the phantom: rows go down (-z), tilted by up to so many degrees each way."""
    down = np.column_stack([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    tilts = random.uniform(-degrees, degrees, 2)
    return rotation([0, 0, 1], random.uniform(0, 360)) @ rotation([1, 0, 0], tilts[0]) @ rotation([0, 1, 0], tilts[1]) @ down


def pixels_in_phantom(scan_to_phantom):
    """(rows, columns, 3) in mm."""
    row, column = np.mgrid[:HEIGHT, :WIDTH]
    points = np.stack([SPACING * column, SPACING * row, 0 * row, 1 + 0 * row], axis=-1)
    return points @ scan_to_phantom[:3].T


def speckle(random, level):
    return level * random.rayleigh(size=(HEIGHT, WIDTH))


def wire_picture(scan_to_phantom, random):
    """Water with specks and the three axes of the phantom as wires."""
    points = pixels_in_phantom(scan_to_phantom)
    grey = speckle(random, 22)
    for wire in range(3):
        distance = np.linalg.norm(np.delete(points, wire, axis=-1), axis=-1)
        # a wire that lies nearly in the slice sends its echo away
        if abs(scan_to_phantom[wire, 2]) > 0.3:
            grey = grey + 220 * np.exp(-(distance / 1.0) ** 2)
    return np.clip(grey, 0, 255).astype(np.uint8)


def floor_picture(scan_to_phantom, random):
    """A bath with specks and the floor z = 0 of the phantom, behind which there is little."""
    height = pixels_in_phantom(scan_to_phantom)[..., 2]
    height = height + random.normal(0, 0.3) + random.normal(0, 0.2, WIDTH)  # the thick beam's echo comes early or late
    grey = speckle(random, 22) + 200 * np.exp(-(height / 0.7) ** 2) * (0.85 + 0.15 * random.random((HEIGHT, WIDTH)))
    return np.clip(np.where(height < -1.5, 0.7 * grey, grey), 0, 255).astype(np.uint8)


def point_picture(scan_to_phantom, random):
    """A ball of 3 mm at the phantom's origin."""
    distance = np.linalg.norm(pixels_in_phantom(scan_to_phantom), axis=-1)
    return np.clip(speckle(random, 22) + 220 * np.exp(-(distance / 1.2) ** 2), 0, 255).astype(np.uint8)


def source(data):
    """A source of the pipeline with these very data."""
    producer = TrivialProducer()
    producer.GetClientSideObject().SetOutput(data)
    return producer


def slices(pictures, poses, times=None):
    """Tracked slices of a probe that is not calibrated."""
    count = len(poses)
    stack = vtkImageData()
    stack.SetDimensions(WIDTH, HEIGHT, count)
    grey = numpy_to_vtk(np.ascontiguousarray(pictures).ravel(), deep=1)
    grey.SetName("Intensity")
    stack.GetPointData().SetScalars(grey)
    fields = {"ProbeToTracker": np.reshape(poses, (count, 16)), "SliceStatus": np.zeros(count, np.uint8),
              "FrameNumber": np.arange(count, dtype=np.int32), "Timestamp": 0.1 * np.arange(count) if times is None else times}
    for name, values in fields.items():
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=1)
        array.SetName(name)
        stack.GetFieldData().AddArray(array)
    return source(stack)


def table(columns):
    """A table of {name: numbers or texts}."""
    result = vtkTable()
    for name, values in columns.items():
        if isinstance(values[0], str):
            array = vtkStringArray()
            for value in values:
                array.InsertNextValue(value)
        else:
            array = numpy_to_vtk(np.ascontiguousarray(values), deep=1)
        array.SetName(name)
        result.AddColumn(array)
    return source(result)


def points(places):
    """Points as a source, (n, 3) in mm."""
    data, array, vertices = vtkPolyData(), vtkPoints(), vtkCellArray()
    for number, place in enumerate(places):
        array.InsertNextPoint(*place)
        vertices.InsertNextCell(1, [number])
    data.SetPoints(array)
    data.SetVerts(vertices)
    return source(data)


def fetch(proxy, port=0):
    return servermanager.Fetch(proxy, idx=port)


def figure(data, name):
    return data.GetFieldData().GetArray(name).GetValue(0)


def advice(data):
    array = data.GetFieldData().GetAbstractArray("Advice")
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())]


def corner_error(image_to_probe):
    """Largest distance in mm of the image's corners from where they are."""
    corners = np.array([[c, r, 0, 1] for c in (0, WIDTH - 1) for r in (0, HEIGHT - 1)])
    return np.linalg.norm(((image_to_probe - IMAGE_TO_PROBE) @ corners.T)[:3], axis=0).max()
