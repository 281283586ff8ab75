# SPDX-License-Identifier: BSD-3-Clause
"""Implants for bone that was cut out of intact skulls: how far they are from it, and how far they were predicted to be.

    . build/release/lacuna-env.sh
    xvfb-run -a pvpython Testing/Science/skull_implants.py --tool PATH/implant_cases.py --out FOLDER [--cases NAME,...] [--random FIRST-LAST]
                         [--picture FILE.png] [--check] [--templates] [NAME=CT.mha ...]

For each skull and case (a name of the tool's list, or random:SEED): the tool cuts the hole, lacuna.implant makes the implant from the whole
file, with nothing marked but a point in the hole, and the tool scores it. FOLDER keeps the implants and results.csv; a later call makes only
what is missing. FOLDER/results.md is the table. The picture shows the true error of each implant beside the predicted one.

Errors are along the ray from the middle of the head, times the cosine between ray and surface, as the tool has it. band: the part
of the outer surface whose true error is at most 1.96 times the predicted one. ratio: RMS of the predicted error by RMS of the true one.
--templates gives each skull the next one of the list as its template, the last one the first; use another FOLDER for it.
Random cases that the tool calls unfair (without bone nearly everywhere) are left out. Needs SciPy.

Without NAME=CT.mha: head.mha of LACUNA_TEST_DATA, and Cranium.inv3 of Debian's package invesalius-examples. --check ends with 1 when an
implant is worse than implants are meant to be (is_good), and with 77 when the tool or the skulls are missing.
"""
import argparse
import csv
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import time

import numpy as np
import vtkmodules.vtkRenderingFreeType  # noqa: F401 (draws text)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkPolyDataNormals, vtkThreshold
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkRenderingAnnotation import vtkScalarBarActor
from vtkmodules.vtkRenderingCore import (vtkActor, vtkColorTransferFunction, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTextActor,
                                         vtkWindowToImageFilter)

FIELDS = ["skull", "case", "diameter", "rms", "largest", "p99", "thickness", "dice", "covered", "intrudes", "predicted", "ratio", "band", "warned",
          "seconds", "problem"]
SCALE = [(0.0, (0.16, 0.30, 0.62)), (0.4, (0.62, 0.80, 0.88)), (0.8, (0.98, 0.90, 0.60)), (1.2, (0.90, 0.45, 0.20)), (2.0, (0.60, 0.05, 0.10))]
CELL, TOP, LEFT, BOTTOM = (300, 280), 34, 170, 70  # pixels
LEVEL = 300
KNOWN = {("head", "random:17"), ("Cranium", "random:11"), ("Cranium", "random:25")}  # worse, as the page on accuracy says
CRANIUM = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3"


def load_tool(path):
    spec = importlib.util.spec_from_file_location("implant_cases", path)
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    return tool


