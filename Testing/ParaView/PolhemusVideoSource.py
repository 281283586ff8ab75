# SPDX-License-Identifier: BSD-3-Clause
"""Polhemus Video Source in ParaView: an emulated FASTRAK on a pseudo-terminal, a test signal of FFmpeg.

argument: the emulator's program. The library LacunaPseudoTerminalPorts must be preloaded.
"""
import os
import shutil
import subprocess
import sys
import tempfile
import time

import lacuna
from lacuna import live
from lacuna.errors import raising
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

import lacuna_test

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
started = time.monotonic()
folder = tempfile.mkdtemp(prefix="lacuna-live-")
link = os.path.join(folder, "tracker")
poses = os.path.join(folder, "poses.txt")
with open(poses, "w") as file:
    # rests, then goes to and fro by 40 mm at 10 mm/s
    file.write("0 1 150 30 -40 10 20 30\n2 1 150 30 -40 10 20 30\n6 1 150 70 -40 10 20 30\n10 1 150 30 -40 10 20 30\n")
environment = {key: value for key, value in os.environ.items() if key != "LD_PRELOAD"}


def plug_in(*options, motion=poses):
    emulator = subprocess.Popen([sys.argv[1], "--link", link, "--baud", "115200", "--poses", motion, "--loop", *options],
                                stdout=subprocess.PIPE, text=True, env=environment)
    assert "115200 baud" in emulator.stdout.readline()
    return emulator


def slices_of(source, port=0):
    data = servermanager.Fetch(source, idx=port)
    fields = data.GetFieldData()
    arrays = {fields.GetArrayName(i): vtk_to_numpy(fields.GetArray(i)) for i in range(fields.GetNumberOfArrays())
              if fields.GetArray(i)}
    return data, arrays


def wait(source, condition, what):
    print(f"{time.monotonic() - started:6.1f} s: {what}", flush=True)
    assert live.poll_until(source, condition, seconds=60), (what, live.get(source, "Message"))


