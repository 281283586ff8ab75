# SPDX-License-Identifier: BSD-3-Clause
"""Scans of calibration phantoms with a probe whose image lies in a known place."""
import csv
import os
import sys

import numpy as np
from paraview.simple import CSVReader, XMLImageDataReader
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

from lacuna_test import output
from tracked_slice_files import tracked_slices

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Documentation", "Examples", "04-calibration"))
from scans import looking_down, pose, rotation  # noqa: F401 (for the tests, too)

WIDTH, HEIGHT, SPACING = 200, 160, 0.4  # 80 x 64 mm

# The receiver is some way off the image and askew; nothing is symmetric.
SCAN_TO_PROBE = pose(rotation([1, 2, -0.5], 70), [25, -60, 110])
IMAGE_TO_PROBE = SCAN_TO_PROBE @ np.diag([SPACING, SPACING, 1, 1])
PHANTOM_TO_TRACKER = pose(rotation([0.3, -1, 0.4], 130), [200, -80, 150])


def probe_to_tracker(scan_to_phantom):
    return PHANTOM_TO_TRACKER @ scan_to_phantom @ np.linalg.inv(SCAN_TO_PROBE)


def corner_error(matrix):
    """Largest distance in mm of the image's corners from where they are."""
    corners = np.array([[c, r, 0, 1] for c in (0, WIDTH - 1) for r in (0, HEIGHT - 1)])
    return np.linalg.norm(((matrix - IMAGE_TO_PROBE) @ corners.T)[:3], axis=0).max()


def wall_picture(scan_to_phantom, random):
    """A bath with specks and the floor z = 0 of the phantom."""
    row, column = np.mgrid[:HEIGHT, :WIDTH]
    pixels = np.stack([SPACING * column, SPACING * row, 0 * row, 1 + 0 * row], axis=-1)
    height = pixels @ scan_to_phantom[2]
    # ultrasound comes back only where it meets the floor near to a right angle; here everywhere
    grey = 20 * random.random((HEIGHT, WIDTH)) + 220 * np.exp(-(height / 0.8) ** 2)
    return np.clip(grey, 0, 255).astype(np.uint8)


def wire_picture(scan_to_phantom, random):
    """A bath with the three wires: spots with tails and echoes in speckle, below the bright transducer."""
    row, column = np.mgrid[:HEIGHT, :WIDTH]
    grey = np.hypot(*random.normal(scale=9, size=(2, HEIGHT, WIDTH)))
    grey = (grey + np.roll(grey, 1, axis=1)) / 2 + np.clip(140 - 25 * row, 0, None)
    phantom_to_scan = np.linalg.inv(scan_to_phantom)
    for wire in range(3):
        along, place = phantom_to_scan[2, wire], phantom_to_scan[2, 3]
        if abs(along) < 0.2:  # too flat to be a spot
            continue
        point = np.zeros(4)
        point[wire], point[3] = -place / along, 1
        spot = (phantom_to_scan @ point)[:2] / SPACING
        if abs(point[wire]) > 60 or not (-20 < spot[0] < WIDTH + 20 and -20 < spot[1] < HEIGHT + 20):
            continue
        x, y = column - spot[0], row - spot[1]
        x = x - 0.15 * y  # the beam is askew
        lobe = np.exp(-0.5 * (y / 1.1) ** 2)
        tail = np.where(y > 0, 0.4 * (1 - np.exp(-y)) * np.exp(-y / 14) * (0.8 + 0.2 * np.cos(1.3 * y)), 0)
        echo = 0.3 * np.exp(-0.5 * ((y - 24) / 1.3) ** 2)
        width = 2 + 1.5 * spot[1] / HEIGHT
        grey += random.uniform(150, 300) * np.exp(-0.5 * (x / width) ** 2) * np.maximum(lobe, np.maximum(tail, echo))
    return np.clip(grey, 0, 255).astype(np.uint8)


