# SPDX-License-Identifier: BSD-3-Clause
"""Both of Lacuna's jobs in one run: a closed surface from freehand ultrasound slices, and an
implant surface for the hole in a skull. Without arguments it works on built-in phantoms
whose truth is known; with --sweep and --ct on your own files. It writes pictures, the
volume (.vti), the closed surface (.stl), the filled depth map (.vti), the implant surface
(.igs), and report.md and report.html with the numbers and pictures, which say first whether all is well. --live does something else: it acquires a sweep from an
emulated tracker and scanner and shows the surface while it grows. Without demo.sh: pvpython -- -m lacuna.demo, where the --
keeps ParaView from turning numbers such as -13 into --13."""
import argparse
import math
import os
import sys


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(
        prog="demo.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", default="demo-output", help="folder for the results (%(default)s)")
    parser.add_argument("--only", choices=["ultrasound", "implant"], help="do one of the two jobs")

    sweep = parser.add_argument_group("freehand ultrasound")
    sweep.add_argument("--sweep", metavar="FILE", help="tracked sequence (.igs.mha, .mha, .mhd); default: a phantom")
    sweep.add_argument("--calibration", metavar="XML", help="PLUS configuration with the Image-to-Probe transform")
    sweep.add_argument("--spacing", type=float, default=0.5, metavar="MM", help="voxel size of the volume (%(default)s)")
    sweep.add_argument("--clip", type=int, nargs=4, metavar=("X", "Y", "W", "H"),
                       help="part of the slices to use, pixels: left, top, width, height (without the scanner's frame, say)")
    sweep.add_argument("--level", type=float, metavar="GREY",
                       help="grey level of the surface; default: the phantom's, or Otsu's threshold")
    sweep.add_argument("--median", type=int, default=5, metavar="N", help="size of the median window, voxels (%(default)s)")

    live = parser.add_argument_group("live acquisition, without hardware")
    live.add_argument("--live", action="store_true",
                      help="acquire from emulated devices; writes the sweep, its calibration and pictures. Ends by itself or by Ctrl-C")
    live.add_argument("--seconds", type=float, default=20, metavar="S", help="time of the acquisition (%(default)s)")
    live.add_argument("--offscreen", action="store_true", help="pictures only, no window")

    implant = parser.add_argument_group("cranial implant")
    implant.add_argument("--ct", metavar="FILE", help="CT volume in Hounsfield units; default: a phantom with a hole")
    implant.add_argument("--iso", type=float, default=500, metavar="HU", help="level of the bone surface (%(default)s)")
    implant.add_argument("--view", type=float, nargs=3, default=[0, 0, -1], metavar=("X", "Y", "Z"),
                         help="direction in which --ct is looked at (%(default)s: from above)")
    implant.add_argument("--hole", type=float, nargs=4, metavar=("X", "Y", "Z", "R"),
                         help="a point in the hole and its radius, mm: what lies inside this cylinder along the view is "
                              "replaced; default: the holes of the depth map")
    implant.add_argument("--margin", type=float, metavar="MM", help="sound bone used around the hole (12; phantom: 20)")
    implant.add_argument("--node-spacing", type=float, metavar="MM", help="distance of the spline's nodes (1; phantom: 2)")
    options = parser.parse_args(arguments)
    if options.calibration and not options.sweep:
        parser.error("--calibration belongs to --sweep")
    if options.clip and not options.sweep:
        parser.error("--clip belongs to --sweep")
    if options.hole and not options.ct:
        parser.error("--hole belongs to --ct (the phantom knows its own hole)")
    if options.live and (options.only or options.sweep or options.ct):
        parser.error("--live works on emulated devices alone")
    if not 4 <= options.seconds <= 3600:
        parser.error(f"--seconds: {options.seconds:g} is not from 4 to 3600")
    for name in ("spacing", "margin", "node_spacing"):
        value = getattr(options, name)
        if value is not None and not (math.isfinite(value) and value > 0):
            parser.error(f"--{name.replace('_', '-')}: {value:g} is not a length above 0 mm")
    if options.median < 1 or options.median % 2 == 0:
        parser.error(f"--median: {options.median} is not an odd number above 0")
    if options.hole and not options.hole[3] > 0:
        parser.error("--hole: the radius must be above 0 mm")
    for name in ("sweep", "calibration", "ct"):
        file = getattr(options, name)
        if file and not os.path.isfile(file):
            parser.error(f"--{name}: there is no file {file}")
    return options


def main(arguments=None):
    options = parse_arguments(arguments)
    import lacuna.plugin
    from lacuna import demo_implant, demo_live, demo_ultrasound
    from lacuna.demo_report import Report
    report = Report()
    with report.stage("make the output folder"):
        os.makedirs(options.output, exist_ok=True)
    with report.stage("load the plugin"):
        lacuna.plugin.load()
    if options.live:
        demo_live.run(options, report)
    elif options.only != "implant":
        demo_ultrasound.run(options, report)
    if options.only != "ultrasound" and not options.live:
        demo_implant.run(options, report)
    try:
        name = report.write(options.output, lacuna.__version__)
    except OSError as error:
        raise SystemExit(f"demo.sh: the report cannot be written to {options.output}: {error.strerror}") from error
    print(f"== {report.verdict()[1]}")
    print(f"== done: see {name} and the files beside it")
    return report


if __name__ == "__main__":
    main(sys.argv[1:])
