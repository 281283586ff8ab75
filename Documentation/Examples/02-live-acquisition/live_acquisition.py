# SPDX-License-Identifier: BSD-3-Clause
"""A sweep is taken live, from a tracker and a scanner that are emulated, and its surface grows while it is.

    LD_PRELOAD=libLacunaPseudoTerminalPorts.so pvpython live_acquisition.py [folder for the results, default: .] [port]

The library (in lib/ of a build or an installation) lets the emulated serial port pass for a real one. Writes
live-acquisition.png, live-acquisition.pvsm and the sweep, live-acquisition.mhd.
"""
import os
import subprocess
import sys

import lacuna.plugin

lacuna.plugin.load()
from lacuna import demo_live, live, pictures, states
from paraview.simple import *

folder = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else ".")
port = int(sys.argv[2]) if len(sys.argv) > 2 else 5004
os.makedirs(folder, exist_ok=True)
LINK, CALIBRATION, VIDEO = f"/tmp/lacuna-tracker-{port}", f"/tmp/lacuna-probe-{port}.xml", f"tcp://127.0.0.1:{port}"

# Devices without hardware: a hand that sweeps to and fro by 80 mm every 8 s over the ellipsoids of Phantom Sweep
emulator = subprocess.Popen([demo_live.find_program(), "--link", LINK, "--baud", "115200", "--video", VIDEO, "--calibration", CALIBRATION, "--seconds", "120"],
                            stdout=subprocess.PIPE, env={name: value for name, value in os.environ.items() if name != "LD_PRELOAD"})
for _ in range(3):  # it says when it is ready
    emulator.stdout.readline()

# The source, and a pipeline behind it as behind any sweep; with devices of your own: /dev/ttyUSB0 and /dev/video0
scanner = PolhemusVideoSource(registrationName="Scanner", TrackerConnection="/dev/../../.." + LINK, BaudRate=115200, VideoURL=VIDEO, VideoLatency=0.04,
                              CalibrationFileName=CALIBRATION, CropRectangle=[61, 45, 631, 462], CaptureMode="Movement", MovementThreshold=0.8)
volume = SweptVolume(registrationName="Volume", Input=scanner, OutputSpacing=[0.8, 0.8, 0.8], OutputBounds=[-30, 30, -30, 30, -50, 50],
                     FanOrigin=[376, -214], FanAngles=[-26, 26], FanRadii=[40, 100], UseTooFast=1)
smooth = SpeckleFilter(registrationName="Median", Input=volume, Operation="Median", KernelSize=[3, 3, 3])
surface = Contour(registrationName="Surface", Input=smooth, ContourBy=["POINTS", "Intensity"], Isosurfaces=[120], ComputeScalars=0)
frames = SlicePlanes(registrationName="Slices", Input=scanner, OutlineOnly=1, Stride=20, InvalidSlices="Show")
view = pictures.new_view()
pictures.show_surface(surface, view, pictures.TISSUE)
pictures.show_slices(frames, view)
Render(view)
camera = view.GetActiveCamera()  # where the surface will be: there is nothing yet to reset it to
camera.SetFocalPoint(0, 0, 0)
camera.SetPosition(-160, -100, -150)
camera.SetViewUp(0, -1, 0)
view.CameraParallelProjection = 1
camera.SetParallelScale(64)
states.save(os.path.join(folder, "live-acquisition.pvsm"))  # before there are slices: the sweep is in the file of the recording

# Connect, Start, and 9 s later Stop; ParaView's window polls by itself, a script does it
try:
    scanner.RecordFileName = os.path.join(folder, "live-acquisition.mhd")
    live.connect(scanner)
    if not live.poll_until(scanner, lambda: live.get(scanner, "TrackerWorks") and live.get(scanner, "VideoWorks"), seconds=60):
        sys.exit(f"the devices do not work: {live.get(scanner, 'Message')}")
    live.start(scanner)
    for second in range(9):
        live.poll_until(scanner, lambda: False, seconds=1)
        surface.UpdatePipeline()
        print(f"{live.get(scanner, 'SliceCount')} slices, {surface.GetDataInformation().GetNumberOfCells()} triangles", flush=True)
    live.stop(scanner)
    live.poll_until(scanner, lambda: live.get(scanner, "RecordedSlices") == live.get(scanner, "SliceCount"), seconds=30)
finally:
    live.disconnect(scanner)
    emulator.terminate()

pictures.add_scale_bar(view, 10)
pictures.save(view, os.path.join(folder, "live-acquisition.png"))
