# SPDX-License-Identifier: BSD-3-Clause
"""Slice Ray Caster through ParaView: defaults, known surfaces, other ways to the same surface, growth, cameras, state."""
import os

import numpy as np
from paraview.simple import *
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

from lacuna_test import check_defaults, compare_with_baseline, output

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
import lacuna
from lacuna import pictures, views


def fetch(proxy):
    proxy.UpdatePipeline()
    return servermanager.Fetch(proxy)


def depths(image):
    """Depth of each pixel (row, column)."""
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetArray("Depth")).reshape(height, width)


def rays(image):
    """Where the rays start (row, column, 3), and their direction."""
    matrix = np.array(image.GetFieldData().GetArray("ImageToWorld").GetTuple(0)).reshape(4, 4)
    width, height, _ = image.GetDimensions()
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    return x[..., None] * matrix[:3, 0] + y[..., None] * matrix[:3, 1] + matrix[:3, 3], matrix[:3, 2]


def rotation(axis, degrees):
    a, b = [i for i in range(3) if i != axis]
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrix = np.eye(3)
    matrix[a, a] = matrix[b, b] = c
    matrix[a, b], matrix[b, a] = (-s, s) if axis != 1 else (s, -s)
    return matrix


def ellipsoid(p):
    """Below 0 in the main ellipsoid of Phantom Sweep."""
    q = (p - (-3, 2, 1)) @ (rotation(2, 20) @ rotation(1, -15)) / (17, 12, 15)
    return (q ** 2).sum(-1) - 1


def kumara(p):
    """Below 0 in the kumara of Phantom Sweep, which equals no mirror image of itself."""
    z = p[..., 2] / 95
    t = 1 + 0.2 * z
    u = (p[..., 0] - 16 * (z * z - 0.06)) / (38.75 * t)
    v = (p[..., 1] - 9 * z * (1 - z * z)) / (43 * t)
    return np.where(np.abs(z) > 1.2, 1, u * u + v * v + z * z - 1)


def true_depths(inside, start, ray):
    """First root of a function along each ray; NaN without one."""
    t = np.arange(0, 300, 1.0)
    first = np.full(start.shape[:-1], np.nan)
    for row in np.ndindex(start.shape[:-2]):
        solid = inside(start[row][:, None, :] + t[:, None] * ray) < 0
        first[row] = np.where(solid.any(-1), t[solid.argmax(-1)], np.nan)
    low, high = first - 1, first
    for _ in range(40):
        middle = 0.5 * (low + high)
        solid = inside(start + np.nan_to_num(middle)[..., None] * ray) < 0
        low, high = np.where(solid, low, middle), np.where(solid, middle, high)
    return high


def slopes(depth, spacing):
    """Steepness of true depths, mm per mm."""
    down, right = np.gradient(depth, spacing)
    return np.hypot(down, right)


def check_panel():
    proxy = SliceRayCaster(Input=PhantomSweep(NumberOfSlices=2, ImageSize=[8, 8]))
    own = lacuna.vtkLacunaSliceRayCaster()
    enumerations = {"SolidSide": ["Above", "Below"], "BadPoses": ["Refuse", "LeaveOut", "KeepOutliers"],
                    "GapMethod": ["Automatic", "Given", "Unlimited"]}
    names = ["IsoValue", "MaximumGap", "ViewDirection", "ViewUp", "FocalPoint", "PlaneOrigin",
             "PixelSpacing", "ImageSize", "ClipRectangle", "FanOrigin", "FanAngles", "FanRadii",
             "UseTooFast", "UseGatedOut", "UseImageInvalid"]
    check_defaults(proxy, own, names, enumerations)
    Delete(proxy)


