# SPDX-License-Identifier: BSD-3-Clause
"""What is measured beside what: every table and plot of run.py.

A suite is measured in rounds: in each one all of its programs run once, one after the other, so that a row and its
peers alternate. Rows are named by program and name; a program that ends in .py is one of this folder.
"""
from dataclasses import dataclass

from harness.sizes import SIZES


@dataclass(frozen=True)
class Row:
    """A row of a program. wall and cpu: its times, or counters in ms instead of them."""
    program: str
    name: str
    label: str = "Lacuna"
    wall: str = "wall"
    cpu: str = "cpu"

    @property
    def key(self):
        return f"{self.program}:{self.name}"


@dataclass(frozen=True)
class Comparison:
    """How many times as fast as each peer. A yardstick is no peer: nothing could be faster, as reading memory once."""
    title: str
    ours: Row
    peers: tuple
    quick: bool = True


@dataclass(frozen=True)
class Scaling:
    """Time against a size: series of (label, ((x, row), ...)), the first of them ours. Of a quick run: x up to quick."""
    file: str
    title: str
    x: str
    series: tuple
    quick: float = 1e30


@dataclass(frozen=True)
class Threads:
    """Time against threads: series of (label, ((threads, row), ...))."""
    file: str
    title: str
    series: tuple
    quick: bool = True


@dataclass(frozen=True)
class Figures:
    """Counters side by side: columns of (counter, heading, format), rows of (label, row)."""
    title: str
    columns: tuple
    rows: tuple
    quick: bool = True


@dataclass(frozen=True)
class Suite:
    name: str
    title: str
    about: str
    comparisons: tuple = ()
    scalings: tuple = ()
    threads: tuple = ()
    figures: tuple = ()
    rounds: int = 0  # instead of the run's: 0

    def rows(self, quick):
        """All rows it needs, by program, in the order of their programs' first appearance."""
        found = {}

        def add(row):
            names = found.setdefault(row.program, [])
            if row.name not in names:
                names.append(row.name)

        for each in self.comparisons:
            if each.quick or not quick:
                for row in (each.ours, *each.peers):
                    add(row)
        for each in self.scalings:
            for _, points in each.series:
                for x, row in points:
                    if x <= each.quick or not quick:
                        add(row)
        for each in self.threads:
            if each.quick or not quick:
                for _, points in each.series:
                    for _, row in points:
                        add(row)
        for each in self.figures:
            if each.quick or not quick:
                for _, row in each.rows:
                    add(row)
        return found


def points(program, name, values, label="Lacuna", x=lambda value: value):
    """Rows of one name with a value in it."""
    return label, tuple((x(value), Row(program, name.format(value), label)) for value in values)


def cube(edge):
    return edge**3


def square(edge):
    return edge**2


SCIPY, ALGLIB, VTK = "scipy", "ALGLIB", "VTK"
PEERS = "peers_scipy.py"


def speckle():
    own, slab = "SpeckleFilter", "220 × 172 × 40"
    threads = "two threads"

    def against(title, name, *peers):
        return Comparison(title, Row(own, name), peers)

    return Suite(
        "speckle", "Speckle Filter", f"Bytes of speckle. VTK: vtkImageMedian3D and vtkImageGaussianSmooth, {threads}; scipy.ndimage: one thread.",
        comparisons=(
            Comparison(f"median 9 × 9 × 9, {slab}", Row(own, "Size3D/Median_uint8/9"),
                       (Row(own, "Size3D/VTKMedian_uint8/9", VTK), Row(PEERS, "Size3D/Median_uint8/9", SCIPY)), quick=False),
            against(f"median 3 × 3 × 3, {slab}", "Size3D/Median_uint8/3", Row(own, "Size3D/VTKMedian_uint8/3", VTK), Row(PEERS, "Size3D/Median_uint8/3", SCIPY)),
            against("median 11 × 11, 640 × 480 × 4", "Image/Median_uint8/11", Row(own, "Image/VTKMedian_uint8/11", VTK), Row(PEERS, "Image/Median_uint8/11", SCIPY)),
            against(f"Gaussian of 2 voxels, {slab}", "Gaussian3D/Gaussian_uint8/2", Row(own, "Gaussian3D/VTKGaussian_uint8/2", VTK), Row(PEERS, "Gaussian3D/Gaussian_uint8/2", SCIPY)),
            against(f"minimum 9 × 9 × 9, {slab}", "Size3D/Minimum_uint8/9", Row(PEERS, "Size3D/Minimum_uint8/9", SCIPY)),
            against(f"opening 9 × 9 × 9, {slab}", "Size3D/Opening_uint8/9", Row(PEERS, "Size3D/Opening_uint8/9", SCIPY)),
            against(f"mean 9 × 9 × 9, {slab}", "Size3D/Mean_uint8/9", Row(PEERS, "Size3D/Mean_uint8/9", SCIPY))),
        scalings=(
            Scaling("speckle-voxels", "Median of 9 × 9 × 9", "voxels",
                    (points(own, "Cube/Median_uint8/{}", (46, 100, 215, 464), x=cube), points(own, "Cube/VTKMedian_uint8/{}", (46, 100), VTK, cube)), quick=1e5),
            Scaling("speckle-window", f"Median, {slab}", "window's edge, voxels",
                    (points(own, "Size3D/Median_uint8/{}", (3, 5, 9, 15, 31)), points(own, "Size3D/VTKMedian_uint8/{}", (3, 5, 9), VTK),
                     points(PEERS, "Size3D/Median_uint8/{}", (3, 5, 9), SCIPY)), quick=3)),
        threads=(Threads("speckle-threads", "Median of 9 × 9 × 9, 215³ voxels", (points(own, "Threads/Median_uint8/{}", (1, 2, 4)),)),))


