# SPDX-License-Identifier: BSD-3-Clause
"""All that writes files alike: links are followed and stay, a full disk is an error that leaves what was there, nothing is left aside."""
import contextlib
import errno
import glob
import os
import resource
import shutil
import signal
import stat
import time
import unittest.mock

import calibration_scans as scans
import numpy as np
from lacuna_test import output
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkPoints, vtkVersion
from vtkmodules.vtkCommonDataModel import vtkStructuredGrid

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
import lacuna
from lacuna import outlines, pictures, states
from lacuna.data import fetch
from lacuna.errors import PipelineError, raising
from lacuna.files import save_data, writing
from lacuna.solids import save_solid

FULL = resource.RLIMIT_FSIZE  # a limit of the size of files, as a full disk


@contextlib.contextmanager
def full_disk(size):
    """Files grow up to so many bytes."""
    before = resource.getrlimit(FULL)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(FULL, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(FULL, before)
        signal.signal(signal.SIGXFSZ, handler)


place = output("WrittenFiles")
shutil.rmtree(place, ignore_errors=True)
os.mkdir(place)

sweep = PhantomSweep(NumberOfSlices=12)
sphere = Sphere(ThetaResolution=60, PhiResolution=60)
coarse = Sphere(ThetaResolution=12, PhiResolution=12)
depth = BSplineIsoRayCaster(Input=SkullPhantom(Spacing=[3, 3, 3]), IsoValues=[500], ViewDirection=[-0.4, 0.2, -0.9])
filled = RBFHoleFiller(Input=depth, Smoothing=5, NodeSpacing=3)
outliner = SliceOutliner(Input=sweep)
for number in range(4, 8):
    outlines.add(outliner, "Organ", number, [(10, 10), (60, 10), (60, 50), (10, 60)])
view = CreateView("RenderView")
view.ViewSize = [300, 200]
Show(sphere, view)


def mould():
    """61 x 41 points at 1 mm, in the press."""
    x, y = np.meshgrid(np.arange(61.0), np.arange(41.0))
    grid = vtkStructuredGrid()
    grid.SetDimensions(61, 41, 1)
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.stack([x, y, -2 + 0.02 * x], axis=2).reshape(-1, 3), deep=True))
    grid.SetPoints(points)
    matrix = numpy_to_vtk(np.eye(4).reshape(1, 16), deep=True)
    matrix.SetName("PressToPatient")
    grid.GetFieldData().AddArray(matrix)
    source = TrivialProducer()
    source.GetClientSideObject().SetOutput(grid)
    source.UpdatePipeline()
    return source


def calibration():
    """Probe Calibration's file: it replaces only its own."""
    random = np.random.default_rng(5)
    poses, shown = [], []
    for _ in range(40):
        scan = scans.pose(scans.looking_down(random, 50), [*random.uniform(-40, 40, 2), 0])
        scan[2, 3] = -(scan[2, :2] @ [0.5 * scans.WIDTH * scans.SPACING, random.uniform(0.3, 0.8) * scans.HEIGHT * scans.SPACING])
        poses.append(scans.probe_to_tracker(scan))
        shown.append(scans.wall_picture(scan, random))
    bath = scans.open_scan("WrittenFilesBath", np.array(shown), poses)

    def write(name):
        proxy = ProbeCalibration(Input=bath, Method="SingleWall", PixelSpacing=scans.SPACING, OutputFileName=name)
        with raising():
            proxy.UpdatePipeline()
        Delete(proxy)
    return write


def saved(source, **options):
    def write(name):
        with raising():
            SaveData(name, source, **options)
    return write


def text_file(name):
    with writing(name) as aside, open(aside, "w", encoding="ascii") as file:
        file.write("x" * 10000)


def pixels(name):
    pictures.write_pixels(name, np.random.default_rng(1).integers(0, 255, (100, 100, 3), dtype=np.uint8))


path = MillingToolPath(Input=mould(), MapSpacing=0.5)

