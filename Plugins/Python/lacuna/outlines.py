# SPDX-License-Identifier: BSD-3-Clause
"""Outlines of structures in slices: added by scripts, traced, kept in files, measured.

    from lacuna import outlines
    outliner = SliceOutliner(Input=slices)                    # tracked slices, or a volume
    outlines.add(outliner, "Kidney", 12, [(120, 80), (150, 70), (160, 100), (130, 115)])
    outlines.trace(outliner, "Kidney", 14, place=(140, 95))
    outlines.save(outliner, "kidney.csv")
    surfaces = OutlinedStructures(Input=outliner)
    print(outlines.table(surfaces)["Kidney"]["Volume (ml)"])

Slices have their number in the sweep, or the voxel index in a volume. Points are (column, row); the middle of the first
pixel is (0, 0).
"""
import csv
import math
import warnings

import numpy

COLUMNS = ("structure", "outline", "slice", "column", "row", "x", "y", "z", "handle", "color")


def get(outliner):
    """The outlines of a Slice Outliner: a list of dictionaries with structure (name), index (1, 2, ...), number, slice, points (N x 2)."""
    rows = numpy.array(outliner.OutlinePoints, dtype=float).reshape(-1, 5)
    names = list(outliner.StructureNames)
    found = {}
    for structure, number, where, column, row in rows:
        index = int(structure)
        name = names[index - 1] if index <= len(names) else f"Structure {index}"
        found.setdefault((index, int(number)), {"structure": name, "index": index, "number": int(number), "slice": int(where),
                                                "points": []})["points"].append((column, row))
    for outline in found.values():
        outline["points"] = numpy.array(outline["points"])
    return list(found.values())


def add(outliner, structure, number, points):
    """Adds an outline to slice `number`: three or more (column, row) in order, around the structure of this name."""
    points = numpy.asarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3 or not numpy.isfinite(points).all():
        raise ValueError(f"the outline of {structure} in slice {number} needs three or more points (column, row) of finite numbers")
    _set(outliner, get(outliner) + [{"structure": structure, "slice": int(number), "points": points}])


def remove(outliner, structure, number):
    """Takes away the outlines of a structure in a slice. Raises ValueError when there is none."""
    left = [outline for outline in get(outliner) if (outline["structure"], outline["slice"]) != (structure, number)]
    if len(left) == len(get(outliner)):
        raise ValueError(f"{structure} has no outline in slice {number}")
    _set(outliner, left)


def trace(outliner, structure, number, level=None, place=None, region=None, median=5, tolerance=0.7):
    """Adds the contour of slice `number` at a grey level, and returns its points (N x 2).

    level: None for Otsu's of the region. place: (column, row) in the structure: the innermost contour around it. Without place: that around
    the largest bright area in region: (first column, last column, first row, last row), None for all. median: pixels of the median filter
    before, odd, 1 for none. tolerance: pixels by which the kept points may miss the contour. Raises ValueError when there is no contour.
    """
    from vtkmodules.vtkCommonCore import vtkPoints

    from . import vtkLacunaOutlineTools
    picture = _picture(outliner, number)
    region = (0, -1, 0, -1) if region is None else tuple(int(v) for v in region)
    if level is None:
        level = vtkLacunaOutlineTools.ProposeLevel(picture, region)
    line, few = vtkPoints(), vtkPoints()
    if not vtkLacunaOutlineTools.Trace(picture, level, (math.nan, math.nan) if place is None else tuple(place), region, median, line):
        raise ValueError(f"slice {number} has no closed contour at {level:g}" + ("" if place is None else f" around column {place[0]:g}, row {place[1]:g}"))
    vtkLacunaOutlineTools.Simplify(line, tolerance, few)
    points = numpy.array([few.GetPoint(i)[:2] for i in range(few.GetNumberOfPoints())])
    add(outliner, structure, number, points)
    return points