def radial_basis():
    own = "RadialBasis"
    fit, grid = "FastFit<2>/kernel:0/nodes:{}/digits:4/threads:0", "FastGrid<2>/kernel:0/nodes:{}/digits:4/grid:512"
    return Suite(
        "radial-basis", "Radial basis functions",
        "Franke's function, thin plate with a linear polynomial. scipy: RBFInterpolator, exact; ALGLIB 3.19: thin plates by domain decomposition, one thread; "
        "VTK: vtkThinPlateSplineTransform. Lacuna's fits of more than some thousand nodes and its grids are right to 10⁻⁴ of the values' range.",
        comparisons=(
            Comparison("fit, 700 nodes, exact", Row(own, "Fit/kernel:0/nodes:700"), (Row(PEERS, "Fit/nodes:700", SCIPY), Row(own, "FitALGLIB/nodes:700", ALGLIB))),
            Comparison("700 nodes on 512 × 512 points, to 10⁻⁴", Row(own, grid.format(700)),
                       (Row(PEERS, "Grid/nodes:700/grid:512", SCIPY), Row(own, "GridALGLIB/nodes:700/grid:512", ALGLIB), Row(own, "PlainSum/nodes:700/grid:512", "plain sum"))),
            Comparison("the same, exact, AVX2, one thread", Row(own, "Evaluate/kernel:0/nodes:700/grid:512/threads:1/set:1"), (Row(own, "PlainSum/nodes:700/grid:512", "plain sum"),)),
            Comparison("warp by 700 pairs of landmarks, set-up", Row(own, "WarpSetUp/pairs:700"), (Row(own, "WarpSetUpVTK/pairs:700", VTK), Row(PEERS, "WarpSetUp/pairs:700", SCIPY)), quick=False)),
        scalings=(
            Scaling("radial-basis-fit", "Fit of a thin plate", "nodes",
                    (points(own, fit, (1000, 10000, 100000)), points(PEERS, "Fit/nodes:{}", (1000, 3000, 10000), SCIPY), points(own, "FitALGLIB/nodes:{}", (1000, 10000), ALGLIB)), quick=1000),
            Scaling("radial-basis-grid", "512 × 512 values of a thin plate", "nodes",
                    (points(own, grid, (1000, 10000, 100000)), points(PEERS, "Grid/nodes:{}/grid:512", (1000, 3000), SCIPY), points(own, "GridALGLIB/nodes:{}/grid:512", (1000, 3000), ALGLIB)), quick=1000)),
        threads=(Threads("radial-basis-threads", "Radial basis functions", (
            points(own, "FastFit<2>/kernel:0/nodes:20000/digits:4/threads:{}", (1, 2, 4), "fit of 20 000 nodes"),
            points(own, "Evaluate/kernel:0/nodes:700/grid:512/threads:{}/set:1", (1, 2, 4), "exact sums, 700 nodes, 512 × 512"))),),
        figures=(Figures("The cases of the thesis (section 6.4), to 10⁻⁴: how many times as fast as", (
            ("direct/fast", "exact sums with vectors", ".1f"), ("plain/fast", "the plain sum", ".1f"), ("error/bound", "error / bound", ".4f")),
            tuple((f"{nodes} nodes, {size} × {size}", Row(own, f"ThesisCase/nodes:{nodes}/grid:{size}")) for nodes in (697, 578) for size in (205, 512))),))


