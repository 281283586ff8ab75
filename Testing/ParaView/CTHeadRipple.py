# SPDX-License-Identifier: BSD-3-Clause
"""Ripple of a real skull whose slices are 3 mm apart, against slices of 1 mm: the figures of the user guide."""
import importlib.util
import os
import sys

path = os.path.join(os.environ["LACUNA_TEST_DATA"], "ct_head", "head.mha")
if not os.path.exists(path):
    print("skipped: no", path)
    sys.exit(77)
here = os.path.dirname(os.path.abspath(__file__))
script = os.path.join(here, "../../Documentation/Examples/08-ripple/ripple.py")
specification = importlib.util.spec_from_file_location("ripple", script)
ripple = importlib.util.module_from_spec(specification)
specification.loader.exec_module(ripple)

results = ripple.main(os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "ripple-head"), path)
for view, figures in results.items():
    linear, quasi, spline = (figures[name] for name in ripple.INTERPOLATIONS)
    # At the back much of the bone lies along the slices; what falls between them comes back by no interpolation.
    assert linear[2] >= (2 if view == "back" else 3) * quasi[2], view
    assert linear[3] >= 4 * quasi[3], view
    assert spline[2] < linear[2], view
    # The residual as a whole is hardly smaller: an error that depends on tilt, curvature and thin bone is in it too.
    assert quasi[1] < 1.1 * linear[1], view
    # the bias: the spline through the voxels has least, the smoothing one most
    assert abs(spline[0]) < linear[0] < quasi[0] < 0.5, view
print("ok")
