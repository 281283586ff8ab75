# SPDX-License-Identifier: BSD-3-Clause
"""The user guide's pictures of plate, model, moulds and paths are what their examples make."""
import os
import runpy
import sys

from lacuna_test import compare_with_baseline, output

examples = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../Documentation/Examples")
for script, names in (
        ("12-plate-model-mould/plate_model_mould.py", ("implant-plate.png", "defect-model.png", "press-orientation.png")),
        ("12-plate-model-mould/milling_tool_path.py", ("milling-tool-path.png",))):
    sys.argv = [os.path.join(examples, script), output("FabricationPictures")]
    runpy.run_path(sys.argv[0], run_name="__main__")
    for name in names:
        compare_with_baseline(os.path.join(output("FabricationPictures"), name), name, 30)
