# SPDX-License-Identifier: BSD-3-Clause
"""Live sources in scripts: ParaView's window polls them by itself, pvpython does not.

    source = PolhemusVideoSource(TrackerConnection="/dev/ttyUSB0", VideoURL="/dev/video0")
    live.start(source)
    live.poll_until(source, lambda: live.get(source, "SliceCount") >= 200, seconds=60)
    live.stop(source)
"""
import time

LEVEL = 100  # grey level of the surface to begin with
DARK = 20  # grey level at and below which the newest frame is left out in space
GREY = (0, 0, 0, 0), (255, 1, 1, 1)


def connect(source):
    """Opens the devices; they take a moment (see TrackerWorks and VideoWorks)."""
    source.SMProxy.InvokeCommand("Connect")


def start(source):
    """Takes slices from now on."""
    source.SMProxy.InvokeCommand("Start")


def stop(source):
    """Ends the capture and takes over the last slices."""
    source.SMProxy.InvokeCommand("Stop")
    poll(source)


def find():
    """The live source of the pipeline: the active one, or the only one there is."""
    from paraview import simple

    active = simple.GetActiveSource()
    sources = [each for each in simple.GetSources().values() if each.GetXMLName() == "LacunaPolhemusVideoSource"]
    if active in sources:
        return active
    if len(sources) != 1:
        raise RuntimeError(f"There are {len(sources)} Polhemus Video Sources: make one of them active" if sources
                           else "There is no Polhemus Video Source: make one (Sources > Lacuna), then Apply")
    return sources[0]


def toggle_capture(source=None):
    """Starts the capture, or stops it while it runs; for a macro with a key of its own. Returns whether it runs now.

    source: default: the one that find() finds.
    """
    source = source or find()
    source.SMProxy.UpdatePropertyInformation()
    if get(source, "Capturing"):
        stop(source)
    else:
        start(source)
        source.SMProxy.UpdatePropertyInformation()
    return bool(get(source, "Capturing"))


def clear(source):
    """Drops the slices; the next Start begins a new sweep."""
    source.SMProxy.InvokeCommand("Clear")
    poll(source)


def disconnect(source):
    """Closes the devices."""
    source.SMProxy.InvokeCommand("Disconnect")
    poll(source)


def poll(source):
    """Takes over what has come and updates the source with its information properties."""
    source.SMProxy.InvokeCommand("Poll")
    source.UpdatePipelineInformation()
    source.UpdatePipeline()
    source.SMProxy.UpdatePropertyInformation()


def get(source, name):
    """An information property as it was at the last poll, such as SliceCount or Message."""
    value = source.GetProperty(name).GetData()
    return "" if value is None else value


def poll_until(source, condition, seconds=10, interval=0.02):
    """Polls until condition() is true, or for so many seconds; returns whether it is."""
    end = time.monotonic() + seconds
    poll(source)
    while not condition() and time.monotonic() < end:
        time.sleep(interval)
        poll(source)
    return bool(condition())


def show_layout(source=None):
    """Two views side by side: the scanner's picture upright, and it in space with the frames of the slices and the surface that grows from them.

    source: a Polhemus Video Source, by default the one that find() finds; without one a new one is made, whose devices are to be chosen.
    The surface is that of the slices so far, by Swept Volume, a median filter and a Contour at LEVEL: its slider moves it while it grows.
    Returns the source, the views and the Contour.
    """
    from lacuna import pictures, window
    from paraview import simple

    sources = [each for each in simple.GetSources().values() if each.GetXMLName() == "LacunaPolhemusVideoSource"]
    source = source or (find() if sources else simple.PolhemusVideoSource(registrationName="Live"))
    layout = simple.CreateLayout("Live")
    picture = simple.CreateView("RenderView")
    simple.AssignViewToLayout(view=picture, layout=layout, hint=0)
    space = simple.CreateView("RenderView")
    layout.SplitHorizontal(0, 0.42)
    simple.AssignViewToLayout(view=space, layout=layout, hint=2)

    picture.InteractionMode = "2D"
    picture.OrientationAxesVisibility = 0
    simple.SetActiveView(picture)
    newest = simple.Show(simple.OutputPort(source, 1), picture)
    newest.SetRepresentationType("Slice")
    window._color_apart(newest, picture, "Intensity", GREY)
    camera = picture.GetActiveCamera()
    camera.SetPosition(0, 0, -1)  # rows of an image run downwards
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(0, -1, 0)
    simple.ResetCamera(picture)

    volume = simple.SweptVolume(registrationName="Live volume", Input=source, UseTooFast=1)
    smooth = simple.SpeckleFilter(registrationName="Live median", Input=volume, Operation="Median", KernelSize=[3] * 3)
    surface = pictures.contour(smooth, "Intensity", LEVEL, registrationName="Live surface")
    frames = simple.SlicePlanes(registrationName="Live frames", Input=source, OutlineOnly=1, Stride=10, InvalidSlices="Show")
    simple.SetActiveView(space)
    placed = simple.Show(simple.OutputPort(source, 1), space)
    placed.SetRepresentationType(window.SLICES)
    placed.Dark = DARK
    window._color_apart(placed, space, "Intensity", GREY)
    pictures.show_surface(surface, space, pictures.TISSUE)
    pictures.show_surface(frames, space, pictures.FRAME)
    simple.SetActiveSource(source)
    simple.RenderAllViews()
    return source, picture, space, surface