def swept_volume():
    own, batch = "SweptVolume", "CleanFloat/slices:{}/spacing:4/mode:{}/threads:{}"
    splat = Row(own, "SplatClean/slices:200/spacing:4", "pixel splat")
    least = Row(own, "ReadAndWrite/spacing:4", "yardstick: pixels read, voxels written")
    score = (("filled", "filled", ".4f"), ("RMS", "RMS error", ".3f"), ("grown_MB", "memory, MB", ".0f"))
    return Suite(
        "swept-volume", "Swept Volume",
        "An analytic scene, slices of 640 × 480 bytes of 0.1 mm, voxels of 0.4 mm (4.4 million). Pixel splat: each pixel shared among the eight voxels around it, the usual way "
        "(lacunaPixelSplat.h: one thread, holes are not filled). RMS error in grey levels against the truth in the swept region.",
        comparisons=(
            Comparison("200 slices, footprint, one thread", Row(own, batch.format(200, 0, 1)), (splat, least)),
            Comparison("200 slices, footprint, two threads", Row(own, batch.format(200, 0, 2)), (splat, least)),
            Comparison("200 slices, bilinear, one thread", Row(own, batch.format(200, 1, 1)), (splat, least), quick=False),
            Comparison("200 slices, nearest, one thread", Row(own, batch.format(200, 2, 1)), (splat, least), quick=False)),
        scalings=(Scaling("swept-volume-slices", "Swept Volume, 0.4 mm, two threads", "slices",
                          (("Lacuna", tuple((n, Row(own, batch.format(n, 0, 2))) for n in (20, 200, 2000))),
                           points(own, "SplatClean/slices:{}/spacing:4", (20, 200, 2000), "pixel splat, one thread")), quick=200),),
        threads=(Threads("swept-volume-threads", "Swept Volume, 200 slices", (("footprint", tuple((n, Row(own, batch.format(200, 0, n))) for n in (1, 2, 4))),)),),
        figures=(Figures("Error and memory", score, (
            ("footprint", Row(own, batch.format(200, 0, 2))), ("bilinear", Row(own, batch.format(200, 1, 1))), ("nearest", Row(own, batch.format(200, 2, 1))),
            ("footprint, noise", Row(own, "NoisyFloat/slices:200/spacing:4/mode:0/threads:2")), ("wide, noise", Row(own, "NoisyFloat/slices:200/spacing:4/mode:5/threads:2")),
            ("pixel splat", splat), ("pixel splat, noise", Row(own, "SplatNoisy/slices:200/spacing:4"))), quick=False),))


def iso_ray_caster():
    own, head, edges = "IsoRayCaster", "CTHead/interpolation:{}/view:{}/threads:2", "CTHeadFlyingEdges/normals:1/view:{}/threads:2"

    def against(title, interpolation, view, quick=False):
        return Comparison(title, Row(own, head.format(interpolation, view)),
                          (Row(own, f"CTHeadReference/view:{view}/threads:2", "the thesis's algorithm"), Row(own, edges.format(view), "VTK FlyingEdges + z-buffer")), quick)

    return Suite(
        "iso-ray-caster", "B-Spline Iso Ray Caster",
        "From volume to depth map with normals, nothing prepared, two threads. The head is ct_head/head.mha of LACUNA_TEST_DATA at 500 HU with 512 × 512 rays, the shell a bone in a cube. "
        "VTK's FlyingEdges3D, with as many threads (back end STDThread), makes triangles, which a z-buffer draws (lacunaSurfacePass.h).",
        comparisons=(against("CT head, B-spline, along an axis", 0, 0, True), against("CT head, B-spline, oblique", 0, 1), against("CT head, trilinear, along an axis", 2, 0),
                     Comparison("shell of 256³, B-spline, oblique", Row(own, "Shell/256/512/2"), (Row(own, "ShellFlyingEdges/256/512/2", "VTK FlyingEdges + z-buffer"),))),
        scalings=(
            Scaling("iso-ray-caster-voxels", "Depth map of 512 × 512, B-spline", "voxels",
                    (points(own, "Shell/{}/512/2", (46, 100, 215, 464), x=cube), points(own, "ShellFlyingEdges/{}/512/2", (46, 100, 215, 464), "VTK FlyingEdges + z-buffer", cube)), quick=1.1e6),
            Scaling("iso-ray-caster-rays", "Depth map of 256³ voxels, B-spline", "rays",
                    (points(own, "Shell/256/{}/2", (256, 512, 1024, 2048), x=square), points(own, "ShellFlyingEdges/256/{}/2", (256, 512, 1024, 2048), "VTK FlyingEdges + z-buffer", square)), quick=3e5)),
        threads=(Threads("iso-ray-caster-threads", "Depth map of 256³ voxels", (
            points(own, "Shell/256/512/{}", (1, 2, 4)), points(own, "ShellFlyingEdges/256/512/{}", (1, 2, 4), "VTK FlyingEdges + z-buffer"))),))


