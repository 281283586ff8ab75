# SPDX-License-Identifier: BSD-3-Clause
"""In which coordinates data are, as far as it is known.

    from lacuna import coordinates
    coordinates.find(proxy)            # "patient, DICOM LPS", "press" or "unknown", with ", mirrored" behind it
"""
from lacuna.data import fetch

PATIENT, PRESS, UNKNOWN, MIRRORED = "patient, DICOM LPS", "press", "unknown", ", mirrored"
NAMES = {"Patient": PATIENT, "Press": PRESS}  # by the field data array Coordinates

# ParaView's filters that leave points where they are, by their labels.
KEEPING = frozenset((
    "Append Attributes", "Append Datasets", "Append Geometry", "Cell Data to Point Data", "Clean", "Clean to Grid",
    "Clip", "Connectivity", "Contour", "Decimate", "Extract Block", "Extract Cells By Region", "Extract Selection",
    "Extract Subset", "Extract Surface", "Feature Edges", "Generate Surface Normals", "Group Datasets",
    "Iso Volume", "Merge Blocks", "Pass Arrays", "Point Data to Cell Data", "Slice", "Surface Normals", "Tetrahedralize",
    "Threshold", "Triangulate"))

# ParaView's filters that set the direction of an image back to the identity.
RESETTING = frozenset(("Color By Array", "Crop", "Gradient Legacy", "Gradient Magnitude", "Image Shrink", "Median"))
IDENTITY = (1, 0, 0, 0, 1, 0, 0, 0, 1)
TOLERANCE = 1e-5  # of elements of a direction matrix, as in the filters


def find(source):
    """The coordinates of a proxy or of data (vtkDataObject), from the field data that Lacuna's filters pass on.

    ParaView's filters pass field data on, too, even those that move points (Transform, Reflect). Of a proxy these are
    seen in its pipeline, and the answer is "unknown"; data alone do not tell, nor do files. It is "unknown" as well
    where a filter has reset the direction of an image.
    """
    data = source
    if hasattr(source, "GetXMLLabel"):
        if not _keeps_points(source):
            return UNKNOWN
        data = fetch(source)
    if data is None or _is_reset(data):
        return UNKNOWN
    mark = data.GetFieldData().GetAbstractArray("Coordinates")
    name = UNKNOWN
    if mark is not None and mark.IsA("vtkStringArray") and mark.GetNumberOfValues() == 1:
        name = NAMES.get(mark.GetValue(0), UNKNOWN)
    return name + MIRRORED if is_mirrored(data) else name


def is_mirrored(data):
    """Whether data (vtkDataObject) are marked as a mirror image of the patient, or of what they show."""
    mark = data.GetFieldData().GetArray("Mirrored")
    return mark is not None and mark.GetNumberOfTuples() > 0 and mark.GetComponent(0, 0) != 0


def _is_same(matrix, other):
    return all(abs(a - b) <= TOLERANCE for a, b in zip(matrix, other))


def _is_reset(data):
    """Whether an image lies otherwise than its field data recorded (DirectionMatrix)."""
    record = data.GetFieldData().GetArray("DirectionMatrix")
    if record is None or record.GetNumberOfValues() != 9 or not data.IsA("vtkImageData") or not data.GetNumberOfPoints():
        return False
    return not _is_same(record.GetTuple(0), data.GetDirectionMatrix().GetData())


def _keeps_points(proxy):
    """Whether points come to a proxy from their source without having been moved by a filter of ParaView.

    Images are not asked: their points are where origin, spacing and direction say, unless the direction was reset.
    Where several come together, all have to be in the same coordinates.
    """
    inputs = proxy.GetProperty("Input")
    inputs = [inputs[k] for k in range(len(inputs))] if inputs is not None else []
    if inputs and not proxy.GetXMLName().startswith("Lacuna"):
        if proxy.GetXMLLabel() not in KEEPING and \
                proxy.GetDataInformation().DataInformation.GetDataSetTypeAsString() != "vtkImageData":
            return False
        record = proxy.FieldData.GetArray("DirectionMatrix") if proxy.GetXMLLabel() in RESETTING else None
        if record is not None and not _is_same([record.GetRange(k)[0] for k in range(9)], IDENTITY):
            return False
        if len(inputs) > 1 and len({find(each) for each in inputs}) > 1:
            return False
    return all(_keeps_points(each) for each in inputs)
