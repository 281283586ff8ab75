# SPDX-License-Identifier: BSD-3-Clause
"""Assemble Tracked Slices in pvpython: three formats of poses, all kinds of pictures, laterality, state, errors."""
import os

import lacuna
import numpy as np
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkBMPReader, vtkBMPWriter, vtkJPEGWriter

from lacuna_test import check_defaults, output

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna.errors import PipelineError, raising
import own_pictures_files as files

SLICES = 24
FOLDER = os.path.dirname(output("assemble/x"))
os.makedirs(FOLDER, exist_ok=True)


def fetch(proxy):
    """The output with pixels [slice, row, column] and poses [slice, 4, 4]."""
    proxy.UpdatePipeline()
    data = servermanager.Fetch(proxy)
    columns, rows, slices = data.GetDimensions()
    pixels = vtk_to_numpy(data.GetPointData().GetScalars()).reshape(slices, rows, columns)
    poses = data.GetFieldData().GetArray("ImageToReference")
    return data, pixels, vtk_to_numpy(poses).reshape(-1, 4, 4) if poses else None


def path(name):
    return os.path.join(FOLDER, name)


def table(name):
    return CSVReader(FileName=[path(name)])


# Defaults of the proxy = defaults of the class.
sweep = PhantomSweep(Anatomy="Vessels", Motion="Arbitrary", NumberOfSlices=SLICES, ImageSize=[160, 120], PixelSpacing=0.4)
data, pixels, poses = fetch(sweep)
fields = data.GetFieldData()
probe = vtk_to_numpy(fields.GetArray("ProbeToReference")).reshape(-1, 4, 4)
calibration = vtk_to_numpy(fields.GetArray("ImageToProbe")).reshape(4, 4)
rigid = calibration / [0.4, 0.4, 0.4, 1]
times = vtk_to_numpy(fields.GetArray("Timestamp"))
files.write_poses(path("matrix.csv"), "Matrix", probe, extra={"time": times.tolist()})
files.write_poses(path("quaternion.csv"), "Quaternion", probe, unit=1000.0)
files.write_poses(path("euler.csv"), "Euler", probe, unit=25.4)

first = AssembleTrackedSlices(Input=sweep, Poses=table("matrix.csv"))
plain = lacuna.vtkLacunaAssembleTrackedSlices()
enumerations = {
    "PoseFormat": ["Matrix", "Quaternion", "Euler"],
    "PoseTransform": ["ProbeToReference", "ReferenceToProbe", "ImageToReference", "ReferenceToImage"],
    "LengthUnit": ["mm", "m", "cm", "inch"],
    "RowOrder": ["Automatic", "TopRowFirst", "BottomRowFirst"],
    "MatchBy": ["Order", "FrameNumber", "Time"]}
names = ["FrameColumn", "TimestampColumn", "StatusColumn", "GateColumn", "GateRange", "FirstFrameNumber",
         "FrameRate", "TimeOffset", "MaximumTimeGap", "SkipInvalidPoses"]
check_defaults(first, plain, names, enumerations)
assert list(first.PixelSpacing) == [0] and plain.GetPixelSpacing() == (0, 0)
assert list(first.ImageToProbe) == np.eye(4).ravel().tolist()
assert plain.GetNumberOfPoseColumns() == 0 and len(first.PoseColumns) == 0
listed = set(enumerations) | set(names) | {"Input", "Poses", "PixelSpacing", "ImageToProbe", "PoseColumns"}
assert set(first.ListProperties()) - {"PointData", "CellData", "FieldData"} == listed, first.ListProperties()

# Without calibration: poses of the probe only, and a warning that says what to do.
warnings = []
with raising(warnings):
    data, own_pixels, own_poses = fetch(first)
assert own_poses is None and data.GetFieldData().GetArray("ProbeToReference").GetNumberOfTuples() == SLICES
assert any("Set PixelSpacing" in text for text in warnings), warnings

# The spacing is one number or two, and may stand in the matrix instead.
for settings in (dict(PixelSpacing=0.4, ImageToProbe=rigid.ravel().tolist()),
                 dict(PixelSpacing=[0.4, 0.4], ImageToProbe=rigid.ravel().tolist()),
                 dict(PixelSpacing=0, ImageToProbe=calibration.ravel().tolist()),
                 dict(PixelSpacing=0.4, ImageToProbe=calibration.ravel().tolist())):
    for name, value in settings.items():
        setattr(first, name, value)
    with raising():
        data, own_pixels, own_poses = fetch(first)
    assert np.abs(own_poses[:, :, [0, 1, 3]] - poses[:, :, [0, 1, 3]]).max() < 1e-12, settings
    assert np.array_equal(own_pixels, pixels)
assert np.array_equal(vtk_to_numpy(data.GetFieldData().GetArray("Timestamp")), times)