def slice_ray_caster():
    own = "SliceRayCaster"
    least = Row(own, "Fingerprints/threads:1", "yardstick: pixels read")
    return Suite(
        "slice-ray-caster", "Slice Ray Caster", "200 slices of 640 × 480 bytes into a depth map of 512 × 512, all of it covered by each slice; nearest slices last.",
        comparisons=(Comparison("one by one, one thread", Row(own, "OneByOne/oblique:0/order:0"), (least,)),
                     Comparison("all at once, one thread", Row(own, "AllAtOnce/oblique:0/order:0/threads:1"), (least,))),
        threads=(Threads("slice-ray-caster-threads", "Slice Ray Caster, 200 slices", (points(own, "AllAtOnce/oblique:0/order:0/threads:{}", (1, 2, 4), "all at once"),)),))


def growing_sweep():
    own = "GrowingSweep"
    columns = (("early", "slice 5–14, ms", ".1f"), ("late", "slice 191–200, ms", ".1f"), ("worst", "worst, ms", ".1f"), ("cpuLate", "processor, late, ms", ".1f"))
    return Suite("growing-sweep", "A growing sweep", "What an update takes when one slice of 640 × 480 more has come, of the whole filter, while a scan is drawn.",
                 figures=(Figures("Time of an update", columns, tuple((label, Row(own, f"{name}/slices:200")) for name, label in (
                     ("SliceRayCaster", "Slice Ray Caster, 512 × 512"), ("SweptVolume", "Swept Volume, 0.4 mm")))),))


def occluded_angle():
    own = "OccludedAngle"
    return Suite(
        "occluded-angle", "Occluded Angle", "Random attenuation. The yardstick reads the data and updates the sums once, which each direction must do at least.",
        scalings=(Scaling("occluded-angle-voxels", "Occluded angle, 20 directions, two threads", "voxels", (points(own, "Size/edge:{}", (46, 100, 215, 464), x=cube),), quick=1.1e6),),
        threads=(Threads("occluded-angle-threads", "Occluded angle, 192³ voxels, 200 directions", (points(own, "Cube/192/{}/0/0", (1, 2, 4)),), quick=False),),
        figures=(Figures("One direction, one thread", (("cpu_ns", "ns for a voxel", ".3f"), ("times_stream", "times the yardstick", ".2f")), tuple(
            (f"{edge}³ voxels", Row(own, f"Cube/{edge}/1/0/0")) for edge in (64, 128, 192, 256))),))


def closed_surfaces():
    own = "ClosedSurfaces"
    columns = (("volume", "volume error, %", "+.2f"), ("mean", "mean distance, voxels", ".3f"), ("largest", "largest distance, voxels", ".2f"), ("closed", "closed", ".0f"), ("seconds", "processor, s", ".2f"))
    methods = (("OcclusionSurface", "Occlusion Surface, defaults"), ("CGALPoisson", "CGAL Poisson"), ("CGALAlphaWrap", "CGAL alpha wrap"), ("VTKHoppe", "VTK, Hoppe 1992"), ("VTKSignedDistance", "VTK, signed distances"))

    def case(name, title, cleaned=""):
        return Figures(title, columns, tuple((label + (", outliers removed first" if cleaned and not label.endswith("defaults") else ""),
                                              Row(own, f"{name}/{method}{'' if method == 'OcclusionSurface' else cleaned}")) for method, label in methods), quick=name == "cube20")

    return Suite("closed-surfaces", "Occlusion Surface", "Closed shapes of which most voxels are missing. The peers have, for each shape, the best of several settings, chosen with the truth at hand, and normals.",
                 figures=(case("sphere90", "Sphere, 90 % missing"), case("cube60", "Cube of 60 voxels, 90 % missing"), case("cube20", "Cube of 20 voxels, 90 % missing"),
                          case("kumara", "Kumara, 60 % missing in patches"), case("kumara_noise", "The same with 2 % outliers", "_cleaned")), rounds=1)


