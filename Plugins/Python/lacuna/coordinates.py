# SPDX-License-Identifier: BSD-3-Clause
"""In which coordinates data are, as far as it is known.

    from lacuna import coordinates
    coordinates.find(proxy)            # "patient, DICOM LPS", "press" or "unknown"

With ", as the file says" behind it when the data were read from a file other than DICOM, and ", mirrored".
"""
import functools
import math

from vtkmodules.vtkCommonCore import vtkFloatArray
from vtkmodules.vtkCommonDataModel import vtkImageData

from lacuna.data import fetch

PATIENT, PRESS, UNKNOWN, MIRRORED = "patient, DICOM LPS", "press", "unknown", ", mirrored"
AS_FILE = ", as the file says"  # whose data may have been moved before they were written
NAMES = {"Patient": PATIENT, "Press": PRESS}  # by the field data array Coordinates

# ParaView's filters that leave points where they are, by their labels.
KEEPING = frozenset((
    "Append Attributes", "Append Datasets", "Append Geometry", "Cell Data to Point Data", "Clean", "Clean to Grid",
    "Clip", "Connectivity", "Contour", "Decimate", "Extract Block", "Extract Cells By Region", "Extract Selection",
    "Extract Subset", "Extract Surface", "Feature Edges", "Generate Surface Normals", "Group Datasets",
    "Iso Volume", "Merge Blocks", "Pass Arrays", "Point Data to Cell Data", "Slice", "Surface Normals", "Tetrahedralize",
    "Threshold", "Triangulate"))

# ParaView's filters that cut the cells of an image as though its direction were the identity, all of them in 5.11: their points
# are where nothing of the patient is. Slices by planes and crinkle clips, which cut no cell, are right.
STRAIGHTENING = frozenset(("Clip", "Contour", "Iso Volume", "Slice"))

# Those that move points and may give an image all the same, whose directions are then the identity.
MOVING = frozenset(("Axis-Aligned Reflect", "Axis-Aligned Transform"))

# ParaView's filters that set the direction of an image back to the identity, in 5.11; later ones may keep it.
RESETTING = frozenset(("Color By Array", "Crop", "Gradient Legacy", "Gradient Magnitude", "Image Shrink", "Median"))
IDENTITY = (1, 0, 0, 0, 1, 0, 0, 0, 1)
TOLERANCE = 1e-5  # of elements of a direction matrix, as in the filters


def find(source):
    """The coordinates of a proxy or of data (vtkDataObject), from the field data that Lacuna's filters pass on.

    ParaView's filters pass field data on, too, even those that move points (Transform, Reflect). Of a proxy these are
    seen in its pipeline, and the answer is "unknown"; data alone do not tell, nor do files. It is "unknown" as well
    where a filter has reset the direction of an image, or does not heed it (STRAIGHTENING).
    """
    name = _place(source)
    if name != UNKNOWN and hasattr(source, "GetXMLLabel") and _is_from_file(source):
        name += AS_FILE
    return name + MIRRORED if is_mirrored(source) else name


def is_patient(source):
    """Whether a proxy or data (vtkDataObject) are in patient coordinates and not mirrored, as far as it is known; files
    are believed.
    """
    return _place(source) == PATIENT and not is_mirrored(source)


def _place(source):
    """PATIENT, PRESS or UNKNOWN, without how it is known."""
    data = source
    if hasattr(source, "GetXMLLabel"):
        if not keeps_points(source):
            return UNKNOWN
        data = fetch(source)
    if data is None or _is_reset(data):
        return UNKNOWN
    mark = data.GetFieldData().GetAbstractArray("Coordinates")
    if mark is not None and mark.IsA("vtkStringArray") and mark.GetNumberOfValues() == 1:
        return NAMES.get(mark.GetValue(0), UNKNOWN)
    return UNKNOWN


def is_mirrored(source):
    """Whether a proxy or data (vtkDataObject) are a mirror image of the patient, or of what they show.

    Data are by their mark, which filters of ParaView may drop; proxies also behind Mirror, Reflect and a Transform with
    a negative Scale, whatever comes after it.
    """
    data = source
    if hasattr(source, "GetXMLLabel"):
        if _is_behind_reflection(source):
            return True
        data = fetch(source)
    mark = None if data is None else data.GetFieldData().GetArray("Mirrored")
    return mark is not None and mark.GetNumberOfTuples() > 0 and mark.GetComponent(0, 0) != 0


def _is_behind_reflection(proxy):
    """Whether Mirror's image (its first output), a Reflect or a mirroring Transform is in a pipeline; a PriorSurface from
    one is a pattern only.
    """
    label = proxy.GetXMLLabel()
    if proxy.GetXMLName() == "LacunaMirror" and proxy.Port == 0 or label in ("Reflect", "Axis-Aligned Reflect"):
        return True
    if label == "Axis-Aligned Transform" and math.prod(proxy.Scale) < 0:
        return True
    if label == "Transform" and proxy.Transform.GetXMLLabel() == "Transform" and math.prod(proxy.Transform.Scale) < 0:
        return True
    return any(_is_behind_reflection(each) for each in _inputs(proxy))