def outer_surface(path):
    """The outer face of an implant with its normals."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    normals = vtkPolyDataNormals()  # splits edges, so that the wall does not bend the normals of the rim
    normals.SetInputConnection(reader.GetOutputPort())
    normals.SetFeatureAngle(45)
    outer = vtkThreshold()
    outer.SetInputConnection(normals.GetOutputPort())
    outer.SetInputArrayToProcess(0, 0, 0, 1, "ImplantFace")
    outer.SetThresholdFunction(vtkThreshold.THRESHOLD_LOWER)
    outer.SetLowerThreshold(0.5)
    surface = vtkGeometryFilter()
    surface.SetInputConnection(outer.GetOutputPort())
    surface.Update()
    return surface.GetOutput()


def both_errors(case, surface):
    """At each point, mm along the normal: the true one, positive outwards and NaN where there was no bone, and the predicted one."""
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float) - case.c
    radii = np.linalg.norm(points, axis=1)
    rays = points / radii[:, None]
    outer, _ = case.tables(rays)
    cosine = np.abs((vtk_to_numpy(surface.GetPointData().GetNormals()) * rays).sum(axis=1))
    return (radii - outer) * cosine, vtk_to_numpy(surface.GetPointData().GetArray("PredictedError")) * cosine


def point_areas(surface):
    """Of each point, a third of the triangles around it, mm²."""
    points = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    a, b, c = (points[corners[:, k]] for k in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    return np.bincount(corners.ravel(), np.repeat(areas, 3), len(points))


def measure(tool, options, skull, ct, name, template=None):
    start = os.path.join(options.out, f"{skull}-{name.replace(':', '')}")
    case = tool.Case(ct, name)
    row = dict.fromkeys(FIELDS, "") | {"skull": skull, "case": name}
    if name.startswith("random:") and not case.fair():
        return row | {"problem": "unfair"}
    subprocess.run([options.pvpython, options.tool, "cut", ct, name, f"{start}.mha"], check=True, stdout=subprocess.DEVNULL)
    hole = [f"{x:.3f}" for x in case.c + 85 * case.w]
    begin = time.monotonic()
    made = subprocess.run([options.pvpython, "--", "-m", "lacuna.implant", f"{start}.mha", "--output", f"{start}.vtp", "--hole", *hole,
                           *(["--template", template] if template else [])], capture_output=True, text=True, check=False)
    row["seconds"] = f"{time.monotonic() - begin:.0f}"
    os.remove(f"{start}.mha")
    if made.returncode:
        return row | {"problem": " ".join((made.stderr or made.stdout).split())}
    score = subprocess.run([options.pvpython, options.tool, "score", ct, name, f"{start}.vtp"], capture_output=True, text=True, check=True)
    score = json.loads(score.stdout[score.stdout.index("{"):].splitlines()[0])
    surface = outer_surface(f"{start}.vtp")
    errors, predicted = both_errors(case, surface)
    known = np.isfinite(errors)
    areas = point_areas(surface)[known]
    rms = [np.sqrt(np.average(np.square(values[known]), weights=areas)) for values in (predicted, errors)]
    return row | {"diameter": score["diameter_mm"], "rms": score["outer"]["rms"], "largest": score["outer"]["max"], "p99": score["outer"]["p99"],
                  "thickness": score.get("thickness_rms", ""), "dice": score.get("dice", ""), "covered": score["covered"],
                  "intrudes": score.get("intrudes_mm3", ""), "predicted": f"{rms[0]:.3f}", "ratio": f"{rms[0] / rms[1]:.2f}",
                  "band": f"{np.average(np.abs(errors[known]) <= 1.96 * predicted[known], weights=areas):.3f}",
                  "warned": int("may be more than 1 mm off" in made.stdout + made.stderr)}


def is_good(row):
    """Whether an implant fits, and is as near to the bone as it has to be. Of random cases; those of KNOWN have to fit."""
    if row["problem"]:
        return row["problem"] == "unfair"
    number = {field: float(row[field]) for field in ("rms", "largest", "dice", "covered", "intrudes")}
    is_near = number["rms"] <= 1.2 and number["largest"] <= 4 and number["dice"] >= (0.65 if row["skull"] == "head" else 0.75)
    return number["covered"] >= 0.985 and number["intrudes"] <= 20 and (is_near or (row["skull"], row["case"]) in KNOWN)


def find_skulls(options):
    """What is there of the two skulls, by name."""
    skulls = {"head": os.path.join(os.environ.get("LACUNA_TEST_DATA", ""), "ct_head", "head.mha")}
    if os.path.exists(CRANIUM):
        skulls["Cranium"] = os.path.join(options.out, "Cranium.mha")
        if not os.path.exists(skulls["Cranium"]):
            subprocess.run([options.pvpython, options.tool, "skull", CRANIUM, skulls["Cranium"]], check=True)
    return {name: path for name, path in skulls.items() if os.path.exists(path)}


def write_table(path, rows):
    with open(path, "w", encoding="utf-8") as file:
        file.write("| skull | case | mm across | outer RMS / largest, mm | Dice | thickness RMS, mm | covered | in bone, mm³ | predicted RMS, mm | in the band |"
                   " warned | s |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n")
        for row in rows:
            if row["problem"] == "unfair":
                continue
            if row["problem"]:
                file.write(f"| {row['skull']} | {row['case']} | {row['problem']} |" + " |" * 9 + "\n")
                continue
            file.write("| {skull} | {case} | {diameter} | {rms} / {largest} | {dice} | {thickness} | {covered} | {intrudes} | {predicted} |"
                       " {band} | {warning} | {seconds} |\n".format(warning="yes" if row["warned"] in ("1", 1) else "no", **row))
        file.write(distribution([row for row in rows if row["case"].startswith("random:") and not row["problem"]]))


def distribution(rows):
    """Of the random cases, in words."""
    if not rows:
        return ""
    text = f"\n{len(rows)} random cases. Median, 90th percentile and worst:"
    for field, sign in (("rms", 1), ("largest", 1), ("dice", -1), ("thickness", 1), ("ratio", -1), ("band", -1)):
        values = sign * np.sort([sign * float(row[field]) for row in rows])
        text += f" {field} {np.median(values):.2f}, {values[int(0.9 * (len(values) - 1))]:.2f}, {values[-1]:.2f};"
    silent = [row["case"] for row in rows if float(row["largest"]) > 1 and not int(row["warned"])]
    fine = [row for row in rows if float(row["largest"]) <= 1]
    return text + (f" beyond 1 mm without a warning: {len(silent)} ({', '.join(silent)}); of {len(fine)} that are not, "
                   f"{sum(int(row['warned']) for row in fine)} warn.\n")


# The picture

def colors():
    table = vtkColorTransferFunction()
    for error, color in SCALE:
        table.AddRGBPoint(error, *color)
    return table


def actor_of(data, color=None, table=None):
    mapper = vtkPolyDataMapper()
    mapper.SetInputDataObject(data)
    actor = vtkActor()
    actor.SetMapper(mapper)
    if table:
        mapper.SetLookupTable(table)
        mapper.UseLookupTableScalarRangeOn()
        mapper.InterpolateScalarsBeforeMappingOff()
        actor.GetProperty().SetAmbient(0.3)
        actor.GetProperty().SetDiffuse(0.7)
    else:
        mapper.ScalarVisibilityOff()
        actor.GetProperty().SetColor(*color)
    return actor


def skull_surface(case):
    """What is left of the skull, without its holder."""
    bone = np.minimum(case.cut(), case.a)
    image = vtkImageData()
    image.SetDimensions(*bone.shape[::-1])
    image.SetSpacing(*case.s)
    image.SetOrigin(*case.o)
    image.GetPointData().SetScalars(numpy_to_vtk(bone.astype(np.int16).ravel(), deep=True))
    contour = vtkFlyingEdges3D()
    contour.SetInputData(image)
    contour.SetValue(0, LEVEL)
    contour.ComputeScalarsOff()
    contour.Update()
    return contour.GetOutput()


def words(text, x, y, size=17, left=False):
    actor = vtkTextActor()
    actor.SetInput(text)
    actor.SetPosition(x, y)
    style = actor.GetTextProperty()
    style.SetFontSize(size)
    style.SetColor(0.1, 0.1, 0.1)
    style.SetVerticalJustificationToCentered()
    if not left:
        style.SetJustificationToCentered()
    return actor


def draw(tool, options, skulls, rows):
    rows = [row for row in rows if not row["problem"] and not row["case"].startswith("random:")]
    columns = 2 if len(rows) > 1 else 1  # of pairs of pictures
    lines = -(-len(rows) // columns)
    width, height = columns * (LEFT + 2 * CELL[0]), TOP + lines * CELL[1] + BOTTOM
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(4)
    window.SetSize(width, height)
    base = vtkRenderer()
    base.SetBackground(1, 1, 1)
    window.AddRenderer(base)
    table = colors()
    for column in range(columns):
        left = column * (LEFT + 2 * CELL[0]) + LEFT
        base.AddActor2D(words("true error", left + CELL[0] / 2, height - TOP / 2))
        base.AddActor2D(words("predicted error", left + 1.5 * CELL[0], height - TOP / 2))
    for k, row in enumerate(rows):
        case = tool.Case(skulls[row["skull"]], row["case"])
        surface = outer_surface(os.path.join(options.out, f"{row['skull']}-{row['case']}.vtp"))
        bone = skull_surface(case)
        errors, predicted = both_errors(case, surface)
        left, bottom = (k % columns) * (LEFT + 2 * CELL[0]) + LEFT, BOTTOM + (lines - 1 - k // columns) * CELL[1]
        base.AddActor2D(words(f"{row['skull']}\n{row['case']}\n{float(row['diameter']):.0f} mm\nRMS {float(row['rms']):.2f}", left - LEFT + 8,
                              bottom + CELL[1] / 2, left=True))
        for i, values in enumerate((np.abs(errors), predicted)):
            shown = vtkPolyDataNormals()
            shown.SetInputData(surface)
            shown.SplittingOff()
            shown.Update()
            data = shown.GetOutput()
            data.GetPointData().SetScalars(numpy_to_vtk(np.nan_to_num(values, nan=0.0), deep=True))
            renderer = vtkRenderer()
            renderer.SetBackground(1, 1, 1)
            x, y = left + i * CELL[0], bottom
            renderer.SetViewport(x / width, y / height, (x + CELL[0]) / width, (y + CELL[1]) / height)
            renderer.AddActor(actor_of(bone, (0.93, 0.90, 0.83)))
            renderer.AddActor(actor_of(data, table=table))
            camera = renderer.GetActiveCamera()
            camera.ParallelProjectionOn()
            camera.SetFocalPoint(*case.c)
            camera.SetPosition(*(case.c + 500 * case.w))
            camera.SetViewUp(*((0, 0, 1) if abs(case.w[2]) < 0.85 else (0, 1, 0)))
            renderer.ResetCamera()
            camera.SetParallelScale(95)
            window.AddRenderer(renderer)
    bar = vtkScalarBarActor()
    bar.SetLookupTable(table)
    bar.SetOrientationToHorizontal()
    bar.SetNumberOfLabels(6)
    bar.SetLabelFormat("{:.1f}" if "{" in bar.GetLabelFormat() else "%.1f")  # VTK 9.6 and later, or before
    bar.SetTitle("mm")
    for style in (bar.GetLabelTextProperty(), bar.GetTitleTextProperty()):
        style.SetColor(0.1, 0.1, 0.1)
        style.ShadowOff()
        style.ItalicOff()
        style.BoldOff()
    bar.SetPosition(0.25, 5 / height)
    bar.SetPosition2(0.5, (BOTTOM - 10) / height)
    base.AddActor2D(bar)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetFileName(options.picture)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("skulls", nargs="*", metavar="NAME=CT.mha")
    parser.add_argument("--tool", default=os.path.join(os.environ.get("LACUNA_TEST_DATA", ""), "..", "tools", "implant_cases.py"))
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--templates", action="store_true")
    parser.add_argument("--out", required=True)
    parser.add_argument("--cases", default="")
    parser.add_argument("--random", default="")
    parser.add_argument("--picture")
    options = parser.parse_args()
    options.pvpython = shutil.which("pvpython")
    if not os.path.exists(options.tool):
        print(f"skipped: no {options.tool} (--tool)")
        return 77
    os.makedirs(options.out, exist_ok=True)
    skulls = dict(text.split("=", 1) for text in options.skulls) or find_skulls(options)
    if not skulls:
        print("skipped: no skull: set LACUNA_TEST_DATA or install invesalius-examples")
        return 77
    tool = load_tool(options.tool)
    names = [name for name in options.cases.split(",") if name]
    if options.random:
        first, last = map(int, options.random.split("-"))
        names += [f"random:{seed}" for seed in range(first, last + 1)]
    path = os.path.join(options.out, "results.csv")
    if options.check and os.path.exists(path):
        os.remove(path)  # of another version
    rows = list(csv.DictReader(open(path, encoding="utf-8"))) if os.path.exists(path) else []
    for skull, ct in skulls.items():
        for name in names:
            if any((row["skull"], row["case"]) == (skull, name) for row in rows):
                continue
            others = list(skulls.values())
            template = others[(others.index(ct) + 1) % len(others)] if options.templates and len(others) > 1 else None
            rows.append(measure(tool, options, skull, ct, name, template))
            print(", ".join(f"{key} {value}" for key, value in rows[-1].items() if value != ""), flush=True)
            with open(path, "w", encoding="utf-8", newline="") as file:
                writer = csv.DictWriter(file, FIELDS)
                writer.writeheader()
                writer.writerows(rows)
    write_table(os.path.join(options.out, "results.md"), rows)
    if options.picture:
        draw(tool, options, skulls, rows)
    print(distribution([row for row in rows if row["case"].startswith("random:") and not row["problem"]]))
    bad = [f"{row['skull']} {row['case']}" for row in rows if not is_good(row)]
    if bad:
        print("worse than they are meant to be:", ", ".join(bad))
    return 1 if options.check and bad else 0


if __name__ == "__main__":
    sys.exit(main())