try:
    emulator = plug_in()
    try:
        live.find()
        raise AssertionError("found a source where there is none")
    except RuntimeError as error:
        assert "no Polhemus Video Source" in str(error)
    source = PolhemusVideoSource()
    other = PolhemusVideoSource()
    SetActiveSource(None)
    try:
        live.find()
        raise AssertionError("chose one of two")
    except RuntimeError as error:
        assert "2 Polhemus" in str(error)
    SetActiveSource(source)
    assert live.find() == source
    Delete(other)
    SetActiveSource(None)
    assert live.find() == source
    lacuna_test.check_defaults(
        source, lacuna.vtkLacunaPolhemusVideoSource(),
        ["BaudRate", "Station", "Hemisphere", "FiltersOff", "ButtonStarts", "CropRectangle", "VideoLatency",
         "PixelSpacing", "TimeOffset", "HoldLastPose", "MovementThreshold", "SpeedLimit", "MemoryLimit",
         "RecordCompression", "LiveDisplay"],
        {"Field": ["Both", "Top", "Bottom"], "CaptureMode": ["Movement", "EveryFrame"], "RecordFormat": ["Binary", "ASCII"],
         "RecordUnit": ["Centimetre", "Inch"], "TrackerReset": ["Nothing", "Frames", "Factory"]})
    hints = source.SMProxy.GetHints()
    assert hints.FindNestedElementByName("LiveSource").GetAttribute("interval") == "40"
    UpdatePipeline(proxy=source)  # opens nothing
    source.SMProxy.UpdatePropertyInformation()
    assert not live.get(source, "TrackerWorks") and "Connect" in live.get(source, "Message")

    # a wrong port, and no video: what to do is said, at once and again and again
    source.TrackerConnection = "/dev/ttyLacunaNone"
    live.connect(source)
    wait(source, lambda: "There is no port /dev/ttyLacunaNone" in live.get(source, "Message"), "wrong port")
    wait(source, lambda: "VideoURL is not set" in live.get(source, "Message"), "no video")
    assert not live.get(source, "TrackerWorks")
    source.TrackerConnection = "igtl://127.0.0.1:1?transform=ProbeToTracker"  # nobody listens there
    wait(source, lambda: "igtl://127.0.0.1:1 " in live.get(source, "Message"), "no OpenIGTLink server")

    # mended, without anything else than the properties
    source.TrackerConnection = "/dev/../../.." + link
    source.VideoURL = "lavfi:testsrc2=size=96x64:rate=25"
    source.CaptureMode = "EveryFrame"
    wait(source, lambda: live.get(source, "TrackerWorks") and live.get(source, "VideoWorks"), "devices")
    wait(source, lambda: slices_of(source, 1)[0].GetNumberOfPoints() == 96 * 64, "the newest frame")
    assert slices_of(source)[0].GetNumberOfPoints() == 0 and live.get(source, "SliceCount") == 0  # dormant

    # every frame, recorded
    source.RecordFileName = os.path.join(folder, "sweep.mhd")
    source.UpdatePipeline()
    live.start(source)
    wait(source, lambda: live.get(source, "SliceCount") >= 5, "first slices")
    assert live.get(source, "Capturing")
    few = live.get(source, "SliceCount")
    planes = SlicePlanes(Input=source)  # downstream of a stack that grows
    wait(source, lambda: live.get(source, "SliceCount") >= few + 25, "more slices")
    begin = time.monotonic()
    live.stop(source)
    print(f"stopped after {time.monotonic() - begin:.3f} s", flush=True)
    assert not live.get(source, "Capturing")
    data, arrays = slices_of(source)
    count = live.get(source, "SliceCount")
    assert data.GetDimensions() == (96, 64, count) and live.get(source, "FrameCount") == count
    assert "ImageToReference" not in arrays
    for name in ("ProbeToTracker", "TrackerToReference", "Timestamp", "SliceStatus", "FrameNumber", "Residual", "Speed"):
        assert len(arrays[name]) == count, name
    assert all(arrays["FrameNumber"][1:] == arrays["FrameNumber"][:-1] + 1)
    assert all(arrays["Timestamp"][1:] > arrays["Timestamp"][:-1])
    valid = arrays["SliceStatus"] & 1 == 0
    assert valid.sum() >= count - live.get(source, "FramesWithoutPose") and valid.any()
    assert abs(arrays["ProbeToTracker"][valid][:, 3] - 150).max() < 0.01  # x
    assert abs(arrays["ProbeToTracker"][valid][:, 7] - 50).max() < 20.01  # y: 30 to 70 mm
    wait(source, lambda: live.get(source, "RecordedSlices") == count, "the disk")
    wait(source, lambda: f"{count} slices verified" in live.get(source, "Message"), "read back")

    # the recording is the same, for the reader without any setting
    reader = TrackedSliceReader(FileName=live.get(source, "RecordedFileName"))
    read, fields = slices_of(reader)
    assert read.GetDimensions() == data.GetDimensions()
    assert (vtk_to_numpy(read.GetPointData().GetScalars()) == vtk_to_numpy(data.GetPointData().GetScalars())).all()
    for name in ("SliceStatus", "FrameNumber", "Timestamp"):
        assert (fields[name] == arrays[name]).all(), name
    assert abs(fields["ProbeToTracker"][valid] - arrays["ProbeToTracker"][valid]).max() < 1e-12

    # calibrated afterwards, as Probe Calibration writes it
    calibration = os.path.join(folder, "calibration.xml")
    with open(calibration, "w") as file:
        file.write('<PlusConfiguration version="2.9"><CoordinateDefinitions><Transform From="Image" To="Probe" '
                   'Matrix="0.2 0 0 5 0 0.2 0 6 0 0 0.2 7 0 0 0 1"/></CoordinateDefinitions></PlusConfiguration>')
    source.CalibrationFileName = calibration
    source.UpdatePipeline()
    data, arrays = slices_of(source)
    image, probe = (arrays[name].reshape(-1, 4, 4) for name in ("ImageToReference", "ProbeToTracker"))
    assert abs(image[valid] - probe[valid] @ arrays["ImageToProbe"].reshape(4, 4)).max() < 1e-9
    planes.UpdatePipeline()
    assert planes.GetDataInformation().GetNumberOfPoints() > 0

    # by movement: none while it rests, evenly spaced while it goes; of none, and of the first ones, no volume can be made
    # yet, which is no error (here each would be raised)
    live.clear(source)
    assert live.get(source, "SliceCount") == 0
    source.RecordFileName = ""
    source.CaptureMode = "Movement"
    source.MovementThreshold = 2
    source.SpeedLimit = 50
    gated = GateSlices(Input=source, SpeedLimit=100)
    volumes = [SweptVolume(Input=source, OutputSpacing=[1, 1, 1]), SweptVolume(Input=gated, OutputSpacing=[1, 1, 1])]
    sizes = {}

    def reconstruct():
        count = slices_of(source)[0].GetDimensions()[2]
        for volume in volumes:
            with raising():
                volume.UpdatePipeline()
        sizes[count] = [servermanager.Fetch(volume).GetNumberOfPoints() for volume in volumes]
        return live.get(source, "SliceCount") >= 8

    reconstruct()
    live.start(source)
    wait(source, reconstruct, "slices by movement")
    print("voxels of slices:", sizes, flush=True)
    assert max(sizes[min(sizes)]) == 0 and min(sizes[max(sizes)]) > 0
    assert 1 in sizes or 2 in sizes, "the first slices came too fast to be looked at"
    for volume in volumes + [gated]:
        Delete(volume)
    source.SpeedLimit = 5
    wait(source, lambda: live.get(source, "TooFastSlices") > 0, "speed")
    live.stop(source)
    data, arrays = slices_of(source)
    assert live.get(source, "StillFrames") > live.get(source, "SliceCount")
    counts = ("SliceCount", "StillFrames", "FramesWithoutPose", "FramesOfWrongSize", "FramesPastLimit")
    assert live.get(source, "FrameCount") == sum(live.get(source, name) for name in counts)
    steps = abs(arrays["ProbeToTracker"][1:, 7] - arrays["ProbeToTracker"][:-1, 7])
    assert steps.min() > 1.99, steps
    assert (arrays["SliceStatus"] & 4).any() and (arrays["Speed"][arrays["SliceStatus"] & 4 > 0] > 5).all()

    # however the FASTRAK writes its records
    live.clear(source)
    source.RecordFormat = "ASCII"
    source.RecordUnit = "Inch"
    source.TrackerReset = "Factory"
    source.CaptureMode = "EveryFrame"
    live.start(source)
    wait(source, lambda: live.get(source, "TrackerWorks"), "ASCII in inches")
    seen = live.get(source, "SliceCount")
    wait(source, lambda: live.get(source, "SliceCount") >= seen + 20, "slices of ASCII records")
    live.stop(source)
    arrays = slices_of(source)[1]
    assert arrays["SliceStatus"][-1] & 1 == 0 and abs(arrays["ProbeToTracker"][-1][3] - 150) < 0.01

    # unplugged and plugged in again, while the capture goes on
    live.clear(source)
    source.CaptureMode = "EveryFrame"
    live.start(source)
    wait(source, lambda: live.get(source, "SliceCount") >= 3, "slices")
    emulator.terminate()
    emulator.wait()
    wait(source, lambda: not live.get(source, "TrackerWorks") and "plug" in live.get(source, "Message"), "unplugged")
    emulator = plug_in()
    wait(source, lambda: live.get(source, "TrackerWorks"), "plugged in")
    without = live.get(source, "FramesWithoutPose")
    seen = live.get(source, "SliceCount")
    wait(source, lambda: live.get(source, "SliceCount") >= seen + 10, "slices after")
    live.stop(source)
    arrays = slices_of(source)[1]
    assert without > 0 and (arrays["SliceStatus"] & 1).sum() >= without
    assert arrays["SliceStatus"][-1] & 1 == 0

    # a macro with a key of its own
    live.clear(source)
    assert live.toggle_capture() and live.get(source, "Capturing")
    wait(source, lambda: live.get(source, "SliceCount") >= 3, "started by a macro")
    assert not live.toggle_capture() and not live.get(source, "Capturing")
    assert live.toggle_capture(source)
    live.stop(source)

    # the stylus's button, or a foot switch in its place
    live.clear(source)
    source.ButtonStarts = True
    emulator.terminate()
    emulator.wait()
    emulator = plug_in("--button", "4", "--button", "6")
    wait(source, lambda: live.get(source, "Capturing"), "the button starts")
    wait(source, lambda: not live.get(source, "Capturing"), "the button stops")
    taken = live.get(source, "SliceCount")
    print(f"{taken} slices between two presses", flush=True)
    assert taken > (0 if lacuna_test.SANITIZED else 10)  # a sanitizer makes the emulator late

    live.disconnect(source)
    # they stay, and with them the frames before the press that still waited for their poses
    assert taken <= live.get(source, "SliceCount") == len(slices_of(source)[1]["SliceStatus"])
    Delete(planes)
    Delete(reader)

    # the probe is lifted and put down elsewhere, again and again: live and from the recording its sweeps have the same ends
    strips = os.path.join(folder, "strips.txt")
    with open(strips, "w") as file:
        file.write("0 1 150 30 -40 10 20 30\n1.2 1 150 42 -40 10 20 30\n")
    emulator.terminate()
    emulator.wait()
    emulator = plug_in(motion=strips)
    live.connect(source)
    live.clear(source)
    source.ButtonStarts = False
    source.SpeedLimit = 0
    source.RecordFileName = os.path.join(folder, "strips.mhd")
    live.start(source)
    volume = SweptVolume(Input=source, BadPoses="LeaveOut", OutputSpacing=[2, 2, 2])
    for enough in (90, 180, 360):  # a busy machine may miss where the probe is put down
        wait(source, lambda enough=enough: live.get(source, "SliceCount") >= enough, f"strips of {enough} slices")
        if len(slices_of(volume)[1]["Sweeps"]) > 1:
            break
    live.stop(source)
    Delete(volume)
    count = live.get(source, "SliceCount")
    wait(source, lambda: live.get(source, "RecordedSlices") == count, "the strips on the disk")
    reader = TrackedSliceReader(FileName=live.get(source, "RecordedFileName"), CalibrationFileName=calibration)
    for make, settings in ((SweptVolume, {"OutputSpacing": [2, 2, 2]}), (SliceRayCaster, {"IsoValue": 100})):
        ends = []
        for slices in source, reader:
            proxy = make(Input=slices, BadPoses="LeaveOut", **settings)  # one may be of the way in between
            arrays = slices_of(proxy)[1]
            proxy.UpdatePropertyInformation()
            ends.append((arrays["Sweeps"].tolist(), arrays["SweepGap"].tolist(), proxy.GetProperty("SweepDescription").GetData()))
            Delete(proxy)
        print(ends[0][2], flush=True)
        assert ends[0] == ends[1], ends
        assert len(ends[0][0]) > 1 and max(ends[0][1]) < 9 and "not joined" in ends[0][2], ends[0]
    Delete(reader)

    # the folder of the recording is removed while slices come: a warning at once, and all of them in another file
    gone = os.path.join(folder, "gone")
    os.mkdir(gone)
    live.clear(source)
    source.RecordFileName = os.path.join(gone, "lost.mhd")
    live.start(source)
    wait(source, lambda: live.get(source, "RecordedSlices") >= 20, "slices in a folder")
    warnings = []
    shutil.rmtree(gone)
    removed = time.monotonic()
    with raising(warnings):
        wait(source, lambda: "lost.raw' is no longer there" in live.get(source, "Message"), "the folder is removed")
        assert lacuna_test.SANITIZED or time.monotonic() - removed < 2
        count = live.get(source, "RecordedSlices")
        wait(source, lambda: live.get(source, "RecordedSlices") >= count + 20, "slices in another folder")
        live.stop(source)
    assert any("removed" in warning for warning in warnings), warnings
    wait(source, lambda: live.get(source, "VerifiedSlices") == live.get(source, "SliceCount"), "read back")
    assert live.get(source, "RecordedFileName") == os.path.join(folder, "lost.mhd") in live.get(source, "DiskMessage")
    reader = TrackedSliceReader(FileName=live.get(source, "RecordedFileName"))
    (data, arrays), (read, fields) = slices_of(source), slices_of(reader)
    assert (vtk_to_numpy(read.GetPointData().GetScalars()) == vtk_to_numpy(data.GetPointData().GetScalars())).all()
    assert (fields["FrameNumber"] == arrays["FrameNumber"]).all()
    live.disconnect(source)
    Delete(reader)
    Delete(source)
finally:
    emulator.terminate()
    emulator.wait()
    shutil.rmtree(folder, ignore_errors=True)
print("done", flush=True)
