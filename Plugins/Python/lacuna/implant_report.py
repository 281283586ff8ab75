# SPDX-License-Identifier: BSD-3-Clause
"""Pictures, numbers and warnings of an implant of lacuna.implant: index.html, its PNGs and report.pdf in one folder."""
import collections
import html
import math
import os

import numpy as np
import paraview.simple as pv
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersCore import vtkProbeFilter

import lacuna
from lacuna import coordinates, implant, pictures, views
from lacuna.data import fetch
from lacuna.demo_implant import view_up
from lacuna.files import writing
from lacuna.solids import NOTICE

IMPLANT = (0.25, 0.55, 0.78)
CHOSEN, OTHER = (0.80, 0.10, 0.10), (0.90, 0.55, 0.10)  # outlines of holes
STEP = 0.8  # mm between samples of the bone that is shown, at least
REACH, STEPS = 10.0, 41  # mm to either side in which the other side of the head is looked for, and samples there
LEAST_MIRRORED = 0.5  # of the outer surface, for which a deviation from the mirrored side means something
MATERIALS = (("PEEK", 1.3), ("PMMA", 1.18), ("titanium", 4.5))  # g/cm³
# file name, title if the CT is known to be the patient's, else as the axes say, direction
SIDES = (("front", "From the front", "Along +y", (0, 1, 0)), ("back", "From behind", "Along −y", (0, -1, 0)),
         ("left", "From the patient's left", "Along −x", (-1, 0, 0)), ("right", "From the patient's right", "Along +x", (1, 0, 0)),
         ("top", "From above", "Along −z", (0, 0, -1)), ("bottom", "From below", "Along +z", (0, 0, 1)))


def show_bone(bone, level, view, made=lambda proxy: proxy):
    """Shows the surface of the bone (a proxy of a volume), sampled every STEP mm or more. Returns the proxy that is shown.

    made: is called with each proxy that is made.

    ParaView's Contour does not heed how a volume is turned; a Transform after it does.
    """
    image = fetch(bone)
    rates = [max(1, int(STEP / spacing)) for spacing in image.GetSpacing()]
    surface = bone
    if max(rates) > 1:
        extent = image.GetExtent()
        surface = made(pv.ExtractSubset(Input=bone, VOI=list(extent), SampleRateI=rates[0], SampleRateJ=rates[1], SampleRateK=rates[2]))
        image = fetch(surface)
    grey = image.GetPointData().GetScalars().GetName()
    surface = made(pictures.contour(surface, grey, level))
    direction = np.array([image.GetDirectionMatrix().GetElement(i, k) for i in range(3) for k in range(3)]).reshape(3, 3)
    if not np.allclose(direction, np.eye(3), atol=1e-12):
        origin = np.array(image.GetOrigin())
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = direction, origin - direction @ origin
        turn = vtkTransform()
        turn.SetMatrix(matrix.ravel())
        surface = made(pv.Transform(Input=surface))
        surface.Transform.Translate, surface.Transform.Rotate = list(turn.GetPosition()), list(turn.GetOrientation())
        surface.Transform.Scale = list(turn.GetScale())  # negative where the directions are left-handed
    pictures.show_surface(surface, view, pictures.BONE)
    return surface


def show_error(proxy, view, numbers):
    """Shows an implant coloured by its predicted error, from 0 to 1 mm or more."""
    display = pictures.show_surface(proxy, view, IMPLANT)
    _color(display, view, "PredictedError", "predicted error, mm", (0, max(1, _up(numbers["PredictedErrorMaximum"]))), "Viridis")
    return display


def _color(display, view, array, title, bounds, preset):
    """pictures.color_by with a bar that is easy to read on bone."""
    bar = pv.GetScalarBar(pictures.color_by(display, view, array, title, bounds, preset), view)
    bar.HorizontalTitle, bar.ScalarBarLength = 1, 0.4
    bar.TitleBold = bar.LabelBold = 1
    bar.WindowLocation = "Upper Right Corner"


Deviation = collections.namedtuple("Deviation", "mean rms largest place covered")  # mm, mm, mm, x y z in mm, part of the area


