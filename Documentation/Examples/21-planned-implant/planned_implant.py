# SPDX-License-Identifier: BSD-3-Clause
"""A tumour under an intact skull: the cut around it, a guide for the saw, and the implant that closes it.

    pvpython planned_implant.py [folder for picture and state file, default: .]

Writes planned-implant.png and planned-implant.pvsm, for File > Load State.
"""
import os
import sys

import lacuna.plugin

lacuna.plugin.load()
import numpy as np
from lacuna import implant, implant_report, pictures, states
from lacuna.data import fetch
from lacuna.demo_implant import view_up
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

LEVEL = 500  # of the phantom's bone, Hounsfield units
TUMOUR, EDGE = (0.55, 0.16, 0.2), (0.05, 0.1, 0.2)

skull = SkullPhantom(registrationName="Skull", Spacing=[2, 2, 2], DefectRadius=0)
bone = SkullBone(registrationName="Bone", Input=skull, Level=LEVEL)
tumour = Sphere(registrationName="Tumour", Center=[38, -15, 32], Radius=13, ThetaResolution=40, PhiResolution=40)
cut = SkullResection(registrationName="Cut", Input=bone, Tumour=tumour, Margin=10, Bevel=15)
design = SkullImplant(registrationName="Implant", Input=cut, DefectOutline=OutputPort(cut, 1), Level=LEVEL, TriangleSize=1.5,
                      DrainageSpacing=11, Plates=3, RimDistance=4, EngravedText="L 21", TextHeight=7)
design.UpdatePipeline()
made = implant.Made(cut, design, OutputPort(design, 1), OutputPort(design, 2))
print("\n".join(implant.describe(made)))

# The phantom is the truth: how far the outer face is from it
mesh = fetch(design)
points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float) - np.array(skull.Center)
outer = np.unique(vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)[vtk_to_numpy(mesh.GetCellData().GetArray("ImplantFace")) == 0])
truth = skull.GetClientSideObject()
off = np.array([np.linalg.norm(p) - truth.IntersectOuterSurface(skull.Center, list(p / np.linalg.norm(p))) for p in points[outer]])
print(f"outer face: {np.sqrt((off**2).mean()):.2f} mm RMS from the phantom, {np.abs(off).max():.2f} mm at most")

inwards = np.array(implant.measures(made)["InsertionDirection"])
views = []
for title in ("The cut around the tumour, and the guide", "The implant and its plates", "From within"):
    view = pictures.new_view((420, 420))
    view.OrientationAxesVisibility = 0
    pictures.add_title(view, title)
    views.append(view)
around, within = inwards + [0.35, 0.25, 0], -inwards
surface = implant_report.show_bone(cut, LEVEL, views[0])
pictures.show_surface(surface, views[1], pictures.BONE)
pictures.show_surface(OutputPort(cut, 3), views[0], pictures.METAL)
pictures.show_surface(tumour, views[0], TUMOUR)
pictures.show_surface(design, views[1], implant_report.IMPLANT)
plates = pictures.show_surface(made.plates, views[1], pictures.METAL)
plates.LineWidth, plates.RenderLinesAsTubes = 7, 1
pictures.show_surface(design, views[2], implant_report.IMPLANT)
edges = pictures.show_surface(FeatureEdges(registrationName="Edges", Input=design, BoundaryEdges=0, NonManifoldEdges=0, FeatureAngle=50), views[2],
                              EDGE)
edges.LineWidth, edges.Ambient, edges.Diffuse = 2, 1, 0
for view, direction, size in zip(views, (around, inwards, within), (46, 40, 28)):
    pictures.look(view, list(direction), view_up(list(direction)))
    bounds = np.array(mesh.GetBounds()).reshape(3, 2)
    camera = view.GetActiveCamera()
    move = bounds.mean(axis=1) - camera.GetFocalPoint()
    camera.SetPosition(*(np.array(camera.GetPosition()) + move))
    camera.SetFocalPoint(*bounds.mean(axis=1))
    camera.SetParallelScale(size)
layout = pictures.lay_out(views, "Planned implant")

folder = sys.argv[1] if len(sys.argv) > 1 else "."
os.makedirs(folder, exist_ok=True)
pictures.save_layout(layout, os.path.join(folder, "planned-implant.png"))
states.save(os.path.join(folder, "planned-implant.pvsm"))
