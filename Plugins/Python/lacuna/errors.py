# SPDX-License-Identifier: BSD-3-Clause
"""Pipeline errors as Python exceptions.

VTK and ParaView print what goes wrong and go on; a batch script wants to stop:

    from lacuna.errors import raising
    with raising():
        volume.UpdatePipeline()
"""
import contextlib
import re

from vtkmodules.vtkCommonCore import vtkOutputWindow


class PipelineError(RuntimeError):
    """What an algorithm reported through its error macro."""


_set_aside = []
_AGAIN = " (change a property to try again)"


@contextlib.contextmanager
def set_aside(*texts):
    """Within the block these errors, which are known to be false alarms there, are none for raising(); they are printed all the same."""
    _set_aside.append(texts)
    try:
        yield
    finally:
        _set_aside.pop()


def _clean(text):
    """The sentence alone, without the line that names a source file and the object's address."""
    lines = [line for line in text.strip().splitlines()
             if not re.match(r"(ERROR|Warning|Generic Warning): In ", line)]
    return re.sub(r"^\w+ \(0x[0-9a-f]+\): ", "", " ".join(line.strip() for line in lines)).strip()


def _check_outputs(proxy):
    """Raises the error that an output of proxy, or of one of those before it, holds."""
    from lacuna.data import fetch
    from paraview import servermanager
    for port in range(proxy.SMProxy.GetNumberOfOutputPorts()):
        if proxy.SMProxy.GetDataInformation(port).GetFieldDataInformation().GetArrayInformation("LacunaError"):
            fetch(servermanager.OutputPort(proxy, port))
    for name in proxy.ListProperties():
        prop = proxy.SMProxy.GetProperty(name)
        for i in range(prop.GetNumberOfProxies() if prop.IsA("vtkSMInputProperty") else 0):
            _check_outputs(servermanager._getPyProxy(prop.GetProxy(i)))


@contextlib.contextmanager
def raising(warnings=None, proxies=()):
    """Raises PipelineError at the end of the block when an algorithm reported an error in it.

    warnings: a list that receives the texts of warnings, or None.
    proxies: sources and filters of ParaView. An error that their outputs, or those of filters before them, hold is raised, too: ParaView
    does not execute again what has failed in an earlier block, and its own filters pass on what is left.
    """
    errors = []

    def keep(_window, event, text):
        text = _clean(text)
        if event == "ErrorEvent" and not text.startswith("Algorithm ") and not any(text in known for known in _set_aside):
            errors.append(text)
        elif event == "WarningEvent" and warnings is not None:
            warnings.append(text)

    keep.CallDataType = "string0"
    window = vtkOutputWindow.GetInstance()
    tags = [window.AddObserver(event, keep) for event in ("ErrorEvent", "WarningEvent")]
    consequence = None
    try:
        yield
    except Exception as exception:
        # what an algorithm said is the cause of what Python stumbled over later
        if not errors:
            raise
        consequence = exception
    finally:
        for tag in tags:
            window.RemoveObserver(tag)
    if errors:
        # of several ranks an error that is kept is told again with a hint
        told = dict.fromkeys(text for text in errors if text.removesuffix(_AGAIN) == text or text.removesuffix(_AGAIN) not in errors)
        raise PipelineError("; ".join(told)) from consequence
    for proxy in proxies:
        _check_outputs(proxy)