def mirror_deviation(bone, level, implant, origin, normal):
    """How far an implant's outer surface is from the bone of the head's other side, mirrored: a Deviation.

    bone: vtkImageData in which only bone is at or above level. implant: vtkPolyData of Skull Implant. origin, normal: of the plane of
    symmetry, mm. Distances are along the implant's normal, positive where the implant is farther out, by the area of its triangles; no
    bone within REACH counts as none. mean, rms, largest and place are None where covered is 0.
    """
    points = vtk_to_numpy(implant.GetPoints().GetData()).astype(float)
    corners = vtk_to_numpy(implant.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    corners = corners[vtk_to_numpy(implant.GetCellData().GetArray("ImplantFace")) == 0]
    a, b, c = (points[corners[:, k]] for k in range(3))
    middles, normals = (a + b + c) / 3, np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1) / 2
    middles, normals, areas = middles[areas > 0], normals[areas > 0], areas[areas > 0]
    normals /= 2 * areas[:, None]
    origin, normal = np.asarray(origin, float), np.asarray(normal, float) / np.linalg.norm(normal)
    feet = middles - 2 * np.outer((middles - origin) @ normal, normal)
    ways = normals - 2 * np.outer(normals @ normal, normal)
    heights = np.linspace(REACH, -REACH, STEPS)  # from outside
    samples = (feet[:, None, :] + heights[None, :, None] * ways[:, None, :]).reshape(-1, 3)
    places = vtkPoints()
    places.SetData(numpy_to_vtk(samples, deep=True))
    where = vtkPolyData()
    where.SetPoints(places)
    probe = vtkProbeFilter()
    probe.SetInputData(where)
    probe.SetSourceData(bone)
    probe.Update()
    found = probe.GetOutput().GetPointData()
    values = vtk_to_numpy(found.GetArray(bone.GetPointData().GetScalars().GetName())).astype(float)
    values[vtk_to_numpy(found.GetArray(probe.GetValidPointMaskArrayName())) == 0] = -np.inf  # outside of the volume
    values = values.reshape(-1, STEPS)
    inside = values >= level
    first = inside.argmax(axis=1)  # 0: none, or bone that goes on outside of REACH
    rows = np.flatnonzero((first > 0) & np.isfinite(values[np.arange(len(first)), first - 1]))
    at = first[rows]
    above, below = values[rows, at], values[rows, at - 1]
    off = -(heights[at] + (heights[0] - heights[1]) * (above - level) / (above - below))
    weights = areas[rows] / areas[rows].sum()
    if len(rows) == 0:
        return Deviation(None, None, None, None, 0.0)
    worst = np.abs(off).argmax()
    return Deviation(float(weights @ off), float(np.sqrt(weights @ off**2)), float(off[worst]), middles[rows[worst]],
                     float(areas[rows].sum() / areas.sum()))


Content = collections.namedtuple("Content", "title subject notice warnings pictures letters rows explanations sides checks origin steps foot")

CHECKS = ("Open the CT and the implant together in another program. Is it the patient, the side, the hole?",
          "Measure a known distance in both. The unit is the millimetre; STL, PLY and OBJ files do not say so.",
          "Cut through bone and implant. The gap should be even, nothing should overlap or stand out.",
          "Print skull and implant, and fit them by hand.")
EXPLANATIONS = (
    "The predicted error is a standard error. Expect about two thirds of the surface within it, and 95 % within twice as much. "
    "It assumes that the missing bone was shaped like sound bone. It does not know about a tumour, a fracture that has moved, or artefacts.",
    "The deviation from the mirrored other side is positive where the implant is farther out. The sides of most heads differ by 1 to 2 mm, so it "
    "is no error by itself. Look for the reason where it is larger.")


def write(folder, made, record, ct_name, warnings, template_name=None):
    """Writes index.html, report.pdf and their pictures into a folder that exists. Returns the names of both, without the PDF where
    matplotlib is not installed.

    made: of implant.make_implant; record: of solids.save_solid; ct_name: of the CT's file, without its folder; warnings: texts; template_name:
    as ct_name, of the template.
    """
    from lacuna import implant_pdf
    numbers = implant.measures(made)
    shown = _draw(folder, made, numbers)
    all_of_it = content(made, numbers, record, ct_name, warnings, shown, template_name)
    written = [os.path.join(folder, "index.html")]
    with writing(written[0]) as name, open(name, "w", encoding="utf-8") as file:
        file.write(_page(all_of_it))
    try:
        with writing(os.path.join(folder, "report.pdf")) as name:
            implant_pdf.write(name, all_of_it, folder)
    except ImportError:
        return written
    return written + [os.path.join(folder, "report.pdf")]


