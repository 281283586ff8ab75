# SPDX-License-Identifier: BSD-3-Clause
"""Pictures in one style: white background, matt surfaces, scalar bars with units."""
import numpy as np
import paraview.simple as pv
from paraview import servermanager
from paraview.modules.vtkRemotingViews import vtkPVView
from paraview.servermanager import vtkSMTransferFunctionPresets
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkChartsCore import vtkAxis, vtkChart, vtkChartLegend, vtkChartXY
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkTable
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter
from vtkmodules.vtkRenderingCore import vtkTextProperty, vtkTextRenderer, vtkWindowToImageFilter
from vtkmodules.vtkRenderingFreeType import vtkFreeTypeTools
from vtkmodules.vtkViewsContext2D import vtkContextView
import vtkmodules.vtkRenderingContextOpenGL2  # noqa: F401 (draws charts)

from lacuna.data import fetch
from lacuna.files import writing
from lacuna.views import annotations, map_letters, text_color

BONE = (0.93, 0.89, 0.80)
METAL = (0.62, 0.66, 0.72)
TISSUE = (0.80, 0.45, 0.38)
FRAME = (0.55, 0.63, 0.75)


def new_view(size=(1200, 900)):
    """A render view on white with dark text."""
    return _style(pv.CreateView("RenderView"), size)


def new_picture(size):
    """As new_view, for a picture alone: in the ParaView application it is in no layout, and can be drawn at once.

    A view in a window that Qt has not shown yet gives black pictures.
    """
    if not vtkPVView.GetUseGenericOpenGLRenderWindow():
        return new_view(size)
    vtkPVView.SetUseGenericOpenGLRenderWindow(False)
    try:
        view = servermanager._create_view("RenderView")
    finally:
        vtkPVView.SetUseGenericOpenGLRenderWindow(True)
    view.GetRenderWindow().SetOffScreenRendering(1)
    return _style(view, size)


def _style(view, size):
    view.ViewSize = list(size)
    view.UseColorPaletteForBackground = 0
    view.BackgroundColorMode = "Gradient"
    view.Background = [1.0, 1.0, 1.0]
    view.Background2 = [0.86, 0.89, 0.93]
    view.OrientationAxesLabelColor = [0.1, 0.1, 0.1]
    view.CenterAxesVisibility = 0
    view.KeyLightElevation, view.KeyLightAzimuth = 25, -20
    view.KeyLightWarmth, view.KeyLightIntensity = 0.55, 0.72
    return view


def _draw_labels_once():
    """Texts of render views turn this off, and then VTK 9.2 draws the labels of charts one and a half times."""
    vtkFreeTypeTools.GetInstance().SetScaleToPowerTwo(True)


def new_chart(bottom, left, size=(900, 600)):
    """A chart view of ParaView's with the titles of its axes."""
    _draw_labels_once()
    view = pv.CreateView("XYChartView")
    view.ViewSize = list(size)
    view.BottomAxisTitle, view.LeftAxisTitle = bottom, left
    return view


def contour(volume, grey, level, **options):
    """ParaView's Contour of a volume at a level of the point array grey."""
    return pv.Contour(Input=volume, ContourBy=["POINTS", grey], Isosurfaces=[level], ComputeScalars=0, **options)


def show_surface(proxy, view, color):
    """Shows a surface in one matt colour."""
    display = pv.Show(proxy, view)
    display.ColorArrayName = [None, ""]
    display.AmbientColor = display.DiffuseColor = list(color)
    display.Specular = 0.15
    display.SpecularPower = 20
    return display


def marked_points(image, array, all_name, name):
    """The pixels or voxels of an image where an array is above a half, as points to be shown; names are the pipeline browser's."""
    points = pv.MaskPoints(registrationName=all_name, Input=image, OnRatio=1, MaximumNumberofPoints=10000000, GenerateVertices=1, SingleVertexPerCell=1)
    return pv.Threshold(registrationName=name, Input=points, Scalars=["POINTS", array], ThresholdMethod="Above Upper Threshold", UpperThreshold=0.5)


