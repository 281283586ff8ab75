# SPDX-License-Identifier: BSD-3-Clause
"""How much memory each source and filter needs at its peak, as a multiple of its input and output, at two sizes.

    . build/release/lacuna-env.sh
    pvpython Testing/Benchmarks/memory.py [name ...]

(every.py says how long they take.) Each is measured in a process of its own (Linux): resident memory over that before the filter runs, plus its input, divided
by input and output. 1 is the least that can be, below 1 what shares arrays with the input. A file that is written is no output: it is
on the disk. Prints the table of the guide's page on memory.
"""
import os
import struct
import sys
import tempfile
import time

import lacuna.plugin
import numpy as np

lacuna.plugin.load()
from lacuna import occlusion
from lacuna.errors import raising
from paraview import servermanager
from harness.sizes import SIZES
from paraview.simple import *

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "Documentation", "Examples", "04-calibration"))
import scans

MEBIBYTE = 1048576
FOLDER = None  # for files of the filter that is measured


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


def path(name):
    return os.path.join(FOLDER, name)


def reader(slices):
    source = sweep(slices)
    SaveData(path("sweep.mha"), source, CompressionLevel=0)
    Delete(source)
    return OpenDataFile(path("sweep.mha"))


def series(slices):
    """A CT series of 512 x 512 pixels, explicit little endian."""
    def element(tag, vr, value):
        value = value.encode() if isinstance(value, str) else value
        value += (b"\0" if vr == "UI" else b" ") * (len(value) % 2)
        length = struct.pack("<HI", 0, len(value)) if vr == "OW" else struct.pack("<H", len(value))
        return struct.pack("<HH2s", tag >> 16, tag & 0xFFFF, vr.encode()) + length + value
    short = struct.Struct("<H").pack
    storage, syntax = "1.2.840.10008.5.1.4.1.1.2", "1.2.840.10008.1.2.1"
    pixels = np.arange(512 * 512, dtype="<i2").tobytes()
    os.makedirs(path("series"))
    for n in range(slices):
        meta = element(0x20002, "UI", storage) + element(0x20003, "UI", f"1.2.3.{n}") + element(0x20010, "UI", syntax)
        data = b"".join(element(*one) for one in (
            (0x80016, "UI", storage), (0x80018, "UI", f"1.2.3.{n}"), (0x80060, "CS", "CT"), (0x20000D, "UI", "1.2.4"),
            (0x20000E, "UI", "1.2.5"), (0x200013, "IS", str(n)), (0x200032, "DS", f"0\\0\\{n}"), (0x200037, "DS", "1\\0\\0\\0\\1\\0"),
            (0x280002, "US", short(1)), (0x280004, "CS", "MONOCHROME2"), (0x280010, "US", short(512)), (0x280011, "US", short(512)),
            (0x280030, "DS", "0.5\\0.5"), (0x280100, "US", short(16)), (0x280101, "US", short(16)), (0x280102, "US", short(15)),
            (0x280103, "US", short(1)), (0x281052, "DS", "0"), (0x281053, "DS", "1"), (0x7FE00010, "OW", pixels)))
        with open(path(f"series/{n}.dcm"), "wb") as file:
            file.write(bytes(128) + b"DICM" + element(0x20000, "UL", struct.pack("<I", len(meta))) + meta + data)
    return CTSeriesReader(FileName=path("series"))


def volume(slices):
    """A NIfTI file of 512 x 512 voxels of 16 bits, whose slices come in reverse order."""
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, 512, 512, slices, 1, 1, 1, 1)
    struct.pack_into("<2h", header, 70, 4, 16)
    struct.pack_into("<8f", header, 76, 1, 0.5, 0.5, 1, 0, 0, 0, 0)
    struct.pack_into("<f", header, 108, 352)
    struct.pack_into("<B", header, 123, 2)
    struct.pack_into("<2h", header, 252, 0, 1)
    struct.pack_into("<12f", header, 280, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, -1, 0)
    header[344:348] = b"n+1\0"
    with open(path("volume.nii"), "wb") as file:
        file.write(header)
        for _ in range(slices):
            file.write(np.arange(512 * 512, dtype="<i2").tobytes())
    return VolumeReader(FileName=path("volume.nii"))