def content(made, numbers, record, ct_name, warnings, shown, template_name=None):
    """What both forms of the report say: a Content of texts and of (file, title) of pictures."""
    rows = _rows(made, numbers)
    if template_name:
        rows.append(("template", f"{template_name}: {implant.template_text(numbers)}"))
    letters = "L, R, A, P, H, F at the edges of the pictures are the patient's left, right, front, back, head and feet." if \
        coordinates.is_patient(made.bone) else "The CT does not say how the patient lay: check left and right by other means. The pictures have no letters."
    return Content(
        "Cranial implant", f"CT: {ct_name} · implant: {record['file']}",
        f"{NOTICE} Who makes an implant answers for it. Check side, size, shape and gap by other means.", warnings, shown[0],
        letters + " The hole that the implant closes is outlined in red, other holes in orange.", rows, EXPLANATIONS, shown[1], CHECKS,
        f"Lacuna {lacuna.__version__}. Coordinates: {record['coordinates']}. SHA-256 of {record['file']}: {record['sha256']}", record["steps"],
        f"Cranial implant · {record['file']}")


def _draw(folder, made, numbers):
    """Saves the pictures; returns (file name, title) of the main ones and of those from six sides."""
    patient = coordinates.is_patient(made.bone)
    inwards = list(numbers["InsertionDirection"])
    files = []

    def save(view, name, title):
        pictures.save(view, os.path.join(folder, name + ".png"))
        files.append((name + ".png", title))

    view = _new_view((640, 560))
    bone = show_bone(made.bone, made.implant.Level, view)
    pictures.show_surface(made.implant, view, IMPLANT)
    if patient:  # the bone is too: the Transform of show_bone takes it to where the patient is
        views.show_orientation(view, force=True)
    for name, title, axis_title, direction in SIDES:
        pictures.look(view, direction, view_up(direction), 1.15)
        save(view, name, title if patient else axis_title)
    pv.Delete(view)
    sides, files = files, []

    view = _new_view((900, 720))
    pictures.show_surface(bone, view, pictures.BONE)
    pictures.look(view, inwards, view_up(inwards))
    _frame(view, made.implant)
    pictures.add_scale_bar(view, 20, aside=patient)
    if patient:
        views.show_orientation(view, force=True)
    outlines = _show_outlines(made.defects, numbers, view)
    save(view, "defect", "The outline of the hole")
    for proxy in outlines:
        pv.Hide(proxy, view)
    pictures.show_surface(made.implant, view, IMPLANT)
    if fetch(made.plates).GetNumberOfCells():
        outlines = [pv.Tube(Input=made.plates, Radius=1)]
        pictures.show_surface(outlines[0], view, pictures.METAL)
    save(view, "implant", "The implant in the skull, seen the way it is put in")
    for proxy in [made.implant, *outlines]:
        pv.Hide(proxy, view)
    outer = pv.Threshold(Input=made.implant, Scalars=["CELLS", "ImplantFace"], ThresholdMethod="Below Lower Threshold", LowerThreshold=0.5)
    display = show_error(outer, view, numbers)
    save(view, "error", "Predicted error of the outer surface")
    display.SetScalarBarVisibility(view, False)
    low, high = numbers["ThicknessMinimum"], numbers["ThicknessMaximum"]
    _color(display, view, "Thickness", "thickness, mm", (low, max(high, low + 0.1)), "Plasma")
    save(view, "thickness", "Thickness")
    pv.Delete(view)
    return files, sides


def _new_view(size):
    view = pictures.new_picture(size)
    view.OrientationAxesVisibility = 0
    return view


