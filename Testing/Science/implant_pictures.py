# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of implants in Documentation/UserGuide: for a patient's forehead and for half of the vault (implant-gallery.md), with holes, plates and
text (implant-details.md), and after a planned cut (skull-resection.md).

    . build/release/lacuna-env.sh
    xvfb-run -a -s "-screen 0 1280x1024x24 -noreset" pvpython Testing/Science/implant_pictures.py [--project Cranium.inv3] FOLDER

Makes implant-forehead.png, implant-hemisphere.png, implant-details.png and skull-resection.png in FOLDER, within some minutes. The CT is in Debian's package invesalius-examples
(GPL-2): that of a patient with a gap in the forehead. The second hole is cut by this script.

InVesalius keeps axial slices with the rows turned over: x to the patient's left, y to the front, z to the head. Here y becomes that of
patient coordinates (LPS). Without that the head would be its mirror image.
"""
import argparse
import os
import plistlib
import tarfile

import lacuna.plugin

lacuna.plugin.load()
import numpy as np
import paraview.simple as pv
from lacuna import implant, implant_report, pictures, views
from lacuna.data import fetch
from lacuna.demo_implant import view_up
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkImageAppend
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter

PROJECT = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3"
SOFT = 40  # HU, of what fills a cut
PANEL = (480, 450)  # pixels
CUT_BONE, CUT_IMPLANT = (0.80, 0.70, 0.52), (0.10, 0.33, 0.56)
BEHIND = (0.62, 0.78, 0.90)  # the implant behind its cut
TUMOUR, EDGES = (0.55, 0.16, 0.2), (0.05, 0.1, 0.2)
TUMOUR_PLACE = np.array([0.72, 0.42, 0.78])  # in the box of the bone
GREYS = 6  # of 256 that look alike: the files get smaller


def read_project(path):
    """Voxels (z, y, x) and their spacing x y z in mm, in patient coordinates."""
    with tarfile.open(path) as archive:
        files = {os.path.basename(member.name): member for member in archive.getmembers()}
        project = plistlib.load(archive.extractfile(files["main.plist"]))
        about, spacing = project["matrix"], project["spacing"]
        raw = archive.extractfile(files[os.path.basename(about["filename"])]).read()
    voxels = np.frombuffer(raw, about["dtype"]).reshape(about["shape"])
    return np.ascontiguousarray(voxels[:, ::-1, :]).astype(np.int16), np.array(spacing, float)


def cut(voxels, spacing, axis, angle):
    """A copy without the bone in a cone around axis from amid the bone; the rim is about a voxel wide."""
    k, j, i = np.meshgrid(*(np.arange(n, dtype=np.float32) for n in voxels.shape), indexing="ij")
    bone = voxels > implant.LEVEL
    centre = np.array([(x[bone].min() + x[bone].max()) / 2 for x in (i, j, k)]) * spacing
    centre[2] += 15  # mm: the face is in the scan, too
    x = np.stack([i * spacing[0], j * spacing[1], k * spacing[2]], axis=-1) - centre
    r = np.linalg.norm(x, axis=-1)
    axis = np.asarray(axis) / np.linalg.norm(axis)
    inside = r * (np.radians(angle) - np.arccos(np.clip(x @ axis / np.maximum(r, 1), -1, 1)))  # mm
    share = np.clip(0.5 + inside, 0, 1)
    return np.rint(voxels * (1 - share) + np.minimum(voxels, SOFT) * share).astype(np.int16), centre + 85 * axis


def as_proxy(voxels, spacing):
    image = vtkImageData()
    image.SetDimensions(*voxels.shape[::-1])
    image.SetSpacing(*spacing)
    grey = numpy_to_vtk(voxels.ravel(), deep=True)
    grey.SetName("HounsfieldUnits")
    image.GetPointData().SetScalars(grey)
    source = pv.TrivialProducer()
    source.GetClientSideObject().SetOutput(image)
    source.UpdatePipeline()
    return source


class Sheet:
    """Panels of one picture, row by row."""

    def __init__(self, folder):
        self.Folder, self.Rows = folder, [[]]

    def view(self):
        view = pictures.new_view(PANEL)
        view.Background2, view.OrientationAxesVisibility = [1, 1, 1], 0
        return view

    def add(self, view, title, direction, middle, scale, bar=50):
        """direction: in which the camera looks; scale: mm from the middle to the upper edge. Letters where it looks along an axis."""
        pictures.look(view, direction, view_up(direction))
        camera = view.GetActiveCamera()
        move = np.array(middle) - np.array(camera.GetFocalPoint())
        camera.SetPosition(*(np.array(camera.GetPosition()) + move))
        camera.SetFocalPoint(*middle)
        camera.SetParallelScale(scale)
        pv.Render(view)
        pictures.add_title(view, title).WindowLocation = "Upper Left Corner"
        pictures.add_scale_bar(view, bar, aside=True)
        if max(map(abs, direction)) == 1:
            views.show_orientation(view, force=True)
        name = os.path.join(self.Folder, f"panel-{len(self.Rows)}-{len(self.Rows[-1])}.png")
        pictures.save(view, name)
        pv.Delete(view)
        reader = vtkPNGReader()
        reader.SetFileName(name)
        reader.Update()
        os.remove(name)
        self.Rows[-1].append(reader.GetOutput())

    def write(self, name):
        def join(images, axis):
            together = vtkImageAppend()
            together.SetAppendAxis(axis)
            for image in images:
                together.AddInputData(image)
            together.Update()
            return together.GetOutput()

        sheet = join([join(row, 0) for row in self.Rows[::-1]], 1)  # rows of images go upwards
        colours = vtk_to_numpy(sheet.GetPointData().GetScalars())
        colours[:] = np.minimum((colours.astype(int) + GREYS // 2) // GREYS * GREYS, 255)
        colours[colours >= 255 - GREYS // 2] = 255
        writer = vtkPNGWriter()
        writer.SetCompressionLevel(9)
        writer.SetFileName(os.path.join(self.Folder, name))
        writer.SetInputData(sheet)
        writer.Write()


def outer_of(made):
    return pv.Threshold(Input=made.implant, Scalars=["CELLS", "ImplantFace"], ThresholdMethod="Below Lower Threshold", LowerThreshold=0.5)


def forehead(folder, voxels, spacing):
    made = implant.make_implant(as_proxy(voxels, spacing))
    numbers = implant.measures(made)
    print("\n".join(implant.describe(made)), flush=True)
    head = np.array(made.bone.GetDataInformation().GetBounds()).reshape(3, 2).mean(axis=1)
    hole = np.array(numbers["Defects"][numbers["Chosen"]].center)
    face = np.array([head[0], hole[1], hole[2] - 30])
    sheet = Sheet(folder)
    front, aside = (0, 1, 0), (0.75 * np.sign(head[0] - hole[0]), 0.95, -0.35)
    for title, direction, shown in (("Before: the gap", front, False), ("The implant in place", front, True), ("The same, from the side", aside, True)):
        view = sheet.view()
        implant_report.show_bone(made.bone, implant.LEVEL, view)
        if shown:
            pictures.show_surface(made.implant, view, implant_report.IMPLANT)
        if len(sheet.Rows[-1]) == 2:
            sheet.Rows.append([])
        sheet.add(view, title, direction, face if direction == front else 0.5 * (face + hole) + [0, 0, 5], 98)
    view = sheet.view()
    implant_report.show_error(outer_of(made), view, numbers)
    sheet.add(view, "The implant alone", tuple(numbers["InsertionDirection"]), hole + [0, 0, 2], 36, 10)
    sheet.write("implant-forehead.png")


def hemisphere(folder, voxels, spacing):
    voxels, point = cut(voxels, spacing, (0.80, 0.10, 0.60), 44)
    made = implant.make_implant(as_proxy(voxels, spacing), hole=point)
    numbers = implant.measures(made)
    print("\n".join(implant.describe(made)), flush=True)
    middle = np.array(made.bone.GetDataInformation().GetBounds()).reshape(3, 2).mean(axis=1) + [0, 0, 8]
    hole = np.array(numbers["Defects"][numbers["Chosen"]].center)
    aside = (-0.8, 0.75, -0.45)
    sheet = Sheet(folder)
    for title, shown in ((f"Before: {numbers['DefectArea'] / 100:.0f} cm² are missing", False), ("The implant in place", True)):
        view = sheet.view()
        implant_report.show_bone(made.bone, implant.LEVEL, view)
        if shown:
            pictures.show_surface(made.implant, view, implant_report.IMPLANT)
        sheet.add(view, title, aside, middle, 112)
    sheet.Rows.append([])
    plane, grey = (0, 1, 0), fetch(made.bone).GetPointData().GetScalars().GetName()  # what is in front of the plane is taken away
    edge = _slice(made.implant, hole, plane)
    lowest = min(vtk_to_numpy(fetch(edge).GetPoints().GetData()), key=lambda point: point[2])
    for title, place, scale, bar in (("Cut open, from the front", middle + [0, 0, 5], 100, 50), ("The edge in this cut", lowest + [-2, 0, 3], 14, 5)):
        view = sheet.view()
        bone = implant_report.show_bone(made.bone, implant.LEVEL, view)
        pv.Hide(bone, view)
        for surface, colour in ((bone, pictures.BONE), (made.implant, BEHIND)):
            pictures.show_surface(_behind(surface, hole, plane), view, colour)
        section = _slice(made.bone, hole, plane)
        for face, colour in ((pv.Clip(Input=section, ClipType="Scalar", Scalars=["POINTS", grey], Value=implant.LEVEL, Invert=0), CUT_BONE),
                             (_face(made.implant, hole, plane), CUT_IMPLANT)):
            display = pictures.show_surface(face, view, colour)
            display.Ambient, display.Diffuse, display.Specular = 0.9, 0.1, 0
        sheet.add(view, title, plane, place, scale, bar)
    sheet.write("implant-hemisphere.png")


def details(folder, voxels, spacing):
    """Holes, plates, two parts and text."""
    voxels, point = cut(voxels, spacing, (0.80, 0.10, 0.60), 38)
    made = implant.make_implant(as_proxy(voxels, spacing), hole=point, DrainageSpacing=14, SutureSpacing=18, Plates=5, Parts=2, EngravedText="L 1742",
                                TextHeight=7)
    print("\n".join(implant.describe(made)), flush=True)
    inwards = np.array(implant.measures(made)["InsertionDirection"])
    hole = np.array(made.implant.GetDataInformation().GetBounds()).reshape(3, 2).mean(axis=1)
    sheet = Sheet(folder)
    view = sheet.view()
    implant_report.show_bone(made.bone, implant.LEVEL, view)
    pictures.show_surface(made.implant, view, implant_report.IMPLANT)
    pictures.show_surface(pv.Tube(Input=made.plates, Radius=1.2), view, pictures.METAL)
    sheet.add(view, "Two parts, holes, five plates", tuple(inwards), hole, 62, 20)
    view = sheet.view()
    pictures.show_surface(made.implant, view, implant_report.IMPLANT)
    edges = pictures.show_surface(pv.FeatureEdges(Input=made.implant, BoundaryEdges=0, NonManifoldEdges=0, FeatureAngle=50), view, EDGES)
    edges.LineWidth, edges.Ambient, edges.Diffuse = 1.5, 1, 0
    sheet.add(view, "From within", tuple(-inwards), hole, 62, 20)
    sheet.write("implant-details.png")


def resection(folder, voxels, spacing):
    """A cut around a tumour, its guide and its implant."""
    bone = pv.SkullBone(Input=as_proxy(voxels, spacing), Level=implant.LEVEL)
    bone.UpdatePipeline()
    low, high = np.array(bone.GetDataInformation().GetBounds()).reshape(3, 2).T
    place = low + (high - low) * TUMOUR_PLACE
    tumour = pv.Sphere(Center=list(place), Radius=17, ThetaResolution=48, PhiResolution=48)
    made = pv.SkullResection(Input=bone, Tumour=tumour, Margin=8, Bevel=15)
    made.UpdatePipeline()
    direction = np.array(fetch(pv.OutputPort(made, 2)).GetFieldData().GetArray("CutDirection").GetTuple(0))
    design = pv.SkullImplant(Input=made, DefectOutline=pv.OutputPort(made, 1), Level=implant.LEVEL, DrainageSpacing=12)
    middle = np.array(pv.OutputPort(made, 3).GetDataInformation().GetBounds()).reshape(3, 2).mean(axis=1)
    aside = tuple(direction + [0, 0.4, -0.2])
    sheet = Sheet(folder)
    for title, shown in (("The guide on the bone, the tumour below", ((pv.OutputPort(made, 3), pictures.METAL), (tumour, TUMOUR))),
                         ("The implant", ((design, implant_report.IMPLANT),))):
        view = sheet.view()
        implant_report.show_bone(made, implant.LEVEL, view)
        for proxy, colour in shown:
            pictures.show_surface(proxy, view, colour)
        sheet.add(view, title, aside, middle, 60, 20)
    sheet.write("skull-resection.png")


def _slice(data, origin, normal):
    section = pv.Slice(Input=data, SliceType="Plane")
    section.SliceType.Origin, section.SliceType.Normal = list(origin), list(normal)
    section.UpdatePipeline()
    return section


def _behind(surface, origin, normal, invert=0):
    clip = pv.Clip(Input=surface, ClipType="Plane", Invert=invert)
    clip.ClipType.Origin, clip.ClipType.Normal = list(origin), list(normal)
    return clip


def _face(solid, origin, normal):
    """The face of a closed surface that a plane cuts."""
    closed = pv.ClipClosedSurface(Input=solid, ClippingPlane="Plane", GenerateFaces=1, GenerateOutline=0)
    closed.ClippingPlane.Origin, closed.ClippingPlane.Normal = list(origin), list(normal)
    return _behind(closed, np.array(origin) + 0.01 * np.array(normal), normal, invert=1)


PICTURES = {make.__name__: make for make in (forehead, hemisphere, details, resection)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folder")
    parser.add_argument("--project", default=PROJECT)
    parser.add_argument("--only", choices=tuple(PICTURES))
    options = parser.parse_args()
    os.makedirs(options.folder, exist_ok=True)
    voxels, spacing = read_project(options.project)
    for name, make in PICTURES.items():
        if options.only in (None, name):
            make(options.folder, voxels, spacing)


if __name__ == "__main__":
    main()
