# SPDX-License-Identifier: BSD-3-Clause
"""Your own pictures and poses: a series of PNG files and a CSV table become tracked slices and a volume.

    pvpython own_pictures.py [folder for pictures and data, default: .]

So that the result can be judged, the pictures are those of a phantom whose truth is known: they are written as any
program would write them, in colour and with a time and a pose (metres, quaternion) for each.
"""
import os
import struct
import sys
import zlib

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna import pictures
from paraview.simple import *
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

SPACING = 0.2  # mm
SENSOR = [[0.96, 0, 0.28, 12], [0, 1, 0, 150], [-0.28, 0, 0.96, -25], [0, 0, 0, 1]]  # transducer to sensor, mm


def quaternion(rotation):
    """x y z w of a rotation matrix."""
    _, vectors = np.linalg.eigh(np.array([
        [rotation[0, 0] - rotation[1, 1] - rotation[2, 2], 0, 0, 0],
        [rotation[0, 1] + rotation[1, 0], rotation[1, 1] - rotation[0, 0] - rotation[2, 2], 0, 0],
        [rotation[0, 2] + rotation[2, 0], rotation[1, 2] + rotation[2, 1], rotation[2, 2] - rotation[0, 0] - rotation[1, 1], 0],
        [rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1], np.trace(rotation)]]))
    return vectors[:, -1]


def write_png(name, rgb):
    """Row 0 of rgb is the top of the picture."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    height, width, _ = rgb.shape
    rows = b"".join(b"\0" + row.tobytes() for row in rgb)
    with open(name, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def record(folder):
    """What a scanner and a tracker would leave: slice-000.png ..., poses.csv, and the calibration."""
    sweep = PhantomSweep(Anatomy="Ellipsoids", Motion="Arbitrary", NumberOfSlices=80, SpeckleLevel=0.1, PixelSpacing=SPACING)
    sweep.UpdatePipeline()
    data = servermanager.Fetch(sweep)
    fields = data.GetFieldData()
    columns, rows, slices = data.GetDimensions()
    grey = vtk_to_numpy(data.GetPointData().GetScalars()).reshape(slices, rows, columns)
    for number, picture in enumerate(grey):
        write_png(os.path.join(folder, f"slice-{number:03}.png"), np.repeat(picture[:, :, None], 3, axis=2))
    # the tracker's sensor is fixed to the probe at some distance from the transducer
    poses = vtk_to_numpy(fields.GetArray("ProbeToReference")).reshape(slices, 4, 4) @ np.linalg.inv(SENSOR)
    # the operator begins in a hurry
    times = np.cumsum([0.03 if number < 27 else 0.12 for number in range(slices)])
    with open(os.path.join(folder, "poses.csv"), "w", encoding="ascii") as file:
        file.write("time,tx [m],ty [m],tz [m],qx,qy,qz,qw\n")
        for time, pose in zip(times, poses):
            numbers = [time, *(pose[:3, 3] / 1000), *quaternion(pose[:3, :3])]
            file.write(",".join(f"{value:.9f}" for value in numbers) + "\n")
    calibration = SENSOR @ vtk_to_numpy(fields.GetArray("ImageToProbe")).reshape(4, 4) / [SPACING, SPACING, SPACING, 1]
    return sweep, calibration


def main(folder):
    os.makedirs(folder, exist_ok=True)
    phantom, calibration = record(folder)
    poses = vtk_to_numpy(servermanager.Fetch(phantom).GetFieldData().GetArray("ImageToReference"))

    # from here on: what you do with your own
    names = sorted(os.path.join(folder, name) for name in os.listdir(folder) if name.startswith("slice-"))
    stack = PNGSeriesReader(FileNames=names)
    table = CSVReader(FileName=[os.path.join(folder, "poses.csv")])
    slices = AssembleTrackedSlices(
        Input=stack, Poses=table, PoseFormat="Quaternion", LengthUnit="m", PixelSpacing=SPACING,
        ImageToProbe=list(calibration.ravel()))
    volume = SweptVolume(Input=slices, OutputSpacing=[0.5, 0.5, 0.5])
    surface = Contour(Input=volume, ContourBy=["POINTS", "Intensity"], Isosurfaces=[120], ComputeScalars=0)

    # the truth is known here: the same poses, and the grey levels of the phantom in the volume
    slices.UpdatePipeline()
    own = vtk_to_numpy(servermanager.Fetch(slices).GetFieldData().GetArray("ImageToReference"))
    error = np.abs(own - poses).max()
    print(f"poses differ by {error:.1e} mm at most", flush=True)
    assert error < 1e-4
    volume.UpdatePipeline()
    image = servermanager.Fetch(volume)
    grey = vtk_to_numpy(image.GetPointData().GetArray("Intensity")).astype(float)
    inside = np.flatnonzero(vtk_to_numpy(image.GetPointData().GetArray("vtkValidPointMask")))[::997]
    truth = phantom.GetClientSideObject()
    difference = [grey[i] - truth.EvaluateTruth(*image.GetPoint(i)) for i in inside]
    mirrored = [grey[i] - truth.EvaluateTruth(-image.GetPoint(i)[0], *image.GetPoint(i)[1:]) for i in inside]
    print(f"RMS error of the volume {np.std(difference):.1f} grey levels, {np.std(mirrored):.1f} against its mirror image", flush=True)
    assert np.std(difference) < 8 < 12 < np.std(mirrored)

    draw(slices, surface, folder)


def look(view):
    pictures.look(view, (-0.62, 0.38, 0.8), (0, -1, 0), 1.15)
    pictures.add_scale_bar(view, 20)


def draw(slices, surface, folder):
    # one slice among the outlines of others, and a quarter of the surface in front of it
    view = pictures.new_view((900, 700))
    one = ExtractSubset(Input=slices)
    extent = slices.GetDataInformation().GetExtent()
    middle = (extent[5] + 1) // 2
    one.VOI = [*extent[:4], middle, middle]
    pictures.show_slices(SlicePlanes(Input=one), view)
    pictures.show_slices(SlicePlanes(Input=slices, Stride=8, OutlineOnly=1), view)
    pose = vtk_to_numpy(servermanager.Fetch(slices).GetFieldData().GetArray("ImageToReference")).reshape(-1, 4, 4)[middle]
    normal = np.cross(pose[:3, 0], pose[:3, 1])
    front = Clip(Input=surface, ClipType="Plane", Invert=1)
    front.ClipType.Origin = list(pose[:3, 3])
    front.ClipType.Normal = list(normal)
    half = Clip(Input=front, ClipType="Plane", Invert=0)
    half.ClipType.Origin = list((pose @ (0.47 * extent[1], 0.47 * extent[3], 0, 1))[:3])
    half.ClipType.Normal = list(0.6 * pose[:3, 0] + 0.9 * pose[:3, 1])
    pictures.show_surface(half, view, pictures.TISSUE)
    look(view)
    pictures.save(view, os.path.join(folder, "planes-intensity.png"))

    for color_by in ("Speed", "RegistrationError"):
        view = pictures.new_view((900, 700))
        pictures.show_slices(SlicePlanes(Input=slices, Stride=5, ColorBy=color_by), view)
        look(view)
        pictures.save(view, os.path.join(folder, f"planes-{color_by.lower()}.png"))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else ".")
