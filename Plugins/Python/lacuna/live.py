# SPDX-License-Identifier: BSD-3-Clause
"""Live sources in scripts: ParaView's window polls them by itself, pvpython does not.

    source = PolhemusVideoSource(TrackerConnection="/dev/ttyUSB0", VideoURL="/dev/video0")
    live.start(source)
    live.poll_until(source, lambda: live.get(source, "SliceCount") >= 200, seconds=60)
    live.stop(source)
"""
import time


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