def outlines(count):
    """A table of so many outlines of 1000 points each."""
    angles = np.linspace(0, 2 * np.pi, 1000, endpoint=False)
    points = [f"{50 * x},{40 * y}" for x, y in zip(np.cos(angles), np.sin(angles))]
    with open(path("outlines.csv"), "w", encoding="ascii") as file:
        file.write("structure,outline,x,y,z\n")
        for n in range(count):
            file.writelines(f"Liver,{n},{point},{n / 10}\n" for point in points)
    return OutlineReader(FileName=path("outlines.csv"))


def floor(slices, degrees):
    """Hundreds of scans of the floor of a bath, to and fro and tilted to all sides by so many degrees."""
    random = np.random.default_rng(1)
    places = [scans.pose(scans.looking_down(random, degrees), [*random.uniform(-20, 20, 2), 35 + 8 * np.sin(0.2 * np.pi * n)]) for n in range(100)]
    pictures = np.array([scans.floor_picture(place, random) for place in places])
    poses = [scans.probe_to_tracker(place) for place in places]
    return scans.slices(np.tile(pictures, (slices // 100, 1, 1)), np.tile(poses, (slices // 100, 1, 1)))


def receivers(rows):
    """Poses of two receivers that are fixed to each other."""
    random = np.random.default_rng(1)
    moments = np.arange(rows) // 2
    places = random.uniform([20, -25, -15], [50, 20, 15], (rows, 3))
    places[1::2] = places[::2] + [20, 1, 2]
    columns = {"Time": 30.0 * moments, "Station": 1 + np.arange(rows) % 2, **{name: places[:, n] for n, name in enumerate("xyz")}}
    return scans.table(columns | {name: np.zeros(rows) for name in ("azimuth", "elevation", "roll")})


def written(name, source, **settings):
    writer = CreateWriter(path(name), source)
    for key, value in settings.items():
        setattr(writer, key, value)
    return writer


def milled(spacing, **settings):
    return MillingToolPath(Input=PressOrientation(Input=filled(spacing)), **settings)


def assembled(slices):
    with open(path("poses.csv"), "w", encoding="ascii") as file:
        file.write("Slice," + ",".join(f"m{n}" for n in range(16)) + "\n")
        for n in range(slices):
            file.write(f"{n},1,0,0,0,0,1,0,0,0,0,1,{0.1 * n},0,0,0,1\n")
    table = CSVReader(FileName=[path("poses.csv")])
    images = Wavelet(WholeExtent=[0, 639, 0, 479, 0, slices - 1])
    return AssembleTrackedSlices(Input=images, Poses=table, PoseFormat="Matrix", PoseColumns=["m"], PixelSpacing=0.1)


def outlined(n):
    """Ellipses in the slices around the middle of n, as OutlinePoints."""
    slices = [n // 2 + k * max(1, n // 20) for k in (-4, -2, 0, 2, 4)]
    return [value for number in slices for angle in np.linspace(0, 2 * np.pi, 16, endpoint=False)
            for value in (1, number, number, 300 + 150 * np.cos(angle), 200 + 100 * np.sin(angle))]


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


def occlusion_surface(n):
    sparse = dict(Shape="Sphere", Dimensions=[n] * 3, PresentFraction=0.1, Seed=3)
    seen = OccludedAngle(Input=IncompleteShape(**sparse), NumberOfDirections=100, **occlusion.GROW_AND_SNAP)
    return OcclusionSurface(Input=seen, Data=IncompleteShape(**sparse))


# label of the proxy, and which one of it: what makes it of a size
CASES = {
    "Skull Phantom": skull,
    "Phantom Sweep": sweep,
    "Incomplete Shape": shape,
    "Tracked Slice Reader": reader,
    "CT Series Reader": series,
    "Volume Reader": volume,
    "Outline Reader": outlines,
    "Assemble Tracked Slices": assembled,
    "Gate Slices": lambda n: GateSlices(Input=sweep(n), SpeedLimit=1e6),
    "Bone Echo": lambda n: BoneEcho(Input=sweep(n)),
    "Scan Region": lambda n: ScanRegion(Input=floor(n, 25)),
    "Probe Calibration": lambda n: ProbeCalibration(Input=floor(n, 25), Method="SingleWall", PixelSpacing=scans.SPACING),
    "Temporal Calibration": lambda n: TemporalCalibration(Input=floor(n, 0)),
    "Tracker Self Test": lambda n: TrackerSelfTest(Input=receivers(n)),
    "Slice Planes": lambda n: SlicePlanes(Input=sweep(n)),
    "Slice Outliner": lambda n: SliceOutliner(Input=sweep(n), OutlinePoints=outlined(n)),
    "Outlined Structures": lambda n: OutlinedStructures(Input=SliceOutliner(Input=sweep(20), OutlinePoints=outlined(20)), OutputSpacing=30 / n),
    "Swept Volume": lambda n: SweptVolume(Input=sweep(n), OutputSpacing=[0.2] * 3),
    "Swept Volume, footprints across slices": lambda n: SweptVolume(Input=sweep(n), OutputSpacing=[0.2] * 3, FootprintAcrossSlices=1),
    "Slice Ray Caster": lambda n: SliceRayCaster(Input=sweep(n), IsoValue=120, PixelSpacing=0.05),
    "Speckle Filter, median": lambda n: SpeckleFilter(Input=wavelet(n)),
    "Speckle Filter, opening in 3-D": lambda n: SpeckleFilter(Input=wavelet(n), Operation="Opening", KernelSize=[5, 5, 5]),
    "Speckle Filter, Gaussian": lambda n: SpeckleFilter(Input=wavelet(n), Operation="Gaussian"),
    "Contrast To Speckle": lambda n: ContrastToSpeckle(Input=wavelet(n), InsideBounds=[0, 9, 0, 9, 0, 9], IsoValue=150),
    "B-Spline Iso Ray Caster": lambda n: BSplineIsoRayCaster(Input=skull(n), IsoValues=[500]),
    "B-Spline Iso Ray Caster, interpolating": lambda n: BSplineIsoRayCaster(Input=skull(n), IsoValues=[500], Interpolation="InterpolatingBSpline"),
    "Depth Map Shader": lambda n: DepthMapShader(Input=depth(n)),
    "Depth Map Surface": lambda n: DepthMapSurface(Input=depth(n)),
    "Mirror": lambda n: Mirror(Input=skull(n), PlaneMethod="Given", Normal=[1, 0, 0]),
    "Mirror, best symmetry": lambda n: Mirror(Input=skull(n)),
    "Skull Bone": lambda n: SkullBone(Input=skull(n)),
    "Skull Implant": lambda n: SkullImplant(Input=skull(n)),
    "Skull Resection": lambda n: SkullResection(Input=skull(n), Tumour=Sphere(Center=[-30, 20, 45], Radius=10)),
    "RBF Hole Filler": filled,
    "RBF Interpolator": interpolate,
    "RBF Image Warp": warp,
    "RBF Surface": lambda n: RBFSurface(Input=Sphere(Radius=50, ThetaResolution=n, PhiResolution=n // 2)),
    "Occluded Angle": angle,
    "Occlusion Surface": occlusion_surface,
    "Implant Plate": lambda n: ImplantPlate(Input=filled(n), Thickness=2, EdgeClearance=0.5),
    "Defect Model": lambda n: DefectModel(Input=filled(n)),
    "Press Orientation": lambda n: PressOrientation(Input=filled(n)),
    "Milling Tool Path": milled,
    "IGES Writer": lambda n: written("fit.igs", filled(n)),
    "STEP Writer": lambda n: written("plate.step", ImplantPlate(Input=filled(0.5), Thickness=2, EdgeClearance=0.5, TriangleSize=n)),
    "G-Code Writer": lambda n: written("path.nc", milled(1, StepOver=n, MapSpacing=2), AcceptWarnings=1),
    "Tracked Slice Writer, raw": lambda n: written("sweep.mha", sweep(n), CompressionLevel=0),
    "Tracked Slice Writer, compressed": lambda n: written("sweep.mha", sweep(n), CompressionLevel=1),
}


def status(key):
    with open("/proc/self/status", encoding="ascii") as file:
        return next(int(line.split()[1]) * 1024 for line in file if line.startswith(key + ":"))


def size_of(proxy, *ports):
    """Bytes of what it makes at these ports, or at all."""
    algorithm = proxy.GetClientSideObject()
    outputs = [algorithm.GetOutputDataObject(port) for port in ports or range(algorithm.GetNumberOfOutputPorts())]
    return sum(1024 * output.GetActualMemorySize() for output in outputs if output)


def inputs_of(proxy):
    """The outputs that it takes."""
    found = []
    for name in ("Input", "Data", "Poses", "Landmarks", "Targets"):
        inputs = proxy.GetProperty(name)
        for n in range(inputs.SMProperty.GetNumberOfProxies() if inputs is not None else 0):
            source = servermanager._getPyProxy(inputs.SMProperty.GetProxy(n))
            found.append(servermanager.OutputPort(source, inputs.SMProperty.GetOutputPortForConnection(n)))
    return found


def measure(name, make, size):
    """(input, output, peak over what was there before) in bytes, (clock, processor of all threads) in ms."""
    with raising():
        proxy = make(size)
        assert name.split(",")[0] == proxy.SMProxy.GetXMLLabel(), proxy.SMProxy.GetXMLLabel()
        inputs = inputs_of(proxy)
        for each in inputs:
            each.UpdatePipeline()
        with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
            file.write("5")
        before, clock, processor = status("VmRSS"), time.perf_counter(), time.process_time()
        proxy.UpdatePipeline()
        took = [1e3 * (time.perf_counter() - clock), 1e3 * (time.process_time() - processor)]
        return sum(size_of(each, each.Port) for each in inputs), size_of(proxy), status("VmHWM") - before, *took


def apart(*what):
    """measure in a child process."""
    global FOLDER
    receive, send = os.pipe()
    with tempfile.TemporaryDirectory(prefix="lacuna-memory-") as FOLDER:
        child = os.fork()
        if child == 0:
            try:
                os.write(send, " ".join(map(str, measure(*what))).encode())
            except BaseException as error:  # told by the parent
                os.write(send, f"error: {error}".encode())
            os._exit(0)
        os.close(send)
        with os.fdopen(receive) as stream:
            said = stream.read()
        os.waitpid(child, 0)
    if not said or said.startswith("error"):
        raise RuntimeError(said or "the child process died")
    return map(float, said.split())


def main(names):
    """Returns whether a row is missing."""
    print("| source, filter or writer | input | output | peak beyond these | all / (input + output) | the same, larger: input | output "
          "| peak beyond | all / (input + output) |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    failed = False
    for name in names or CASES:
        cells = [name]
        for size in SIZES[name]:
            try:
                taken, made, peak, *_ = apart(name, CASES[name], size)
            except RuntimeError as error:
                print(f"{name}: {error}", file=sys.stderr)
                failed = True
                break
            cells += [f"{taken / MEBIBYTE:.0f}", f"{made / MEBIBYTE:.0f}", f"{max(0, peak - made) / MEBIBYTE:.0f}",
                      f"{(peak + taken) / max(1, taken + made):.2f}"]
        else:
            print("| " + " | ".join(cells) + " |", flush=True)
    return failed


if __name__ == "__main__":
    unknown = [name for name in sys.argv[1:] if name not in CASES]
    if unknown:
        sys.exit(f"no case {', '.join(unknown)}; there are: {', '.join(CASES)}")
    sys.exit(main(sys.argv[1:]))
