# SPDX-License-Identifier: BSD-3-Clause
"""The ultrasound half of the demo: tracked slices -> volume -> closed surface."""
import os

import paraview.simple as pv
from paraview import servermanager
from vtkmodules.vtkFiltersCore import vtkMassProperties
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.util.numpy_support import vtk_to_numpy

from lacuna import pictures

PHANTOM = dict(NumberOfSlices=120, ImageSize=[400, 300], PixelSpacing=0.15, Motion="Twist", Anatomy="Ellipsoids")


def read(options):
    if options.sweep:
        sweep = pv.TrackedSliceReader(FileName=options.sweep)
        if options.calibration:
            sweep.CalibrationFileName = options.calibration
    else:
        sweep = pv.PhantomSweep(**PHANTOM)
    sweep.UpdatePipeline()
    return sweep


def surface_level(volume):
    """Half-way between the mean and the brightest grey level of the voxels that have one."""
    data = servermanager.Fetch(volume).GetPointData()
    grey = vtk_to_numpy(data.GetArray("Intensity"))[vtk_to_numpy(data.GetArray("vtkValidPointMask")) > 0]
    return float(grey.mean() + grey.max()) / 2


def closed_surface(volume, level, median):
    """Contour of the median-filtered volume, largest piece."""
    smooth = pv.Median(Input=volume, SelectInputScalars=["POINTS", "Intensity"], KernelSize=[median] * 3)
    contour = pv.Contour(Input=smooth, ContourBy=["POINTS", "Intensity"], Isosurfaces=[level],
                         ComputeNormals=1, ComputeScalars=0)
    return pv.Connectivity(Input=contour, ExtractionMode="Extract Largest Region", ColorRegions=0)


def measure(surface):
    """Volume in ml and whether the surface is closed (no edge with one triangle only)."""
    triangles = vtkTriangleFilter()
    triangles.SetInputData(servermanager.Fetch(surface))
    mass = vtkMassProperties()
    mass.SetInputConnection(triangles.GetOutputPort())
    mass.Update()
    return mass.GetVolume() / 1000
