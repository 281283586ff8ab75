# SPDX-License-Identifier: BSD-3-Clause
"""How much memory each source and filter needs at its peak, as a multiple of its input and output, at two sizes.

    . build/release/lacuna-env.sh
    pvpython Testing/Benchmarks/memory.py [name ...]

Each is measured in a process of its own (Linux): resident memory over that before the filter runs, plus its input, divided
by input and output. 1 is the least that can be, below 1 what shares arrays with the input. Prints the table of the guide's page on memory.
"""
import os
import sys
import tempfile

import lacuna.plugin

lacuna.plugin.load()
from lacuna.errors import raising
from paraview import servermanager
from paraview.simple import *

MEBIBYTE = 1048576
FOLDER = tempfile.gettempdir()


def sweep(slices, **settings):
    return PhantomSweep(NumberOfSlices=slices, ImageSize=[640, 480], PixelSpacing=0.1, Motion="Twist", **settings)


def wavelet(n):
    return Wavelet(WholeExtent=[0, n - 1] * 3)


def skull(spacing):
    return SkullPhantom(Spacing=[spacing] * 3)


def depth(spacing, **settings):
    return BSplineIsoRayCaster(Input=SkullPhantom(Spacing=[1, 1, 1]), IsoValues=[500], PixelSpacing=spacing, **settings)


def filled(spacing):
    fill = RBFHoleFiller(Input=depth(spacing, ViewDirection=[-0.5, 0.2, -0.8]), NodeSpacing=2, Smoothing=5)
    fill.DefectRegion = "Sphere"
    fill.DefectRegion.Center = [37, -15, 60]
    fill.DefectRegion.Radius = 34
    return fill


def reader(slices):
    name = os.path.join(FOLDER, f"lacuna-memory-{os.getpid()}.mha")
    source = sweep(slices)
    SaveData(name, source, CompressionLevel=0)
    Delete(source)
    made = OpenDataFile(name)
    made.UpdatePipelineInformation()
    os.remove(name)  # it is open
    return made


def assembled(slices):
    name = os.path.join(FOLDER, f"lacuna-memory-{os.getpid()}.csv")
    with open(name, "w", encoding="ascii") as file:
        file.write("Slice," + ",".join(f"m{n}" for n in range(16)) + "\n")
        for n in range(slices):
            file.write(f"{n},1,0,0,0,0,1,0,0,0,0,1,{0.1 * n},0,0,0,1\n")
    table = CSVReader(FileName=[name])
    table.UpdatePipeline()
    os.remove(name)
    images = Wavelet(WholeExtent=[0, 639, 0, 479, 0, slices - 1])
    return AssembleTrackedSlices(Input=images, Poses=table, PoseFormat="Matrix", PoseColumns=["m"], PixelSpacing=0.1)


def landmarks():
    return Sphere(Radius=50, ThetaResolution=12, PhiResolution=8)


def warp(n):
    moved = Transform(Input=landmarks())
    moved.Transform.Rotate = [0, 0, 10]
    return RBFImageWarp(Input=wavelet(n), Landmarks=landmarks(), Targets=moved, Kernel="Linear")


def interpolate(spacing):
    warmth = Calculator(Input=landmarks(), ResultArrayName="Warmth", Function="coordsX")
    return RBFInterpolator(Input=warmth, ScalarArray="Warmth", Kernel="Linear", OutputSpacing=[spacing] * 3)


def shape(n, **settings):
    return IncompleteShape(Shape="Sphere", Dimensions=[n] * 3, PresentFraction=0.6, Seed=3, **settings)


def angle(n):
    return OccludedAngle(Input=shape(n), NumberOfDirections=6, ThresholdsOverPi=[1.9, 1.7])