def apply_preset(table, name):
    """Gives a color transfer function the colours of a preset: ParaView 5 calls Viridis "Viridis (matplotlib)", 6 does not."""
    presets = vtkSMTransferFunctionPresets.GetInstance()
    table.ApplyPreset(name if presets.HasPreset(name) else f"{name} (matplotlib)", True)


def number_format(pattern, like):
    """A format of numbers, given as "{:.2f}", in the style of another one: printf's, %.2f, in ParaView 5, this one in 6."""
    return pattern if "{" in like else pattern.replace("{:", "%").replace("}", "")


def _set_digits(bar, digits):
    """How many decimals a scalar bar shows."""
    bar.AutomaticLabelFormat = 0
    bar.LabelFormat = bar.RangeLabelFormat = number_format(f"{{:.{digits}f}}", bar.LabelFormat)


def color_by(display, view, array, title, bounds, preset="Cool to Warm"):
    """Colours by a point array over fixed bounds, with a scalar bar that says what it is."""
    pv.ColorBy(display, ("POINTS", array))
    table = pv.GetColorTransferFunction(array, display, separate=True)
    apply_preset(table, preset)
    table.RescaleTransferFunction(*bounds)
    table.NanOpacity = 0
    display.LookupTable = table
    display.SetScalarBarVisibility(view, True)
    bar = pv.GetScalarBar(table, view)
    bar.Title, bar.ComponentTitle = title, ""
    bar.TitleColor = bar.LabelColor = text_color(view)
    _set_digits(bar, 2)
    bar.WindowLocation = "Lower Right Corner"
    return table


def show_image(image, view, array, title, bounds, preset="Grayscale"):
    """Shows an image that is one pixel deep, an output of a source too, flat by a point array; returns its display."""
    view.OrientationAxesVisibility = 0
    display = pv.Show(image, view)
    display.SetRepresentationType("Slice")
    color_by(display, view, array, title, bounds, preset)
    return display


def show_slices(planes, view):
    """Shows Slice Planes as pictures, not as lit surfaces: in grey levels, or by speed or error with units.

    The colours of Speed change from blue to red at the SpeedLimit. What has no value is red in grey pictures, else yellow.
    """
    display = pv.Show(planes, view)
    display.Ambient, display.Diffuse, display.Specular = 1, 0, 0
    display.LineWidth = 2
    name = planes.GetProperty("ColorBy").GetData()
    if planes.OutlineOnly and name == "Intensity":
        display.ColorArrayName = [None, ""]
        display.AmbientColor = display.DiffuseColor = [0.25, 0.35, 0.5]
        return display
    place = "CELLS" if name == "Speed" else "POINTS"
    planes.UpdatePipeline()
    low, high = (planes.CellData if name == "Speed" else planes.PointData)[name].GetRange()
    pv.ColorBy(display, (place, name))
    table = pv.GetColorTransferFunction(name, display, separate=True)
    apply_preset(table, {"Intensity": "Grayscale", "Speed": "Cool to Warm"}.get(name, "Viridis"))
    if name == "Speed" and planes.SpeedLimit > 0:
        low, high = 0, 2 * planes.SpeedLimit
    table.RescaleTransferFunction(low, high if high > low else low + 1)
    table.NanColor = [0.85, 0.1, 0.1] if name == "Intensity" else [1, 0.85, 0]
    display.LookupTable = table
    display.SetScalarBarVisibility(view, True)
    bar = pv.GetScalarBar(table, view)
    bar.Title = {"Intensity": "Grey level", "Speed": "Speed (mm/s)"}.get(name, "Expected error (mm)")
    bar.ComponentTitle = ""
    bar.TitleColor = bar.LabelColor = text_color(view)
    _set_digits(bar, 2 if name == "RegistrationError" else 0)
    bar.WindowLocation = "Lower Right Corner"
    return display


