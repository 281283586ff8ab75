# SPDX-License-Identifier: BSD-3-Clause
"""Compares speckle filters on one image, as the thesis's section 4.5.

    from lacuna import speckle
    rows = speckle.compare(image, inside_array="Inside", iso_value=120)
    print(speckle.table(rows))
"""
import paraview.simple as pv

from lacuna.data import fetch

#: label -> properties of Speckle Filter; None is the image as it is.
FILTERS = {
    "none": None,
    "Mean 5x5": dict(Operation="Mean", KernelSize=[5, 5, 1]),
    "Gaussian 1.41": dict(Operation="Gaussian", KernelSize=[5, 5, 1], StandardDeviation=2 ** 0.5),
    "Median 5x5": dict(Operation="Median", KernelSize=[5, 5, 1]),
    "Mode 5x5": dict(Operation="Mode", KernelSize=[5, 5, 1]),
    "AdaptiveMedian 5x5": dict(Operation="AdaptiveMedian", KernelSize=[5, 5, 1], AdaptiveStrength=1),
    "Opening 5x5": dict(Operation="Opening", KernelSize=[5, 5, 1], KernelShape="Ellipsoid"),
    "Closing 5x5": dict(Operation="Closing", KernelSize=[5, 5, 1], KernelShape="Ellipsoid"),
    "OpenClose 5x5": dict(Operation="OpenClose", KernelSize=[5, 5, 1], KernelShape="Ellipsoid"),
    "CloseOpen 5x5": dict(Operation="CloseOpen", KernelSize=[5, 5, 1], KernelShape="Ellipsoid"),
}

COLUMNS = ("CSR", "InsideMean", "InsideSNR", "OutsideMean", "OutsideSNR", "Regions")


def measure(image, inside_array="", outside_array="", inside_bounds=None, outside_bounds=None,
            iso_value=128, scalar_array=""):
    """The row of Contrast To Speckle as a dictionary. image: a pipeline proxy."""
    contrast = pv.ContrastToSpeckle(Input=image, InsideArray=inside_array, OutsideArray=outside_array,
                                    IsoValue=iso_value, ScalarArray=scalar_array)
    if inside_bounds is not None:
        contrast.InsideBounds = inside_bounds
    if outside_bounds is not None:
        contrast.OutsideBounds = outside_bounds
    table = fetch(contrast)
    pv.Delete(contrast)
    return {table.GetColumnName(i): table.GetColumn(i).GetValue(0)
            for i in range(table.GetNumberOfColumns())}


def compare(image, filters=None, **regions):
    """One row for each filter: the keys of measure(), and the label as "filter".

    filters: label -> properties of Speckle Filter (None: the image as it is); default FILTERS.
    regions: inside_array, outside_array, inside_bounds, outside_bounds, iso_value, scalar_array, as in measure().
    """
    rows = []
    for label, properties in (FILTERS if filters is None else filters).items():
        if properties is None:
            rows.append(dict(filter=label, **measure(image, **regions)))
            continue
        filtered = pv.SpeckleFilter(Input=image, ScalarArray=regions.get("scalar_array", ""), **properties)
        rows.append(dict(filter=label, **measure(filtered, **regions)))
        pv.Delete(filtered)
    return rows


def table(rows):
    """The rows of compare() as a Markdown table."""
    lines = ["| filter | " + " | ".join(COLUMNS) + " |", "|---|" + "---:|" * len(COLUMNS)]
    for row in rows:
        cells = [str(row[c]) if isinstance(row[c], int) else f"{row[c]:.2f}" for c in COLUMNS]
        lines.append(f"| {row['filter']} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def truth_masks(sweep, inside, outside):
    """One slice of a Phantom Sweep with the point arrays Inside and Outside.

    sweep: a Phantom Sweep of one slice. inside, outside: (least, greatest) true grey level of the two
    regions. The masks come from the scene without speckle, so no filter can influence them.
    """
    quiet = pv.PhantomSweep(SpeckleLevel=0)
    for name in ("Anatomy", "NumberOfSlices", "ImageSize", "PixelSpacing", "Motion", "EdgeWidth", "Center"):
        setattr(quiet, name, getattr(sweep, name))
    masks = quiet
    for name, (least, greatest) in (("Inside", inside), ("Outside", outside)):
        masks = pv.Calculator(Input=masks, ResultArrayName=name,
                              Function=f"(Intensity >= {least}) * (Intensity <= {greatest})")
    return pv.AppendAttributes(Input=[sweep, masks])