def _show_outlines(defects, numbers, view):
    """The outline of each hole, of the one that the implant closes in red; returns the proxies."""
    shown = []
    first = 1 if numbers["ChosenDefect"] else 0  # 0: an outline was drawn
    for k in range(len(numbers["Defects"])):
        one = pv.Threshold(Input=defects, Scalars=["CELLS", "Defect"], ThresholdMethod="Between", LowerThreshold=first + k - 0.5,
                           UpperThreshold=first + k + 0.5)
        outline = pv.FeatureEdges(Input=pv.ExtractSurface(Input=one), BoundaryEdges=1, FeatureEdges=0, NonManifoldEdges=0, ManifoldEdges=0)
        outline.UpdatePipeline()
        if outline.GetDataInformation().GetNumberOfCells() == 0:
            outline = one  # points
        display = pictures.show_surface(outline, view, CHOSEN if k == numbers["Chosen"] else OTHER)
        display.LineWidth, display.PointSize, display.RenderLinesAsTubes = 5, 4, 0
        display.Ambient, display.Diffuse = 1, 0
        shown.append(outline)
    return shown


def _frame(view, proxy):
    """Brings a proxy close, and keeps the camera's direction and all else in sight."""
    bounds = np.array(proxy.GetDataInformation().GetBounds()).reshape(3, 2)
    camera = view.GetActiveCamera()
    middle = bounds.mean(axis=1)
    move = middle - np.array(camera.GetFocalPoint())
    camera.SetPosition(*(np.array(camera.GetPosition()) + move))
    camera.SetFocalPoint(*middle)
    camera.SetParallelScale(0.6 * float(np.linalg.norm(bounds[:, 1] - bounds[:, 0])))
    pv.Render(view)


def _up(value):
    """The next tenth."""
    return math.ceil(10 * value - 1e-9) / 10


def _rows(made, numbers):
    """(quantity, value) of the table."""
    place = implant.places(made)
    inwards = numbers["InsertionDirection"]
    text = " ".join(f"{x:.3f}" for x in inwards)
    if coordinates.is_patient(made.bone):
        text += f" (towards the patient's {implant.direction_words(inwards)})"
    chosen = numbers["Defects"][numbers["Chosen"]]
    rows = [("hole: area", f"{chosen.area / 100:.1f} cm²"), ("hole: centre", place(chosen.center))]
    others = [f"{defect.area / 100:.1f} cm² at {place(defect.center)}" for k, defect in enumerate(numbers["Defects"]) if k != numbers["Chosen"]]
    rows += [("other holes, not closed", "; ".join(others) or "none"),
             ("area of the hole in the outer surface", f"{numbers['DefectArea'] / 100:.1f} cm²"),
             ("outer area of the implant", f"{numbers['OuterArea'] / 100:.1f} cm²"),
             ("volume", f"{numbers['Volume'] / 1000:.2f} ml")]
    rows += [(f"mass in {name} ({density:g} g/cm³)", f"{numbers['Volume'] / 1000 * density:.1f} g") for name, density in MATERIALS]
    rows += [("thickness, least to largest", f"{numbers['ThicknessMinimum']:.1f} to {numbers['ThicknessMaximum']:.1f} mm"),
             ("thickness, mean", f"{numbers['ThicknessMean']:.1f} mm"),
             ("thinnest place", f"{numbers['MinimumThickness']:.1f} mm at {place(numbers['MinimumThicknessPoint'])}"),
             ("clearance of the edge", f"{made.implant.EdgeClearance:g} mm"),
             ("predicted error of the outer surface, RMS", f"{numbers['PredictedErrorRMS']:.2f} mm"),
             ("predicted error, largest", f"{numbers['PredictedErrorMaximum']:.2f} mm at {place(numbers['PredictedErrorMaximumPoint'])}"),
             *_mirror_rows(made, place),
             ("insertion direction", text),
             ("least taper of the implant's walls", f"{numbers['LeastTaper']:.1f}°"),
             ("least distance from bone on the way in", f"{numbers['InsertionClearance']:.2f} mm"),
             ("undercuts of the bone, not filled", implant.undercut_text(numbers, place)),
             *_setting_rows(made.implant),
             ("holes through the implant", f"{numbers['NumberOfHoles']:.0f}"),
             *((f"plate {k}", text) for k, text in enumerate(implant.plate_texts(made, place), 1)),
             ("bone level", f"{made.implant.Level:g} HU")]
    return rows


def _setting_rows(design):
    """Of what a Skull Implant adds to the shape only when it is asked to."""
    rows = []
    if design.Parts > 1:
        rows.append(("parts", f"{design.Parts}"))
    if design.OuterOffset or design.InnerOffset:
        rows.append(("faces moved outwards, less towards the rim",
                     f"outer {design.OuterOffset:+g} mm, inner {design.InnerOffset:+g} mm; in full {design.OffsetFade:g} mm from the rim"))
    if design.EngravedText:
        rows.append(("text in the inner face", design.EngravedText))
    return rows