# name: (what makes the filter of a size, small size, large size)
CASES = {
    "Skull Phantom": (skull, 1, 0.5),
    "Phantom Sweep": (sweep, 100, 400),
    "Incomplete Shape": (shape, 200, 400),
    "Tracked Slice Reader": (reader, 100, 400),
    "Assemble Tracked Slices": (assembled, 50, 200),
    "Gate Slices": (lambda n: GateSlices(Input=sweep(n), SpeedLimit=1e6), 100, 400),
    "Slice Planes": (lambda n: SlicePlanes(Input=sweep(n)), 10, 40),
    "Swept Volume": (lambda n: SweptVolume(Input=sweep(n), OutputSpacing=[0.2] * 3), 100, 400),
    "Swept Volume, footprints across slices": (lambda n: SweptVolume(Input=sweep(n), OutputSpacing=[0.2] * 3,
                                                                     FootprintAcrossSlices=1), 100, 400),
    "Slice Ray Caster": (lambda n: SliceRayCaster(Input=sweep(n), IsoValue=120, PixelSpacing=0.05), 50, 200),
    "Speckle Filter, median": (lambda n: SpeckleFilter(Input=wavelet(n)), 200, 320),
    "Speckle Filter, opening in 3-D": (lambda n: SpeckleFilter(Input=wavelet(n), Operation="Opening", KernelSize=[5, 5, 5]), 200, 320),
    "Speckle Filter, Gaussian": (lambda n: SpeckleFilter(Input=wavelet(n), Operation="Gaussian"), 200, 320),
    "Contrast To Speckle": (lambda n: ContrastToSpeckle(Input=wavelet(n), InsideBounds=[0, 9, 0, 9, 0, 9], IsoValue=150), 200, 320),
    "B-Spline Iso Ray Caster": (lambda n: BSplineIsoRayCaster(Input=skull(n), IsoValues=[500]), 1, 0.5),
    "B-Spline Iso Ray Caster, interpolating": (lambda n: BSplineIsoRayCaster(Input=skull(n), IsoValues=[500],
                                                                             Interpolation="InterpolatingBSpline"), 1, 0.5),
    "Depth Map Shader": (lambda n: DepthMapShader(Input=depth(n)), 0.2, 0.1),
    "Depth Map Surface": (lambda n: DepthMapSurface(Input=depth(n)), 0.2, 0.1),
    "Mirror": (lambda n: Mirror(Input=skull(n), PlaneMethod="Given", Normal=[1, 0, 0]), 1, 0.5),
    "Mirror, best symmetry": (lambda n: Mirror(Input=skull(n)), 1, 0.5),
    "RBF Hole Filler": (filled, 0.25, 0.15),
    "RBF Interpolator": (interpolate, 0.5, 0.3),
    "RBF Image Warp": (warp, 160, 256),
    "Occluded Angle": (angle, 160, 320),
    "Implant Plate": (lambda n: ImplantPlate(Input=filled(n), Thickness=2, EdgeClearance=0.5), 0.3, 0.15),
    "Defect Model": (lambda n: DefectModel(Input=filled(n)), 0.3, 0.15),
    "Press Orientation": (lambda n: PressOrientation(Input=filled(n)), 0.3, 0.15),
}


def status(key):
    with open("/proc/self/status", encoding="ascii") as file:
        return next(int(line.split()[1]) * 1024 for line in file if line.startswith(key + ":"))


def size_of(proxy):
    algorithm = proxy.GetClientSideObject()
    return sum(1024 * algorithm.GetOutputDataObject(port).GetActualMemorySize() for port in range(algorithm.GetNumberOfOutputPorts())
               if algorithm.GetOutputDataObject(port))


def inputs_of(proxy):
    found = []
    for name in ("Input", "Data", "Poses", "Landmarks", "Targets"):
        if proxy.GetProperty(name) is not None and getattr(proxy, name, None):
            value = getattr(proxy, name)
            found += list(value) if isinstance(value, (list, servermanager.InputProperty)) else [value]
    return found


def measure(make, size):
    """(input, output, peak over what was there before) in bytes."""
    with raising():
        proxy = make(size)
        inputs = inputs_of(proxy)
        for each in inputs:
            each.UpdatePipeline()
        with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
            file.write("5")
        before = status("VmRSS")
        proxy.UpdatePipeline()
        return sum(size_of(each) for each in inputs), size_of(proxy), status("VmHWM") - before


def apart(make, size):
    """measure in a child process."""
    receive, send = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.write(send, " ".join(map(str, measure(make, size))).encode())
        except BaseException as error:  # told by the parent
            os.write(send, f"error: {error}".encode())
        os._exit(0)
    os.close(send)
    with os.fdopen(receive) as stream:
        said = stream.read()
    os.waitpid(child, 0)
    if not said or said.startswith("error"):
        raise RuntimeError(said or "the child process died")
    return map(int, said.split())


print("| source or filter | input | output | peak beyond these | all / (input + output) | the same, larger: input | output "
      "| peak beyond | all / (input + output) |")
print("|---|---|---|---|---|---|---|---|---|", flush=True)
failed = False
for name in sys.argv[1:] or CASES:
    make, *sizes = CASES[name]
    cells = [name]
    for size in sizes:
        try:
            taken, made, peak = apart(make, size)
        except RuntimeError as error:
            print(f"{name}: {error}", file=sys.stderr)
            failed = True
            break
        cells += [f"{taken / MEBIBYTE:.0f}", f"{made / MEBIBYTE:.0f}", f"{max(0, peak - made) / MEBIBYTE:.0f}",
                  f"{(peak + taken) / max(1, taken + made):.2f}"]
    else:
        print("| " + " | ".join(cells) + " |", flush=True)
sys.exit(failed)
