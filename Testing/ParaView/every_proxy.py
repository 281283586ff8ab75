# SPDX-License-Identifier: BSD-3-Clause
"""Every proxy of the plugin in small pipelines, for tests of what must hold for all of them.

A pipeline is a function that makes sources and filters under registration names, and writes files "written.*" into a
folder of the test that uses it: call make_files first, or use_files.
"""
import contextlib
import os
import re
import subprocess

import calibration_scans as scans
import numpy as np
from lacuna_test import output
from paraview import servermanager, smtrace
from paraview.simple import *
from tracked_slice_files import open_slices

_folder = None
WRITERS = {"igs": "LacunaIGESWriter", "step": "LacunaSTEPWriter", "nhdr": "LacunaTrackedSliceWriter", "nc": "LacunaGCodeWriter"}


def path(name):
    """Of a file in the test's folder."""
    return os.path.join(_folder, name)


def traced():
    return servermanager.vtkSMTrace.GetActiveTracer() is not None


def save_data(name, source, **settings):
    """File > Save Data, traced as ParaView's window does, which paraview.simple.SaveData does not."""
    writer = CreateWriter(path(name), source)
    for prop, value in settings.items():
        setattr(writer, prop, value)
    if traced():
        smtrace.SaveData(writer.SMProxy, path(name), source.SMProxy, 0)
    writer.UpdatePipeline()


@contextlib.contextmanager
def applied(proxy):
    """Changes of a proxy, traced as the Apply of ParaView's panel does."""
    item = smtrace.PropertiesModified(proxy.SMProxy) if traced() else None
    yield proxy
    if item:
        item.finalize()


def remove_all():
    """Deletes all views and sources. A new session takes seconds, in which ParaView goes through the definitions of all proxies."""
    for proxy in (*GetViews(), *GetSources().values()):
        Delete(proxy)


def use_files(test):
    """Takes those that another process has made."""
    global _folder
    _folder = os.path.abspath(output(test))


def make_files(test, *series):
    """What readers read, in a folder for test. series: the program that makes a CT series, if there is one."""
    use_files(test)
    os.makedirs(_folder, exist_ok=True)
    sweep = PhantomSweep(NumberOfSlices=12, ImageSize=[60, 50], PixelSpacing=1, Motion="Arbitrary")
    SaveData(path("sweep.nhdr"), proxy=sweep)
    random = np.random.default_rng(3)
    poses = [scans.pose(scans.rotation([0, 0, 1], 2 * i), [0, 0, i]) for i in range(8)]
    open_slices(f"{test}/stack", random.integers(0, 255, (8, 30, 40)).astype(np.uint8), poses)
    scans.open_table(f"{test}/poses", ["Slice", *(f"m{i}" for i in range(16))], [[n, *pose.ravel()] for n, pose in enumerate(poses)])
    scans.open_table(f"{test}/gate", ["Time", "Gate"], [[0.1 * n, 0.13 * n % 1] for n in range(30)])
    scans.open_wall(f"{test}/", random)
    scans.open_wires(f"{test}/", random)
    scans.open_receivers(f"{test}/", random)
    with open(path("volume.nrrd"), "wb") as file:  # turned about z, from head to feet
        file.write(b"NRRD0004\ntype: uint8\ndimension: 3\nspace: right-anterior-superior\nsizes: 12 10 8\nencoding: raw\n"
                   b"space directions: (0.6,0.8,0) (0.8,-0.6,0) (0,0,-2)\nspace origin: (5,-6,7)\n\n"
                   + random.integers(0, 255, 960).astype(np.uint8).tobytes())
    with open(path("outlines.csv"), "w", encoding="ascii") as file:  # of a ball
        file.write("structure,outline,x,y,z\n")
        for n, (z, angles) in enumerate((z, np.arange(0, 2 * np.pi, 0.5)) for z in (-8, -4, 0, 4, 8)):
            radius = np.sqrt(100 - z ** 2)
            file.writelines(f"Ball,{n},{radius * np.cos(a)},{radius * np.sin(a)},{z}\n" for a in angles)
    for program in series:
        subprocess.run([program, path("series")], check=True, stdout=subprocess.DEVNULL)
    remove_all()