def _mirror_rows(made, place):
    """Of the plane in which the whole bone is most alike: that of the implant's model fits less well where its sides hardly differ."""
    mirror = pv.Mirror(Input=made.bone)
    mirror.UpdatePipeline()
    fields = fetch(mirror).GetFieldData()
    origin, normal = (vtk_to_numpy(fields.GetArray("MirrorPlane" + name)).ravel() for name in ("Origin", "Normal"))
    pv.Delete(mirror)
    off = mirror_deviation(fetch(made.bone), made.implant.Level, fetch(made.implant), origin, normal)
    if off.covered < LEAST_MIRRORED:
        return [("deviation from the mirrored other side", f"not given: the other side has bone for only {100 * off.covered:.0f} % of the implant, "
                                                           "as at the midline")]
    return [("deviation from the mirrored other side, mean", f"{off.mean:+.1f} mm"), ("the same, RMS", f"{off.rms:.1f} mm"),
            ("the same, largest", f"{off.largest:+.1f} mm at {place(off.place)}"),
            ("part of the implant for which the other side has bone", f"{100 * off.covered:.0f} %")]


STYLE = """
body { font: 16px/1.45 system-ui, sans-serif; color: #222; max-width: 1200px; margin: 0 auto; padding: 1.5em; }
h1 { font-size: 1.7em; margin: 0 0 0.3em; } h2 { font-size: 1.25em; margin: 1.8em 0 0.6em; }
.notice { background: #f3f4f6; border-left: 5px solid #7a8594; padding: 0.6em 1em; }
.warning { background: #fff3e0; border-left: 5px solid #d97706; padding: 0.6em 1em; margin: 0.5em 0; }
.fine { background: #edf7ee; border-left: 5px solid #3c8c4a; padding: 0.6em 1em; }
table { border-collapse: collapse; } td, th { border-bottom: 1px solid #d8dce2; padding: 0.35em 1.2em 0.35em 0; text-align: left; vertical-align: top; }
.two, .three { display: grid; gap: 1em; } .two { grid-template-columns: repeat(2, 1fr); } .three { grid-template-columns: repeat(3, 1fr); }
figure { margin: 0; } img { width: 100%; border: 1px solid #d8dce2; } figcaption { font-size: 0.9em; color: #444; }
code { font-size: 0.85em; overflow-wrap: anywhere; } li { margin: 0.25em 0; }
@media print { body { max-width: none; } figure { break-inside: avoid; } }
"""


def _page(told):
    """The HTML of a Content."""
    text = html.escape

    def figures(files, columns):
        inside = "\n".join(f'<figure><img src="{name}" alt="{text(title)}"><figcaption>{text(title)}</figcaption></figure>' for name, title in files)
        return f'<div class="{columns}">\n{inside}\n</div>'

    def each(texts, tag, kind=""):
        return "\n".join(f"<{tag}{kind}>{text(one)}</{tag}>" for one in texts)

    rows = "\n".join(f"<tr><td>{text(name)}</td><td>{text(value)}</td></tr>" for name, value in told.rows)
    warnings = each(told.warnings, "p", ' class="warning"') or '<p class="fine">No warnings.</p>'
    steps = "\n".join(f"<li><code>{text(step)}</code></li>" for step in told.steps)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>{text(told.title)}</title>
<style>{STYLE}</style>
</head>
<body>
<h1>{text(told.title)}</h1>
<p>{text(told.subject)}</p>
<p class="notice"><b>{text(told.notice)}</b></p>
<h2>Warnings</h2>
{warnings}
<h2>The implant</h2>
{figures(told.pictures, "two")}
<p>{text(told.letters)}</p>
<h2>Numbers</h2>
<table>
{rows}
</table>
{each(told.explanations, "p")}
<h2>From six sides</h2>
{figures(told.sides, "three")}
<h2>Before anything is made</h2>
<ul>
{each(told.checks, "li")}
</ul>
<h2>Where this comes from</h2>
<p>{text(told.origin)}</p>
<ol>
{steps}
</ol>
</body>
</html>
"""
