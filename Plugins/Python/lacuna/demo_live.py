# SPDX-License-Identifier: BSD-3-Clause
"""The live part of the demo: emulated devices -> live acquisition -> a reconstruction that grows on screen."""
import math
import os
import re
import select
import shutil
import signal
import socket
import subprocess
import tempfile
import time

import lacuna
import numpy as np
import paraview.simple as pv
from lacuna import demo_ultrasound, live, pictures
from vtkmodules.util.numpy_support import vtk_to_numpy

PROGRAM = "lacuna-fastrak-emulator"
PRELOAD = "libLacunaPseudoTerminalPorts.so"
LATENCY = 0.04  # s, of the emulated video
ISO = 120  # of Phantom Sweep's Ellipsoids
TRUE_VOLUME = 4 / 3 * math.pi * 17 * 12 * 15 / 1000  # ml, of the main one
SPACING = 0.8  # mm
ALLOWED = 0.08  # of the volume; a computer with too much to do answers the tracker late
MARGIN = 34  # mm around the middle of the scene
PATIENCE = 30  # s until the devices work


def run(options, report):
    """All stages; options are demo.py's, report its Report."""
    report.section("Live acquisition")
    with Interruption() as stop, tempfile.TemporaryDirectory(prefix="lacuna-live-") as folder:
        with report.stage("start the emulated tracker and scanner"):
            devices = Devices(folder, options)
        try:
            with report.stage("open both devices"):
                source = connect(devices, options.output, stop)
            with report.stage("acquire"):
                picture = Picture(source, devices, options)
                picture.acquire(stop)
            with report.stage("end and keep the sweep"):
                if stop.wanted:
                    report.add("ended by", "the user")
                finish(source, picture, options, report)
        finally:
            devices.end()


class Interruption:
    """Notes Ctrl-C instead of ending at once."""

    def __init__(self):
        self.wanted = False
        self.before = {}

    def __enter__(self):
        self.before = {number: signal.signal(number, self.note) for number in (signal.SIGINT, signal.SIGTERM)}
        return self

    def __exit__(self, *_error):
        for number, handler in self.before.items():
            signal.signal(number, handler or signal.SIG_DFL)  # None: one that is not Python's

    def note(self, _number, _frame):
        self.wanted = True


class Devices:
    """The program with both emulators, and what it says about them."""

    def __init__(self, folder, options):
        if PRELOAD not in os.environ.get("LD_PRELOAD", ""):
            raise RuntimeError(f"{PRELOAD} is not preloaded, without which no pseudo-terminal can be opened as a serial "
                               "port: run ./demo.sh --live")
        link = os.path.join(folder, "tracker")
        self.port = "/dev/../../.." + link
        self.calibration = os.path.join(options.output, "live-calibration.xml")
        poses = os.path.join(folder, "poses.txt")
        with open(poses, "w", encoding="utf-8") as file:
            file.writelines(hand(options.seconds))
        self.video = f"tcp://127.0.0.1:{free_port()}"
        # not of this terminal, so that Ctrl-C leaves them until the sweep is closed
        self.process = subprocess.Popen(
            [find_program(), "--link", link, "--baud", "115200", "--poses", poses, "--loop", "--noise", "0.05", "0.02",
             "--video", self.video, "--video-latency", str(LATENCY), "--calibration", self.calibration,
             "--seconds", str(10 * options.seconds + 600)],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True,
            env={name: value for name, value in os.environ.items() if name != "LD_PRELOAD"})
        try:
            text = self.read_lines(3)
            numbers = re.findall(r"(\w+) (-?[\d.]+(?: -?[\d.]+)*)", text[-1].split(":", 1)[1])
            self.region = {name: [float(value) for value in values.split()] for name, values in numbers}
        except Exception:
            self.end()
            raise

    def read_lines(self, count):
        """The first lines of what it says."""
        text = b""
        while text.count(b"\n") < count:
            if not select.select([self.process.stdout], [], [], PATIENCE)[0]:
                raise RuntimeError(f"{PROGRAM} says nothing")
            more = os.read(self.process.stdout.fileno(), 4096)
            text += more
            if not more:
                raise RuntimeError(f"{PROGRAM} ended: {text.decode().strip()}")
        return text.decode().splitlines()[:count]

    def end(self):
        self.process.terminate()
        self.process.wait()
        self.process.stdout.close()