def iges():
    own = "IGESWriter"
    shapes = ("waves", "skull", "skull with a bump", "thin plate")
    columns = (("bytes", "bytes", ".0f"), ("control_points", "control points", ".0f"), ("deviation_um", "deviation, µm", ".3f"))
    return Suite(
        "iges", "IGES Writer", "121 × 121 points to a B-spline surface in a file, 1 µm, one thread. OpenCASCADE 7.6: GeomAPI_PointsToBSplineSurface (degrees up to 8, its default) and IGESControl_Writer.",
        comparisons=tuple(Comparison(shape, Row(own, f"Lacuna/{number}"), (Row(own, f"OpenCASCADE/{number}/8", "OpenCASCADE"),), quick=number == 2) for number, shape in enumerate(shapes)),
        scalings=(Scaling("iges-points", "Points to an IGES file, 1 µm, one thread", "points",
                          (points(own, "LacunaOfPoints/points:{}", (39, 122, 384), x=square), points(own, "OpenCASCADEOfPoints/points:{}", (39, 122, 384), "OpenCASCADE", square)), quick=2e4),),
        figures=(Figures("What is in the file", columns, tuple(row for number, shape in enumerate(shapes) for row in (
            (f"{shape}: Lacuna", Row(own, f"Lacuna/{number}")), (f"{shape}: OpenCASCADE", Row(own, f"OpenCASCADE/{number}/8")))), quick=False),))


def tool_path():
    own = "ToolPath"
    return Suite(
        "tool-path", "Milling Tool Path", "A mould of 120 × 120 mm, ball end of 8 mm, 121 lines. The plain drop-cutter tries all triangles in reach, and only at the surface's points (opencamlib is in no Debian package).",
        comparisons=(Comparison("path, two threads", Row(own, "Path/2"), (Row(own, "PlainDropCutter/2", "plain drop-cutter"),)),),
        scalings=(Scaling("tool-path-points", "Tool path, as many lines as rows of points, two threads", "points of the surface",
                          (points(own, "PathOfPoints/points:{}", (39, 122, 384), x=square), points(own, "PlainDropCutterOfPoints/points:{}", (39, 122), "plain drop-cutter", square)), quick=2e4),),
        threads=(Threads("tool-path-threads", "Tool path, 121 lines", (points(own, "Path/{}", (1, 2, 4)),)),))


def implant_plate():
    own = "ImplantPlate"
    return Suite(
        "implant-plate", "Implant Plate", "A disc of 60 mm on a bent and bumpy surface, triangles of 0.5 mm, from depths to the closed solid with its measures. No peer makes such plates; the goal was 2 s.",
        threads=(Threads("implant-plate-threads", "Implant Plate", (
            points(own, "Plate/{}/0", (1, 2, 4), "in the defect"), points(own, "Plate/{}/2", (1, 2, 4), "overlapping, screw holes, drainage"))),),
        figures=(Figures("Plates, two threads", (("wall", "clock, ms", ".0f"), ("cpu", "processor, ms", ".0f"), ("triangles", "triangles", ".0f"), ("thickness", "thinnest, mm", ".3f")), tuple(
            (label, Row(own, f"Plate/2/{kind}")) for kind, label in enumerate(("in the defect", "with drainage", "overlapping, screw holes, drainage")))),))


def ct_series():
    own, name = "CTSeriesReader", "CTSeries/syntax:{}/slices:{}/threads:{}"

    def row(syntax, slices, threads, what="reader", label="Lacuna"):
        return Row(own, name.format(syntax, slices, threads), label, what, what + "Cpu")

    def against(title, syntax, peers=(), quick=False):
        at = (syntax, 500, 2)
        return Comparison(title, row(*at), (*peers, row(*at, "raw", "yardstick: bytes read"), *((row(*at, "decode", "yardstick: pixels decoded"),) if syntax else ())), quick)

    return Suite(
        "ct-series", "CT Series Reader", "Slices of 512 × 512 in the system's memory, from opening the folder to the volume, two threads. VTK: vtkDICOMImageReader, one thread, uncompressed files only. Yardsticks are the least of their trials.",
        comparisons=(against("500 slices, uncompressed", 0, (row(0, 500, 2, "vtk", VTK),)), against("500 slices, JPEG-LS", 1), against("500 slices, JPEG lossless", 2)),
        scalings=(Scaling("ct-series-slices", "CT series, uncompressed, two threads", "slices", (
            ("Lacuna", tuple((n, row(0, n, 2)) for n in (5, 50, 500))), (VTK, tuple((n, row(0, n, 2, "vtk", VTK)) for n in (5, 50, 500)))), quick=50),),
        threads=(Threads("ct-series-threads", "CT series, 500 slices, uncompressed", (("Lacuna", tuple((n, row(0, 500, n)) for n in (1, 2, 4))),), quick=False),))


