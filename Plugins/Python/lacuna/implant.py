# SPDX-License-Identifier: BSD-3-Clause
"""The missing part of a skull as a solid: CT in, implant out.

    pvpython -- -m lacuna.implant CT --output implant.stl [--hole X Y Z] [--template FILE] [--report DIR]

    from lacuna import implant
    made = implant.make_implant(ct)           # ct: a proxy; made.bone, made.implant, made.defects are proxies
    numbers = implant.measures(made)

Holes, plates, parts, offsets and text are properties of made.implant, or settings of make_implant: DrainageSpacing=12, Plates=4.
"""
import argparse
import collections
import contextlib
import ctypes
import math
import os
import sys
import tempfile

import numpy as np
import paraview.simple as pv
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow
from vtkmodules.vtkRenderingCore import vtkRenderWindow

from lacuna import coordinates, views
from lacuna.data import fetch
from lacuna.errors import raising

LEVEL = 300  # Hounsfield units
AIR = -300  # the same: below it there is air around the head
BONE = (100, 1000)  # the same: levels of bone
CLEARANCE = 0.5  # mm
LATERAL = 0.7  # cosine between the left and the normal of a plane that can be one of symmetry
ENDINGS = (".stl", ".ply", ".obj", ".vtp", ".3mf", ".step", ".stp")
MESHES = (".stl", ".ply", ".obj", ".vtp")  # of a template
SCREEN = 'xvfb-run -a -s "-screen 0 1280x1024x24 -noreset"'
WORDS = {"L": "left", "R": "right", "P": "back", "A": "front", "H": "top", "F": "bottom"}

# Options of the command: the property of Skull Implant, its unit, what it is for.
PROPERTIES = {"drainage": "DrainageSpacing", "sutures": "SutureSpacing", "plates": "Plates", "parts": "Parts", "engrave": "EngravedText",
              "outer-offset": "OuterOffset", "inner-offset": "InnerOffset"}
SETTINGS = {"drainage": ("MM", "drainage holes so far apart, 4 to 50"), "sutures": ("MM", "holes for sutures along the rim, so far apart, 4 to 50"),
            "plates": ("N", "plates that fasten the implant, up to 12: a hole in it for each"),
            "parts": ("N", "parts into which the implant is divided, up to 6"),
            "engrave": ("TEXT", "text in the inner face, such as a code"),
            "outer-offset": ("MM", "moves the outer face outwards, or inwards if negative; fades to the rim"),
            "inner-offset": ("MM", "the same for the inner face")}

Made = collections.namedtuple("Made", "bone implant defects plates")
Defect = collections.namedtuple("Defect", "area center")  # mm², mm


def make_implant(ct, hole=None, level=LEVEL, clearance=CLEARANCE, progress=None, template=None, thickness=0, **settings):
    """Makes the pipeline from a CT (a proxy) to an implant, and updates it. Opens no file and shows nothing.

    hole: a point in or near the hole, x y z in the CT's patient millimetres; None takes the largest hole. level: of the bone's
    surface in Hounsfield units. clearance: of the implant's edge from the bone in mm. progress: is called with the part of the design
    that is done, 0 to 1. template: another skull (a proxy of a CT or of a mesh in mm), or None.
    thickness: of the implant in mm; 0 takes that of the bone. settings: other properties of Skull Implant.
    Returns the proxies bone (Skull Bone), implant (Skull Implant), defects and plates (its other outputs). Raises PipelineError when a
    filter reports an error, for example when there is no hole. Nothing of the pipeline is left then.
    """
    made = []
    try:
        with raising():
            made.append(pv.SkullBone(Input=ct))
            made[0].Level = level  # not above: ParaView takes a value that is the default for none, and sets what the data propose
            if template is not None and _is_volume(template):
                template = pv.SkullBone(Input=template)
                made.append(template)
                template.Level = level
            design = pv.SkullImplant(Input=made[0], Level=level, EdgeClearance=clearance, Thickness=thickness, **settings)
            made.append(design)
            if template is not None:
                design.Template = template
            if hole is not None:
                design.DefectChoice, design.Point = "Nearest to Point", list(hole)
            if progress:
                design.GetClientSideObject().AddObserver("ProgressEvent", lambda object, _: progress(object.GetProgress()))
            design.UpdatePipeline()
    except Exception:
        for proxy in reversed(made):
            pv.Delete(proxy)
        raise
    return Made(made[0], design, pv.OutputPort(design, 1), pv.OutputPort(design, 2))


def _is_volume(proxy):
    proxy.UpdatePipeline()
    return proxy.GetDataInformation().GetDataSetTypeAsString() == "vtkImageData"


