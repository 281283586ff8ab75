# SPDX-License-Identifier: BSD-3-Clause
"""A macro in the ParaView application draws pictures for a report at once: the same view from two sides."""
import os

import lacuna_window


def test(_window):
    from lacuna import pictures
    from paraview.simple import Delete, GetActiveView, Sphere
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader

    active = GetActiveView()
    ball = Sphere(Center=[40, 0, 0], Radius=30)
    view = pictures.new_picture((320, 240))
    pictures.show_surface(ball, view, (0.1, 0.2, 0.9))
    pictures.show_surface(Sphere(Center=[-40, 0, 0], Radius=30), view, (0.9, 0.2, 0.1))
    pictures.add_scale_bar(view, 20)
    blue = []
    for direction in ((0, 1, 0), (0, -1, 0)):
        pictures.look(view, direction, (0, 0, 1))
        name = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "WindowPictures.png")
        pictures.save(view, name)
        reader = vtkPNGReader()
        reader.SetFileName(name)
        reader.Update()
        pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(240, 320, -1).astype(int)
        seen = pixels[..., 2] > pixels[..., 0] + 60
        blue.append([int(seen[:, :160].sum()), int(seen[:, 160:].sum())])
    assert min(blue[0][1], blue[1][0]) > 2000 > 50 > max(blue[0][0], blue[1][1]), blue  # +x is on the right as one looks along +y
    Delete(view)
    assert GetActiveView() == active


if lacuna_window.IS_INSIDE:
    lacuna_window.inside(test)
else:
    lacuna_window.run(__file__)