# The formats give the same, and so does what is made of it.
first.PixelSpacing = 0.4
first.ImageToProbe = rigid.ravel().tolist()
quaternions = AssembleTrackedSlices(
    Input=sweep, Poses=table("quaternion.csv"), PoseFormat="Quaternion", LengthUnit="m", PixelSpacing=0.4,
    ImageToProbe=rigid.ravel().tolist())
angles = AssembleTrackedSlices(
    Input=sweep, Poses=table("euler.csv"), PoseFormat="Euler", LengthUnit="inch", PixelSpacing=0.4,
    ImageToProbe=rigid.ravel().tolist())
for other in (quaternions, angles):
    with raising():
        assert np.abs(fetch(other)[2] - fetch(first)[2]).max() < 1e-10


def volume(slices):
    proxy = SweptVolume(Input=slices, OutputSpacing=[0.8, 0.8, 0.8], OutputBounds=[-30, 30, -24, 24, -24, 24])
    proxy.UpdatePipeline()
    image = servermanager.Fetch(proxy)
    points = image.GetPointData()
    return image, vtk_to_numpy(points.GetArray("Intensity")), vtk_to_numpy(points.GetArray("vtkValidPointMask"))


first.ImageToProbe = calibration.ravel().tolist()
first.PixelSpacing = 0
image, grey, mask = volume(sweep)
assert mask.mean() > 0.5
assert np.array_equal(volume(first)[1], grey) and np.array_equal(volume(first)[2], mask)
for other in (quaternions, angles):
    _, own, own_mask = volume(other)
    assert (own_mask != mask).mean() < 1e-3 and (np.abs(own.astype(int) - grey) > 1).mean() < 1e-3

# Inverse and image poses.
matrices = {
    "ReferenceToProbe": np.linalg.inv(probe), "ImageToReference": poses, "ReferenceToImage": np.linalg.inv(poses)}
for transform, written in matrices.items():
    files.write_poses(path("other.csv"), "Matrix", written)
    other = AssembleTrackedSlices(Input=sweep, Poses=table("other.csv"), PoseTransform=transform)
    if transform == "ReferenceToProbe":
        other.ImageToProbe = calibration.ravel().tolist()
    with raising():
        assert np.abs(fetch(other)[2] - poses).max() < 1e-9, transform
    assert (fetch(other)[0].GetFieldData().GetArray("ProbeToReference") is None) == ("Image" in transform)

# Pictures of all kinds, as other programs write them: the top row of the picture is row 0.
for number, picture in enumerate(pixels):
    files.write_png(path(f"grey{number:03}.png"), picture)
    files.write_png(path(f"colour{number:03}.png"), np.repeat(picture[:, :, None], 3, axis=2))
    files.write_tiff(path(f"t{number:03}.tif"), picture)
    files.write_mha(path(f"m{number:03}.mha"), picture)
files.write_mha(path("stack.mha"), pixels)


def series(pattern):
    return [path(pattern.format(number)) for number in range(SLICES)]


stacks = {
    "PNG": PNGSeriesReader(FileNames=series("grey{:03}.png"), ReadAsImageStack=1),
    "colour PNG": PNGSeriesReader(FileNames=series("colour{:03}.png"), ReadAsImageStack=1),
    "PNG as time steps": PNGSeriesReader(FileNames=series("grey{:03}.png"), ReadAsImageStack=0),
    "TIFF": TIFFSeriesReader(FileNames=series("t{:03}.tif"), ReadAsImageStack=1),
    "TIFF as time steps": TIFFSeriesReader(FileNames=series("t{:03}.tif"), ReadAsImageStack=0),
    "MetaImage": MetaFileSeriesReader(FileNames=[path("stack.mha")]),
    "MetaImages as time steps": MetaFileSeriesReader(FileNames=series("m{:03}.mha")),
}
for kind, stack in stacks.items():
    other = AssembleTrackedSlices(Input=stack, Poses=table("matrix.csv"), ImageToProbe=calibration.ravel().tolist())
    with raising():
        data, own_pixels, own_poses = fetch(other)
    assert own_pixels.shape == pixels.shape, (kind, own_pixels.shape)
    assert np.array_equal(own_pixels, pixels), kind
    assert np.array_equal(own_poses, poses), kind
    assert data.GetSpacing() == (1, 1, 1) and data.GetOrigin() == (0, 0, 0), kind

