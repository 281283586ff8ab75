# SPDX-License-Identifier: BSD-3-Clause
"""The user guide's pictures of plate, model and moulds are what their example makes."""
import os
import runpy
import sys

from lacuna_test import compare_with_baseline, output

example = os.path.join(os.path.dirname(os.path.abspath(__file__)),
                       "../../Documentation/Examples/06-plate-model-mould/plate_model_mould.py")
sys.argv = [example, output("FabricationPictures")]
runpy.run_path(example, run_name="__main__")
for name in ("implant-plate.png", "defect-model.png", "press-orientation.png"):
    compare_with_baseline(os.path.join(output("FabricationPictures"), name), name, 30)
