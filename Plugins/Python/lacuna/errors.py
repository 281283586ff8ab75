# SPDX-License-Identifier: BSD-3-Clause
"""Pipeline errors as Python exceptions.

VTK and ParaView print what goes wrong and go on; a batch script wants to stop:

    from lacuna.errors import raising
    with raising():
        volume.UpdatePipeline()

After lacuna.load() every call that executes a pipeline does so by itself, except in ParaView's window:

    raise_errors(False)   # prints errors and goes on, as VTK does
"""
import contextlib
import errno
import functools
import os
import re
import sys
import tempfile
import time

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
    if text is None:  # what VTK gives Python of a text that is not UTF-8; those of Lacuna are
        return "a message that is not UTF-8, which Python cannot show; it is in the output above"
    lines = [line for line in text.strip().splitlines()
             if not re.match(r"(ERROR|Warning|Generic Warning): In ", line)]
    return re.sub(r"^\w+ \(0x[0-9a-f]+\): ", "", " ".join(line.strip() for line in lines)).strip()


def _check_outputs(proxy, seen=None):
    """Raises the error that an output of proxy, or of one of those before it, holds."""
    from lacuna.data import fetch
    from paraview import servermanager
    seen = set() if seen is None else seen
    if proxy.SMProxy.GetGlobalID() in seen:
        return
    seen.add(proxy.SMProxy.GetGlobalID())
    connection = servermanager.ActiveConnection
    if not connection.IsRemote() and (connection.GetNumberOfDataPartitions() == 1 or _ranks() is not None):
        _check_own_outputs(proxy)  # no rank waits here for another one
    else:
        for port in range(proxy.SMProxy.GetNumberOfOutputPorts()):
            if proxy.SMProxy.GetDataInformation(port).GetFieldDataInformation().GetArrayInformation("LacunaError"):
                fetch(servermanager.OutputPort(proxy, port))
    for name in proxy.ListProperties():
        prop = proxy.SMProxy.GetProperty(name)
        for i in range(prop.GetNumberOfProxies() if prop and prop.IsA("vtkSMInputProperty") else 0):
            _check_outputs(servermanager._getPyProxy(prop.GetProxy(i)), seen)


def _check_own_outputs(proxy):
    """Raises the error that the data of an algorithm in this process hold."""
    from lacuna.data import blocks
    algorithm = proxy.GetClientSideObject()
    if algorithm is None or not algorithm.IsA("vtkAlgorithm"):
        return
    for port in range(algorithm.GetNumberOfOutputPorts()):
        for block in blocks(algorithm.GetOutputDataObject(port)):
            error = block.GetFieldData().GetAbstractArray("LacunaError")
            if error:
                raise PipelineError(error.GetValue(0))


def _ranks():
    """The controller of pvbatch --sym, whose ranks all run the script; None elsewhere."""
    if "paraview.servermanager" not in sys.modules:
        return None
    from paraview.modules.vtkRemotingCore import vtkProcessModule
    from vtkmodules.vtkParallelCore import vtkMultiProcessController
    module = vtkProcessModule.GetProcessModule()
    controller = vtkMultiProcessController.GetGlobalController()
    return controller if module and module.GetSymmetricMPIMode() and controller and controller.GetNumberOfProcesses() > 1 else None


def _agree(own):
    """The text of the first rank that has one; all ranks of pvbatch --sym meet here."""
    controller = _ranks()
    if controller is None:
        return own
    from vtkmodules.vtkCommonCore import vtkIntArray, vtkUnsignedCharArray
    from vtkmodules.vtkParallelCore import vtkCommunicator
    ranks = controller.GetNumberOfProcesses()
    mine, first = vtkIntArray(), vtkIntArray()
    mine.InsertNextValue(controller.GetLocalProcessId() if own else ranks)
    first.SetNumberOfValues(1)
    controller.AllReduce(mine, first, vtkCommunicator.MIN_OP)
    if first.GetValue(0) == ranks:
        return ""
    text = vtkUnsignedCharArray()
    for byte in own.encode("utf-8", "backslashreplace"):
        text.InsertNextValue(byte)
    controller.Broadcast(text, first.GetValue(0))
    return bytes(text.GetValue(i) for i in range(text.GetNumberOfValues())).decode()


def _file_name(writer):
    return writer.FileName if isinstance(writer.FileName, str) else writer.FileName[0]


def _disk_time(folder):
    """Now, in ns, by the clock that gives a folder's files their times: the one of a server may be late."""
    try:
        with tempfile.TemporaryFile(dir=folder) as probe:
            return os.fstat(probe.fileno()).st_mtime_ns
    except OSError:  # the writer says what is wrong
        return time.time_ns()


def _check_written(writer, begun):
    """Raises OSError when a file of a writer of ParaView is missing or may be cut off; most of these writers do not look."""
    from lacuna.files import check_whole
    name = _file_name(writer)
    if os.path.exists(name) and not os.path.isfile(name):
        return  # a device or a pipe
    folder, root = os.path.dirname(name) or ".", os.path.splitext(os.path.basename(name))[0]
    pieces = os.path.join(folder, root)  # of formats of several files
    made = [entry.path for place in (folder, pieces) if os.path.isdir(place) for entry in os.scandir(place)
            if re.match(re.escape(root) + "([^A-Za-z]|$)", entry.name) and entry.is_file() and entry.stat().st_mtime_ns >= begun]
    if not made:
        raise FileNotFoundError(errno.ENOENT, "the file was not written", name)
    for each in made:
        check_whole(each)


