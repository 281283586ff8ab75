# SPDX-License-Identifier: BSD-3-Clause
"""The demo says which stage failed and why; so does lacuna.errors.raising."""
import os

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


ct = output("small-ct.vti")
pv.SaveData(ct, proxy=pv.Wavelet(WholeExtent=[-8, 8, -8, 8, -8, 8]), DataMode="Binary")
message = failure("--only", "implant", "--ct", ct, "--iso", "50000")
assert "stage 'fill the hole' failed" in message and "check the iso-value" in message, message

oriented = file_with("oriented.mha", "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_SHORT\n"
                     "TransformMatrix = -1 0 0 0 1 0 0 0 1\nElementDataFile = LOCAL\n0123456789abcdef")
message = failure("--only", "implant", "--ct", oriented)
assert "stage 'read the CT' failed" in message and "mirrored" in message, message

uncalibrated = file_with("uncalibrated.igs.mha", "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\n"
                         "ElementType = MET_UCHAR\nSeq_Frame0000_ProbeToTrackerTransform = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n"
                         "Seq_Frame0000_ProbeToTrackerTransformStatus = OK\n"
                         "Seq_Frame0001_ProbeToTrackerTransform = 1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 1\n"
                         "Seq_Frame0001_ProbeToTrackerTransformStatus = OK\nElementDataFile = LOCAL\n01234567")
message = failure("--only", "ultrasound", "--sweep", uncalibrated)
assert "stage 'reconstruct the volume' failed" in message and "not calibrated" in message, message

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
