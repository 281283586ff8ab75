# SPDX-License-Identifier: BSD-3-Clause
"""A plate for a disc of 30 mm radius taken out of the CT of a real skull."""
import os

import numpy as np
from lacuna.errors import raising
from lacuna_test import data
from paraview import servermanager
from paraview.simple import LoadPlugin, OpenDataFile
from vtkmodules.numpy_interface import dataset_adapter as dsa
from vtkmodules.vtkFiltersCore import vtkFeatureEdges

LoadPlugin(os.environ["LACUNA_PLUGIN"], remote=False, ns=globals())
head = OpenDataFile(data("ct_head/head.mha"))
depth = BSplineIsoRayCaster(Input=head, IsoValues=[500], ViewDirection=[0, 0, -1], ComputeThickness=1)
filled = RBFHoleFiller(Input=depth, Smoothing=5)
filled.DefectRegion = "Cylinder"
filled.DefectRegion.Center = [90.2, 97.5, 100]
filled.DefectRegion.Axis = [0, 0, 1]
filled.DefectRegion.Radius = 30
for thickness, side, clearance in ((3, "Inward", 0.5), (0.7, "Outward", -5)):
    plate = ImplantPlate(Input=filled, Thickness=thickness, Side=side, EdgeClearance=clearance,
                         DrainageSpacing=8, TriangleSize=0.5 if thickness > 1 else 0)
    warnings = []
    with raising(warnings):
        plate.UpdatePipeline()
    result = servermanager.Fetch(plate)
    edges = vtkFeatureEdges()
    edges.SetInputData(result)
    edges.FeatureEdgesOff()
    edges.BoundaryEdgesOn()
    edges.NonManifoldEdgesOn()
    edges.Update()
    assert edges.GetOutput().GetNumberOfCells() == 0
    fields = dsa.WrapDataObject(result).FieldData
    figures = {name: np.asarray(fields[name]).item() for name in (
        "Volume", "Mass", "OuterArea", "OutlineLength", "MinimumThickness",
        "MinimumCurvatureRadius", "DrainageHoleCount")}
    print(thickness, side, figures, warnings)
    assert abs(figures["MinimumThickness"] / thickness - 1) < 0.01
    assert figures["MinimumCurvatureRadius"] > (thickness if side == "Inward" else 0)
    # about the middle of the disc and on its side of the head
    bounds = result.GetBounds()
    assert abs((bounds[0] + bounds[1]) / 2 - 90.2) < 1 and abs((bounds[2] + bounds[3]) / 2 - 97.5) < 1
    radius = 30 - clearance
    assert abs((bounds[1] - bounds[0]) / 2 - radius) < 1.5