def find_program():
    # <prefix>/lib/python3.x/site-packages/lacuna, and <prefix>/bin
    beside = os.path.join(os.path.abspath(lacuna.__file__), *[os.pardir] * 5, "bin", PROGRAM)
    found = os.path.normpath(beside) if os.path.exists(os.path.normpath(beside)) else shutil.which(PROGRAM)
    if not found:
        raise RuntimeError(f"the program {PROGRAM} is not installed")
    return found


def free_port():
    with socket.socket() as line:
        line.bind(("127.0.0.1", 0))
        return line.getsockname()[1]


def hand(seconds):
    """A sweep to and fro over 70 mm in that time, tilted one way and then the other, as lines of poses."""
    for i in range(int(seconds * 20) + 1):
        angle = 2 * math.pi * i / int(seconds * 20)
        place = (200 + 2 * math.sin(3 * angle), 35 * math.sin(angle), -60 + 1.5 * math.cos(2 * angle))
        turn = (5 * math.cos(angle), 20 + 2 * math.sin(2 * angle), 4 * math.cos(angle))
        yield " ".join(f"{value:.6f}" for value in (i / 20, 1, *place, *turn)) + "\n"


def connect(devices, folder, stop):
    """The source with both devices at work."""
    source = pv.PolhemusVideoSource(
        TrackerConnection=devices.port, BaudRate=115200, VideoURL=devices.video, VideoLatency=LATENCY,
        CalibrationFileName=devices.calibration, CropRectangle=[int(n) for n in devices.region["CropRectangle"]],
        CaptureMode="Movement", MovementThreshold=0.8, RecordFileName=os.path.join(folder, "live-sweep.mhd"), LiveDisplay=0)
    live.connect(source)
    if not live.poll_until(source, lambda: works(source) or stop.wanted, seconds=PATIENCE):
        raise RuntimeError(f"the devices do not work: {live.get(source, 'Message')}")
    return source


def works(source):
    return live.get(source, "TrackerWorks") and live.get(source, "VideoWorks")


class Picture:
    """The pipeline behind the source and the picture of it."""

    def __init__(self, source, devices, options):
        self.source = source
        self.options = options
        self.devices = devices
        self.volume = self.surface = self.newest = None
        self.films = 0
        self.steps = 0
        self.view = pictures.new_view((1280, 720))
        self.text = pv.Text(Text="waiting for the probe")
        display = pv.Show(self.text, self.view)
        display.Color, display.FontSize = [0.15, 0.15, 0.15], 16
        display.WindowLocation = "Upper Left Corner"
        self.look()

    def look(self):
        """As on the scanner's screen, with the probe above, but from aside and a little from above."""
        pv.Render(self.view)  # the first one looks where it likes
        lateral, depth, travel = np.eye(3)  # of the scene
        direction = travel + 0.75 * lateral + 0.5 * depth
        camera = self.view.GetActiveCamera()
        self.view.CameraParallelProjection = 1
        camera.SetFocalPoint(0, 0, 0)
        camera.SetPosition(*(-300 * direction / np.linalg.norm(direction)))
        camera.SetViewUp(*-depth)
        camera.SetParallelScale(54)

    def acquire(self, stop):
        """Until the time is over, or Ctrl-C."""
        live.start(self.source)
        end = time.monotonic() + self.options.seconds
        next_picture = 0
        while time.monotonic() < end and not stop.wanted:
            live.poll(self.source)
            if live.get(self.source, "SliceCount") >= 2:
                self.update()
            self.draw()
            if time.monotonic() > next_picture:
                self.film()
                next_picture = time.monotonic() + 1
            time.sleep(0.02)
        live.stop(self.source)

    def update(self):
        """What is shown is brought up to the slices that there are."""
        if not self.volume:
            self.build()
        count = demo_ultrasound.dimensions(self.source)[2]
        self.show_slice(count - 1)
        self.surface.UpdatePipeline()
        speed = live.get(self.source, "Speed")
        self.text.Text = f"{count} slices" + ("" if math.isnan(speed) else f", {speed:.0f} mm/s")
        self.steps += 1

    def show_slice(self, number):
        extent = self.source.GetDataInformation().GetExtent()
        self.newest.VOI = [*extent[:4], extent[4] + number, extent[4] + number]

    def show_middle(self):
        """The slice that is nearest to the middle of the scene."""
        fields = self.source.GetClientSideObject().GetOutputDataObject(0).GetFieldData()
        poses = vtk_to_numpy(fields.GetArray("ImageToReference")).reshape(-1, 4, 4)
        column, row, width, height = self.devices.region["CropRectangle"]
        centers = poses[:, :3] @ (column + width / 2, row + height / 2, 0, 1)
        self.show_slice(int(np.argmin(np.linalg.norm(centers, axis=1))))

    def build(self):
        region = self.devices.region
        self.volume = pv.SweptVolume(
            Input=self.source, OutputSpacing=[SPACING] * 3, OutputBounds=[-MARGIN, MARGIN] * 3, FanOrigin=region["FanOrigin"],
            FanAngles=region["FanAngles"], FanRadii=region["FanRadii"],
            UseTooFast=1)  # haste harms by the latency, which is known here
        smooth = pv.SpeckleFilter(Input=self.volume, Operation="Median", KernelSize=[3] * 3)
        smooth.UpdatePipeline()
        contour = pv.Contour(Input=smooth, ContourBy=["POINTS", "Intensity"], Isosurfaces=[ISO], ComputeNormals=1,
                             ComputeScalars=0)
        self.surface = contour
        pictures.show_surface(contour, self.view, pictures.TISSUE)
        self.newest = pv.ExtractSubset(Input=self.source)
        plane = pv.SlicePlanes(Input=self.newest, InvalidSlices="Show", MaximumNumberOfPoints=75000)
        demo_ultrasound.show_picture(plane, self.view, sector=True)
        frames = pv.SlicePlanes(Input=self.source, OutlineOnly=1, Stride=10, InvalidSlices="Show")
        pictures.show_surface(frames, self.view, pictures.FRAME).LineWidth = 1
        self.look()

    def draw(self):
        pv.Render(self.view)
        interactor = self.view.GetInteractor()
        if not self.options.offscreen and interactor:
            interactor.ProcessEvents()

    def film(self):
        folder = os.path.join(self.options.output, "live-film")
        os.makedirs(folder, exist_ok=True)
        pictures.save(self.view, os.path.join(folder, f"{self.films:04d}.png"))
        self.films += 1