def freehand():
    sweep = PhantomSweep(registrationName="Sweep", NumberOfSlices=30, ImageSize=[80, 60], PixelSpacing=0.8, Motion="Arbitrary",
                         NumberOfSweeps=2, SpeckleLevel=0.2, PoseNoise=[0.1, 0.2], Seed=4)
    breath = ProgrammableSource(registrationName="Breath", OutputDataSetType="vtkTable", Script="""
import numpy as np
time = np.arange(0, 3, 0.1)
output.RowData.append(time, "Time")
output.RowData.append((time / 1.3) % 1, "Gate")""")
    gated = GateSlices(registrationName="Gated", Input=sweep, GateTable=breath, GateType="Phase", GateRange=[0.9, 0.5])
    smooth = SpeckleFilter(registrationName="Smooth", Input=gated, Operation="Opening", KernelShape="Ellipsoid", KernelSize=[3, 3, 1])
    BoneEcho(registrationName="Bone echo", Input=gated, MinimumConfidence=0.05, MinimumArea=0)
    SlicePlanes(registrationName="Planes", Input=smooth, ColorBy="Speed", Stride=3)
    corners = (20, 15), (60, 18), (55, 45), (40, 30), (22, 44)
    # a sweep of its own: Slice Ray Caster has all of its input on every rank
    outlined = PhantomSweep(registrationName="Outlined sweep", NumberOfSlices=30, ImageSize=[80, 60], PixelSpacing=0.8, Motion="Arbitrary")
    outliner = SliceOutliner(registrationName="Outliner", Input=outlined, Slice=9, StructureNames=["Gland", "Cyst"], StructureColors=[0.9, 0.6, 0, 0, 0, 1],
                             OutlinePoints=[value for structure in (1, 2) for number in (5, 9, 14) for column, row in corners
                                            for value in (structure, number, number, column, row + 3 * structure)])
    OutlinedStructures(registrationName="Structures", Input=outliner, RegistrationError=0.5)
    volume = SweptVolume(registrationName="Volume", Input=[gated, sweep], OutputSpacing=[1.5, 1.5, 1.5], Compounding="Maximum",
                         ClipRectangle=[2, 3, 70, 50])
    ContrastToSpeckle(registrationName="Contrast", Input=volume, InsideBounds=[-3, 3, -3, 3, -3, 3], IsoValue=120)
    Contour(registrationName="Contour", Input=volume, ContourBy=["POINTS", "Intensity"], Isosurfaces=[120])
    cast = SliceRayCaster(registrationName="Cast", Input=sweep, IsoValue=120, ViewDirection=[0.2, 1, 0.3], PixelSpacing=1)
    DepthMapSurface(registrationName="Surface", Input=cast)
    save_data("written.nhdr", smooth, CompressionLevel=3)


def files():
    reader = TrackedSliceReader(registrationName="Reader", FileName=path("sweep.nhdr"), FrameStride=2)
    SweptVolume(registrationName="Volume", Input=reader, OutputSpacing=[2, 2, 2])
    SweptVolume(registrationName="Principal volume", Input=reader, OutputSpacing=[3, 3, 3], OutputFrame="Principal")
    gate = CSVReader(registrationName="Gate", FileName=[path("gate.csv")])
    GateSlices(registrationName="Gated", Input=reader, GateTable=gate, GateType="Phase", GateRange=[0.9, 0.5])
    stack = XMLImageDataReader(registrationName="Stack", FileName=[path("stack.vti")])
    poses = CSVReader(registrationName="Poses", FileName=[path("poses.csv")])
    AssembleTrackedSlices(registrationName="Assembled", Input=stack, Poses=poses, PoseFormat="Matrix", PoseColumns=["m"], PixelSpacing=0.4)
    turned = VolumeReader(registrationName="Turned volume", FileName=path("volume.nrrd"))
    Mirror(registrationName="Mirrored volume", Input=turned, PlaneMethod="Given", Origin=[-11.9, 4.3, 0], Normal=[1, 0.02, 0])
    SkullBone(registrationName="Turned bone", Input=turned, Level=100)
    SkullResection(registrationName="Turned cut", Input=turned, Tumour=Sphere(registrationName="Within", Center=[0, 4, 0], Radius=3), Level=100,
                   Margin=1, GuideWidth=0)
    OccludedAngle(registrationName="Turned angle", Input=turned, NumberOfDirections=8)
    SpeckleFilter(registrationName="Turned and smooth", Input=turned, Operation="Median", KernelSize=[3, 3, 1])
    RBFInterpolator(registrationName="Of turned", Input=turned, ScalarArray="Intensity", Kernel="Linear", OutputSpacing=[4, 4, 4])
    corners = Sphere(registrationName="Corners", Radius=9, ThetaResolution=4, PhiResolution=4)
    RBFImageWarp(registrationName="Turned and warped", Input=turned, Landmarks=corners, Targets=corners)
    OutlineReader(registrationName="Outlines", FileName=path("outlines.csv"))
    if os.path.isdir(path("series/oblique")):
        CTSeriesReader(registrationName="CT", FileName=path("series/oblique"), MissingSlices="Interpolate")