def measures(made):
    """The numbers of an implant: its field data by name, a number or an array each, as the page of Skull Implant lists them.

    Besides these, Defects is a list of Defect (area in mm², center), the largest first, and Chosen the index of the one
    that the implant closes.
    """
    data = fetch(made.implant)
    fields = data.GetFieldData()
    numbers = {}
    for k in range(fields.GetNumberOfArrays()):
        array = fields.GetArray(k)  # None for texts
        if array is not None and array.GetNumberOfValues():
            values = vtk_to_numpy(array).ravel()
            numbers[array.GetName()] = float(values[0]) if values.size == 1 else values
    fields = fetch(made.defects).GetFieldData()
    areas = vtk_to_numpy(fields.GetArray("DefectAreas")).ravel()
    centers = vtk_to_numpy(fields.GetArray("DefectCenters")).reshape(-1, 3)
    numbers["Defects"] = [Defect(float(area), center) for area, center in zip(areas, centers)]
    numbers["Chosen"] = max(int(numbers["ChosenDefect"]) - 1, 0)  # 0: the only one, of an outline that was drawn
    return numbers


def describe(made):
    """The result in plain words, a list of lines."""
    numbers = measures(made)
    place = places(made)
    count = len(numbers["Defects"])
    lines = [f"{count} hole{'s' if count != 1 else ''} found:"]
    for k, defect in enumerate(numbers["Defects"]):
        chosen = "  <- the implant closes this one" if k == numbers["Chosen"] else ""
        lines.append(f"  {k + 1}: about {defect.area / 100:.1f} cm², centre at {place(defect.center)}{chosen}")
    lines.append(f"implant: {numbers['Volume'] / 1000:.2f} ml, {numbers['Mass']:.1f} g; thickness {numbers['ThicknessMinimum']:.1f} to "
                 f"{numbers['ThicknessMaximum']:.1f} mm, mean {numbers['ThicknessMean']:.1f} mm; thinnest place "
                 f"{numbers['MinimumThickness']:.1f} mm, at {place(numbers['MinimumThicknessPoint'])}")
    lines.append(f"way in: no nearer to bone than {numbers['InsertionClearance']:.1f} mm; undercuts of the bone: {undercut_text(numbers, place)}")
    lines.append(f"predicted error of the outer surface (standard error): {numbers['PredictedErrorRMS']:.2f} mm RMS; largest "
                 f"{numbers['PredictedErrorMaximum']:.2f} mm, at {place(numbers['PredictedErrorMaximumPoint'])}")
    if "TemplateFitRMS" in numbers:
        lines.append(f"template: {template_text(numbers)}")
    if numbers["NumberOfHoles"]:
        lines.append(f"holes through the implant: {numbers['NumberOfHoles']:.0f}")
    return lines + [f"plate {k}: {text}" for k, text in enumerate(plate_texts(made, place), 1)]


def plate_texts(made, place):
    """Where each plate is screwed to the bone, and how thick that is. place: of places."""
    data = fetch(made.plates)
    if not data.GetNumberOfCells():
        return []
    screws = vtk_to_numpy(data.GetPoints().GetData()).reshape(-1, 2, 3)[:, 1]
    thickness = vtk_to_numpy(data.GetCellData().GetArray("BoneThickness"))
    return [f"screw in bone of {mm:.1f} mm at {place(screw)}" for screw, mm in zip(screws, thickness)]


def warnings_of(proxy):
    """What an implant (a proxy of Skull Implant) warns of, a list of texts."""
    array = fetch(proxy).GetFieldData().GetAbstractArray("Warnings")
    return [array.GetValue(k) for k in range(array.GetNumberOfValues())]


def undercut_text(numbers, place):
    """What of the hole an implant cannot fill because bone is above it. numbers: of measures; place: of places."""
    if not numbers["UndercutVolume"] > 0:
        return "none"
    return f"{numbers['UndercutVolume']:.0f} mm³, up to {numbers['UndercutWidth']:.1f} mm wide, at {place(numbers['UndercutPoint'])}"


def template_text(numbers):
    """How well the template of an implant fits, and how far it counts. numbers: of measures."""
    return (f"{numbers['TemplateFitRMS']:.1f} mm RMS from the sound bone, scaled by {numbers['TemplateScale']:.3f}; its shape counts by "
            f"{numbers['TemplateFactor']:.2f}, its thickness by {numbers['TemplateThicknessFactor']:.2f} (0 not at all, 1 wholly)")


