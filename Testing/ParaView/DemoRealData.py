# SPDX-License-Identifier: BSD-3-Clause
"""The demo on real data: a spine phantom's sweep and the CT of a real skull with a disc cut out."""
from lacuna import demo
from lacuna_test import compare_with_baseline, data, output

sweep = data("ultrasound_spine/SpinePhantomFreehand.igs.mha")
calibration = data("ultrasound_spine/PlusDeviceSet_SpinePhantomFreehandReconstructionOnly.xml")
ct = data("ct_head/head.mha")
ultrasound = ["--sweep", sweep, "--calibration", calibration]

# the grid that PLUS makes of the same sweep
report = demo.main(["--only", "ultrasound", "--output", output("demo-spine")] + ultrasound)
assert report.get("volume, voxels") == "147 × 106 × 105"
origin = [float(x) for x in report.get("origin, mm").split()]
assert all(abs(a - b) < 2e-3 for a, b in zip(origin, (-74.5217, 165.573, 29.072))), origin

# below the bright tissue near the probe: a closed surface of the vertebra, about 1.5 ml of echoes
# (1.36 ml when the volume ends at the outermost pixel centres: the clip cuts through echoes)
report = demo.main(["--output", output("demo-real-data"), "--clip", "187", "225", "445", "391", "--level", "60",
                    "--ct", ct, "--hole", "90.2", "97.5", "100", "30"] + ultrasound)
assert report.get("open edges of the surface") == 0
assert abs(float(report.get("enclosed volume, ml")) - 1.47) < 0.07
compare_with_baseline(output("demo-real-data/ultrasound.png"), "spine.png", 30)
compare_with_baseline(output("demo-real-data/implant.png"), "head.png", 30)

# against the bone that was removed; a plain dense solution reaches 0.94 and 0.32 mm
assert float(report.get("error against the bone that was there: largest, mm")) <= 1.0
assert float(report.get("error against the bone that was there: RMS, mm")) <= 0.35
assert float(report.get("IGES surface: largest deviation from the fit, mm")) <= 0.005

# of an intact skull nobody wants an implant: the bone encloses a small foramen only
report = demo.main(["--only", "implant", "--output", output("demo-no-hole"), "--ct", ct])
assert report.verdict()[0] is False and "mark it with --hole" in report.verdict()[1], report.verdict()