@contextlib.contextmanager
def _checking_writers(errors):
    """Within the block ParaView's writers, as SaveData uses them, add to errors when what they wrote may be cut off."""
    servermanager = sys.modules.get("paraview.servermanager")
    connection = servermanager.ActiveConnection if servermanager else None
    ranks = _ranks()
    # the files of a remote server are not here, and of several ranks one looks
    if not connection or connection.IsRemote() or (ranks and ranks.GetLocalProcessId() > 0):
        yield
        return
    update = servermanager.SourceProxy.UpdatePipeline

    def update_and_check(proxy, *arguments):
        is_writer = proxy.SMProxy.GetXMLGroup() == "writers" and "FileName" in proxy.ListProperties()
        begun = _disk_time(os.path.dirname(_file_name(proxy)) or ".") if is_writer else 0
        before = len(errors)
        update(proxy, *arguments)
        if is_writer and len(errors) == before:
            try:
                _check_written(proxy, begun)
            except OSError as error:
                errors.append(f"{error.filename}: {error.strerror}")

    servermanager.SourceProxy.UpdatePipeline = update_and_check
    try:
        yield
    finally:
        servermanager.SourceProxy.UpdatePipeline = update


@contextlib.contextmanager
def raising(warnings=None, proxies=()):
    """Raises PipelineError at the end of the block when an algorithm reported an error in it, or a writer of ParaView cut a file off.

    warnings: a list that receives the texts of warnings, or None.
    proxies: sources and filters of ParaView. An error that their outputs, or those of filters before them, hold is raised, too: ParaView
    does not execute again what has failed in an earlier block, and its own filters pass on what is left.
    Under pvbatch --sym an error of one rank is raised on all; so all of them must come to the end of the block.
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
    failure = None
    try:
        with _checking_writers(errors):
            yield
        if not errors:
            for proxy in proxies:
                _check_outputs(proxy)
    except Exception as exception:
        failure = exception
    finally:
        for tag in tags:
            window.RemoveObserver(tag)
    # of several ranks an error that is kept is told again with a hint
    told = "; ".join(dict.fromkeys(text for text in errors if text.removesuffix(_AGAIN) == text or text.removesuffix(_AGAIN) not in errors))
    agreed = _agree(told or (failure and (str(failure) or type(failure).__name__)) or "")
    if failure is not None and not errors:
        raise failure
    if told or agreed:
        # what an algorithm said is the cause of what Python stumbled over later
        raise PipelineError(told or agreed) from failure


# What executes pipelines, by the module or class that has it.
EXECUTING = {
    "paraview.simple": ("Show", "Render", "RenderAllViews", "SaveData", "SaveScreenshot", "SaveAnimation"),
    "paraview.servermanager": ("Fetch",),
    "paraview.servermanager.SourceProxy": ("UpdatePipeline",)}
_default = {"raises": False, "depth": 0}
_replaced = {}  # ParaView's own function: the one that raises


def raise_errors(on=True):
    """Whether every call that executes a pipeline raises what an algorithm reports in it, as by raising(): UpdatePipeline, Show, Render,
    SaveData, SaveScreenshot, SaveAnimation and Fetch. lacuna.load() turns it on, except in ParaView's window.

    An error that the data still hold is raised again by each call that asks for them. Under pvbatch --sym all ranks must make these calls.
    """
    _default["raises"] = bool(on)
    if on and not _replaced:
        import paraview.simple as simple
        from paraview import servermanager
        owners = dict(zip(EXECUTING, (simple, servermanager, servermanager.SourceProxy)))
        for owner, names in EXECUTING.items():
            for name in names:
                before = getattr(owners[owner], name)
                _replaced[before] = _raising_call(owners[owner], name, before)
                setattr(owners[owner], name, _replaced[before])


def replace_in(script):
    """Gives a script's globals the functions that raise in place of those that it has imported from ParaView."""
    for name, value in list(script.items()):
        if callable(value) and getattr(value, "__hash__", None) and value in _replaced:
            script[name] = _replaced[value]


def _asked_for(name, given):
    """The proxies whose data a call asks for, as far as its arguments tell; of views those that they show."""
    import paraview.simple as simple
    from paraview import servermanager
    if name == "Render" and not any(given):
        given = [simple.GetActiveView()]
    elif name == "RenderAllViews":
        given = simple.GetViews()
    found = []
    for each in given:
        if isinstance(each, servermanager.SourceProxy):
            found.append(each)
        elif isinstance(each, servermanager.Proxy) and each.SMProxy.IsA("vtkSMViewProxy"):
            found += [shown.Input for shown in each.Representations
                      if getattr(shown, "Visibility", False) and isinstance(getattr(shown, "Input", None), servermanager.SourceProxy)]
    return found


def _raising_call(owner, name, before):
    """A function of ParaView with raising() about it."""
    @functools.wraps(before)
    def call(*arguments, **options):
        if not _default["raises"] or _default["depth"]:
            return before(*arguments, **options)
        asked = _asked_for(name, [*arguments, *options.values()])
        _default["depth"] += 1
        try:
            with raising(proxies=asked):
                # not before(): raising() has put a look at writers about UpdatePipeline
                return getattr(owner, name)(*arguments, **options)
        finally:
            _default["depth"] -= 1
    return call
