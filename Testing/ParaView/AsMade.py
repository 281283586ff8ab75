# SPDX-License-Identifier: BSD-3-Clause
"""lacuna.as_made lays a part on its plan however it lies in its file, and tells where it deviates; mirrored parts, other units and other parts are found out."""
import os
import zipfile

import lacuna.plugin

lacuna.plugin.load()
import numpy as np
from lacuna import as_made
from lacuna.solids import save_solid
from lacuna_test import output
from paraview.simple import TrivialProducer
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance
from vtkmodules.vtkIOGeometry import vtkSTLWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

N = 41
BUMP, PLACE, WIDTH = 0.6, np.array([20.0, 10.0]), 5.0  # mm


def plate(bump=0.0, pit=0.0):
    """A curved plate of 4 mm without any symmetry, with a bump on its upper face and a pit elsewhere."""
    u, v = np.meshgrid(np.linspace(-1, 1, N), np.linspace(-1, 1, N), indexing="ij")
    x, y = 50 * u * (1 + 0.2 * v), 35 * v * (1 + 0.15 * u)
    low = np.sqrt(90**2 - x**2 - 1.3 * y**2) - 70 + 0.002 * x * y + 0.1 * x
    high = low + 4 + bump * np.exp(-((x - PLACE[0])**2 + (y - PLACE[1])**2) / (2 * WIDTH**2))
    high -= pit * np.exp(-((x + PLACE[0])**2 + (y + PLACE[1])**2) / (2 * WIDTH**2))
    points = np.concatenate([np.stack([x, y, high], -1).reshape(-1, 3), np.stack([x, y, low], -1).reshape(-1, 3)])
    index = np.arange(N * N).reshape(N, N)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
    ring = np.concatenate([index[:, 0], index[-1, 1:], index[-2::-1, -1], index[0, -2:0:-1]])
    following = np.roll(ring, -1)
    under = N * N
    return points, np.concatenate([np.stack(each, 1) for each in (
        (a, b, c), (a, c, d), (a + under, c + under, b + under), (a + under, d + under, c + under),
        (ring, ring + under, following), (following, ring + under, following + under))])


def surface(points, corners):
    return as_made._triangles(as_made._surface(points, corners), "plate")


def moved(points, turn, shift):
    return points @ as_made._rotation(np.array(turn)).T + shift


TURN, SHIFT = (1.2, -2.0, 0.7), np.array([300.0, -20.0, 55.0])
points, corners = plate()
plan = surface(points, corners)

# The same, turned and moved: the motion is found to a thousandth of a millimetre.
found = as_made.compare(plan, surface(moved(points, TURN, SHIFT), corners))
back = moved(points, TURN, SHIFT) @ found.matrix[:3, :3].T + found.matrix[:3, 3]
assert np.abs(back - points).max() < 1e-3, np.abs(back - points).max()
assert abs(np.linalg.det(found.matrix[:3, :3]) - 1) < 1e-9
assert not as_made.warnings(found), as_made.warnings(found)

# A bump and a pit are where they are, as high and deep as they are along the surface's normal, and the rest stays on the plan.
made, _ = plate(BUMP, BUMP)
found = as_made.compare(plan, surface(moved(made, TURN, SHIFT), corners))
there, back = as_made.deviation(found.part), as_made.deviation(found.plan)
exact = vtkImplicitPolyDataDistance()
exact.SetInput(plan)
true = max(exact.EvaluateFunction(*point) for point in made)
assert 0.4 < true < BUMP and abs(there.outward - true) < 0.01, (there.outward, true)
assert np.linalg.norm(there.outward_at[:2] - PLACE) < 2.5, there.outward_at
assert abs(back.outward - true) < 0.05 and np.linalg.norm(back.outward_at[:2] + PLACE) < 2.5, back
assert abs(there.inward + back.outward) < 0.05 and abs(there.mean) < 0.01, there
assert there.within[0] > 0.95 and there.within[2] == 1, there.within

# A mirrored part, files in inches, another part.
mirrored = surface(moved(points * [1, -1, 1], TURN, SHIFT), corners[:, ::-1])
assert any("mirror image" in one for one in as_made.warnings(as_made.compare(plan, mirrored)))
for scale, word in ((1 / 25.4, "25.4 times as small as the plan: the part's file seems to be in inches"), (1000, "the plan's file seems to be in metres"), (0.1, "the part's file seems to be in centimetres"), (3, "not the same part")):
    try:
        as_made.compare(plan, surface(points * scale, corners))
        raise AssertionError(scale)
    except ValueError as error:
        assert word in str(error), error
try:
    as_made.compare(surface(points / 25.4, corners), plan)
    raise AssertionError
except ValueError as error:
    assert "the plan's file seems to be in inches" in str(error), error

# A disc fits in any turn, and that is said.
angle = np.linspace(0, 2 * np.pi, 73)[:-1]
ring = np.stack([30 * np.cos(angle), 30 * np.sin(angle), 0 * angle], 1)
disc = np.concatenate([ring, ring + [0, 0, 4], [[0, 0, 0], [0, 0, 4]]])
k, n = np.arange(72), np.roll(np.arange(72), -1)
sides = np.concatenate([np.stack(each, 1) for each in ((n, k, k * 0 + 144), (k + 72, n + 72, k * 0 + 145), (k, n, n + 72), (k, n + 72, k + 72))])
disc = surface(disc, sides)
assert any("too symmetric" in one for one in as_made.warnings(as_made.compare(disc, disc)))

