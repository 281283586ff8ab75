# SPDX-License-Identifier: BSD-3-Clause
"""Scan Region through ParaView: a made-up scanner's screen as a stack, as a picture, and cropped."""
import os

import numpy as np
from paraview.simple import *
from paraview import servermanager
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGWriter

from lacuna_test import check_defaults, output
from tracked_slice_files import open_slices

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna import macros, vtkLacunaScanRegion
from lacuna.errors import PipelineError, raising

WIDTH, HEIGHT = 640, 480
ORIGIN, ANGLES, RADII = (300.0, -60.0), (-31.0, 29.0), (110.0, 470.0)
PITCH, FIRST = 21.37, 44.6
row, column = np.mgrid[:HEIGHT, :WIDTH]
radius = np.hypot(column - ORIGIN[0], row - ORIGIN[1])
angle = np.degrees(np.arctan2(column - ORIGIN[0], row - ORIGIN[1]))
sees = (radius >= RADII[0]) & (radius <= RADII[1]) & (angle >= ANGLES[0]) & (angle <= ANGLES[1])


def screen(seed):
    """Speckle in a sector, a panel of letters, a grey bar, and a ruler, one tick in five longer."""
    random = np.random.default_rng(seed)
    grey = np.zeros((HEIGHT, WIDTH))
    wave = random.normal(size=(2, HEIGHT, WIDTH))
    speckle = np.hypot(*(wave + np.roll(wave, 1, 2) + np.roll(wave, 2, 2)))
    tissue = 1 + 0.4 * np.sin(column / 40 + seed) * np.cos(row / 33)
    grey[sees] = np.clip(4 + 25 * speckle * tissue, 0, 255)[sees]
    letters = np.random.default_rng(0).random((HEIGHT // 2, WIDTH)) < 0.5
    text = np.repeat(letters, 2, axis=0) & (column % 8 < 5) & (row % 18 < 12)
    grey[text & (column > 6) & (column < 60) & (row > 60) & (row < 400)] = 200
    grey[text & (row < 16) & (column > 380) & (column < 560)] = 200
    grey[120:300, 620:632] = np.linspace(255, 0, 180)[:, None]
    for k in range(18):
        y = round(FIRST + k * PITCH)
        grey[y, 570:(584 if k % 5 == 0 else 577)] = 170
    grey[round(FIRST):round(FIRST + 17 * PITCH), 570] = 170
    return grey.astype(np.uint8)


def field(data, name):
    return vtk_to_numpy(data.GetFieldData().GetArray(name))[0]


def check(data, sure=0.3):
    assert np.abs(field(data, "FanOrigin") - ORIGIN).max() < 3, field(data, "FanOrigin")
    assert np.abs(field(data, "FanAngles") - ANGLES).max() < 0.5, field(data, "FanAngles")
    assert np.abs(field(data, "FanRadiiInPixels") - RADII).max() < 3
    columns, rows = np.flatnonzero(sees.any(axis=0)), np.flatnonzero(sees.any(axis=1))
    box = [columns[0], rows[0], len(columns), len(rows)]
    assert np.abs(field(data, "ClipRectangle") - box).max() <= 3, (field(data, "ClipRectangle"), box)
    tick, error = field(data, "DepthTick")
    assert abs(tick - PITCH) < 3 * error < 0.1, (tick, error)
    assert sure < field(data, "Confidence") <= 1, field(data, "Confidence")


stack = open_slices("ScanRegion", np.array([screen(n) for n in range(8)]), [np.eye(4)] * 8)
proxy = ScanRegion(Input=stack)
check_defaults(proxy, vtkLacunaScanRegion(), ["TickLength", "PixelAspect"])
with raising():
    proxy.UpdatePipeline()
table = servermanager.Fetch(proxy)
check(table, sure=0.9)
# mm are not assumed
assert table.GetFieldData().GetArray("PixelSpacing") is None
assert table.GetFieldData().GetArray("FanRadii") is None
proxy.TickLength = 5
with raising():
    proxy.UpdatePipeline()
table = servermanager.Fetch(proxy)
spacing = field(table, "PixelSpacing")
assert np.abs(spacing - 5 / PITCH).max() < 2e-3 * 5 / PITCH, spacing
assert np.abs(field(table, "FanRadii") - 5 / PITCH * np.array(RADII)).max() < 0.7
words = [table.GetColumnByName("Quantity").GetValue(i) for i in range(table.GetNumberOfRows())]
assert words == ["Confidence", "ClipRectangle", "FanOrigin", "FanAngles", "FanRadiiInPixels",
                 "DepthTick", "WidthTick", "PixelSpacing", "FanRadii"], words
remark = table.GetColumnByName("Remark").GetValue(5)
assert "one in 5 is longer" in remark and "if a tick is 10 mm" in remark, remark
assert table.GetColumnByName("Value").GetValue(6) == "not found"

# The second output lies on the screen.
overlay = proxy.GetClientSideObject().GetOutputDataObject(1)
part = vtk_to_numpy(overlay.GetCellData().GetArray("Part"))
assert sorted(set(part)) == [0, 1, 2] and (part == 2).sum() == 18
x0, x1, y0, y1 = overlay.GetBounds()[:4]
assert 0 <= x0 < x1 <= WIDTH and 0 <= y0 < y1 <= HEIGHT

# Swept Volume takes the values as they are.
volume = SweptVolume(Input=stack, OutputSpacing=[4, 4, 4], FanOrigin=list(field(table, "FanOrigin")),
                     FanAngles=list(field(table, "FanAngles")),
                     FanRadii=list(field(table, "FanRadiiInPixels")),
                     ClipRectangle=[int(v) for v in field(table, "ClipRectangle")])
volume.Interpolation = "NearestVoxel"
with raising():
    volume.UpdatePipeline()

# Cropped, the numbers are those of the screen.
crop = ExtractSubset(Input=stack, VOI=[56, 639, 20, 479, 0, 7])
cropped = ScanRegion(Input=crop)
with raising():
    cropped.UpdatePipeline()
check(servermanager.Fetch(cropped), sure=0.9)

# A picture of the screen, which VTK reads with the bottom row first.
picture = vtkImageData()
picture.SetDimensions(WIDTH, HEIGHT, 1)
colours = np.repeat(screen(3)[::-1, :, None], 3, axis=2)
picture.GetPointData().SetScalars(numpy_to_vtk(colours.reshape(-1, 3), deep=1))
writer = vtkPNGWriter()
writer.SetInputData(picture)
writer.SetFileName(output("ScanRegion.png"))
writer.Write()
png = ScanRegion(Input=PNGSeriesReader(FileNames=[output("ScanRegion.png")]))
with raising():
    png.UpdatePipeline()
check(servermanager.Fetch(png))
bounds = png.GetClientSideObject().GetOutputDataObject(1).GetBounds()
assert abs(bounds[3] - (HEIGHT - 1 - field(table, "ClipRectangle")[1]) - 0.5) < 3, bounds

# In a dark bath only streaks change: a proposal, with a warning. All slices are looked at: the far end
# of the sector is seen in one slice only, which is none of the 32 for the other ways.
random = np.random.default_rng(5)
baths = []
for n in range(60):
    bath = screen(0)
    bath[sees] = 0
    streaks = np.zeros(bath.shape, bool)
    for x, y in zip(random.integers(8, WIDTH - 8, 120), random.integers(2, HEIGHT - 2, 120)):
        streaks[y - 1:y + 2, x - 6:x + 7] = True
    bath[streaks & sees & (radius < 440)] = 9 + n % 5
    if n == 2:
        bath[sees & (radius > 460)] = 9
    baths.append(bath)
bath = open_slices("ScanRegionBath", np.array(baths), [np.eye(4)] * len(baths))
proxy = ScanRegion(Input=bath)
warnings = []
with raising(warnings):
    proxy.UpdatePipeline()
table = servermanager.Fetch(proxy)
assert 0.3 < field(table, "Confidence") < 0.5, field(table, "Confidence")
assert any("the true region may be larger" in warning for warning in warnings), warnings
assert "the true region may be larger" in table.GetColumnByName("Remark").GetValue(0)
x, y = field(table, "FanOrigin")
angles, radii = field(table, "FanAngles"), field(table, "FanRadiiInPixels")
assert abs(radii[1] + y - RADII[1] - ORIGIN[1]) < 3, (y, radii)
left, top, width, height = field(table, "ClipRectangle")
away = np.hypot(column - x, row - y)
to = np.degrees(np.arctan2(column - x, row - y))
proposed = ((away >= radii[0]) & (away <= radii[1]) & (to >= angles[0]) & (to <= angles[1]) & (column >= left)
            & (column < left + width) & (row >= top) & (row < top + height))
assert (proposed & sees).sum() > 0.95 * (proposed | sees).sum(), (x, y, angles, radii)
changes = np.ptp(np.array(baths), axis=0) > 0
assert proposed[changes].mean() > 0.999, proposed[changes].mean()
# Nothing takes it by itself.
assert macros._fan_mask(servermanager.Fetch(stack)) == "Automatic"
assert macros._fan_mask(servermanager.Fetch(bath)) == "None"
try:
    with raising():
        SweptVolume(Input=bath, FanMask="Automatic", Interpolation="NearestVoxel").UpdatePipeline()
    raise AssertionError("a fan is found in the bath")
except PipelineError as error:
    assert "Scan Region may propose" in str(error), error

# What cannot be is said.
frozen = open_slices("ScanRegionFrozen", np.array([baths[0]] * 4), [np.eye(4)] * 4)
black = open_slices("ScanRegionBlack", np.zeros((1, 60, 60), np.uint8), [np.eye(4)])
for source, settings, words in [
        (black, {}, "the scan region is not found"), (black, {}, "Give several frames"),
        (frozen, {}, "no outline can be proposed either: besides texts nothing changes"),
        (stack, {"PixelAspect": -1}, "PixelAspect is -1"), (stack, {"TickLength": -2}, "TickLength is -2")]:
    bad = ScanRegion(Input=source, **settings)
    try:
        with raising():
            bad.UpdatePipeline()
        raise AssertionError("taken: " + words)
    except PipelineError as error:
        assert words in str(error), (words, error)
