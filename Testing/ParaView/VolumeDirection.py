# SPDX-License-Identifier: BSD-3-Clause
"""Volumes say twice how they are turned. Behind a filter of ParaView that resets the directions Lacuna
stops; behind all others, and behind its own, a letter F comes out where it was in the patient."""
import os
import shutil
import subprocess
import sys

import lacuna
import lacuna_test
import numpy as np
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
from lacuna import coordinates
from lacuna.errors import PipelineError, raising
folder = lacuna_test.output("Volume direction")
shutil.rmtree(folder, ignore_errors=True)
subprocess.run([sys.argv[1], folder], check=True)
ARRAY = "DirectionMatrix"
SERIES = ("body axial", "body feet first", "body oblique")  # the first has no turn to lose


def directions(proxy):
    """The direction matrix of an image and its record (None without), row by row."""
    image = servermanager.Fetch(proxy)
    record = image.GetFieldData().GetArray(ARRAY)
    return (np.array(image.GetDirectionMatrix().GetData()),
            None if record is None else vtk_to_numpy(record)[0])


def centroid(volume):
    """Of the surface of the letter as seen from the front."""
    depth = BSplineIsoRayCaster(Input=volume, ScalarArray="HounsfieldUnits", IsoValues=[300], ViewDirection=[0, 1, 0],
                                ViewUp=[0, 0, 1])
    surface = DepthMapSurface(Input=depth)
    surface.UpdatePipeline()
    return vtk_to_numpy(servermanager.Fetch(surface).GetPoints().GetData()).mean(axis=0)


def refusal(proxy):
    """The error with which a filter stops, or an empty text."""
    try:
        with raising():
            proxy.UpdatePipeline()
    except PipelineError as error:
        return str(error)
    return ""


def warp(volume):
    pairs = Sphere(Radius=20, ThetaResolution=4, PhiResolution=4)
    return RBFImageWarp(Input=volume, Landmarks=pairs, Targets=pairs)


def shadows(volume):
    depth = BSplineIsoRayCaster(Input=SkullPhantom(Spacing=[5, 5, 5]), IsoValues=[300])
    return DepthMapShader(Input=depth, Volume=volume)


TAKERS = {
    "ray caster": lambda volume: BSplineIsoRayCaster(Input=volume, IsoValues=[300]),
    "shadows": shadows,
    "Mirror": lambda volume: Mirror(Input=volume, PlaneMethod="Given", Normal=[1, 0, 0], Origin=[1, 0, 0]),
    "Speckle Filter": lambda volume: SpeckleFilter(Input=volume, KernelSize=[3, 3, 1]),
    "Contrast To Speckle": lambda volume: ContrastToSpeckle(
        Input=volume, InsideBounds=[-12, -5, -12, 12, -3, 12], OutsideBounds=[5, 20, -12, 12, -3, 12]),
    "Occluded Angle": lambda volume: OccludedAngle(Input=volume, NumberOfDirections=8),
    "Phantom Sweep": lambda volume: PhantomSweep(Input=volume, NumberOfSlices=4, ImageSize=[16, 16]),
    "RBF Image Warp": warp,
    "RBF Interpolator": lambda volume: RBFInterpolator(
        Input=ExtractSubset(Input=volume, VOI=[8, 12, 8, 12, 8, 12]), OutputSpacing=[2, 2, 2]),
}
RESETTING = {
    "Median": lambda volume: Median(Input=volume, SelectInputScalars=["POINTS", "HounsfieldUnits"],
                                    KernelSize=[1, 1, 1]),
    "Gradient Magnitude": lambda volume: GradientMagnitude(Input=volume),
    "Image Shrink": lambda volume: ImageShrink(Input=volume, ShrinkFactors=[2, 2, 2]),
    "Median of a part": lambda volume: Median(
        Input=ExtractSubset(Input=volume, VOI=[3, 50, 0, 40, 2, 30]),
        SelectInputScalars=["POINTS", "HounsfieldUnits"], KernelSize=[1, 1, 1]),
}
KEEPING = {
    "Extract Subset": lambda volume: ExtractSubset(Input=volume, VOI=[1, 56, 1, 50, 0, 39]),
    "Calculator": lambda volume: Calculator(Input=volume, Function="HounsfieldUnits", ResultArrayName="HounsfieldUnits"),
    "Python Calculator": lambda volume: PythonCalculator(Input=volume, Expression="HounsfieldUnits + 0.0",
                                                         ArrayName="HounsfieldUnits"),
    "Pass Arrays": lambda volume: PassArrays(Input=volume, PointDataArrays=["HounsfieldUnits"],
                                             FieldDataArrays=[ARRAY]),
    "Random Attributes": lambda volume: RandomAttributes(Input=volume),
    "Point Data To Cell Data": lambda volume: PointDatatoCellData(
        Input=volume, ProcessAllArrays=0, PointDataArraytoprocess=["HounsfieldUnits"], PassPointData=1),
    "Gaussian": lambda volume: SpeckleFilter(Input=volume, Operation="Gaussian", StandardDeviation=0.3),
    "Median of Lacuna": lambda volume: SpeckleFilter(Input=volume, KernelSize=[1, 1, 1]),
    "RBF Image Warp": warp,
}