def wire_sweep(wire, count, random):
    """Poses (scan to phantom) of a sweep along a wire, and the pixels in which it is seen."""
    poses, pixels = [], []
    phase = random.uniform(0, 2 * np.pi, 6)
    for s in np.linspace(0, 1, count):
        place = np.zeros(3)
        place[wire] = 8 + 38 * (2 * s) if s < 0.5 else -46 + 38 * (2 * s - 1)
        turn = np.roll(np.eye(3), -wire - 1, axis=1)  # the image is across the wire
        turn = rotation(np.eye(3)[wire], 70 * np.sin(5 * s + phase[0])) @ turn
        turn = rotation(turn[:, 0], 40 * np.sin(9 * s + phase[1])) @ turn
        turn = rotation(turn[:, 1], 35 * np.sin(7 * s + phase[2])) @ turn
        pixel = np.array([0.5 + 0.4 * np.sin(8 * s + phase[3]), 0.55 + 0.37 * np.sin(6 * s + phase[4])])
        pixel = pixel * [WIDTH, HEIGHT]
        pixels.append(pixel)
        poses.append(pose(turn, place - turn[:, :2] @ (SPACING * pixel)))
    return poses, pixels


def open_scan(name, pixels, poses, times=None):
    stack = tracked_slices(pixels, poses)
    fields = stack.GetFieldData()
    fields.GetArray("ImageToReference").SetName("ProbeToTracker")
    if times is not None:
        array = numpy_to_vtk(np.asarray(times, float), deep=1)
        array.SetName("Timestamp")
        fields.AddArray(array)
    path = output(name + ".vti")
    writer = vtkXMLImageDataWriter()
    writer.SetDataModeToBinary()
    writer.SetInputData(stack)
    writer.SetFileName(path)
    writer.Write()
    return XMLImageDataReader(FileName=[path])


def open_table(name, columns, rows):
    path = output(name + ".csv")
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(rows)
    return CSVReader(FileName=[path])


def open_wall(prefix, random):
    """A wall that a probe is moved to and fro before: for the lag of the video."""
    wall, times = [], 0.04 * np.arange(150)
    for time in times:
        turn = rotation([0, 1, 0], 8) @ np.column_stack([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
        wall.append(pose(turn, [0, 0, 35 + 8 * np.sin(6.1 * time) + 4 * np.sin(3.7 * time + 1)]))
    return open_scan(prefix + "wall", np.array([wall_picture(pose, random) for pose in wall]),
                    [probe_to_tracker(pose) for pose in wall], times)


def open_wires(prefix, random):
    """Slices without pictures, and the picks of three wires in them."""
    rows, poses = [], []
    for i in range(30):
        wire = i % 3
        place = np.zeros(3)
        place[wire] = random.uniform(-40, 40)
        turn = rotation(random.normal(size=3), random.uniform(-35, 35)) @ np.roll(np.eye(3), -wire - 1, axis=1)
        pixel = random.uniform([10, 10], [WIDTH - 10, HEIGHT - 10])
        poses.append(probe_to_tracker(pose(turn, place - turn[:, :2] @ (SPACING * pixel))))
        rows.append([i, *(pixel + random.uniform(-0.5, 0.5, 2)), "XYZ"[wire]])
    scan = open_scan(prefix + "wires", np.zeros((30, HEIGHT, WIDTH), np.uint8), poses)
    return scan, open_table(prefix + "picks", ["Slice", "Column", "Row", "Wire"], rows)


def open_receivers(prefix, random):
    """A table of two receivers that are fixed to each other."""
    rows = []
    for i in range(60):
        turn, place = rotation(random.normal(size=3), random.uniform(-60, 60)), random.uniform([20, -25, -15], [50, 20, 15])
        for station, where in ((1, place), (2, place + turn @ [20, 1, 2])):
            angles = [np.arctan2(turn[1, 0], turn[0, 0]), -np.arcsin(turn[2, 0]), np.arctan2(turn[2, 1], turn[2, 2])]
            rows.append([30 * i + 0.0083 * station, station, *where, *np.degrees(angles)])
    return open_table(prefix + "receivers", ["Time", "Station", "x", "y", "z", "azimuth", "elevation", "roll"], rows)
