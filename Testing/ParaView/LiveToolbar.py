# SPDX-License-Identifier: BSD-3-Clause
"""The toolbar Live Acquisition of the ParaView application, with emulated devices.

The library LacunaPseudoTerminalPorts must be preloaded. LACUNA_TEST_PICTURES: also saves pictures of the window.
"""
import json
import os
import signal
import tempfile
import time
import types

import lacuna_window

SETTINGS = "LACUNA_LIVE_SETTINGS"
PICTURES = "LACUNA_TEST_PICTURES" in os.environ


def test(window):
    from lacuna import live
    from paraview.simple import (Delete, FindSource, GetActiveSource, GetLayoutByName, GetRenderViews, GetViewsInLayout, PolhemusVideoSource,
                                 Render, ResetCamera, SetActiveSource)

    def picture(name):
        if PICTURES:
            window.wait(300)
            window.save(os.path.join(os.environ["LACUNA_TEST_OUTPUT"], f"LiveToolbar-{name}.png"))

    settings = json.loads(os.environ[SETTINGS])
    window.resize(1500, 900)
    # nothing to start
    assert window.get("LiveStartStop", "enabled") == window.get("LiveSlices", "visible") == "false"
    assert "there is no Polhemus Video Source" in window.get("LiveStartStop", "toolTip")
    window.key(lacuna_window.F9)
    picture("none")

    # by the menu: not before Apply
    window.press("LacunaPolhemusVideoSource")
    source = GetActiveSource()
    assert source.SMProxy.GetXMLName() == "LacunaPolhemusVideoSource"
    picture("new")
    window.wait_for_text("LiveSlices", "true", "visible")
    window.wait_for_text("LiveStartStop", "press Apply first", "toolTip")
    assert window.get("LiveStartStop", "enabled") == "false"
    for name in ("TrackerConnection", "VideoURL", "CalibrationFileName", "CropRectangle", "RecordFileName"):
        setattr(source, name, settings[name])
    source.CaptureMode = "EveryFrame"
    source.SpeedLimit = 40
    window.press("propertiesPanel/Accept")
    window.wait_for_text("LiveStartStop", "true", "enabled")
    window.wait_for_text("LiveStartStop", "^Start$")
    window.wait_for_text("LiveSlices", "^0 slices$")
    window.wait_for_text("LiveSpeed", "^devices not open$")
    window.wait_for_text("LiveDisk", "^Disk: from Start$")
    assert "not open" in window.get("LiveStartStop", "toolTip")

    # by the button
    window.press("LiveStartStop")
    window.wait_for_text("LiveStartStop", "^Stop$")
    window.wait_for_text("LiveSlices", r"^([2-9]\d|\d{3,}) slices$")
    window.wait_for_text("LiveSpeed", r"^\d+ mm/s$")
    window.wait_for_text("LiveDisk", r"^Disk: \d+, [\d.]+ .iB free$")
    window.wait_for_text("LiveMemory", r"^Memory: \d+ MiB of [\d.]+ .iB$")
    for name in ("LiveSlices", "LiveMemory"):
        assert window.get(name, "styleSheet") == "", name
    ResetCamera()
    picture("capturing")

    # by the key, which a held foot does not repeat
    window.key(lacuna_window.F9, repeats=3)
    window.wait_for_text("LiveStartStop", "^Start$")
    source.SMProxy.UpdatePropertyInformation()
    assert not live.get(source, "Capturing")
    count = live.get(source, "TakenSlices")
    window.wait_for_text("LiveDisk", rf"^Disk: {count},")
    window.wait_for("the view's slices", lambda: Render() and source.GetDataInformation().GetExtent()[5] == count - 1)
    assert window.get("LiveSlices") == f"{count} slices"

    # too fast, in words
    source.SpeedLimit = 1
    source.UpdatePipeline()
    window.key(lacuna_window.F9)
    window.wait_for_text("LiveStartStop", "^Stop$")
    window.wait_for_text("LiveSpeed", r"^\d+ mm/s: too fast$")
    assert window.get("LiveSpeed", "warning") == "true" and "1 mm/s" in window.get("LiveSpeed", "toolTip")
    picture("fast")

    # a tracker that hangs holds nobody up, and Stop works
    os.kill(settings["process"], signal.SIGSTOP)
    window.wait_for_text("LiveSpeed", "^(no tracker|no video|speed unknown)$")
    begin, turns = time.monotonic(), 0
    while time.monotonic() < begin + 2:
        window.wait(10)
        turns += 1
    print(f"{turns} turns of the application in 2 s without devices", flush=True)
    assert turns > 10
    picture("hangs")
    begin = time.monotonic()
    window.press("LiveStartStop")
    print(f"stopped after {time.monotonic() - begin:.2f} s", flush=True)
    window.wait_for_text("LiveStartStop", "^Start$")
    os.kill(settings["process"], signal.SIGCONT)
    window.wait_for_text("LiveSpeed", r"mm/s")

    # no room: slices are there, and nothing more is taken
    live.clear(source)
    window.wait_for_text("LiveSlices", "^0 slices$")
    source.MemoryLimit = 1
    source.RecordFileName = ""
    source.UpdatePipeline()
    window.wait_for_text("LiveDisk", "^Disk: not recorded$")
    window.press("LiveStartStop")
    window.wait_for_text("LiveMemory", "^Memory: full$")
    window.wait_for_text("LiveStartStop", "^Start$")
    assert "background" in window.get("LiveMemory", "styleSheet")
    assert "MemoryLimit" in window.get("LiveMemory", "toolTip")
    picture("full")

    # the one that is selected is followed, or what is left
    other = PolhemusVideoSource(registrationName="Other")
    SetActiveSource(other)
    window.wait_for_text("LiveStartStop", "^Other: take slices", "toolTip")
    window.wait_for_text("LiveSlices", "^0 slices$")
    Delete(other)
    window.wait_for_text("LiveMemory", "^Memory: full$")

    # gone
    live.disconnect(source)
    window.wait_for_text("LiveSpeed", "^devices not open$")
    Delete(source)
    window.wait_for_text("LiveStartStop", "false", "enabled")
    window.wait_for_text("LiveSlices", "false", "visible")
    window.take_messages()  # warnings of the devices that hung

    # The layout, before and after there are slices: nothing is said but how fast the probe is
    window.menu("Lacuna/Live Layout")
    source, surface = FindSource("Live"), FindSource("Live surface")
    picture, space = (view for view in GetRenderViews() if view in GetViewsInLayout(GetLayoutByName("Live")))
    assert list(picture.GetActiveCamera().GetViewUp()) == [0, -1, 0] and picture.GetActiveCamera().GetDirectionOfProjection()[2] > 0.99
    for name in ("TrackerConnection", "VideoURL", "CalibrationFileName", "CropRectangle"):
        setattr(source, name, settings[name])
    source.MovementThreshold, source.SpeedLimit = 0.8, 0
    source.UpdatePipeline()
    before = space.GetActiveCamera().GetPosition()
    window.press("LiveStartStop")
    window.wait_for_text("LiveSlices", r"^([2-9]\d|\d{3,}) slices$")
    window.wait_for("the surface", lambda: surface.GetDataInformation().GetNumberOfCells() > 0)
    window.wait_for("the camera", lambda: space.GetActiveCamera().GetPosition() != before)
    picture_of = [each for each in space.Representations if each.GetProperty("Dark")]
    assert [each.Representation for each in picture_of if each.Visibility and each.Input.SMProxy == source.SMProxy] == ["Slices in Space"]
    assert "background" in window.get("LiveStartStop", "styleSheet")
    window.press("LiveStartStop")
    window.wait_for_text("LiveStartStop", "^Start$")
    assert window.get("LiveStartStop", "styleSheet") == ""
    live.disconnect(source)
    window.check_messages()


def main():
    from lacuna import demo_live
    with tempfile.TemporaryDirectory(prefix="lacuna-toolbar-") as folder:
        devices = demo_live.Devices(folder, types.SimpleNamespace(output=folder, seconds=8))
        try:
            region = [int(n) for n in devices.region["CropRectangle"]]
            if not PICTURES:  # few pixels, for a computer with much to do
                region = [region[0] + region[2] // 2, region[1] + region[3] // 2, 128, 96]
            settings = {"TrackerConnection": devices.port, "VideoURL": devices.video,
                        "CalibrationFileName": devices.calibration, "process": devices.process.pid,
                        "CropRectangle": region,
                        "RecordFileName": os.path.join(folder, "sweep.mhd")}
            lacuna_window.run(__file__, **{SETTINGS: json.dumps(settings)})
        finally:
            os.kill(devices.process.pid, signal.SIGCONT)
            devices.end()


if lacuna_window.IS_INSIDE:
    lacuna_window.inside(test)
else:
    main()
    print("ok")