WRITERS = {  # by names of files
    "surface.igs": saved(filled), "path.nc": saved(path),
    "sweep.mha": saved(sweep), "packed.mha": saved(sweep, CompressionLevel=6), "sweep.nrrd": saved(sweep),
    "apart.mhd": saved(sweep), "apart.nhdr": saved(sweep, CompressionLevel=6),
    "calibration.xml": calibration(),
    "solid.stl": lambda name: save_solid(name, sphere), "solid.3mf": lambda name: save_solid(name, sphere),
    "solid.vtp": lambda name: save_solid(name, sphere), "solid.step": lambda name: save_solid(name, coarse), "step.stp": saved(coarse),
    "outlines.csv": lambda name: outlines.save(outliner, name), "state.pvsm": states.save,
    "picture.png": lambda name: pictures.save(view, name), "pixels.png": pixels,
    "image.vti": lambda name: save_data(name, depth, DataMode="Binary"), "notes.txt": text_file,
}
BESIDE = {"apart.mhd": ["apart.zraw"], "apart.nhdr": ["apart.raw.gz"], **{name: [name + ".json"] for name in WRITERS if name.startswith("solid")}}


def content(name):
    with open(name, "rb") as file:
        return file.read()


def listing(*folders):
    return sorted(os.path.relpath(os.path.join(folder, name), place) for folder in folders for name in os.listdir(folder))


