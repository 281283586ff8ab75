// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A sequence file that is open: which of its slices make the stack.
#ifndef lacunaSequenceFile_h
#define lacunaSequenceFile_h

#include "lacunaPixelSource.h"
#include "lacunaSequenceHeader.h"
#include "vtkLacunaSliceStream.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <memory>
#include <string>

namespace lacuna
{
/// Slices of a file that are wanted, and those that fit into the memory. Not a part of the module's
/// interface.
class SequenceFile : public std::enable_shared_from_this<SequenceFile>
{
public:
  /// range: the first and the last slice wanted, the latter may be -1 for the end; stride: from one
  /// to the next. mostBytes: what the pixels of the stack may take. Throws std::runtime_error when
  /// the file cannot be read, range does not fit, or not even one slice fits.
  SequenceFile(const char* fileName, const int range[2], int stride, double mostBytes);

  /// Slices of a regular choice: number First, First + Stride, ...
  struct Choice
  {
    int First = 0;
    std::int64_t Stride = 1;
    int Slices = 0;
  };
  const Choice& GetWanted() const { return this->Wanted; }
  /// Those of the stack: all that are wanted, or every n-th of them.
  const Choice& GetStack() const { return this->Stack; }
  bool IsPreview() const { return this->Stack.Slices < this->Wanted.Slices; }
  /// What a person should know of a preview: which slices, why, and how to get all; else empty.
  std::string DescribePreview() const;
  /// All wanted slices; null when the stack holds them.
  vtkSmartPointer<vtkLacunaSliceStream> MakeStream();

  /// The place of a choice, as of a vtkImageData.
  void GetPlace(const Choice& choice, int extent[6], double origin[3], double spacing[3]) const;
  /// Bytes of one slice of the stack.
  std::int64_t GetSliceSize() const;
  /// Reads the part extent of a choice into pixels, x fastest.
  void Read(const Choice& choice, const int extent[6], void* pixels, Execution& execution);

  SequenceHeader Header;
  std::unique_ptr<PixelSource> Pixels;

private:
  Choice Wanted;
  Choice Stack;
  double MostBytes;
};
}
#endif
