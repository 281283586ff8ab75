# SPDX-License-Identifier: BSD-3-Clause
"""The command lacuna.implant makes a closed implant of a CT in a file, a report without the patient's name, and clear errors."""
import glob
import html
import importlib.util
import os
import re
import shutil
import subprocess

import lacuna.plugin

lacuna.plugin.load()
import numpy as np
from lacuna import implant, implant_report, solids
from lacuna.data import fetch
from lacuna.errors import PipelineError
from lacuna_test import output, picture_error
from paraview.simple import Delete, ExtractSubset, GetSources, SkullPhantom, TrivialProducer, XMLPolyDataReader
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkFeatureEdges, vtkMassProperties
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOGeometry import vtkSTLReader
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

home = os.path.abspath(output("Implant"))
shutil.rmtree(home, ignore_errors=True)
os.makedirs(home)
said = []
implant._say = lambda text: (said.append(text), print(text, flush=True))


def run(*arguments):
    """The command: its exit code, and what it printed."""
    said.clear()
    try:
        code = implant.main([str(each) for each in arguments])
    except SystemExit as end:
        code = end.code
    return code, "\n".join(said)


def printed_number(pattern, text):
    return float(re.search(pattern, text)[1])


phantom = SkullPhantom(Spacing=[2, 2, 2])
truth = phantom.GetClientSideObject()
named = fetch(phantom)
name = vtkStringArray()
name.SetName("PatientName")
name.InsertNextValue("Doe^Jane")
named.GetFieldData().AddArray(name)
ct = os.path.join(home, "head.vti")
writer = vtkXMLImageDataWriter()
writer.SetFileName(ct)
writer.SetDataModeToBinary()
writer.SetInputData(named)
writer.Write()
direction = np.array(phantom.DefectDirection) / np.linalg.norm(phantom.DefectDirection)
middle = np.array(phantom.Center) + direction * truth.IntersectOuterSurface(phantom.Center, direction)

# The largest hole, with a report
stl, report = os.path.join(home, "implant.stl"), os.path.join(home, "report")
code, text = run(ct, "--output", stl, "--report", report, "--plates", 3, "--drainage", 15, "--engrave", "L 7")
assert code == 0, text
reader = vtkSTLReader()
reader.SetFileName(stl)
clean = vtkCleanPolyData()
clean.SetInputConnection(reader.GetOutputPort())
edges = vtkFeatureEdges()
edges.SetInputConnection(clean.GetOutputPort())
edges.FeatureEdgesOff()
edges.NonManifoldEdgesOn()
edges.Update()
assert edges.GetOutput().GetNumberOfCells() == 0, "the STL is not closed"
mass = vtkMassProperties()
mass.SetInputConnection(clean.GetOutputPort())
volume = mass.GetVolume() / 1000
printed = printed_number(r"implant: ([\d.]+) ml", text)
print(f"{volume:.3f} ml in the file, {printed:.2f} ml printed")
assert volume > 5 and abs(volume - printed) < 0.02, (volume, printed)
center = np.array(clean.GetOutput().GetCenter())

# As STEP, with holes, engraving and bevels: one valid solid (the writer has OpenCASCADE judge it) of few faces
read = TrivialProducer()
read.GetClientSideObject().SetOutput(clean.GetOutput())
step = os.path.join(home, "implant.step")
try:
    solids.save_solid(step, read)
    with open(step, encoding="ascii") as file:
        lines = file.read()
    faces = lines.count("ADVANCED_FACE")
    print(f"{faces} faces in STEP of {clean.GetOutput().GetNumberOfCells()} triangles")
    assert lines.count("MANIFOLD_SOLID_BREP") == 1 and 1000 < faces < clean.GetOutput().GetNumberOfCells() / 2, faces
except PipelineError as error:
    assert "libocct" in str(error), error
    print(f"skipped: {error}")