# JPEG and BMP by VTK's writers, which know that the last row of an image is the top of a picture.
for reader, writer, extension, most in ((JPEGSeriesReader, vtkJPEGWriter, "jpg", 12), (None, vtkBMPWriter, "bmp", 0)):
    picture = vtkImageData()
    picture.SetDimensions(160, 120, 1)
    picture.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(pixels[7, ::-1]).ravel(), deep=1))
    writer = writer()
    writer.SetInputData(picture)
    writer.SetFileName(path("one." + extension))
    if extension == "jpg":
        writer.SetQuality(100)
    writer.Write()
    if reader is None:
        reader = TrivialProducer()
        bmp = vtkBMPReader()
        bmp.SetFileName(path("one.bmp"))
        bmp.Update()
        reader.GetClientSideObject().SetOutput(bmp.GetOutput())
    else:
        reader = reader(FileNames=[path("one." + extension)])
    files.write_poses(path("one.csv"), "Matrix", probe[7:8])
    with raising():
        _, own_pixels, _ = fetch(AssembleTrackedSlices(Input=reader, Poses=table("one.csv"), PixelSpacing=0.4))
    assert np.abs(own_pixels[0].astype(int) - pixels[7]).max() <= most, extension
files.write_dicom(path("one.dcm"), pixels[7], 7)
with raising():
    assert np.array_equal(fetch(AssembleTrackedSlices(
        Input=DICOMReaderSingleFile(FileName=path("one.dcm")), Poses=table("one.csv"), PixelSpacing=0.4))[1][0], pixels[7])

# Laterality: the volume of the PNG series is the phantom, and not its mirror image; with the wrong order it is not.
truth = sweep.GetClientSideObject()
png = AssembleTrackedSlices(
    Input=stacks["PNG"], Poses=table("matrix.csv"), ImageToProbe=calibration.ravel().tolist())
image, grey, mask = volume(png)
inside = np.flatnonzero(mask)[::53]


def error(levels, mirror):
    points = np.array([image.GetPoint(i) for i in inside]) * mirror
    return np.sqrt(np.mean([(levels[i] - truth.EvaluateTruth(*p)) ** 2 for i, p in zip(inside, points)]))


assert error(grey, (1, 1, 1)) < 6, error(grey, (1, 1, 1))
for axis in range(3):
    mirror = np.where(np.arange(3) == axis, -1, 1)
    assert error(grey, mirror) > 15, (axis, error(grey, mirror))
png.RowOrder = "TopRowFirst"
assert error(volume(png)[1], (1, 1, 1)) > 15

# A state finds files and settings again.
png.RowOrder = "BottomRowFirst"
png.PoseColumns = ["m"]
SaveState(path("state.py"))
SaveState(path("state.pvsm"))
ResetSession()
LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
LoadState(path("state.pvsm"))
png = next(proxy for (name, _), proxy in GetSources().items()
           if proxy.GetXMLName() == "LacunaAssembleTrackedSlices" and list(proxy.PoseColumns) == ["m"])
assert png.RowOrder == "BottomRowFirst" and list(png.ImageToProbe) == calibration.ravel().tolist()
with raising():
    assert np.array_equal(fetch(png)[1], pixels)

# Errors name what is wrong, and the next update is right again.
cases = [
    (dict(PoseFormat="Euler"), "which fit PoseFormat Matrix"),
    (dict(PoseColumns=["Needle"]), "beginning with 'Needle'"),
    (dict(ImageToProbe=np.diag([1.0, 1, -1, 1]).ravel().tolist()), "it mirrors"),
    (dict(PixelSpacing=-1), "PixelSpacing is -1"),
    (dict(PoseTransform="ReferenceToImage"), "set PixelSpacing"),
    (dict(MatchBy="FrameNumber"), "FrameColumn"),
    (dict(MatchBy="Time"), "set FrameRate"),
]
for change, words in cases:
    old = {name: getattr(png, name) for name in change}
    old = {name: list(value) if hasattr(value, "__len__") and not isinstance(value, str) else value for name, value in old.items()}
    for name, value in change.items():
        setattr(png, name, value)
    try:
        with raising():
            png.UpdatePipeline()
        raise AssertionError(f"no error for {change}")
    except PipelineError as problem:
        assert words in str(problem), (change, problem)
    for name, value in old.items():
        setattr(png, name, value)
    with raising():
        assert np.array_equal(fetch(png)[1], pixels)
png.Input = PNGSeriesReader(FileNames=series("grey{:03}.png")[1:], ReadAsImageStack=1)
try:
    with raising():
        png.UpdatePipeline()
    raise AssertionError("no error for 23 slices and 24 poses")
except PipelineError as problem:
    assert "23 slices but 24 rows" in str(problem), problem
# a picture that is missing: an error, not an endless wait
png.Input = PNGSeriesReader(FileNames=[*series("grey{:03}.png")[1:], path("missing.png")], ReadAsImageStack=0)
try:
    with raising():
        png.UpdatePipeline()
    raise AssertionError("no error for a missing picture")
except PipelineError as problem:
    assert "no picture at time step" in str(problem) or "missing.png" in str(problem), problem
print("ok")
