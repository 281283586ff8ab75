// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a stack of tracked slices is as a sequence file: the inverse of the reader.
#ifndef lacunaSequenceData_h
#define lacunaSequenceData_h

#include "lacunaMatrix4.h"
#include "lacunaSequenceWriter.h"
#include "vtkType.h"

#include <string>
#include <vector>

class vtkAbstractArray;
class vtkDataArray;
class vtkImageData;
class vtkLacunaSliceStream;
class vtkStringArray;
namespace lacuna
{
class Execution;
}

namespace lacuna
{
class SequenceData
{
public:
  /// Collects the slices that stack holds, with their fields; stack must outlive this object.
  /// stream: when given, the slices are its own, and stack is a preview of them; both must outlive
  /// this object. keepPatientIdentity: whether to take fields that IdentifiesPatient is true
  /// of. execution: for reading them. Throws std::runtime_error that names the array when
  /// stack is not tracked slices.
  SequenceData(vtkImageData* stack, const SequenceKind& kind, vtkLacunaSliceStream* stream,
    bool keepPatientIdentity, Execution& execution);

  const SequenceContent& Get() const { return this->Content; }
  /// What cannot be written, one sentence each.
  const std::vector<std::string>& GetWarnings() const { return this->Warnings; }

  SequenceData(const SequenceData&) = delete;
  void operator=(const SequenceData&) = delete;

private:
  void FindSlices();
  void SayWindow();
  void FindPixels();
  void AddArrays();
  void AddArray(vtkAbstractArray* array);
  void AddStrings(vtkStringArray* array);
  void AddNumbers(vtkDataArray* array);
  void AddTransform(vtkDataArray* array);
  std::string ToPixelSpacing(const std::string& text) const;
  void AddStates();
  void AddPoses();
  void AddProvenance();

  /// A transform of the given name as it is between the pixels of the file.
  Matrix4 ToPixels(const std::string& name, const Matrix4& matrix) const;
  std::vector<std::string> GetTexts(const std::string& name) const;

  /// Where the stack lies, or that of all slices.
  struct Place
  {
    const int* Extent;
    const double* Origin;
    const double* Spacing;
  };
  vtkImageData* Stack;
  Place Whole;
  SequenceContent Content;
  std::vector<std::string> Warnings;
  SequenceFieldList Fields;      ///< of Content
  vtkIdType Count = 0;           ///< slices of the sweep
  std::vector<vtkIdType> Slices; ///< those in the stack
  std::vector<unsigned char> Status;
  bool PosesOnly = false;
  bool KeepPatientIdentity;
  std::string ImageFrame = "Image";
  std::string ReferenceFrame = "Reference";
  bool Cropped = false;
  vtkDataArray* Crops =
    nullptr;             // from the whole image to the pixels of each slice, as PLUS says it
  bool Windowed = false; // to whole pixels of the picture, as the header says
  Matrix4 PixelToImage;  ///< (column, row) of the file to those of the sweep
};
}
#endif