def look(view, direction, up, zoom=1.0):
    """Points the camera along direction with up upwards and everything in sight."""
    camera = view.GetActiveCamera()
    camera.SetPosition(0, 0, 0)
    camera.SetFocalPoint(*direction)
    camera.SetViewUp(*up)
    view.CameraParallelProjection = 1
    pv.ResetCamera(view)
    camera.Zoom(zoom)


def add_scale_bar(view, millimetres, aside=False):
    """A bar of that length with its label at the lower edge. After look(): it holds for that view.

    aside: left of the middle, where a letter of views.show_orientation is.
    """
    camera = view.GetActiveCamera()
    direction, up = np.array(camera.GetDirectionOfProjection()), np.array(camera.GetViewUp())
    right = np.cross(direction, up)
    right /= np.linalg.norm(right)
    up = np.cross(right, direction)
    # parallel projection: the window is twice ParallelScale high; in front of all that is shown
    near = 0.9 * camera.GetClippingRange()[0] + 0.1 * camera.GetClippingRange()[1]
    scale, (width, height) = camera.GetParallelScale(), view.ViewSize
    middle = np.array(camera.GetPosition()) + near * direction - 0.84 * scale * up
    if aside:
        middle -= 0.4 * scale * width / height * right
    line = pv.Line(Point1=list(middle - millimetres / 2 * right), Point2=list(middle + millimetres / 2 * right))
    show_surface(line, view, text_color(view)).LineWidth = 5
    annotations.add(line.GetGlobalIDAsString())
    text = f"{millimetres:g} mm"
    display = pv.Show(pv.Text(Text=text), view)
    display.Color = text_color(view)
    display.FontSize = 18
    display.WindowLocation = "Lower Center"
    if aside:
        display.WindowLocation = "Any Location"
        display.Position = [0.3 - 0.3 * 18 * len(text) / width, 0.015]


def add_title(view, text):
    """A line of dark text at the upper edge."""
    display = pv.Show(pv.Text(Text=text), view)
    display.Color = [0.1, 0.1, 0.1]
    display.FontSize = 18
    display.WindowLocation = "Upper Center"
    return display


def save(view, name):
    """Renders into a PNG file."""
    pv.Render(view)
    with writing(name) as aside:
        pv.SaveScreenshot(aside, view, ImageResolution=list(view.ViewSize))


def lay_out(views, title):
    """Puts views side by side, in a layout of that name in ParaView's window, each with its share of the width. Returns the layout, for save_layout."""
    layout = pv.CreateLayout(title)
    widths = [view.ViewSize[0] for view in views]
    cell = 0
    for index, view in enumerate(views[:-1]):
        left = layout.SplitHorizontal(cell, widths[index] / sum(widths[index:]))
        layout.AssignView(left, view)
        cell = left + 1
    layout.AssignView(cell, views[-1])
    return layout


def save_layout(layout, name, rendered=False):
    """Renders all views of a layout into a PNG file, as large as they are together. rendered: they have been drawn before, as by look()."""
    views = pv.GetViewsInLayout(layout)
    size = [sum(view.ViewSize[0] for view in views), max(view.ViewSize[1] for view in views)]
    layout.SetSize(*size)
    for view in [] if rendered else views:
        pv.Render(view)
    with writing(name) as aside:
        pv.SaveScreenshot(aside, layout, SaveAllViews=1, ImageResolution=size, SeparatorWidth=2, SeparatorColor=[1, 1, 1])


def shaded_pixels(proxy):
    """The picture of a Depth Map Shader as (rows, columns, red green blue), uint8; row 0 is on top."""
    image = fetch(proxy)
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetArray("Color")).reshape(height, width, 3)


def show_shaded(proxy, view):
    """Shows a Depth Map Shader, or a Depth Map Surface behind one, in the picture's own colours."""
    display = pv.Show(proxy, view)
    pv.ColorBy(display, ("POINTS", "Color"))
    display.MapScalars = 0
    if display.Representation != "Slice":
        display.Ambient, display.Diffuse = 1, 0  # the picture has its light already
    return display


