# SPDX-License-Identifier: BSD-3-Clause
"""The demo says which stage failed and why; so does lacuna.errors.raising."""
import os
import re
import resource
import runpy
import shutil
import subprocess
import sys

import lacuna.plugin
import paraview.simple as pv
from lacuna import demo
from lacuna.errors import PipelineError, raising
from lacuna_test import output

lacuna.plugin.load()


def failure(*arguments):
    """What the demo says when it stops."""
    try:
        demo.main(["--output", output("demo-errors")] + list(arguments))
    except SystemExit as stop:
        return str(stop)
    raise AssertionError(f"no failure with {arguments}")


def file_with(name, text):
    with open(output(name), "w", encoding="ascii") as file:
        file.write(text)
    return output(name)


message = failure("--live")
assert "stage 'start the emulated tracker and scanner' failed" in message and "./demo.sh --live" in message, message

ct = output("small-ct.vti")
pv.SaveData(ct, proxy=pv.Wavelet(WholeExtent=[-8, 8, -8, 8, -8, 8]), DataMode="Binary")
message = failure("--only", "implant", "--ct", ct, "--iso", "50000")
assert "stage 'fill the hole' failed" in message and "check the iso-value" in message, message

unscaled = file_with("unscaled.mha", "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_SHORT\n"
                     "TransformMatrix = -1 0 0 0 1 0 0 0 1\nElementDataFile = LOCAL\n0123456789abcdef")
message = failure("--only", "implant", "--ct", unscaled)
assert "stage 'read the CT' failed" in message and "ElementSpacing is missing" in message, message

# the walk from a CT to a mould takes none of them either
walk = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../Documentation/Examples/11-implant-to-mould",
                    "implant_to_mould.py")


def walk_failure(ct):
    arguments = sys.argv
    sys.argv = ["implant_to_mould.py", "--output", output("demo-errors"), "--ct", ct, "--hole", "0", "0", "0", "9"]
    try:
        runpy.run_path(walk, run_name="__main__")
    except (ValueError, RuntimeError) as error:
        return str(error)
    finally:
        sys.argv = arguments
    raise AssertionError(f"the walk went on with {ct}")


assert "ElementSpacing is missing" in walk_failure(unscaled)
assert "it is not sure that ParaView heeds" in walk_failure(file_with("surface.stl", "solid a\nendsolid a\n"))

# negative whole numbers arrive, by the commands as they are written: ParaView's own options end at --
repository = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))


def command(name, pattern, *arguments):
    """What a command in a file says when its arguments are replaced."""
    with open(os.path.join(repository, name), encoding="utf-8") as file:
        words = re.search(pattern, file.read()).group(1).split()
    words = [walk if word.endswith("implant_to_mould.py") else word for word in words]
    return subprocess.run([*words, *arguments], capture_output=True, text=True, timeout=120).stderr


arguments = ["--output", output("demo-errors"), "--ct", unscaled, "--hole", "26.6", "-13", "85", "26", "--view", "0", "-1", "0"]
for name, pattern in (("demo.sh", r"(pvpython .*) \"\$@\""),
                      ("Plugins/Python/lacuna/demo.py", r"(pvpython .* lacuna\.demo)"),
                      ("Documentation/UserGuide/cranioplasty.md", r"    (pvpython .*\.py)"),
                      ("Documentation/Examples/11-implant-to-mould/implant_to_mould.py", r"    (pvpython .*\.py)")):
    only = ["--only", "implant"] if "demo" in name else []
    said = command(name, pattern, *only, *arguments)
    assert "ElementSpacing is missing" in said, (name, said)

uncalibrated = file_with("uncalibrated.igs.mha", "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\n"
                         "ElementType = MET_UCHAR\nSeq_Frame0000_ProbeToTrackerTransform = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"
                         "Seq_Frame0000_ProbeToTrackerTransformStatus = OK\n"
                         "Seq_Frame0001_ProbeToTrackerTransform = 1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 1\n"
                         "Seq_Frame0001_ProbeToTrackerTransformStatus = OK\nElementDataFile = LOCAL\n01234567")
message = failure("--only", "ultrasound", "--sweep", uncalibrated)
assert "stage 'reconstruct the volume' failed" in message and "not calibrated" in message, message

# a full disk cuts nothing off in silence: what was there stays, and there is no part of a file
limit = resource.getrlimit(resource.RLIMIT_FSIZE)
shutil.rmtree(output("demo-errors"))
os.mkdir(output("demo-errors"))
with open(os.path.join(output("demo-errors"), "volume.vti"), "w", encoding="ascii") as file:
    file.write("of yesterday")
resource.setrlimit(resource.RLIMIT_FSIZE, (20000, limit[1]))
try:
    message = failure("--only", "ultrasound", "--spacing", "2")
finally:
    resource.setrlimit(resource.RLIMIT_FSIZE, limit)
assert "stage 'reconstruct the volume' failed" in message and "volume.vti" in message, message
assert os.listdir(output("demo-errors")) == ["volume.vti"]
assert os.path.getsize(os.path.join(output("demo-errors"), "volume.vti")) == len("of yesterday")

try:
    demo.main(["--hole", "1", "2", "3", "4"])  # without --ct
    raise AssertionError("accepted")
except SystemExit as stop:
    assert stop.code == 2

# an algorithm's message wins over the exception that it leads to
try:
    with raising():
        swept = pv.SweptVolume(Input=pv.Wavelet())
        swept.UpdatePipeline()
        raise KeyError("later")
    raise AssertionError("no error was raised")
except PipelineError as error:
    assert "ImageToReference" in str(error), error
    assert isinstance(error.__cause__, KeyError)
warnings = []
with raising(warnings):
    pv.Sphere().UpdatePipeline()
assert warnings == []