def places(made):
    """A function that writes a point as text: x y z in mm, and on which side of the head it is if the CT is known to be the patient's.

    The sides are those of the head, however it is turned and wherever it is in the scan: of its symmetry plane.
    """
    fields = fetch(made.implant).GetFieldData()
    middle, normal = (vtk_to_numpy(fields.GetArray("SymmetryPlane" + name)).ravel() for name in ("Origin", "Normal"))
    left = normal if normal[0] > 0 else -normal
    if left[0] < LATERAL:
        left = np.array([1.0, 0, 0])  # what was found are no sides
    back = np.array([0, 1, 0]) - left[1] * left
    back /= np.linalg.norm(back)
    head = np.array([left, back, np.cross(left, back)])
    patient = coordinates.is_patient(made.bone)

    def place(point):
        text = " ".join(f"{x:.1f}" for x in point) + " mm"
        off = head @ (np.asarray(point) - middle)
        return f"{text} ({direction_words(off)})" if patient and off.any() else text

    return place


def direction_words(direction):
    """Where a direction in patient coordinates (LPS) leads, in words such as "left front"."""
    return " ".join(WORDS[letter] for letter in views.direction_letters(direction))


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(
        prog="lacuna.implant", formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Designs an implant for the hole in a skull: a closed surface in the CT's patient millimetres (LPS), with the error to\n"
        "expect. Research software, not a medical device.",
        epilog="Exit codes: 0 the implant is written; 1 something failed, one sentence says what; 2 the command is wrong.\n"
        "Call it as pvpython -- -m lacuna.implant ... The -- keeps ParaView from turning numbers such as -13 into --13.\n"
        f"On a computer without a screen --report needs a virtual one:\n{SCREEN} pvpython -- -m lacuna.implant ...")
    parser.add_argument("ct", metavar="CT", help="a folder with a DICOM series, a file of one, or a volume: .mha .mhd .nrrd .nhdr .nii .nii.gz .vti")
    parser.add_argument("--output", required=True, metavar="FILE",
                        help="the implant, in mm: " + " ".join(ENDINGS) + ". FILE.json beside it says where it comes from")
    parser.add_argument("--hole", type=float, nargs=3, metavar=("X", "Y", "Z"),
                        help="a point in or near the hole, in patient millimetres: x to the left, y to the back, z to the head. Default: the largest hole")
    parser.add_argument("--template", metavar="FILE",
                        help="another skull without this hole: a CT as above, or a mesh in mm (" + " ".join(MESHES) + "). It counts as far as the "
                        "sound bone is like it")
    parser.add_argument("--report", metavar="DIR", help="write index.html and report.pdf with pictures, numbers and warnings into this folder")
    parser.add_argument("--level", type=float, metavar="HU", help=f"of the bone's surface ({LEVEL} in Hounsfield units; needed for other values)")
    parser.add_argument("--clearance", type=float, default=CLEARANCE, metavar="MM", help="gap between the implant's edge and the bone (%(default)s)")
    for name, (unit, text) in SETTINGS.items():
        kind = str if name == "engrave" else int if name in ("plates", "parts") else float
        parser.add_argument("--" + name, type=kind, metavar=unit, help=text)
    parser.add_argument("--thickness", type=float, default=0, metavar="MM", help="of the implant, 0.5 to 20; 0: that of the bone (%(default)s)")
    options = parser.parse_args(arguments)
    folder = os.path.dirname(options.output) or "."
    if not options.output.lower().endswith(ENDINGS):
        parser.error(f"--output: {options.output} does not end in one of {' '.join(ENDINGS)}")
    if not os.path.isdir(folder):
        parser.error(f"--output: there is no folder {folder}")
    if options.hole and not all(map(math.isfinite, options.hole)):
        parser.error("--hole: these are no three numbers in mm")
    if options.level is not None and not (math.isfinite(options.level) and options.level > 0):
        parser.error(f"--level: {options.level:g} is no number above 0")
    if not 0 <= options.clearance <= 5:
        parser.error(f"--clearance: {options.clearance:g} mm is not from 0 to 5")
    if options.thickness != 0 and not 0.5 <= options.thickness <= 20:
        parser.error(f"--thickness: {options.thickness:g} mm is neither 0 nor from 0.5 to 20")
    if options.report and os.path.exists(options.report) and not os.path.isdir(options.report):
        parser.error(f"--report: {options.report} is a file, not a folder")
    return options


def main(arguments=None):
    """The command. Returns 0, or 1 after a failure that one sentence on the standard error explains; wrong arguments exit with 2."""
    options = parse_arguments(arguments)
    try:
        _run(options)
    except (ValueError, RuntimeError, OSError, MemoryError) as error:
        reason = "there is not enough memory" if isinstance(error, MemoryError) else _in_options(str(error))
        print(f"lacuna.implant: {reason}", file=sys.stderr, flush=True)
        return 1
    return 0