for name, write in WRITERS.items():
    print(name, flush=True)
    folder, store = os.path.join(place, name), os.path.join(place, name + "-store")
    os.mkdir(folder)
    os.mkdir(store)
    real, link = os.path.join(store, "real" + os.path.splitext(name)[1]), os.path.join(folder, name)
    os.symlink(os.path.relpath(real, folder), link)

    # where the link leads, whether there is something or not; the link stays, and nothing else comes
    expected = listing(folder, store) + [os.path.relpath(real, place)] + [os.path.join(name, each) for each in BESIDE.get(name, [])]
    for again in range(2):
        write(link)
        assert os.path.islink(link) and os.path.isfile(real), (name, again)
        assert listing(folder, store) == sorted(expected), (name, listing(folder, store))
    size = os.path.getsize(real)
    before = content(real)

    # a disk that is full after a part of it: an error, and what was there stays
    with full_disk(size // 2):
        try:
            write(link)
            raise AssertionError(f"{name}: no error on a full disk")
        except (PipelineError, OSError) as error:
            assert str(error), name
    if name.startswith("solid"):  # older ones step aside
        assert content(real + ".old") == before and not os.path.exists(real), name
        shutil.move(real + ".old", real)
        shutil.move(link + ".json.old", link + ".json")
    assert content(real) == before and os.path.islink(link), name
    assert listing(folder, store) == sorted(expected), (name, listing(folder, store))

# ParaView's own writers tell nobody; raising() does
surface = DepthMapSurface(Input=depth)
# VTK 9.6 and later end the program in the other modes (Documentation/DeveloperGuide/reports.md)
polygons = "Ascii" if (vtkVersion.GetVTKMajorVersion(), vtkVersion.GetVTKMinorVersion()) < (9, 6) else "Appended"
for ending, source, options in (("vti", depth, {"DataMode": "Binary"}), ("vti", depth, {"DataMode": "Appended"}), ("csv", depth, {}),
                                ("vtp", surface, {"DataMode": polygons}), ("ply", surface, {}), ("obj", surface, {}), ("stl", surface, {}),
                                ("vtk", surface, {}), ("pvti", depth, {"DataMode": "Binary"})):
    name = os.path.join(place, f"paraview.{ending}")
    with raising():
        SaveData(name, source, **options)
    size = max(os.path.getsize(each) for each in glob.glob(os.path.join(place, "paraview*")) + glob.glob(os.path.join(place, "paraview/*"))
               if os.path.isfile(each))
    with full_disk(size // 2):
        try:
            with raising():
                SaveData(name, source, **options)
            raise AssertionError(f"{ending} {options}: no error on a full disk")
        except PipelineError as error:
            print(ending, options, error, flush=True)
    for each in glob.glob(os.path.join(place, "paraview*")):
        shutil.rmtree(each) if os.path.isdir(each) else os.remove(each)
# a pipe gets the whole file and stays; so would a device
for name, write in (("pipe.txt", text_file), ("pipe.png", pixels)):
    pipe = os.path.join(place, name)
    os.mkfifo(pipe)
    end = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write(pipe)
    assert stat.S_ISFIFO(os.lstat(pipe).st_mode), name
    write(pipe + ".file" + os.path.splitext(name)[1])
    assert os.read(end, 1 << 16) == content(pipe + ".file" + os.path.splitext(name)[1]), name
    os.close(end)
for pipe in (os.path.join(place, "pipe.stl"), os.path.join(place, "piped.stl.json")):
    os.mkfifo(pipe)
    try:
        save_solid(pipe.removesuffix(".json"), sphere)
        raise AssertionError("no error")
    except PipelineError as error:
        assert "is a device or a pipe" in str(error), error
    assert stat.S_ISFIFO(os.lstat(pipe).st_mode), pipe
loop = os.path.join(place, "loop.txt")
os.symlink("loop.txt", loop)
try:
    text_file(loop)
    raise AssertionError("no error")
except OSError as error:
    assert error.errno == errno.ELOOP and os.path.islink(loop), error

# the disk's clock may be late: what was just written was written; an empty file of somebody else is none of the writer's
other = os.path.join(place, "lately.lock")
open(other, "w", encoding="ascii").close()
os.utime(other, (time.time() + 60,) * 2)
with unittest.mock.patch("lacuna.errors.time.time_ns", return_value=time.time_ns() + 10**10), raising():
    SaveData(os.path.join(place, "late.vti"), depth)

# what a killed process leaves, the next one takes away; what a living one has, and others' folders, it does not
folder = os.path.join(place, "left")
os.mkdir(folder)


def write_for_long(ready, end):
    """A process in the middle of writing, until end is closed."""
    process = os.fork()
    if process == 0:
        os.close(end[1])
        with writing(os.path.join(folder, "a.txt")) as name:
            with open(name, "w", encoding="ascii") as file:
                file.write("x")
            os.write(ready[1], b".")
            os.read(end[0], 1)
        os._exit(0)
    assert os.read(ready[0], 1) == b"."
    return process


ready, end = os.pipe(), os.pipe()
dead, living = write_for_long(ready, end), write_for_long(ready, end)
assert len(os.listdir(folder)) == 2
os.kill(dead, signal.SIGKILL)
os.waitpid(dead, 0)
os.mkdir(os.path.join(folder, "other"))
for each in os.listdir(folder):
    os.utime(os.path.join(folder, each), (time.time() - 3600,) * 2)
text_file(os.path.join(folder, "b.txt"))
left = os.listdir(folder)
assert len(left) == 3 and {"other", "b.txt"} < set(left), left
os.close(end[1])
assert os.waitpid(living, 0)[1] == 0
assert sorted(os.listdir(folder)) == ["a.txt", "b.txt", "other"]

# an error whose text has any bytes, of a file or of its name
wrong = os.path.join(place, "latin1.mha")
with open(wrong, "wb") as file:
    file.write(b"ObjectType = Image\nNDims = 3\nDimSize = 1 1 1\nElementType = MET_\xdc\x1b[2JCHAR\nSeq_Frame0000_ImageStatus = OK\nElementDataFile = LOCAL\nx")
for attempt in range(2):
    reader = TrackedSliceReader(FileName=wrong)
    try:
        with raising():
            reader.UpdatePipeline()
        raise AssertionError("no error")
    except PipelineError as error:
        assert "'MET_\\xdc\\x1b[2JCHAR'" in str(error), error
    try:  # as it is kept in the data
        fetch(reader)
        raise AssertionError("no error")
    except PipelineError as error:
        assert "'MET_\\xdc\\x1b[2JCHAR'" in str(error), error
    Delete(reader)
try:  # one of ParaView's own, of which VTK gives Python nothing
    with raising():
        window = vtkOutputWindow.GetInstance()
        window.DisplayErrorText(b"ERROR: In x.cxx, line 1\nvtkThing (0x1): Cannot read Stra\xdfe.vti\n\n")
    raise AssertionError("no error")
except PipelineError as error:
    assert "not UTF-8" in str(error), error
print("done", flush=True)