Delete(read)
assert np.linalg.norm(center - middle) < 12, (center, middle)  # the phantom's hole is on the patient's left
assert "<- the implant closes this one" in text and "mm RMS" in text and "left" in text
# the outer surface is where the intact skull is
outer = vtk_to_numpy(clean.GetOutput().GetPoints().GetData()).astype(float) - np.array(phantom.Center)
radius = np.linalg.norm(outer, axis=1)
off = np.array([r - truth.IntersectOuterSurface(phantom.Center, list(p / r)) for r, p in zip(radius[::5], outer[::5])])
print(f"{off.max():.2f} mm outside of the intact skull at most")
assert -1 < off.max() < 1, off.max()
assert os.path.exists(stl + ".json")
# the report
with open(os.path.join(report, "index.html"), encoding="utf-8") as file:
    page = file.read()
pictures = re.findall('src="(.*?)"', page)
assert len(pictures) == 10 and all(os.path.basename(each) == each for each in pictures), pictures
has_pdf = importlib.util.find_spec("matplotlib") is not None
assert sorted(os.listdir(report)) == sorted(pictures + ["index.html"] + has_pdf * ["report.pdf"])
assert ("no report.pdf: that needs matplotlib" in text) != has_pdf, text
assert all(os.path.getsize(os.path.join(report, each)) > 10000 for each in pictures)
assert f"{printed:.2f} ml" in page and f"{1.18 * volume:.1f} g" in page and "head.vti" in page
assert "Research software, not a medical device" in page and lacuna.__version__ in page
for word in ("Doe", "Jane", home):
    for name in [os.path.join(report, "index.html"), stl + ".json"] + glob.glob(os.path.join(report, "*.png")):
        with open(name, "rb") as file:
            assert word.encode() not in file.read(), (word, name)
# the phantom's sides are alike within 0.6 mm, and the level adds some tenths on both sides
assert abs(printed_number(r"deviation from the mirrored other side, mean</td><td>([-+.\d]+) mm", page)) < 0.7, page
assert printed_number(r"the same, RMS</td><td>([.\d]+) mm", page) < 0.9, page
assert "<td>text in the inner face</td><td>L 7</td>" in page and "faces moved" not in page and "<td>parts</td>" not in page
assert page.count("screw in bone of") == 3 and printed_number(r"least distance from bone on the way in</td><td>([.\d]+) mm", page) > 0.1, page  # of voxels of 2 mm
if has_pdf and shutil.which("pdftotext"):  # another program reads it
    pdf = subprocess.run(["pdftotext", "-layout", os.path.join(report, "report.pdf"), "-"], check=True, stdout=subprocess.PIPE).stdout.decode()
    for title, value in re.findall("<tr><td>(.*?)</td><td>(.*?)</td></tr>", page):
        for word in html.unescape(f"{title} {value}").split():
            assert word in pdf, (word, pdf)
    images = subprocess.run(["pdfimages", "-list", os.path.join(report, "report.pdf")], check=True, stdout=subprocess.PIPE).stdout.decode()
    assert len(re.findall(r"\d image ", images)) == 10, images
    assert "Doe" not in pdf and home not in pdf
else:
    print("the PDF is not read: pdftotext or matplotlib is missing")
for proxy in list(GetSources().values()):
    Delete(proxy)