HU = ["POINTS", "HounsfieldUnits"]


def group(source):
    return GroupDatasets(Input=[source])


def surface_of(source):
    return ExtractSurface(Input=source)


def place_at(cut, shape):
    """A filter that cuts, with its plane, ball or cylinder near the middle."""
    setattr(shape, "Origin" if shape.GetXMLLabel() == "Plane" else "Center", [0.7, 1.1, -0.6])
    if shape.GetXMLLabel() != "Plane":
        shape.Radius = 12
    return cut


def slice_by(source, kind, **options):
    cut = Slice(Input=source, SliceType=kind, **options)
    return place_at(cut, cut.SliceType)


def clip_by(source, kind, **options):
    cut = Clip(Input=source, ClipType=kind, **options)
    return place_at(cut, cut.ClipType)


# the filters of coordinates.KEEPING by label, each in its variants
CUTS = {
    "Contour": [lambda source: Contour(Input=source, ContourBy=HU, Isosurfaces=[300], ComputeScalars=1)],
    "Iso Volume": [lambda source: IsoVolume(Input=source, InputScalars=HU, ThresholdRange=[300, 5000])],
    "Clip": [lambda source: clip_by(source, "Plane"), lambda source: clip_by(source, "Sphere"),
             lambda source: Clip(Input=source, ClipType="Scalar", Scalars=HU, Value=300),
             lambda source: clip_by(source, "Plane", Crinkleclip=1)],
    "Slice": [lambda source: slice_by(source, "Plane"), lambda source: slice_by(source, "Plane", Crinkleslice=1),
              lambda source: slice_by(source, "Sphere"), lambda source: slice_by(source, "Cylinder")],
}
KEPT = dict(CUTS, **{
    "Append Attributes": [lambda source: AppendAttributes(Input=[source, RandomAttributes(Input=source)])],
    "Append Datasets": [lambda source: AppendDatasets(Input=[source, source])],
    "Append Geometry": [lambda source: AppendGeometry(Input=[surface_of(source), surface_of(source)])],
    "Cell Data to Point Data": [lambda source: CellDatatoPointData(Input=source)],
    "Clean": [lambda source: Clean(Input=surface_of(source))],
    "Clean to Grid": [lambda source: CleantoGrid(Input=source)],
    "Connectivity": [lambda source: Connectivity(Input=source)],
    "Decimate": [lambda source: Decimate(Input=Triangulate(Input=surface_of(source)), TargetReduction=0.5)],
    "Extract Block": [lambda source: ExtractBlock(Input=group(source), Selectors=["/Root"])],
    "Extract Cells By Region": [lambda source: ExtractCellsByRegion(Input=source, IntersectWith="Plane")],
    "Extract Selection": [lambda source: ExtractSelection(Input=source, Selection=SelectionQuerySource(
        ElementType=0, QueryString="HounsfieldUnits > 300"))],
    "Extract Subset": [lambda source: ExtractSubset(Input=source, VOI=[3, 30, 2, 30, 1, 9])],
    "Extract Surface": [surface_of],
    "Feature Edges": [lambda source: FeatureEdges(Input=surface_of(source))],
    "Group Datasets": [group],
    "Merge Blocks": [lambda source: MergeBlocks(Input=group(source))],
    "Pass Arrays": [lambda source: PassArrays(Input=source, PointDataArrays=["HounsfieldUnits"],
                                              FieldDataArrays=[ARRAY, "Coordinates"])],
    "Point Data to Cell Data": [KEEPING["Point Data To Cell Data"]],
    "Tetrahedralize": [lambda source: Tetrahedralize(Input=source)],
    "Threshold": [lambda source: Threshold(Input=source, Scalars=HU, LowerThreshold=300, UpperThreshold=5000)],
    "Triangulate": [lambda source: Triangulate(Input=surface_of(source))],
})
# ParaView 5.11 has the first, 6 the second, 5.13 both
for label, name in (("Generate Surface Normals", "GenerateSurfaceNormals"), ("Surface Normals", "SurfaceNormals")):
    if name in globals():
        KEPT[label] = [lambda source, make=globals()[name]: make(Input=surface_of(source))]


