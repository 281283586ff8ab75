# SPDX-License-Identifier: BSD-3-Clause
"""The main jobs in one step, on what is selected in the pipeline browser: what the menu Lacuna of ParaView calls.

    surface = macros.sweep_to_surface()     # tracked slices -> volume -> median -> surface
    bone = macros.sweep_to_bone()           # tracked slices -> bone in them -> volume -> smooth surface
    filled, name = macros.ct_to_iges()      # CT -> depth map as the view looks -> filled hole -> IGES file
    made = macros.ct_to_implant()           # CT -> bone alone -> implant, coloured by the error to expect
    folder = macros.report_implant()        # a Skull Implant -> implant.stl, report.pdf and index.html
"""
import math
import os

import numpy as np
import paraview.simple as pv

from lacuna import vtkLacunaScanRegion
from lacuna import demo_implant, demo_ultrasound, implant, implant_report, pictures, solids, views, window
from lacuna.data import fetch
from lacuna.errors import PipelineError, raising
from vtkmodules.util.numpy_support import vtk_to_numpy

BONE = 500  # Hounsfield units
MEDIAN = 5  # voxels
BONE_SPACING = 0.4  # mm: voxels of a bone's volume are no smaller
BONE_BLUR = 0.6  # mm: standard deviation of what makes it smooth
VOXELS = 8_000_000  # of a volume, at most
PICTURES = 4  # slices shown beside a surface
VEIL = 0.35  # their opacity, so that the surface is seen behind them
SURE = 0.5  # of a scan region: below it Scan Region warns
# What is seen of an implant, from its own field data: it is right after each Apply, and empty after an error.
FACTS = ("'Implant: %.1f ml, %.0f g, %.1f to %.1f mm thick\\nHole: %.1f cm^2\\nError to expect: %.2f mm RMS, at most %.2f mm' % ("
         "Volume[0] / 1000, Mass[0], ThicknessMinimum[0], ThicknessMaximum[0], DefectArea[0] / 100, PredictedErrorRMS[0], "
         "PredictedErrorMaximum[0]) if 'PredictedErrorRMS' in inputs[0].FieldData.keys() else ''")


def run(job):
    """Runs one of the jobs below as the menu does: what is wrong is said in ParaView's Output Messages, without a traceback."""
    import paraview
    try:
        return job()
    except (ValueError, PipelineError) as error:
        paraview.print_error(f"Lacuna: {error}")
        return None