# Files: 3MF with its unit, STL, and the scan of a part in a turned volume, left-handed too.
home = os.path.abspath(output("AsMade"))
os.makedirs(home, exist_ok=True)
path = os.path.join(home, "plan.3mf")
source = TrivialProducer()
source.GetClientSideObject().SetOutput(plan)
save_solid(path, source)
again = as_made.read(path)
assert np.abs(np.array(again.GetBounds()) - plan.GetBounds()).max() < 1e-4 and abs(as_made._volume(again) / as_made._volume(plan) - 1) < 1e-6
with zipfile.ZipFile(path) as file:
    parts = {name: file.read(name) for name in file.namelist()}
inches = os.path.join(home, "inches.3mf")
with zipfile.ZipFile(inches, "w") as file:
    for name, content in parts.items():
        file.writestr(name, content.replace(b'unit="millimeter"', b'unit="inch"'))
assert abs(as_made._volume(as_made.read(inches)) / as_made._volume(plan) / 25.4**3 - 1) < 1e-6
for name, content in (("cut.3mf", b"PK"), ("empty.stl", b"solid x\nendsolid x\n")):
    with open(os.path.join(home, name), "wb") as file:
        file.write(content)
    try:
        as_made.read(os.path.join(home, name))
        raise AssertionError(name)
    except (ValueError, RuntimeError) as error:
        assert name in str(error), error

SPHERES = np.array([[0.0, 0, 0, 14], [20, 0, 0, 10], [0, 25, 3, 8], [4, 6, 18, 6]])  # centre and radius: not their own mirror image


def volume(step, rotation, handed, lie):
    """The CT of the spheres, whose middle is at lie, turned; left-handed indices where handed is -1."""
    turn = rotation @ np.diag([1.0, 1.0, handed])
    low, high = (SPHERES[:, :3] - SPHERES[:, 3:]).min(axis=0), (SPHERES[:, :3] + SPHERES[:, 3:]).max(axis=0)
    size = np.ceil((high - low) / step).astype(int) + 5
    origin = lie - turn @ (step * (size - 1) / 2)
    image = vtkImageData()
    image.SetDimensions(*size.tolist())
    image.SetSpacing(step, step, step)
    image.SetOrigin(*origin)
    image.SetDirectionMatrix(*turn.ravel())
    k, j, i = (axis.ravel() for axis in np.meshgrid(*(np.arange(count) for count in size[::-1]), indexing="ij"))
    places = (np.stack([i, j, k], 1) * step) @ turn.T + origin
    own = (places - lie) @ rotation + (low + high) / 2  # turned in the scanner, never mirrored
    depth = np.max([radius - np.linalg.norm(own - [x, y, z], axis=1) for x, y, z, radius in SPHERES], axis=0)
    array = numpy_to_vtk((1000 * np.clip(depth, -1.5, 1.5)).astype(np.float32), deep=True)
    array.SetName("HU")
    image.GetPointData().SetScalars(array)
    path = os.path.join(home, "scan.vti")
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(image)
    writer.Write()
    return as_made.read(path)


spheres = volume(0.8, np.eye(3), 1, np.zeros(3))
for handed in (1, -1):
    found = as_made.compare(spheres, volume(1.3, as_made._rotation(np.array([0.3, -0.5, 0.9])), handed, np.array([40.0, -30.0, 900.0])))
    there = as_made.deviation(found.part)
    assert not as_made.warnings(found) and abs(there.mean) < 0.02 and there.rms < 0.04, (there, as_made.warnings(found))

# The command.
stl = os.path.join(home, "part.stl")
writer = vtkSTLWriter()
writer.SetFileName(stl)
writer.SetInputData(surface(moved(made, TURN, SHIFT), corners))
writer.Write()
assert as_made.main([os.path.join(home, "plan.3mf"), stl, "--output", os.path.join(home, "part.vtp"), "--report", home]) == 0
with open(os.path.join(home, "index.html"), encoding="utf-8") as file:
    page = file.read()
assert "No warnings" in page and "plan.3mf" in page and home not in page
assert all(os.path.getsize(os.path.join(home, name)) > 5000 for name in ("outside.png", "inside.png", "histogram.png"))
written = as_made.read(os.path.join(home, "part.vtp"))
assert np.abs(np.array(written.GetBounds()) - plan.GetBounds()).max() < 1, written.GetBounds()
assert as_made.main([os.path.join(home, "none.stl"), stl]) == 1

# Without a screen the numbers are told, and one sentence says what to do
errors = []
as_made.print = lambda *texts, **_: errors.append(" ".join(map(str, texts)))
screen = os.environ.get("DISPLAY")
os.environ["DISPLAY"] = ":9973"
code = as_made.main([os.path.join(home, "plan.3mf"), stl, "--report", os.path.join(home, "no screen")])
assert "deviation of the part from the plan" in errors[0], errors
assert code == 0 or "the report is not written" in errors[-1] and "pvpython -- -m lacuna.as_made" in errors[-1], errors  # VTK 9.4 and later need no screen
del as_made.print
if screen is not None:
    os.environ["DISPLAY"] = screen