def check_truth(name, sweep, inside, direction, gap, **properties):
    """Errors against a surface in closed form, where it is not too steep. gap: mm between samples along a ray."""
    caster = SliceRayCaster(Input=sweep, ViewDirection=direction, ViewUp=[0, -1, 0], **properties)
    image = fetch(caster)
    start, ray = rays(image)
    step = max(1, image.GetDimensions()[0] // 60)
    start = start[::step, ::step]
    depth = depths(image)[::step, ::step]
    truth = true_depths(inside, start, ray)
    gentle = slopes(truth, step * image.GetSpacing()[0]) < 1.5
    error = (depth - truth)[gentle]
    print(f"{name}: {gentle.sum()} pixels, gap {gap:.2f} mm, rms {np.sqrt((error ** 2).mean()):.3f}, "
          f"worst {np.abs(error).max():.3f}, mean {error.mean():.3f} mm", flush=True)
    assert gentle.sum() > 200
    # edges 1.5 mm wide are linear over part of a gap; sharp ones would be off by up to half of it
    assert np.abs(error).max() < 0.25 * gap
    assert np.sqrt((error ** 2).mean()) < 0.15 * gap
    # nothing in front of the object, and nothing beside it
    assert not np.isfinite(depth[~np.isfinite(truth) & (np.abs(inside(start)) > 50)]).any()
    # its mirror image is another object
    def mirrored(p):
        return inside(p * (-1, 1, 1))
    other = (depth - true_depths(mirrored, start, ray))[gentle]
    assert np.nanmean(np.abs(other)) > 10 * np.abs(error).mean(), "mirror images are told apart"
    Delete(caster)


def check_against_volume(sweep):
    """The same view of the volume made of the same slices."""
    view = dict(ViewDirection=[-0.2, 0.3, 1], ViewUp=[0, -1, 0], FocalPoint=[-3, 2, 1], PlaneOrigin=[0, 0, -40],
                PixelSpacing=0.5, ImageSize=[61, 49])
    direct = fetch(SliceRayCaster(Input=sweep, IsoValue=120, **view))
    volume = SweptVolume(Input=sweep, OutputSpacing=[0.4, 0.4, 0.4], PixelSampling="Bilinear")
    made = fetch(BSplineIsoRayCaster(Input=volume, IsoValues=[120], Interpolation="Trilinear", **view))
    for get in (lambda i: i.GetDimensions(), lambda i: i.GetOrigin(), lambda i: i.GetSpacing(),
                lambda i: i.GetFieldData().GetArray("ImageToWorld").GetTuple(0)):
        assert get(direct) == get(made), (get(direct), get(made))
    start, ray = rays(direct)
    gentle = slopes(true_depths(ellipsoid, start, ray), 0.5) < 1.5
    difference = (depths(direct) - depths(made))[gentle]
    print(f"against the volume: {gentle.sum()} pixels, rms {np.sqrt((difference ** 2).mean()):.3f}, "
          f"worst {np.abs(difference).max():.3f} mm", flush=True)
    # as far as each is from the truth: slices 0.5 mm apart, voxels of 0.4 mm
    assert gentle.sum() > 1000
    assert np.abs(difference).max() < 0.1 and np.sqrt((difference ** 2).mean()) < 0.03


def check_vessels():
    """Dark fluid is solid when asked for; the map as a surface."""
    sweep = PhantomSweep(Anatomy="Vessels", NumberOfSlices=100)
    caster = SliceRayCaster(Input=sweep, IsoValue=87.5, SolidSide="Below", ViewDirection=[0.3, 0.2, 1])
    image = fetch(caster)
    truth = sweep.GetClientSideObject()
    start, ray = rays(image)
    depth = depths(image)
    found = np.argwhere(np.isfinite(depth))
    assert 3000 < len(found) < 0.5 * depth.size, len(found)
    for row, column in found[::97]:
        point = start[row, column] + depth[row, column] * ray
        values = [truth.EvaluateTruth(*(point + d * ray)) for d in (-0.55, 0.55)]
        assert max(values) > 60 and min(values) < 115, (point, values)
    mask = vtk_to_numpy(image.GetPointData().GetArray("vtkValidPointMask"))
    assert mask.dtype == np.int8 and mask.sum() == len(found)
    surface = fetch(DepthMapSurface(Input=caster))
    assert surface.GetNumberOfPoints() == len(found)
    # the nine cases once more, by the shader's own code
    shaded = fetch(DepthMapShader(Input=caster, NormalMethod="Predicate"))
    own, other = (vtk_to_numpy(i.GetPointData().GetArray("Normals")) for i in (image, shaded))
    assert np.abs(own).max() > 0.9
    np.testing.assert_allclose(own, other, atol=2e-6)


def check_growth(sweep):
    """Slices that come later are cast alone, and all the same."""
    part = ExtractSubset(Input=sweep)
    caster = SliceRayCaster(Input=part, IsoValue=120, ViewDirection=[0, 0.2, 1], ViewUp=[0, -1, 0],
                            FocalPoint=[0, 0, 0], PlaneOrigin=[0, 0, -40], PixelSpacing=0.5, ImageSize=[128, 96])
    before = 0
    for count in (10, 11, 40, 100):
        part.VOI = [0, 319, 0, 239, 0, count - 1]
        grown = depths(fetch(caster)).copy()
        assert caster.GetClientSideObject().GetNumberOfCastSlices() == count - before
        before = count
    whole = SliceRayCaster(Input=sweep)
    for name in ("IsoValue", "ViewDirection", "ViewUp", "FocalPoint", "PlaneOrigin", "PixelSpacing", "ImageSize"):
        setattr(whole, name, getattr(caster, name))
    expected = depths(fetch(whole))
    assert np.isfinite(expected).sum() > 1000
    np.testing.assert_array_equal(grown, expected)


def check_camera(sweep):
    """A caster with a view's camera shows what the view shows, pixel by pixel."""
    view = CreateView("RenderView")
    view.ViewSize = [400, 300]
    camera = view.GetActiveCamera()
    camera.SetPosition(30, -70, -120)
    camera.SetFocalPoint(-2, 3, 1)
    camera.SetViewUp(0.2, -1, 0.1)
    volume = SweptVolume(Input=sweep, OutputSpacing=[1, 1, 1])
    casters = [SliceRayCaster(Input=sweep, IsoValue=120), BSplineIsoRayCaster(Input=volume, IsoValues=[120])]
    for parallel, rows in ((1, None), (0, 75), (1, 150)):
        camera.SetParallelProjection(parallel)
        camera.SetParallelScale(25)
        for caster in casters:
            SetActiveView(view)
            views.copy_camera(caster, rows=rows)
            image = fetch(caster)
            height = rows or 300
            assert image.GetDimensions() == (height * 4 // 3, height, 1)
            start, ray = rays(image)
            depth = depths(image)
            assert np.isfinite(depth).sum() > 0.02 * depth.size
            # points at the depth of the focal point, on the screen
            eye = image.GetFieldData().GetArray("EyePosition")
            assert (eye is not None) == (caster is casters[1] and not parallel)
            if eye is None:
                near = start + np.linalg.norm(np.subtract(camera.GetFocalPoint(), camera.GetPosition())) * ray
            else:
                assert np.allclose(eye.GetTuple(0), camera.GetPosition())
                near = start
            matrix = camera.GetCompositeProjectionTransformMatrix(4 / 3, -1, 1)
            for row, column in ((0, 0), (height - 1, 3), (height // 3, height)):
                x, y, _, w = matrix.MultiplyPoint((*near[row, column], 1))
                assert abs((x / w + 1) / 2 * height * 4 / 3 - (column + 0.5)) < 1e-6 * height
                assert abs((1 - y / w) / 2 * height - (row + 0.5)) < 1e-6 * height
    for wrong in (0, 2.5, -3):
        try:
            views.copy_camera(casters[0], view, rows=wrong)
        except ValueError as error:
            assert "at least one row" in str(error)
        else:
            raise AssertionError(wrong)


def check_picture():
    """The picture of the user guide: the quick look beside the surface of a volume."""
    sweep = PhantomSweep(Anatomy="Kumara", ImageSize=[300, 280], PixelSpacing=0.4, Travel=210, NumberOfSlices=200,
                         SpeckleLevel=0.15)
    filtered = SpeckleFilter(Input=sweep, KernelSize=[7, 7, 1])
    look = dict(ViewDirection=[0.75, 0.45, 1], ViewUp=[0, -1, 0])
    direct = DepthMapSurface(Input=SliceRayCaster(Input=filtered, IsoValue=110, **look))
    volume = SweptVolume(Input=filtered, OutputSpacing=[1, 1, 1])
    smooth = DepthMapSurface(Input=BSplineIsoRayCaster(Input=volume, IsoValues=[110], **look))
    ray = np.divide(look["ViewDirection"], np.linalg.norm(look["ViewDirection"]))
    right = np.cross(ray, look["ViewUp"])
    aside = Transform(Input=smooth)
    aside.Transform.Translate = list(130 * right / np.linalg.norm(right))
    view = pictures.new_view((1000, 420))
    view.OrientationAxesVisibility = 0
    pictures.show_surface(direct, view, pictures.TISSUE)
    pictures.show_surface(aside, view, pictures.TISSUE)
    pictures.look(view, look["ViewDirection"], look["ViewUp"], 2.1)
    picture = output("slice-ray-caster.png")
    pictures.save(view, picture)
    compare_with_baseline(picture, "slice-ray-caster.png", 40)


def check_state():
    state = output("SliceRayCaster.pvsm")
    sweep = PhantomSweep(NumberOfSlices=20, ImageSize=[60, 50], PixelSpacing=1)
    caster = SliceRayCaster(registrationName="Cast", Input=sweep, IsoValue=110, SolidSide="Below", MaximumGap=2.5,
                            ViewDirection=[0, 0, 1], FocalPoint=[1, 2, 3], ImageSize=[30, 20])
    before = depths(fetch(caster)).copy()
    SaveState(state)
    ResetSession()
    LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
    LoadState(state)
    loaded = FindSource("Cast")
    assert loaded.SolidSide == "Below" and loaded.MaximumGap == 2.5 and list(loaded.FocalPoint) == [1, 2, 3]
    np.testing.assert_array_equal(depths(fetch(loaded)), before)


check_panel()
sweep = PhantomSweep()
check_truth("ellipsoid", sweep, ellipsoid, [0, 0, 1], 50 / 59, IsoValue=120)
check_truth("ellipsoid, oblique", sweep, ellipsoid, [0.4, -0.3, -1], 50 / 59 * np.sqrt(1.25), IsoValue=120)
wild = PhantomSweep(Motion="Arbitrary", NumberOfSlices=100)
check_truth("ellipsoid, arbitrary motion", wild, ellipsoid, [0, 0, 1], 50 / 99, IsoValue=120)
potato = PhantomSweep(Anatomy="Kumara", ImageSize=[300, 280], PixelSpacing=0.4, Travel=210, NumberOfSlices=150)
check_truth("kumara", potato, kumara, [0, 0, 1], 210 / 149, IsoValue=110)
check_truth("kumara, oblique", potato, kumara, [0.4, 0.3, -1], 210 / 149 * np.sqrt(1.25), IsoValue=110)
check_against_volume(wild)
check_vessels()
check_growth(wild)
check_camera(wild)
check_picture()
check_state()
print("ok")