def is_true(proxy, scan):
    """Whether points of a proxy's data have the (whole) values that the scan has where they are. Points of Iso Volume within
    hexahedra have others, an eighth of all."""
    data = servermanager.Fetch(proxy)
    while data.IsA("vtkCompositeDataSet"):
        data = data.GetBlock(0) if hasattr(data, "GetBlock") else data.GetPartition(0, 0)
    if data.GetNumberOfPoints() < 50:
        return False
    places = np.array([data.GetPoint(k) for k in range(0, data.GetNumberOfPoints(), data.GetNumberOfPoints() // 500 + 1)])
    values = vtk_to_numpy(data.GetPointData().GetArray("HounsfieldUnits"))[::data.GetNumberOfPoints() // 500 + 1]
    volume = servermanager.Fetch(scan)
    to_index = np.array([volume.GetPhysicalToIndexMatrix().GetElement(i, j) for i in range(4) for j in range(4)])
    index = np.c_[places, np.ones(len(places))] @ to_index.reshape(4, 4)[:3].T
    size = np.array(volume.GetDimensions())
    grey = vtk_to_numpy(volume.GetPointData().GetArray("HounsfieldUnits")).reshape(size[::-1]).astype(float)
    base = np.clip(np.floor(index).astype(int), 0, size - 2)
    part, true = index - base, np.zeros(len(index))
    for corner in np.ndindex(2, 2, 2):
        i, j, k = (base + corner).T
        true += np.where(corner, part, 1 - part).prod(axis=1) * grey[k, j, i]
    inside = ((index > -1e-3) & (index < size - 1 + 1e-3)).all(axis=1)
    return np.mean(inside & (np.abs(true - values) < 1.01)) > 0.8


def is_marked(proxy):
    """Some filters drop field data, and so the mark."""
    return servermanager.Fetch(proxy).GetFieldData().HasArray("Coordinates") == 1


# ParaView's filters that are said to leave points where they are do so, or are not called the patient's
assert coordinates.KEEPING - set(KEPT) < {"Generate Surface Normals", "Surface Normals"}
assert set(KEPT) <= coordinates.KEEPING and set(CUTS) == coordinates.STRAIGHTENING
marked = {}
for name in ("axial", "feet first", "oblique"):  # the grey level is a formula of the place
    scan = CTSeriesReader(FileName=os.path.join(folder, name))
    for what, variants in KEPT.items():
        for variant, make in enumerate(variants):
            made = make(scan)
            made.UpdatePipeline()
            true, place = is_true(made, scan), coordinates.find(made)
            known = is_marked(made)
            assert place == (coordinates.PATIENT if true and known else coordinates.UNKNOWN), (name, what, variant, place)
            marked[what] = marked.get(what, False) or known
            assert true or name != "axial" and what in CUTS, (name, what, variant)
            if what in CUTS:
                through = make(Transform(Input=scan))  # that does nothing
                through.UpdatePipeline()
                assert is_true(through, scan), (name, what, variant)
                assert (coordinates.find(through) == coordinates.PATIENT) == is_marked(through), (name, what, variant)
                held = make(group(scan))
                held.UpdatePipeline()
                assert is_true(held, scan) == true and coordinates.find(held) == place, (name, what, variant)
    for change, values, mirrored in (("Translate", [1, 0, 0], ""), ("Rotate", [0, 0, 1], ""), ("Scale", [2, 2, 2], ""),
                                     ("Scale", [-1, 1, 1], coordinates.MIRRORED)):
        moved = Transform(Input=scan)
        setattr(moved.Transform, change, values)
        moved.UpdatePipeline()
        assert coordinates.find(moved) == coordinates.UNKNOWN + mirrored, (change, values)
    if "AxisAlignedTransform" in globals():  # in ParaView 6: both may give images
        for moved, mirrored in ((AxisAlignedTransform(Input=scan, Translation=[1, 0, 0]), ""),
                                (AxisAlignedTransform(Input=scan, Scale=[-1, 1, 1]), coordinates.MIRRORED),
                                (AxisAlignedReflect(Input=scan), coordinates.MIRRORED)):
            moved.UpdatePipeline()
            assert coordinates.find(moved) == coordinates.UNKNOWN + mirrored, (name, moved.GetXMLLabel(), coordinates.find(moved))

print("drop the mark:", sorted(what for what, known in marked.items() if not known))
assert sum(marked.values()) > len(marked) - 4, marked

straight = CTSeriesReader(FileName=os.path.join(folder, SERIES[0]))
truth = centroid(straight)
straight_contour = Contour(Input=straight, ContourBy=["POINTS", "HounsfieldUnits"], Isosurfaces=[300])
for name in SERIES:
    scan = CTSeriesReader(FileName=os.path.join(folder, name))
    direction, record = directions(scan)
    assert np.array_equal(direction, record)
    turned = not np.allclose(direction, np.eye(3).ravel())
    assert turned == (name != SERIES[0])
    place = centroid(scan)
    assert np.abs(place - truth).max() < 1, name

    for what, make in RESETTING.items():
        volume = make(scan)
        found, kept = directions(volume)
        assert np.array_equal(kept, record), what
        reset = turned and np.array_equal(found, np.eye(3).ravel())
        if not reset:  # as in ParaView 5.13 and later
            assert np.array_equal(found, direction), what
        for taker, take in TAKERS.items() if what.startswith("Median") else [("ray caster", TAKERS["ray caster"])]:
            error = refusal(take(volume))
            assert ("its source recorded" in error) == reset, (name, what, taker, error)
            assert reset or not error or what != "Median", (name, what, taker, error)
        # nor are pictures and files of ParaView's own called the patient's
        contour = Contour(Input=volume, ContourBy=["POINTS", volume.PointData[0].GetName()], Isosurfaces=[300])
        for proxy, wrong in ((volume, reset), (contour, turned)):
            proxy.UpdatePipeline()
            assert (coordinates.find(proxy) == coordinates.PATIENT) != wrong, (name, what, coordinates.find(proxy))
        assert (coordinates.find(servermanager.Fetch(volume)) == coordinates.PATIENT) != reset, (name, what)
    # the difference also goes through files
    median = RESETTING["Median"](scan)
    reset = not np.array_equal(directions(median)[0], direction)
    file = os.path.join(folder, name + ".vti")
    SaveData(file, proxy=median, DataMode="Binary")
    error = refusal(TAKERS["ray caster"](XMLImageDataReader(FileName=[file])))
    assert ("its source recorded" in error) == reset, (name, error)

    assert coordinates.is_patient(XMLImageDataReader(FileName=[file])) != reset, name

    # files that keep the record and drop the direction
    for ending, options in (".vti", dict(DataMode="Binary")), (".pvti", dict(DataMode="Binary")), (".vtk", {}):
        other = os.path.join(folder, name + ending)
        SaveData(other, proxy=scan, **options)
        opened = OpenDataFile(other)
        error, lost = refusal(TAKERS["ray caster"](opened)), turned and ending != ".vti"
        assert ("a file that does not keep it (.pvti, legacy .vtk)" in error) == lost, (name, ending, error)
        assert coordinates.is_patient(opened) != lost, (name, ending)

    # no false alarm
    for mode in ("Binary", "Ascii"):
        SaveData(file, proxy=scan, DataMode=mode)
        assert np.abs(centroid(XMLImageDataReader(FileName=[file])) - place).max() < 1e-3, (name, mode)
    for what, make in KEEPING.items():
        volume = make(scan)
        shown = centroid(volume)
        assert np.abs(shown - place).max() < 0.3, (name, what, shown, place)
        assert np.allclose(directions(volume)[0], direction), (name, what)
        known = what not in ("Pass Arrays", "RBF Image Warp")  # the first has taken the mark away
        assert (coordinates.find(volume) == coordinates.PATIENT) == known, (name, what)
    for what, take in TAKERS.items():
        assert not refusal(take(scan)), (name, what)
    # what is no volume has no directions to compare, whatever field data came along
    contour = Contour(Input=Transform(Input=scan), ContourBy=["POINTS", "HounsfieldUnits"], Isosurfaces=[300],
                      ComputeScalars=1)
    shown = vtk_to_numpy(servermanager.Fetch(contour).GetPoints().GetData())
    box = vtk_to_numpy(servermanager.Fetch(straight_contour).GetPoints().GetData())
    assert np.abs(np.percentile(shown, (1, 50, 99), axis=0) - np.percentile(box, (1, 50, 99), axis=0)).max() < 1.5, name
    assert coordinates.find(contour) == coordinates.PATIENT, name
    threshold = Threshold(Input=scan, Scalars=["POINTS", "HounsfieldUnits"], LowerThreshold=500, UpperThreshold=4000)
    for what in (contour, Clip(Input=contour, ClipType="Plane"), threshold):
        interpolator = RBFInterpolator(Input=MaskPoints(Input=what, MaximumNumberofPoints=50), OutputSpacing=[9, 9, 9])
        assert not refusal(interpolator), (name, what)
        assert directions(interpolator)[1] is None

    # resampled along the patient's axes: refused, and as the error advises all is right
    for resampled in (ResampleToImage(Input=scan, SamplingDimensions=[80, 80, 80]),
                      ResampleToImage(Input=Transform(Input=scan), SamplingDimensions=[80, 80, 80])):
        error = refusal(TAKERS["ray caster"](resampled))
        assert ("Pass Arrays with all field data arrays but this one" in error) == turned, (name, error)
        resampled.UpdatePipeline()
        others = [each for each in resampled.FieldData.keys() if each != ARRAY]
        passed = PassArrays(Input=resampled, PointDataArrays=["HounsfieldUnits"], FieldDataArrays=others)
        assert np.abs(centroid(passed) - truth).max() < 1.5, (name, centroid(passed), truth)
        assert "Provenance" in passed.FieldData.keys()

    # what Lacuna makes of a volume: turned alike with the record, or placed anew without
    for what, alike in (("Speckle Filter", True), ("Mirror", True), ("Occluded Angle", True), ("RBF Image Warp", True),
                        ("ray caster", False), ("Phantom Sweep", False), ("RBF Interpolator", False)):
        made = TAKERS[what](scan)
        made.UpdatePipeline()
        found, kept = directions(made)
        if alike:
            assert np.array_equal(found, direction) and np.array_equal(kept, record), (name, what)
        elif what == "ray caster":  # its map lies across the view
            assert np.array_equal(kept, found) and not np.array_equal(found, direction), (name, what)
        else:
            assert kept is None and np.array_equal(found, np.eye(3).ravel()), (name, what)
    mirror = TAKERS["Mirror"](scan)
    mirror.UpdatePipeline()
    assert "Provenance" in mirror[1].FieldData.keys() and ARRAY not in mirror[1].FieldData.keys()

skull = SkullPhantom(Spacing=[5, 5, 5])
assert np.array_equal(*directions(skull))

# the closed surface of an image that is turned or mirrored lies around its object, outsides outside
from lacuna import occlusion
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData

letter = np.zeros((18, 24, 44), np.float32)  # z, y, x: no mirror image of it is a turned one of it
letter[6:10, 7:17, 10:14] = 1
letter[6:9, 7:10, 14:30] = 1
letter[10:13, 7:10, 10:13] = 1
flat = letter[6:7]
c, s = np.cos(0.5), np.sin(0.5)
measured = {}
for direction in (np.eye(3), np.diag([-1, 1, 1]), np.diag([-1, -1, 1]), np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
                  np.array([[0, 0, 1], [c, -s, 0], [s, c, 0]]), np.array([[0, 1, 0], [1, 0, 0], [0, 0, 1]])):
    for values in letter, flat:
        image = vtkImageData()
        image.SetDimensions(values.shape[::-1])
        image.SetOrigin(3, -5, 7)
        image.SetSpacing(1, 1.25, 0.75)
        image.SetDirectionMatrix(direction.astype(float).ravel())
        image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=1))
        angle = lacuna.vtkLacunaOccludedAngle()
        angle.SetMode(angle.Binary)
        angle.SetNumberOfDirections(100)
        angle.SetThresholdsOverPi(0, 3.0 if values is letter else 1.5)
        angle.SetInputData(image)
        surface = occlusion.closed_surface(angle)
        index = np.argwhere(vtk_to_numpy(angle.GetOutput().GetPointData().GetArray("Object")).reshape(values.shape))
        places = (index[:, ::-1] * image.GetSpacing()) @ direction.T + image.GetOrigin()
        points = vtk_to_numpy(surface.data.GetPoints().GetData())
        low, high = places.min(axis=0), places.max(axis=0)
        assert np.abs(points.min(axis=0) - low).max() < 1 and np.abs(points.max(axis=0) - high).max() < 1, direction
        # the corner that only this letter has: every voxel's centre is near or within, none of the points is far off
        far = np.array([np.linalg.norm(places - p, axis=1).min() for p in points[::7]])
        assert far.max() < 1.5, (direction, far.max())
        first = measured.setdefault(values is letter, surface)
        assert abs(surface.volume / first.volume - 1) < 1e-5 and abs(surface.area / first.area - 1) < 1e-5
        if values is letter:
            corners = vtk_to_numpy(surface.data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
            p, q, r = (points[corners[:, i]].astype(float) - points.mean(axis=0) for i in range(3))
            volume = np.sum(p * np.cross(q, r)) / 6000
            assert abs(volume / surface.volume - 1) < 1e-3, (direction, volume, surface.volume)
            normals = vtk_to_numpy(surface.data.GetPointData().GetNormals())
            assert np.mean(np.sum(np.cross(q - p, r - p) * normals[corners[:, 0]], axis=1) > 0) > 0.95, direction