# How far an implant is from the mirrored other side: a head in a turned, anisotropic grid, whose right side is a sphere of 80 mm and whose left
# one is wider. The implant on the left has a radius of 80.7 mm below, of 81.5 mm above, and its uppermost part has no bone on the other side.
turn = np.array([[0.0, 0.8, -0.6], [1, 0, 0], [0, 0.6, 0.8]])  # its columns are the grid's axes
origin, plane = np.array([5.0, -7, 11]), np.array([0.6, 0.8, 0])
spacing, size = np.array([1.5, 1.9, 2.3]), np.array([130, 104, 84])
corner = origin - turn @ (spacing * (size - 1) / 2)
k, j, i = np.meshgrid(*(np.arange(n) for n in size[::-1]), indexing="ij")
x = np.stack([i, j, k], axis=-1) * spacing @ turn.T + corner - origin
left, up = x @ plane, x[..., 2]
r = np.linalg.norm(x, axis=-1)
depth = np.minimum(np.where(left > 0, 84, 80) - r, r - 74)
depth[(left < 0) & (up > 40)] = -3
head = vtkImageData()
head.SetDimensions(*map(int, size))
head.SetSpacing(*spacing)
head.SetOrigin(*corner)
head.SetDirectionMatrix(*turn.ravel())
grey = numpy_to_vtk((300 + 100 * depth).ravel(), deep=True)
grey.SetName("CT")
head.GetPointData().SetScalars(grey)
ball = vtkSphereSource()
ball.SetThetaResolution(180)
ball.SetPhiResolution(180)
ball.Update()
solid = ball.GetOutput()
unit = vtk_to_numpy(solid.GetPoints().GetData()).astype(float)
unit /= np.linalg.norm(unit, axis=1)[:, None]
points = vtkPoints()
points.SetDataTypeToDouble()
points.SetData(numpy_to_vtk(origin + unit * np.where(unit[:, 2] > 0, 81.5, 80.7)[:, None], deep=True))
solid.SetPoints(points)
middles = unit[vtk_to_numpy(solid.GetPolys().GetConnectivityArray()).reshape(-1, 3)].mean(axis=1)
part = middles @ plane > 0.4
height = middles[:, 2]
far = (np.abs(height) > 0.03) & (np.abs(height - 0.5) > 0.08)  # from the implant's step, and from the bone's edge
face = numpy_to_vtk(np.where(part & (height > -0.3) & (height < 0.7) & far, 0, 2), deep=True)
face.SetName("ImplantFace")
solid.GetCellData().AddArray(face)
off = implant_report.mirror_deviation(head, 300, solid, origin + [0.8, -0.6, 3], 3 * plane)
corners = unit[vtk_to_numpy(solid.GetPolys().GetConnectivityArray()).reshape(-1, 3)]
areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) * (vtk_to_numpy(face) == 0)
upper, lower, bare = (areas[which].sum() for which in ((height > 0) & (height < 0.5), height < 0, height > 0.5))
mean, rms = (((0.7**power * lower + 1.5**power * upper) / (upper + lower)) ** (1 / power) for power in (1, 2))
print(off, mean, rms)
assert abs(off.mean - mean) < 0.05 and abs(off.rms - rms) < 0.05 and abs(off.largest - 1.5) < 0.15, (off, mean, rms)
assert off.place[2] > origin[2] and (off.place - origin) @ plane > 0  # where the implant is, not mirrored
assert abs(off.covered - (upper + lower) / (upper + lower + bare)) < 0.02, off.covered
low = implant_report.mirror_deviation(head, 300, solid, origin + plane, plane)  # the plane 1 mm to the left: the other side seems 2 mm farther out
assert off.mean - 2 < low.mean < off.mean - 1, low.mean

# Without a screen the implant is kept, and one sentence says what to do
errors = []
implant.print = lambda *texts, **_: errors.append(" ".join(map(str, texts)))
screen = os.environ.get("DISPLAY")
os.environ["DISPLAY"] = ":9973"
alone = os.path.join(home, "alone.stl")
code, text = run(ct, "--output", alone, "--report", os.path.join(home, "no screen"), "--plates", 3, "--drainage", 15, "--engrave", "L 7")
assert os.path.getsize(alone) == os.path.getsize(stl) and "implant: " in text, text
if code == 0:  # VTK 9.4 and later draw without a screen
    assert not errors and picture_error(os.path.join(home, "no screen", "implant.png"), os.path.join(report, "implant.png")) < 10, errors
else:
    assert len(errors) == 1 and "the implant is written, the report is not" in errors[0] and "xvfb-run" in errors[0], errors
del implant.print
if screen is not None:
    os.environ["DISPLAY"] = screen