def sweep_to_surface(source=None):
    """A sweep (by default the active source) becomes a volume, less speckle and a surface, shown with some of its slices.

    The level is half-way for a Phantom Sweep, else Otsu's threshold of the smoothed volume: change Isosurfaces of the result.
    Returns the Contour. Raises ValueError when the source has no calibrated tracked slices.
    """
    source, name, image = _sweep_of(source)
    with _made() as made, raising():
        volume = made(pv.SweptVolume(registrationName=f"Volume of {name}", Input=source, FanMask=_fan_mask(image)))
        _fit(volume)
        smooth = made(pv.SpeckleFilter(registrationName=f"Median of {name}", Input=volume, Operation="Median", KernelSize=[MEDIAN] * 3))
        smooth.UpdatePipeline()
        level = source.GetProperty("TrueIsoValue") and source.GetProperty("TrueIsoValue").GetData()
        if level is None or not math.isfinite(level):
            level = demo_ultrasound.surface_level(smooth)
        grey = fetch(smooth).GetPointData().GetScalars().GetName()
        surface = made(pictures.contour(smooth, grey, level, registrationName=f"Surface of {name}"))
        surface.UpdatePipeline()
        if surface.GetDataInformation().GetNumberOfCells() == 0:
            raise ValueError(f"the volume of '{name}' has no surface at the grey level {level:.4g}")
    slices = image.GetDimensions()[2]
    view = _view()
    window.show_slices(source, view, max(1, (slices - 1) // (PICTURES - 1))).Opacity = VEIL
    pictures.show_surface(surface, view, pictures.TISSUE)
    window.look_at_slices(source, view)
    views.check_orientation(view)
    text = f"Surface of {slices} slices. Move it by the slider Level"
    _show_facts(pv.Text(registrationName="Facts of the surface", Text=text), view)
    pv.SetActiveSource(surface)
    pv.Render(view)
    print(f"Lacuna: surface at grey level {level:.4g} of {slices} slices; the slider Level moves it")
    return surface


def sweep_to_bone(source=None):
    """The bone in a sweep (by default the active source) becomes a surface, shown with some of the slices.

    Bone is what is bright and has a shadow (Bone Echo); its surface is smoothed. Returns the Contour. Raises ValueError when the source has
    no calibrated tracked slices, or no bone is found in them.
    """
    source, name, image = _sweep_of(source)
    with _made() as made, raising():
        echo = made(pv.BoneEcho(registrationName=f"Bone of {name}", Input=source, FanMask=_fan_mask(image)))
        echo.UpdatePipeline()
        area = fetch(echo).GetFieldData().GetArray("BoneArea").GetValue(0)
        volume = made(pv.SweptVolume(registrationName=f"Volume of {name}", Input=echo))
        _fit(volume, BONE_SPACING)
        smooth = made(pv.SpeckleFilter(registrationName=f"Smooth bone of {name}", Input=volume, Operation="Gaussian", StandardDeviation=BONE_BLUR,
                                       KernelSize=[3, 3, 3]))
        surface = made(pictures.contour(smooth, "Intensity", 0.5, registrationName=f"Bone surface of {name}"))
        surface.UpdatePipeline()
        if surface.GetDataInformation().GetNumberOfCells() == 0:
            raise ValueError(f"no bone was found in '{name}': no echo has a shadow behind it. Use Bone Echo with a lower MinimumConfidence")
    view = _view()
    pv.Hide(source, view)
    pictures.show_surface(surface, view, pictures.BONE)
    window.look_onto_slices(source, view)
    slices = image.GetDimensions()[2]
    window.show_slices(source, view, max(1, slices - 1)).Opacity = VEIL  # the first and the last one
    views.check_orientation(view)
    pv.SetActiveSource(surface)
    pv.Render(view)
    print(f"Lacuna: {area / 100:.1f} cm^2 of bone in {slices} slices; MinimumConfidence and MinimumArea of '{_name(echo)}' say what is bone")
    return surface


def ct_to_iges(source=None, folder=None):
    """A CT (by default the active source) becomes an IGES surface that closes the hole that the view looks into.

    A depth map is made as the active 3-D view looks, its holes are filled, bone and filling are shown, and the filled surface
    is written to implant.igs, implant-2.igs, ... in the folder, by default the user's home. A depth map, or one that is
    filled, may be given instead of a CT. Returns the filled map and the file's name. Raises ValueError when the source is
    nothing of these or no hole is seen in it, and PipelineError when a filter fails.
    """
    source = _data_of(source, "a CT: a CT Series Reader, another reader of a volume, or Skull Phantom")
    name = _name(source)
    image = fetch(source)
    is_map = image.IsA("vtkImageData") and image.GetFieldData().HasArray("ImageToWorld") and image.GetPointData().HasArray("Depth")
    if not is_map:
        _check_volume(image, name)
    view = _view()
    with _made() as made, raising():
        depth = filled = source
        if not is_map:
            depth = made(pv.BSplineIsoRayCaster(registrationName=f"Depth map of {name}", Input=source, IsoValues=[BONE],
                                                Interpolation="InterpolatingBSpline"))
            camera = view.GetActiveCamera()
            depth.ViewDirection, depth.ViewUp = list(camera.GetDirectionOfProjection()), list(camera.GetViewUp())
            depth.UpdatePipeline()
        if not image.GetPointData().HasArray("FilledMask"):
            filled = made(pv.RBFHoleFiller(registrationName=f"Filled {name}", Input=depth))
            filled.UpdatePipeline()
        result = fetch(filled)
        mask = result.GetPointData().GetArray("FilledMask") if result else None
        if mask is None or mask.GetRange()[1] < 1:
            raise ValueError(f"no hole is seen in '{name}': turn the 3-D view so that you look straight into the hole, and run the job again; "
                             "or mark the hole in DefectRegion of RBF Hole Filler")
        surface = made(pv.DepthMapSurface(registrationName=f"Surface of {name}", Input=filled, MaximumAngle=80))
        inside = dict(Input=surface, Scalars=["POINTS", "FilledMask"])
        bone = made(pv.Threshold(registrationName="Bone", ThresholdMethod="Below Lower Threshold", LowerThreshold=0.5, AllScalars=0, **inside))
        filling = made(pv.Threshold(registrationName="Filling", ThresholdMethod="Above Upper Threshold", UpperThreshold=0.5, **inside))
        file = _free_name(folder or os.path.expanduser("~"))
        pv.SaveData(file, proxy=filled)
    pv.Hide(source, view)
    pictures.show_surface(bone, view, pictures.BONE)
    pictures.show_surface(filling, view, pictures.METAL)
    pv.ResetCamera(view)
    pv.SetActiveSource(filled)
    pv.Render(view)
    try:
        views.show_orientation(view)
    except ValueError:  # not known to be the patient's, or something else is shown
        pass
    print(f"Lacuna: the filled surface is in {file}; File > Save Data writes it elsewhere")
    return filled, file


def ct_to_implant(source=None):
    """A CT (by default the active source) becomes an implant for its largest hole, shown in the skull and coloured by its predicted error.

    Returns the proxies bone, implant, defects and plates (implant.Made). Raises ValueError when the source is no CT, and PipelineError when
    a filter fails, for example because there is no hole. lacuna.solids.save_solid writes the implant.
    """
    source = _data_of(source, "a CT: a CT Series Reader, another reader of a volume, or Skull Phantom")
    name = _name(source)
    _check_volume(fetch(source), name, implant.LEVEL)
    view = _view()
    with _made() as made, raising():
        result = implant.make_implant(source)
        made(result.bone)
        made(result.implant)
        pv.RenameSource(f"Bone of {name}", result.bone)
        pv.RenameSource(f"Implant of {name}", result.implant)
        numbers = implant.measures(result)
        surface = implant_report.show_bone(result.bone, result.bone.Level, view, made)
        pv.RenameSource(f"Bone surface of {name}", surface)
    pv.Hide(source, view)
    implant_report.show_error(result.implant, view, numbers)
    inwards = list(numbers["InsertionDirection"])
    pictures.look(view, inwards, demo_implant.view_up(inwards))
    _show_scale(result.implant, view)
    _show_facts(pv.PythonAnnotation(registrationName="Facts of the implant", Input=result.implant, ArrayAssociation="Field Data", Expression=FACTS), view)
    pv.SetActiveSource(result.implant)
    try:
        views.show_orientation(view)
    except ValueError:  # not known to be the patient's, or something else is shown
        pass
    pv.Render(view)
    for line in implant.describe(result):
        print(f"Lacuna: {line}")
    print("Lacuna: the menu Lacuna writes the implant: with a report by Implant to Files and Report, alone by Save Solid")
    return result


def report_implant(source=None, folder=None):
    """A Skull Implant (by default the active source) becomes implant.stl and a report (index.html, report.pdf) in a folder of their own.

    That is implant-report, implant-report-2, ... in the folder, by default the user's home. Returns its name. Raises ValueError when the
    source is no Skull Implant, and PipelineError when a filter fails.
    """
    source = _data_of(source, "a Skull Implant")
    if source.GetXMLName() != "LacunaSkullImplant":
        raise ValueError(f"'{_name(source)}' is no Skull Implant; run CT to Implant first, and select what it makes")
    view = _view()
    made = implant.Made(source.Input, source, pv.OutputPort(source, 1), pv.OutputPort(source, 2))
    folder = _free_name(folder or os.path.expanduser("~"), "implant-report", "")
    os.makedirs(folder)
    template = source.Template and _name(source.Template)
    before = set(pv.GetSources())
    try:
        with raising():
            record = solids.save_solid(os.path.join(folder, "implant.stl"), source)
            written = implant_report.write(folder, made, record, _name(source.Input), implant.warnings_of(source), template)
    finally:  # what the pictures needed, the last first
        for key in sorted(set(pv.GetSources()) - before, key=lambda key: -int(key[1])):
            pv.Delete(pv.GetSources()[key])
    pv.SetActiveView(view)
    pv.SetActiveSource(source)
    pv.Render(view)
    missing = "" if len(written) > 1 else "; no report.pdf: that needs matplotlib (Debian: python3-matplotlib)"
    print(f"Lacuna: {', '.join(written)} and implant.stl are written{missing}")
    return folder


def _sweep_of(source):
    """A source of calibrated tracked slices, its name and its data."""
    source = _data_of(source, "a sweep: a Tracked Slice Reader, Phantom Sweep, Assemble Tracked Slices or Polhemus Video Source")
    name = _name(source)
    image = fetch(source)
    fields = image.GetFieldData()
    if not image.IsA("vtkImageData") or not (fields.HasArray("ImageToReference") or fields.HasArray("SliceStatus")):
        raise ValueError(f"'{name}' holds no tracked slices; select a Tracked Slice Reader, Phantom Sweep, Assemble Tracked Slices or "
                         "Polhemus Video Source in the pipeline browser")
    if not fields.HasArray("ImageToReference"):
        raise ValueError(f"'{name}' is not calibrated: where its images lie is not known. Set CalibrationFileName, or use Probe Calibration")
    return source, name, image


def _data_of(source, what):
    """The source, updated, or the active one. Raises ValueError when there is none."""
    source = source or pv.GetActiveSource()
    if source is None:
        raise ValueError(f"nothing is selected in the pipeline browser; open and select {what}")
    with raising():
        source.UpdatePipeline()
    if fetch(source) is None:
        raise ValueError(f"'{_name(source)}' has no data yet: press Apply first")
    return source


def _name(source):
    names = [name for (name, identity), each in pv.GetSources().items() if each == source]
    return names[0] if names else source.GetXMLLabel()


def _check_volume(image, name, level=BONE):
    if not image.IsA("vtkImageData") or min(image.GetDimensions()) < 2:
        raise ValueError(f"'{name}' is no volume; select a CT Series Reader, another reader of a volume, or Skull Phantom in the pipeline browser")
    if image.GetFieldData().HasArray("SliceStatus"):
        raise ValueError(f"'{name}' is a sweep, not a CT: use Sweep to Surface")
    grey = image.GetPointData().GetScalars()
    if grey is None or grey.GetNumberOfComponents() != 1:
        raise ValueError(f"'{name}' has no grey levels (one number per voxel)")
    low, high = grey.GetRange()
    if not low < level <= high:
        raise ValueError(f"the values of '{name}' range from {low:.4g} to {high:.4g}: bone, at {level} Hounsfield units, is not among them")


def _fan_mask(image):
    """Automatic where the images show surely what the probe sees (Scan Region), else None: rulers and texts are no tissue."""
    region = vtkLacunaScanRegion()
    region.SetInputData(image)
    window.update_quietly(region)  # that there is none is no error here
    confidence = region.GetOutputDataObject(0).GetFieldData().GetArray("Confidence")
    return "Automatic" if confidence and confidence.GetValue(0) >= SURE else "None"


def _fit(volume, least=0):
    """Voxels from the data but not too many, of at least so many mm, and a rim of nothing around the sweep, which closes the surface there."""
    volume.UpdatePipelineInformation()
    volume.UpdatePipeline()
    image = fetch(volume)
    spacing = list(image.GetSpacing())
    growth = max(1, (image.GetNumberOfPoints() / VOXELS) ** (1 / 3))
    volume.OutputSpacing = [max(least, growth * step) for step in spacing]
    rim = [MEDIAN * step for step in volume.OutputSpacing]
    bounds = image.GetBounds()
    volume.OutputBounds = [bounds[i] + (1 if i % 2 else -1) * rim[i // 2] for i in range(6)]


def _view():
    view = pv.GetActiveView()
    if view is None or not hasattr(view, "GetActiveCamera"):
        found = pv.GetRenderViews()
        view = found[0] if found else pv.CreateRenderView()
        pv.SetActiveView(view)
    return view


def _show_scale(source, view):
    """A ruler below a surface as the view sees it, of 10, 20 or 50 mm; at the surface's place in space, so that it is right in any view."""
    points = vtk_to_numpy(fetch(source).GetPoints().GetData())
    camera = view.GetActiveCamera()
    inwards, up = np.array(camera.GetDirectionOfProjection()), np.array(camera.GetViewUp())
    right = np.cross(inwards, up)
    right /= np.linalg.norm(right)  # up may be aslant
    up = np.cross(right, inwards)
    low, high = points @ right, points @ up
    length = max([each for each in (10, 20, 50) if each <= np.ptp(low)], default=10)
    middle = (low.min() + low.max()) / 2 * right + (high.min() - 0.1 * np.ptp(high)) * up + (points @ inwards).min() * inwards
    ruler = pv.Ruler(registrationName=f"Scale, {length} mm", Point1=list(middle - length / 2 * right), Point2=list(middle + length / 2 * right))
    display = pv.Show(ruler, view)
    display.Color = display.AxisColor = views.text_color(view)
    display.LabelFormat = pictures.number_format("{:.0f} mm", display.LabelFormat)


def _show_facts(text, view):
    """Shows a text in the upper left corner of a view; it is no data that the letters at the edges depend on."""
    views.annotations.add(text.GetGlobalIDAsString())
    display = pv.Show(text, view)
    display.WindowLocation, display.Justification, display.FontSize, display.Bold = "Upper Left Corner", "Left", 16, 1
    display.Color = views.text_color(view)


def _free_name(folder, stem="implant", ending=".igs"):
    number = 1
    while True:
        name = os.path.join(folder, stem + ("" if number == 1 else f"-{number}") + ending)
        if not os.path.exists(name):
            return name
        number += 1


class _made:
    """Takes away what was made when the block fails, so that nothing half-done stays in the pipeline browser."""

    def __enter__(self):
        self.proxies = []
        self.active = pv.GetActiveSource()
        return self.add

    def add(self, proxy):
        self.proxies.append(proxy)
        return proxy

    def __exit__(self, kind, *_):
        if kind is not None:
            for proxy in reversed(self.proxies):
                pv.Delete(proxy)
            pv.SetActiveSource(self.active)