def write_pixels(name, pixels):
    """Writes (rows, columns, red green blue), row 0 on top, as PNG: as the viewer sees it, not mirrored."""
    height, width, _ = pixels.shape
    image = vtkImageData()
    image.SetDimensions(width, height, 1)
    upwards = np.ascontiguousarray(pixels[::-1], dtype=np.uint8)  # VTK writes the last row first
    image.GetPointData().SetScalars(numpy_to_vtk(upwards.reshape(-1, 3), deep=1))
    writer = vtkPNGWriter()
    writer.SetInputData(image)
    with writing(name) as aside:
        writer.SetFileName(aside)
        writer.Write()


def read_pixels(name):
    """Red, green and blue of a PNG file; row 0 on top."""
    reader = vtkPNGReader()
    reader.SetFileName(name)
    reader.Update()
    width, height, _ = reader.GetOutput().GetDimensions()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(height, width, 3)[::-1]


def text_pixels(text, size=13, dpi=72):
    """Dark text on white as (rows, columns, red green blue), row 0 on top."""
    style = vtkTextProperty()
    style.SetFontSize(size)
    style.SetColor(0, 0, 0)
    image = vtkImageData()
    if not vtkTextRenderer.GetInstance().RenderString(style, text, image, [0, 0], dpi):
        raise RuntimeError("no text can be rendered: " + text)
    width, height, _ = image.GetDimensions()
    values = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[::-1]
    opacity = values[..., 3:].astype(float) / 255
    grey = np.where(opacity > 0, 255 - 215 * opacity, 255).astype(np.uint8)
    filled = np.nonzero((grey < 255).any(axis=(1, 2)))[0]
    columns = np.nonzero((grey < 255).any(axis=(0, 2)))[0]
    grey = grey[filled[0]:filled[-1] + 1, columns[0]:columns[-1] + 1]
    return grey.repeat(3, axis=2)


def put_pixels(pixels, part, row, column):
    """Writes part into pixels with its upper left corner at row and column; what lies outside is left out."""
    row, column = max(row, 0), max(column, 0)
    height, width = min(part.shape[0], pixels.shape[0] - row), min(part.shape[1], pixels.shape[1] - column)
    if height > 0 and width > 0:
        pixels[row:row + height, column:column + width] = part[:height, :width]


def mark_pixels(pixels, letters, size=15, background=(255, 255, 255)):
    """A copy of a picture (rows, columns, red green blue; row 0 on top) in a frame with letters at its edges.

    letters: as of views.map_letters, by edge.
    """
    labels = {edge: text_pixels(text, size) for edge, text in letters.items()}
    margin = max(max(labels[edge].shape[0] for edge in ("top", "bottom")),
                 max(labels[edge].shape[1] for edge in ("left", "right"))) + 8
    height, width, _ = pixels.shape
    framed = np.empty((height + 2 * margin, width + 2 * margin, 3), dtype=np.uint8)
    framed[:] = background
    framed[margin:-margin, margin:-margin] = pixels
    centers = {"top": (margin / 2, framed.shape[1] / 2), "bottom": (framed.shape[0] - margin / 2, framed.shape[1] / 2),
               "left": (framed.shape[0] / 2, margin / 2), "right": (framed.shape[0] / 2, framed.shape[1] - margin / 2)}
    for edge, label in labels.items():
        row, column = centers[edge]
        put_pixels(framed, label, round(row - label.shape[0] / 2), round(column - label.shape[1] / 2))
    return framed