def _is_from_file(proxy):
    """Whether data of a pipeline are from a file with marks, not from DICOM, where the scanner says how the patient lay."""
    inputs = _inputs(proxy)
    if inputs:
        return any(_is_from_file(each) for each in inputs)
    return not proxy.GetXMLName().startswith("Lacuna") and \
        any(proxy.GetProperty(name) is not None for name in ("FileName", "FileNames"))


def _inputs(proxy):
    inputs = proxy.GetProperty("Input")
    return [inputs[k] for k in range(len(inputs))] if inputs is not None else []


def _is_same(matrix, other):
    return all(abs(a - b) <= TOLERANCE for a, b in zip(matrix, other))


def _is_reset(data):
    """Whether an image lies otherwise than its field data recorded (DirectionMatrix)."""
    record = data.GetFieldData().GetArray("DirectionMatrix")
    if record is None or record.GetNumberOfValues() != 9 or not data.IsA("vtkImageData") or not data.GetNumberOfPoints():
        return False
    return not _is_same(record.GetTuple(0), data.GetDirectionMatrix().GetData())


def _record(proxy):
    """The field data DirectionMatrix of a proxy's data, or None."""
    record = proxy.FieldData.GetArray("DirectionMatrix")
    if record is None or record.GetNumberOfTuples() != 1 or record.GetNumberOfComponents() != 9:
        return None
    return [record.GetRange(k)[0] for k in range(9)]


def _is_image(proxy):
    return proxy.GetDataInformation().DataInformation.GetDataSetTypeAsString() == "vtkImageData"


def _is_no_transform(proxy):
    """Whether a proxy is a Transform that leaves points where they are."""
    return proxy.GetXMLLabel() == "Transform" and proxy.Transform.GetXMLLabel() == "Transform" and \
        [*proxy.Transform.Translate, *proxy.Transform.Rotate, *proxy.Transform.Scale] == [0, 0, 0, 0, 0, 0, 1, 1, 1]


@functools.lru_cache(maxsize=None)
def _is_right(label):
    """Whether a filter that cuts by values heeds the direction of an image: tried on values that rise along y. In ParaView 5.11
    none does, in 5.13 Clip and Iso Volume do.
    """
    from paraview.modules.vtkPVVTKExtensionsFiltersGeneral import vtkIsoVolume, vtkPVClipDataSet
    from vtkmodules.vtkFiltersCore import vtkContourFilter
    image, values = vtkImageData(), vtkFloatArray()
    image.SetDimensions(2, 2, 2)
    image.SetDirectionMatrix(0, 0, 1, 1, 0, 0, 0, 1, 0)
    values.SetName("Rising")
    for k in range(8):
        values.InsertNextValue(k % 2)
    image.GetPointData().SetScalars(values)
    cut = {"Clip": vtkPVClipDataSet, "Contour": vtkContourFilter, "Iso Volume": vtkIsoVolume}[label]()
    if label == "Iso Volume":
        cut.ThresholdBetween(0.5, 2)
    elif label == "Clip":
        cut.SetValue(0.5)
    else:
        cut.SetValue(0, 0.5)
    cut.SetInputDataObject(image)
    cut.SetInputArrayToProcess(0, 0, 0, 0, "Rising")
    cut.Update()
    return cut.GetOutput().GetBounds()[2] == 0.5


def _is_straightening(proxy):
    """Whether a proxy cuts cells of images without heeding their direction."""
    label = proxy.GetXMLLabel()
    if label not in STRAIGHTENING:
        return False
    if label == "Slice":
        return proxy.SliceType.GetXMLLabel() != "Plane"
    return not (label == "Clip" and proxy.Crinkleclip or _is_right(label))


def _is_turned(source):
    """Whether a proxy's data are, or hold, an image whose direction is not the identity."""
    record = _record(source)  # what is fetched of several ranks may be an image no more
    if record is not None and not _is_same(record, IDENTITY) and _is_image(source):
        return True
    data = fetch(source)
    leaves = [data]
    if data is not None and data.IsA("vtkCompositeDataSet"):
        visitor = data.NewIterator()
        leaves = []
        while not visitor.IsDoneWithTraversal():
            leaves.append(visitor.GetCurrentDataObject())
            visitor.GoToNextItem()
    return any(each.IsA("vtkImageData") and not _is_same(each.GetDirectionMatrix().GetData(), IDENTITY)
               for each in leaves if each is not None)


def keeps_points(proxy):
    """Whether points come to a proxy from their source without having been moved by a filter of ParaView.

    Images are not asked: their points are where origin, spacing and direction say, unless the direction was reset.
    A Transform that does nothing moves none. Where several come together, all have to be in the same coordinates.
    """
    inputs = _inputs(proxy)
    if inputs and not proxy.GetXMLName().startswith("Lacuna"):
        label = proxy.GetXMLLabel()
        if label in MOVING or label not in KEEPING and not _is_no_transform(proxy) and not _is_image(proxy):
            return False
        if _is_straightening(proxy) and any(_is_turned(each) for each in inputs):
            return False
        if label in RESETTING and _is_reset(fetch(proxy)):
            return False
        if len(inputs) > 1 and len({(_place(each), is_mirrored(each)) for each in inputs}) > 1:
            return False
    return all(keeps_points(each) for each in inputs)