def calibration():
    wires = XMLImageDataReader(registrationName="Wires", FileName=[path("wires.vti")])
    picks = CSVReader(registrationName="Picks", FileName=[path("picks.csv")])
    ProbeCalibration(registrationName="Probe", Input=wires, Picks=picks, PixelSpacing=0.4, OutlierLimit=4)
    wall = XMLImageDataReader(registrationName="Wall", FileName=[path("wall.vti")])
    TemporalCalibration(registrationName="Lag", Input=wall, MaximumLag=0.2)
    ScanRegion(registrationName="Region", Input=wall, TickLength=10)
    receivers = CSVReader(registrationName="Receivers", FileName=[path("receivers.csv")])
    TrackerSelfTest(registrationName="Self test", Input=receivers, LengthUnit="cm")


def live():
    """It has no slices until it is started."""
    PolhemusVideoSource(registrationName="Live", TrackerConnection="/dev/none", VideoURL="lavfi:testsrc2=size=320x240:rate=25",
                        CaptureMode="EveryFrame", CropRectangle=[10, 20, 200, 100], SpeedLimit=30, TimeOffset=-0.04)


def implant():
    skull = SkullPhantom(registrationName="Skull", Spacing=[3, 3, 4], DefectRadius=25, DefectDirection=[0.5, -0.2, 0.8], NoiseLevel=5)
    depth = BSplineIsoRayCaster(registrationName="Depth", Input=skull, IsoValues=[500, 900], ViewDirection=[-0.5, 0.2, -0.8], PixelSpacing=2,
                                ComputeThickness=1)
    opened = BSplineIsoRayCaster(registrationName="Opened", Input=skull, IsoValues=[500], PixelSpacing=2, CutAway="Box")
    with applied(opened):
        opened.CutAway.Position = [-10, -20, 10]
        opened.CutAway.Length = [60, 70, 80]
        opened.CutAway.Rotation = [0, 0, 20]
    DepthMapShader(registrationName="Shaded", Input=opened, Volume=skull, NormalMethod="Gordon", Shading="Phong", DepthCue=0.3)
    Mirror(registrationName="Mirror", Input=depth, PlaneMethod="Given", Origin=[1, 0, 0], Normal=[1, 0.02, 0])
    Mirror(registrationName="Mirrored skull", Input=skull)
    # a phantom of its own: ray casters have all of theirs on every rank
    head = SkullPhantom(registrationName="Head", Spacing=[3, 3, 4], DefectRadius=25, DefectDirection=[0.5, -0.2, 0.8])
    bone = SkullBone(registrationName="Bone", Input=head, Level=400)
    whole = SkullPhantom(registrationName="Whole skull", Spacing=[3, 3, 4], DefectRadius=0)
    template = SkullPhantom(registrationName="Template", Spacing=[3, 3, 4], DefectRadius=0)
    solid = SkullImplant(registrationName="Implant", Input=bone, Level=400, TriangleSize=3, Template=template, TemplateLevel=410)
    PressOrientation(registrationName="Implant mould", Input=solid, Seating="Inlay", FlangeWidth=25)
    SkullResection(registrationName="Cut", Input=bone, Tumour=Sphere(registrationName="Tumour", Center=[-30, 20, 45], Radius=10), Level=400, Margin=4,
                   GuideWidth=6)
    PhantomSweep(registrationName="Scanned", Input=skull, NumberOfSlices=9, ImageSize=[40, 30], PixelSpacing=4, SpeckleLevel=0.1)
    prior = BSplineIsoRayCaster(registrationName="Prior", Input=whole, IsoValues=[500], ViewDirection=[-0.5, 0.2, -0.8], PixelSpacing=2)
    RBFSurface(registrationName="Closed", Input=prior, OutputSpacing=6, OutputBounds=[-80, 80, -95, 95, -80, 72], DistanceSpacing=19)
    filled = RBFHoleFiller(registrationName="Filled", Input=depth, SupportMargin=14, NodeSpacing=3, DefectRegion="Sphere")
    with applied(filled):
        filled.DefectRegion.Center = [37, -15, 60]
        filled.DefectRegion.Radius = 34
    handles = PolyLineSource(registrationName="Handles", Points=[37, -15, 61, 33, -12, 64])
    looped = RBFHoleFiller(registrationName="Looped", Input=depth, NodeSpacing=3.5, Kernel="Cubic", CutoffWavelength=8, ControlPoints=handles,
                           PriorSurface=prior, DefectRegion="Spline Loop")
    with applied(looped):
        looped.DefectRegion.Points = [70, -15, 45, 45, 25, 55, 5, 10, 75, 15, -50, 65]
    DepthMapSurface(registrationName="Surface", Input=looped, MaximumAngle=75)
    plate = ImplantPlate(registrationName="Plate", Input=filled, Thickness=2, EdgeClearance=0.5)
    DefectModel(registrationName="Model", Input=filled)
    mould = PressOrientation(registrationName="Mould", Input=filled, Mould="Male", FlangeWidth=15)
    milled = MillingToolPath(registrationName="Path", Input=mould, ToolRadius=5, StepOver=3, RoughingStep=6)
    save_data("written.igs", filled, Tolerance=0.01)
    save_data("written.nc", milled, AcceptWarnings=1)
    save_data("written.step", plate, Tolerance=0.05)


