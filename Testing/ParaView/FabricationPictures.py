# SPDX-License-Identifier: BSD-3-Clause
"""The user guide's pictures of plate, model, moulds and paths are what their examples make."""
import os

from lacuna_test import compare_with_baseline, output, run_example

for script, names in (
        ("12-plate-model-mould/plate_model_mould.py", ("implant-plate.png", "defect-model.png", "press-orientation.png")),
        ("12-plate-model-mould/milling_tool_path.py", ("milling-tool-path.png",))):
    run_example(script, output("FabricationPictures"))
    for name in names:
        compare_with_baseline(os.path.join(output("FabricationPictures"), name), name, 30)