COUNTS = {"FrameCount": "frames of the video", "MissingFrames": "frames lost", "FramesWithoutPose": "frames without a pose",
          "TooFastSlices": "slices that were too fast"}


def finish(source, picture, options, report):
    """Waits until all is on the disk, says what became of the sweep and closes the devices."""
    count = live.get(source, "SliceCount")
    live.poll_until(source, lambda: live.get(source, "RecordedSlices") >= count, seconds=PATIENCE)
    file = os.path.basename(live.get(source, "RecordedFileName")) or "no file"
    report.add("slices", count)
    written = live.get(source, "RecordedSlices")
    report.add("slices on disk", f"{written} in {file}")
    for name, text in COUNTS.items():
        report.add(text, live.get(source, name))
    report.add("largest time from a slice to a measurement, ms", f"{1000 * live.get(source, 'LargestResidual'):.1f}")
    report.add("pictures of the growing surface", picture.steps)
    live.disconnect(source)
    if count >= 2:
        picture.update()
        picture.show_middle()
    if count >= 2 and picture.surface.GetDataInformation().GetNumberOfCells() > 0:
        largest = pv.Connectivity(Input=picture.surface, ExtractionMode="Extract Largest Region", ColorRegions=0)
        millilitres, open_edges = demo_ultrasound.measure(pv.ExtractSurface(Input=largest))
        report.add("enclosed volume, ml", f"{millilitres:.3f}")
        report.add("open edges of the surface", open_edges)
        error = f"{100 * (millilitres / TRUE_VOLUME - 1):+.2f} %"
        report.add("true volume, ml", f"{TRUE_VOLUME:.3f} (error {error})")
        report.require(open_edges == 0, f"the surface is not closed ({open_edges} open edges): the sweep ended too early")
        report.compare("the live surface's volume", f"{millilitres:.2f} ml", f"{TRUE_VOLUME:.2f} ml", error, f"{100 * ALLOWED:g} %",
                       abs(millilitres / TRUE_VOLUME - 1) <= ALLOWED)
        picture.text.Text = f"{count} slices, surface {millilitres:.1f} ml (truth {TRUE_VOLUME:.1f} ml)"
    else:
        report.require(False, "there is no surface: the acquisition ended too early")
    report.require(written == count, f"{count - written} of {count} slices are not on the disk")
    pictures.add_scale_bar(picture.view, 10)
    pictures.save(picture.view, os.path.join(options.output, "live.png"))
    report.picture("live.png", "The surface as it grew while the probe moved, the frames of its slices, and one slice as the scanner showed it.")