def _in_options(message):
    """A message of the filters with the names of this command's options."""
    for name, option in (("Point (", "--hole ("), ("TemplateLevel", "--level"), ("at this Level, or draw an outline around the defect", "in the CT, or give "
                         "another --level")):
        message = message.replace(name, option)
    return message


def _run(options):
    from lacuna.data import open_volume
    from lacuna.solids import save_solid
    warnings = []
    _say("reading the CT")
    _check_folder(os.path.dirname(options.output) or ".")
    with _told_once(warnings):
        ct = open_volume(options.ct)
        level = _choose_level(ct, options, warnings)
    if options.report:
        _check_folder(options.report)
    if not coordinates.is_patient(ct):
        warnings.append("the CT does not say how the patient lay: left and right, front and back are not known. Check the side by other means")
    _say("designing the implant")
    with _told_once(warnings):
        template = options.template and _open_template(options.template)
        chosen = {PROPERTIES[name]: value for name, value in ((name, getattr(options, name.replace("-", "_"))) for name in SETTINGS) if value is not None}
        made = make_implant(ct, options.hole, level, options.clearance, _Steps(), template, options.thickness, **chosen)
        lines = describe(made)
        record = save_solid(options.output, made.implant)
    warnings = list(dict.fromkeys(warnings))
    for line in lines + [f"warning: {warning}" for warning in warnings]:
        _say(line)
    _say(f"written: {options.output} and {options.output}.json")
    if options.report:
        from lacuna import implant_report
        check_screen("the implant is written, the report is not", "lacuna.implant")
        with _told_once():
            written = implant_report.write(options.report, made, record, os.path.basename(os.path.abspath(options.ct)), warnings,
                                           options.template and os.path.basename(os.path.abspath(options.template)))
        _say(f"written: {' and '.join(written)}")
        if len(written) < 2:
            _say("no report.pdf: that needs matplotlib (Debian: python3-matplotlib)")
    _say("Research software, not a medical device.")


def _open_template(path):
    """A proxy. Raises ValueError when there is no such file."""
    from lacuna.data import open_volume
    if not path.lower().endswith(MESHES):
        return open_volume(path)
    if not os.path.isfile(path):
        raise ValueError(f"--template: there is no file {path}")
    return pv.OpenDataFile(path)


class _Steps:
    """Says each tenth of a work that is done."""

    def __init__(self):
        self.said = 0

    def __call__(self, done):
        if int(10 * done) > self.said:
            self.said = int(10 * done)
            os.write(1, f"  {10 * self.said} %\n".encode())  # print's texts are silent meanwhile, see _told_once


def check_screen(state, command):
    """Raises RuntimeError if pictures need an X server and there is none: VTK would end the program without a word.

    state: what is done and what is not; command: the module that was called.
    """
    if not vtkRenderWindow().GetClassName().startswith("vtkX"):
        return
    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError:
        return  # VTK has it in another way
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = x11.XOpenDisplay(None)
    if not display:
        raise RuntimeError(f"{state}: its pictures need a screen, and there is none. Call the command "
                           f"with a virtual one: {SCREEN} pvpython -- -m {command} ...")
    x11.XCloseDisplay(ctypes.c_void_p(display))


def _check_folder(folder):
    """Makes the folder if there is none. Raises ValueError if nothing can be written into it: before the work, not after it."""
    try:
        os.makedirs(folder, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise ValueError(f"nothing can be written into {folder}: {error.strerror}") from error


def _choose_level(ct, options, warnings):
    """The level that was given, or LEVEL if the values can be Hounsfield units: those of air are in every CT."""
    low, high = ct.PointData[0].GetRange(0)
    is_hounsfield = low < AIR
    if options.level is None and not is_hounsfield:
        raise ValueError(f"{options.ct} has values from {low:g} to {high:g}: these are no Hounsfield units, in which air is -1000. Give --level, the "
                         "value at the surface of bone")
    if is_hounsfield and options.level is not None and not BONE[0] <= options.level <= BONE[1]:
        warnings.append(f"the level {options.level:g} HU is not one of bone, {BONE[0]} to {BONE[1]}")
    return LEVEL if options.level is None else options.level


def _say(text):
    print(text, flush=True)


@contextlib.contextmanager
def _told_once(warnings=None):
    """As raising; VTK's output window and log do not print the messages too. In pvpython the window does not print print's texts either."""
    cutoff = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    window = vtkOutputWindow.GetInstance()
    mode = window.GetDisplayMode()
    window.SetDisplayModeToNever()
    try:
        with raising(warnings):
            yield
    finally:
        window.SetDisplayMode(mode)
        vtkLogger.SetStderrVerbosity(cutoff)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
