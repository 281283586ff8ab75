# SPDX-License-Identifier: BSD-3-Clause
"""From a CT to its files in the ParaView application, as a user does it: menus, panels, mouse, dialogs.

A hole is marked with the mouse and filled; plate, model, mould and tool path are made and written by File > Save Data.
"""
import os

import lacuna_window
from lacuna_window import PANEL


def box(view, points):
    """The rectangle on the screen around points in space, pixels from the upper left corner: two corners."""
    from vtkmodules.vtkRenderingCore import vtkCoordinate
    coordinate = vtkCoordinate()
    coordinate.SetCoordinateSystemToWorld()
    places = []
    for point in points:
        coordinate.SetValue(*point)
        x, y = coordinate.GetComputedDoubleDisplayValue(view.GetRenderer())
        places.append((x, view.ViewSize[1] - y))
    return [tuple(f(place[k] for place in places) for k in (0, 1)) for f in (min, max)]


STEEP = "a sheet can hardly follow the mould"  # the flange


def field(source, name):
    from lacuna.data import fetch
    return fetch(source).GetFieldData().GetArray(name).GetValue(0)


def test(window):
    import numpy as np
    from lacuna.data import fetch
    from paraview.simple import GetActiveSource, GetActiveView
    from vtkmodules.util.numpy_support import vtk_to_numpy

    folder = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "WindowImplant")
    os.makedirs(folder, exist_ok=True)
    for name in os.listdir(folder):
        os.remove(os.path.join(folder, name))

    def make(label, says="", **settings):
        """From the menu, with settings typed in the panel; Apply. says: what it warns of."""
        window.menu(f"Filters/Lacuna/{label}" if GetActiveSource() else f"Sources/Lacuna/{label}")
        for name, values in settings.items():
            for k, value in enumerate(values):
                window.type(f"{PANEL}{name}/DoubleLineEdit{k}", value)
        if says:
            window.press(lacuna_window.ACCEPT)
            said = window.take_messages()
            assert says in said, said
        else:
            window.apply()
        made = GetActiveSource()
        assert made.GetDataInformation().GetNumberOfPoints() > 100, label
        return made

    def write(name, kind, options="OK"):
        path = os.path.join(folder, name)
        window.save_file(path, kind, *[lambda: window.press(options)] * bool(options))
        window.check_messages()
        assert os.path.getsize(path) > 1000, path
        with open(path, "rb") as file:
            return file.read()

    window.resize_view(992, 665)
    assert not window.has_menu("Filters/Lacuna/RBF Hole Filler") and not window.has_menu("File/Save Data...")
    make("Skull Phantom", Spacing=(2, 2, 2))
    window.look_from_above()
    depth = make("B-Spline Iso Ray Caster", ViewDirection=(-0.4, 0.2, -0.9), PixelSpacing=(1.5,))
    make("Depth Map Surface")
    view = GetActiveView()
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [200, -100, 450], [0, 0, 0], [0, 1, 0]
    window.press("actionZoomToData")
    window.compare("ImplantSurface")

    # a rectangle around the hole, dragged over the surface
    window.press("actionSelectSurfacePoints")
    center = np.array([0.4, -0.2, 0.9]) / np.linalg.norm([0.4, -0.2, 0.9]) * 75
    corners = [center + 35 * np.array(d) for d in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0))]
    window.drag(box(view, corners))
    window.compare("ImplantSelection")
    window.select("pipelineBrowser", "BSplineIsoRayCaster1")
    assert GetActiveSource() == depth
    window.menu("Filters/Lacuna/RBF Hole Filler")
    filled = GetActiveSource()
    window.press("propertiesPanel/AdvancedButton")
    assert window.entries(PANEL + "Surface/QComboBox")[0] == "(none)"
    window.choose(PANEL + "Surface/QComboBox", "DepthMapSurface1")
    window.press("pushButtonCopySelection")
    window.press("propertiesPanel/AdvancedButton")
    window.type(PANEL + "NodeSpacing/DoubleLineEdit0", 3)
    window.choose(PANEL + "Kernel/ComboBox", "Cubic")
    assert filled.Surface is None and filled.Kernel == "ThinPlate", "before Apply"
    window.apply()
    assert filled.Kernel == "Cubic" and filled.NodeSpacing == 3
    mask = vtk_to_numpy(fetch(filled).GetPointData().GetArray("FilledMask"))
    print(f"filled {mask.sum()} pixels, {field(filled, 'DefectArea'):.0f} mm2", flush=True)
    assert 4000 < field(filled, "DefectArea") < 12000
    window.select("pipelineBrowser", "RBFHoleFiller1")  # which has moved there, behind both of its inputs
    window.choose("displayColor/Variables", "Deviation")
    window.compare("ImplantDeviation")
    window.choose("displayColor/Variables", "Depth")

    text = write("fit.igs", "IGES")
    assert text[72:73] == b"S" and b"Coordinates of the patient" in text
    make("Implant Plate")
    window.compare("ImplantPlate")
    write("plate.stl", "Stereo")
    window.select("pipelineBrowser", "RBFHoleFiller1")
    make("Defect Model")
    write("model.ply", "PLY")
    window.select("pipelineBrowser", "RBFHoleFiller1")
    window.press("actionPBHideAll")
    make("Press Orientation", says=STEEP)
    window.compare("ImplantMould")
    assert b"Coordinates of the press" in write("mould.igs", "IGES")
    make("Milling Tool Path", ToolRadius=(3,), StepOver=(3,), RoughingStep=(3,))
    window.compare("ImplantPath")
    program = write("mould.nc", "G-code")
    assert b"M30" in program and program.count(b"\n") > 1000


lacuna_window.main(test, STEEP)