def probe_calibration():
    own = "ProbeCalibration"
    columns = (("solved", "solved, %", ".1f"), ("corner_mm", "error at corners, mm", ".3f"), ("rms_mm", "RMS, mm", ".3f"), ("covered", "within 95 %, %", ".1f"))
    return Suite("probe-calibration", "Probe Calibration", "Simulated scans of an image of 90 × 72 mm, 200 phantoms and probes anywhere, no first guess. No package solves the same.",
                 figures=(Figures("Accuracy", columns, (
                     ("three wires", Row(own, "ThreeWires/geometries:200/outliers:0")), ("three wires, 5 % outliers", Row(own, "ThreeWires/geometries:200/outliers:5")),
                     ("single wall", Row(own, "SingleWall/geometries:200")))),), rounds=1)


def live_acquisition():
    own = "LiveAcquisition"
    columns = (("slices", "slices/s", ".1f"), ("lost", "without pose", ".0f"), ("delay50", "delay, ms", ".1f"), ("delay99", "99 %, ms", ".1f"), ("load", "of one core, %", ".1f"))
    return Suite("live-acquisition", "Polhemus Video Source", "An emulated FASTRAK at 115200 baud and 768 × 576 at 25 frames a second, every frame a slice, for 30 s (in a quick run 1 s).",
                 figures=(Figures("Live", columns, (("30 s", Row(own, "Live/seconds:30/signal:0")),), quick=False), Figures("Live, short", columns, (("1 s", Row(own, "Live/seconds:1/signal:0")),))), rounds=1)


def filters():
    own = "filters.py"
    columns = (("wall", "clock, ms", ".0f"), ("cpu", "processor, ms", ".0f"), ("MB", "output, MB", ".2f"))
    return Suite("filters", "Further filters", "Whole filters in VTK, on all cores unless said otherwise.", figures=(
        Figures("Mirror and Slice Planes", columns, (
            ("Mirror, 256³ voxels", Row(own, "Mirror/edge:256")), ("Mirror, 256³ voxels, plane given", Row(own, "MirrorGivenPlane/edge:256")),
            ("Slice Planes, 200 slices of 640 × 480, at most 1 million points, one thread", Row(own, "SlicePlanes/points:1000000")),
            ("the same, 4 million", Row(own, "SlicePlanes/points:4000000")), ("the same, all 61 million", Row(own, "SlicePlanes/points:100000000"))), quick=False),
        Figures("Tracked Slice Writer, ultrasound_spine, by level of compression", columns, tuple((str(level), Row(own, f"Writer/level:{level}")) for level in (0, 1, 6, 9)))))


def every():
    own = "every.py"
    columns = (("wall", "clock, ms", ".0f"), ("cpu", "processor, ms", ".0f"), ("input", "input, MB", ".1f"), ("output", "output, MB", ".1f"))
    rows = tuple((name, Row(own, name)) for name in SIZES)
    half = list(SIZES).index("Speckle Filter, median")
    return Suite("every", "Every source, filter and writer",
                 "Once, in ParaView, with its inputs made. What each makes of what is in `Testing/Benchmarks/memory.py`; for Polhemus Video Source see above.",
                 figures=(Figures("Sources, readers, freehand ultrasound", columns, rows[:half]), Figures("Volumes, maps, surfaces, writers", columns, rows[half:], quick=False)), rounds=3)


def plugin_startup():
    def against(program):
        return Comparison(f"start of {program}", Row("plugin_startup.py", f"{program}/with"), (Row("plugin_startup.py", f"{program}/without", "yardstick: without plugins"),), quick=program == "pvpython")
    return Suite("plugin-startup", "Start of ParaView", "Until ParaView runs a script, with the plugins and without.", comparisons=(against("paraview"), against("pvpython")))


SUITES = tuple(make() for make in (speckle, radial_basis, swept_volume, iso_ray_caster, slice_ray_caster, growing_sweep, occluded_angle, closed_surfaces, iges, tool_path,
                                   implant_plate, ct_series, probe_calibration, live_acquisition, filters, every, plugin_startup))