def side_by_side(panels, gap=6):
    """One picture of (title, pixels) side by side, each with its title above; row 0 on top."""
    margin = 22
    height = max(pixels.shape[0] for _, pixels in panels)
    parts = []
    for title, pixels in panels:
        part = np.full((height + margin, pixels.shape[1] + gap, 3), 255, dtype=np.uint8)
        if title:
            label = text_pixels(title)
            put_pixels(part, label, 4, (pixels.shape[1] - label.shape[1]) // 2)
        put_pixels(part, pixels, margin, 0)
        parts.append(part)
    return np.concatenate(parts, axis=1)[:, :-gap]


def color_bar(to_colors, low, high, unit, height, ticks=5, sign="+"):
    """A scale of that height: to_colors makes (rows, columns, red green blue) of an array of values. sign: before numbers above 0."""
    margin = 8
    bar = np.full((height, 95, 3), 255, dtype=np.uint8)
    length = height - 2 * margin
    values = np.linspace(high, low, length)[:, None].repeat(16, axis=1)
    put_pixels(bar, to_colors(values), margin, 8)
    for value in np.linspace(low, high, ticks):
        row = margin + int(round((high - value) / (high - low) * (length - 1)))
        bar[row, 24:28] = 60
        label = text_pixels(f"{value:{sign}.2f} {unit}" if value else f"0 {unit}", 11)
        put_pixels(bar, label, row - label.shape[0] // 2, 31)
    return bar


def save_shaded(proxy, name, marks=False):
    """Saves the picture of a Depth Map Shader as PNG, pixel by pixel.

    marks: framed by the patient's sides; raises ValueError as views.map_letters does.
    """
    pixels = shaded_pixels(proxy)
    write_pixels(name, mark_pixels(pixels, map_letters(proxy)) if marks else pixels)


def chart_pixels(curves, titles, size=(760, 460), bounds=None, legend=True):
    """A chart as (rows, columns, red green blue), row 0 on top.

    curves: of (label, x, y, colour, style); colour is red, green, blue from 0 to 255, style "line", "dashes" or "points".
    titles: of the axes, below and on the left. bounds: of both axes ((x0, x1), (y0, y1)), default: what the curves need.
    """
    _draw_labels_once()
    view = vtkContextView()
    view.GetRenderer().SetBackground(1, 1, 1)
    window = view.GetRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(*size)
    chart = vtkChartXY()
    view.GetScene().AddItem(chart)
    tables = []  # charts do not keep them
    for label, x, y, color, style in curves:
        table = vtkTable()
        for name, values in (("x", x), (label, y)):
            array = numpy_to_vtk(np.ascontiguousarray(values, dtype=float), deep=1)
            array.SetName(name)
            table.AddColumn(array)
        plot = chart.AddPlot(vtkChart.POINTS if style == "points" else vtkChart.LINE)
        plot.SetInputData(table, 0, 1)
        plot.SetColor(*color, 255)
        plot.SetWidth(2.5)
        if style == "dashes":
            plot.GetPen().SetLineType(2)
        if style == "points":
            plot.SetMarkerStyle(4)  # circles
            plot.SetMarkerSize(8)
        tables.append(table)
    for place, title in ((vtkAxis.BOTTOM, titles[0]), (vtkAxis.LEFT, titles[1])):
        axis = chart.GetAxis(place)
        axis.SetTitle(title)
        axis.SetNotation(vtkAxis.PRINTF_NOTATION)
        axis.SetLabelFormat(number_format(" {:g} ", axis.GetLabelFormat()))  # else the last column of a label stands before it too
        axis.GetGridPen().SetColor(225, 229, 233, 255)
        for text in (axis.GetTitleProperties(), axis.GetLabelProperties()):
            text.SetFontSize(15)
            text.SetBold(False)
            text.SetColor(0.15, 0.15, 0.15)
        if bounds:
            axis.SetBehavior(vtkAxis.FIXED)
            axis.SetRange(*bounds[0 if place == vtkAxis.BOTTOM else 1])
    chart.SetShowLegend(legend)
    chart.GetLegend().GetLabelProperties().SetFontSize(14)
    chart.GetLegend().SetHorizontalAlignment(vtkChartLegend.LEFT)
    chart.GetLegend().SetVerticalAlignment(vtkChartLegend.TOP)
    window.Render()
    picture = vtkWindowToImageFilter()
    picture.SetInput(window)
    picture.ShouldRerenderOff()
    picture.Update()
    image = picture.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[::-1, :, :3].copy()