def occlusion():
    shape = IncompleteShape(registrationName="Shape", Shape="Sphere", Dimensions=[28, 28, 28], PresentFraction=0.6, OutlierFraction=0.02, Seed=3)
    angle = OccludedAngle(registrationName="Angle", Input=shape, NumberOfDirections=60, ThresholdsOverPi=[1.9, 1.7, 1.6], LocalRadii=[8, 0, 0])
    OcclusionSurface(registrationName="Refined", Input=angle, Data=shape)


def radial_basis():
    sphere = Sphere(registrationName="Places", Radius=50, ThetaResolution=20, PhiResolution=12)
    warmth = Calculator(registrationName="Warmth", Input=sphere, ResultArrayName="Warmth", Function="20 + coordsX/10 + sin(coordsZ/15)")
    volume = RBFInterpolator(registrationName="Interpolated", Input=warmth, ScalarArray="Warmth", Kernel="Linear", OutputSpacing=[9, 9, 9], Smoothing=0.1)
    moved = Transform(registrationName="Targets", Input=sphere)
    with applied(moved):
        moved.Transform.Rotate = [0, 0, 10]
        moved.Transform.Scale = [1.1, 1, 1.05]
    RBFImageWarp(registrationName="Warped", Input=volume, Landmarks=sphere, Targets=moved, Kernel="Linear", Smoothing=0.5)
    waves = Calculator(registrationName="Waves", Input=sphere, CoordinateResults=1,
                       Function="(coordsX + 14*sin(coordsY/6))*iHat + coordsY*jHat + coordsZ*kHat")
    RBFImageWarp(registrationName="Folded", Input=volume, Landmarks=sphere, Targets=waves, Kernel="Linear")  # in 2 % of the voxels


def every_kind():
    """Names of all sources, filters and writers of the plugin."""
    manager = servermanager.ProxyManager()
    definitions, found = manager.SMProxyManager.GetProxyDefinitionManager(), set()
    for group in ("sources", "filters", "writers"):
        iterator = definitions.NewSingleGroupIterator(group)
        iterator.InitTraversal()
        while not iterator.IsDoneWithTraversal():
            found.add(iterator.GetProxyName())
            iterator.GoToNextItem()
    return {name for name in found if name.startswith("Lacuna")}


def without_time(content):
    """Of a file: when it was written is the one thing that may differ."""
    return re.sub(rb"\d{8}\.\d{6}|\d{4}-\d\d-\d\d[ T]\d\d:\d\d(:\d\d)?", b"", content)


def written():
    """Names and contents of the files that were written, without the time of day; the folder's other files are read."""
    found = {}
    for name in sorted(name for name in os.listdir(_folder) if name.startswith("written.")):
        with open(path(name), "rb") as file:
            found[name] = without_time(file.read())
    return found


PIPELINES = freehand, files, calibration, live, implant, occlusion, radial_basis