# The side in words is that of the head, which need not be in the middle of the scan, nor straight: here its right half alone is
tilt = np.radians(20)
sides = vtkSphereSource()
sides.Update()
for field, numbers in (("Origin", [[-4.0, 1, 3]]), ("Normal", [[-np.cos(tilt), np.sin(tilt), 0]])):  # turned to the left: y is the back
    array = numpy_to_vtk(np.array(numbers), deep=True)
    array.SetName("SymmetryPlane" + field)
    sides.GetOutput().GetFieldData().AddArray(array)
shown = TrivialProducer()
shown.GetClientSideObject().SetOutput(sides.GetOutput())
whole = SkullPhantom(Spacing=[5, 5, 5])
size = fetch(whole).GetExtent()
half = ExtractSubset(Input=whole, VOI=[size[0], (size[0] + size[1]) // 2, *size[2:]])
half.UpdatePipeline()
place = implant.places(implant.Made(half, shown, None, None))
for point, words in ([-34, 1, 63], "top right"), ([26, 1, 63], "top left"), ([-4 - 80 * np.sin(tilt), 1 - 80 * np.cos(tilt), 3], "front"):
    assert place(point).endswith(f" mm ({words})"), (place(point), words)

# Another skull as a template: the phantom without its hole
whole = SkullPhantom(Spacing=[2.5, 2.5, 2.5], DefectRadius=0)
other = os.path.join(home, "other.vti")
writer.SetFileName(other)
writer.SetInputData(fetch(whole))
writer.Write()
code, text = run(ct, "--output", os.path.join(home, "templated.stl"), "--template", other)
assert code == 0, text
assert printed_number(r"template: ([.\d]+) mm RMS from the sound bone", text) < 0.5, text
assert abs(printed_number(r"scaled by ([.\d]+);", text) - 1) < 0.01, text

# A point near the hole gives the same implant, in another format
vtp = os.path.join(home, "implant.vtp")
code, text = run(ct, "--output", vtp, "--hole", *(middle + 5), "--clearance", 0.5, "--plates", 3, "--drainage", 15, "--engrave", "L 7")
assert code == 0 and printed_number(r"implant: ([\d.]+) ml", text) == printed, text
back = fetch(XMLPolyDataReader(FileName=[vtp]))
assert np.allclose(back.GetBounds(), clean.GetOutput().GetBounds(), atol=1e-3), back.GetBounds()
assert back.GetPointData().GetArray("PredictedError").GetRange()[0] > 0 and back.GetCellData().HasArray("ImplantFace")

# What fails says so in one sentence and leaves no file
errors = []
implant.print = lambda *texts, **_: errors.append(" ".join(map(str, texts)))
far = os.path.join(home, "far.stl")
assert run(ct, "--output", far, "--hole", 300, 0, -13.5)[0] == 1
assert len(errors) == 1 and re.search(r"^lacuna.implant: .*--hole \(300.0, 0.0, -13.5\) mm is \d.* mm away from the nearest hole", errors[0]), errors
errors.clear()
assert run(ct, "--output", far, "--template", os.path.join(home, "none.stl"))[0] == 1 and "--template: there is no file" in errors[0], errors
errors.clear()
words = os.path.join(home, "words.txt")
with open(words, "w", encoding="ascii") as file:
    file.write("no CT\n")
for wrong, what in ((words, "volumes are read from"), (os.path.join(home, "none.mha"), "there is no such file")):
    errors.clear()
    assert run(wrong, "--output", far)[0] == 1
    assert len(errors) == 1 and what in errors[0] and "Traceback" not in errors[0], errors
assert not os.path.exists(far)
assert run(ct)[0] == 2 and run(ct, "--output", "implant.doc")[0] == 2 and run(ct, "--output", os.path.join(home, "none", "a.stl"))[0] == 2
assert run(ct, "--output", far, "--clearance", -1)[0] == 2 and run(ct, "--output", far, "--hole", 1, 2)[0] == 2
assert run(ct, "--output", far, "--report", words)[0] == 2 and run("--help")[0] == 0