def table(structures):
    """The table of Outlined Structures: a dictionary of dictionaries, by the structures' names and the columns' titles."""
    from paraview import servermanager

    from .data import fetch
    data = fetch(servermanager.OutputPort(structures, 1))
    titles = [data.GetColumnName(column) for column in range(data.GetNumberOfColumns())]
    rows = [{title: data.GetColumn(column).GetValue(row) for column, title in enumerate(titles)} for row in range(data.GetNumberOfRows())]
    names = [row["Name"] for row in rows]
    if len(set(names)) < len(names):
        raise ValueError(f"several structures are called {', '.join(sorted({name for name in names if names.count(name) > 1}))}; give each a name of its own")
    return {row["Name"]: row for row in rows}


def save(outliner, path):
    """Writes all outlines as CSV: the points of the curves in pixels and mm; `handle` is 1 for points that were given."""
    from .data import fetch
    from .files import writing
    data = fetch(outliner)
    cells, points = data.GetCellData(), data.GetPointData()
    names, numbers, slices, colors = (cells.GetAbstractArray(name) for name in ("StructureName", "Outline", "SliceNumber", "StructureColor"))
    left_out = len(get(outliner)) - data.GetNumberOfLines()
    if left_out:
        warnings.warn(f"{left_out} outlines lie in slices without a usable pose; they have no place in mm and are not in {path}")
    if data.GetNumberOfLines() == 0:
        raise ValueError("there is no outline to save")
    with writing(path) as name, open(name, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        for cell in range(data.GetNumberOfCells()):
            ids = data.GetCell(cell).GetPointIds()
            for i in range(ids.GetNumberOfIds() - 1):
                point = ids.GetId(i)
                column, row, _ = points.GetArray("Pixel").GetTuple(point)
                writer.writerow((names.GetValue(cell), numbers.GetValue(cell), slices.GetValue(cell), f"{column:.9g}", f"{row:.9g}",
                                 *(f"{x:.12g}" for x in data.GetPoint(point)), int(points.GetArray("Handle").GetValue(point)),
                                 "#{:02x}{:02x}{:02x}".format(*(int(v) for v in colors.GetTuple(cell)))))


def load(outliner, path):
    """Adds the outlines of a CSV file that save, or the panel Slice Outliner, has written. Returns how many."""
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        missing = [name for name in ("structure", "outline", "slice", "column", "row", "handle") if name not in (reader.fieldnames or ())]
        if missing:
            raise ValueError(f"{path} has no column {', '.join(missing)}; outlines of other programs: Outline Reader and outlines.take")
        found = {}
        for line, row in enumerate(reader, 2):
            try:
                key = row["structure"], int(row["outline"])
                where, point, handle = int(row["slice"]), (float(row["column"]), float(row["row"])), int(float(row["handle"]))
            except (TypeError, ValueError) as error:
                raise ValueError(f"{path}, line {line}: {error}") from None
            outline = found.setdefault(key, {"structure": key[0], "slice": where, "points": []})
            if outline["slice"] != where:
                raise ValueError(f"{path}, line {line}: outline {key[1]} of {key[0]} is in slice {outline['slice']}, too")
            if handle:
                outline["points"].append(point)
    for (name, number), outline in found.items():
        if len(outline["points"]) < 3:
            raise ValueError(f"{path}: outline {number} of {name} has fewer than three points with handle 1")
    _set(outliner, get(outliner) + list(found.values()))
    return len(found)


def take(outliner, source, distance=0.5, tolerance=0.3):
    """Adds closed outlines in mm, as of Outline Reader, to the slices in which they lie. Returns how many.

    distance: mm that an outline may leave its slice; ValueError when one leaves all slices by more. tolerance: pixels by which the points that
    are kept may miss the outline.
    """
    from vtkmodules.vtkCommonCore import vtkPoints

    from . import vtkLacunaOutlineTools
    from .data import fetch
    data = fetch(source)
    names = data.GetCellData().GetAbstractArray("StructureName")
    places = _places(outliner)
    added = []
    for cell in range(data.GetNumberOfCells()):
        ids = data.GetCell(cell).GetPointIds()
        line = numpy.array([data.GetPoint(ids.GetId(i)) for i in range(ids.GetNumberOfIds())])
        if len(line) > 1 and (line[0] == line[-1]).all():
            line = line[:-1]
        best = None
        for number, place in places.items():
            across = numpy.cross(place[:3, 0], place[:3, 1])
            away = numpy.abs((line - place[:3, 3]) @ (across / numpy.linalg.norm(across))).max()
            if best is None or away < best[0]:
                best = away, number, place
        if best is None or best[0] > distance:
            raise ValueError(f"outline {cell} lies in no slice: it leaves the nearest one{'' if best is None else f', {best[1]}, by {best[0]:.2f} mm'}; give a larger distance, or use Outlined Structures without a Slice Outliner")
        pixels = numpy.linalg.lstsq(best[2][:3, :2], (line - best[2][:3, 3]).T, rcond=None)[0].T
        points, few = vtkPoints(), vtkPoints()
        for column, row in pixels:
            points.InsertNextPoint(column, row, 0)
        vtkLacunaOutlineTools.Simplify(points, tolerance, few)
        added.append({"structure": names.GetValue(cell) if names else "Structure 1", "slice": best[1],
                      "points": numpy.array([few.GetPoint(i)[:2] for i in range(few.GetNumberOfPoints())])})
    _set(outliner, get(outliner) + added)
    return len(added)


def _set(outliner, outlines):
    """Outlines that have an index keep it; the others go to the structure of their name, or to a new one."""
    names = list(outliner.StructureNames)
    for outline in outlines:
        while len(names) < outline.get("index", 0):
            names.append(f"Structure {len(names) + 1}")
    numbers, values = {}, []
    for outline in outlines:
        if "index" not in outline and outline["structure"] not in names:
            names.append(outline["structure"])
    for outline in outlines:
        structure = outline.get("index") or names.index(outline["structure"]) + 1
        number = numbers.get(structure, 0)
        numbers[structure] = number + 1
        for column, row in outline["points"]:
            values += [structure, number, outline["slice"], float(column), float(row)]
    outliner.StructureNames = names
    outliner.OutlinePoints = values
    outliner.SMProxy.UpdatePropertyInformation()
    outliner.VolumeGrid = list(outliner.GetProperty("InputGrid").GetData())


def _picture(outliner, number):
    """A slice as an image in columns and rows."""
    from paraview import servermanager
    from vtkmodules.vtkCommonDataModel import vtkImageData

    from .data import fetch
    before, outliner.Slice = outliner.Slice, int(number)
    try:
        grid = fetch(servermanager.OutputPort(outliner, 1))
        if grid.GetNumberOfPoints() == 0:
            raise ValueError(f"slice {number} has no usable pose")
        origin, step = (grid.GetFieldData().GetArray(name).GetTuple(0) for name in ("PixelOrigin", "PixelStep"))
        if int(grid.GetFieldData().GetArray("SliceNumber").GetValue(0)) != int(number):
            raise ValueError(f"slice {number} is not in this stack")
        picture = vtkImageData()
        picture.SetExtent(grid.GetExtent())
        picture.SetOrigin(*origin, 0)
        picture.SetSpacing(*step, 1)
        picture.GetPointData().SetScalars(grid.GetPointData().GetScalars())
        return picture
    finally:
        outliner.Slice = before


def _places(outliner):
    """(column, row, 0, 1) to mm by the numbers of slices, of those that have a pose."""
    from .data import fetch
    image = fetch(outliner.Input)
    poses = image.GetFieldData().GetArray("ImageToReference")
    if poses:
        extent, origin, spacing = image.GetExtent(), image.GetOrigin()[2], image.GetSpacing()[2]
        status = image.GetFieldData().GetArray("SliceStatus")
        found = {round(origin + k * spacing): None for k in range(extent[4], extent[5] + 1)}
        found = {i: numpy.array(poses.GetTuple(i)).reshape(4, 4) for i in found if not (status and int(status.GetValue(i)) & 1)}
        return {i: place for i, place in found.items() if numpy.isfinite(place).all()}
    extent, matrix = image.GetExtent(), image.GetIndexToPhysicalMatrix()
    whole = numpy.array([[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])
    found = {}
    for k in range(extent[4], extent[5] + 1):
        place = whole.copy()
        place[:, 3] = whole @ (0, 0, k, 1)
        found[k] = place
    return found
