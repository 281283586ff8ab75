// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaSliceStream
 * @brief   Slices that are too many for the memory, read a few at a time
 *
 * A source of tracked slices (see lacunaTrackedSlices.h) that cannot hold all of its slices puts
 * out a preview: every n-th of them, as an ordinary stack, so that any filter can work on it. Its
 * field data are those of the whole sweep, and say that it is a preview
 * (lacuna::TrackedSlices::PreviewName). Beside it, under STREAM() in the information about its
 * output, it offers this: all slices, to be read in parts. Consumers that need each slice only once
 * take them from here, and need no more of the preview than its field data.
 *
 * @sa vtkLacunaTrackedSliceReader, vtkLacunaSweptVolume, vtkLacunaTrackedSliceWriter
 */
#ifndef vtkLacunaSliceStream_h
#define vtkLacunaSliceStream_h

#include "lacunaExecution.h"
#include "vtkLacunaFiltersCommonModule.h" // for export macro
#include "vtkObject.h"

#include <array>
#include <cstdint>

class vtkAlgorithm;
class vtkInformation;
class vtkInformationObjectBaseKey;

class VTKLACUNAFILTERSCOMMON_EXPORT vtkLacunaSliceStream : public vtkObject
{
public:
  vtkAbstractTypeMacro(vtkLacunaSliceStream, vtkObject);

  /// Where a producer of tracked slices puts the stream.
  static vtkInformationObjectBaseKey* STREAM();

  /// The stream beside what is connected to an input of consumer; null when the input is all there
  /// is, as usual. Looks through filters that pass on their input (SetPassesOn).
  static vtkLacunaSliceStream* Find(vtkAlgorithm* consumer, int port = 0, int connection = 0);

  /// A function that says whether a filter passes on its input as it is, as a program may have such behind each of
  /// its sources. Null: none does.
  static void SetPassesOn(bool (*function)(vtkAlgorithm*));

  /// The extent of the first slice of a preview: to be asked for when only field data are needed beside the stream.
  static std::array<int, 6> GetFirstSlice(vtkInformation* input);

  /// For Announce of filters that change nothing but field data: passes the stream of
  /// input port 0 on to output, or takes away the one of before.
  static void Pass(vtkAlgorithm* filter, vtkInformation* output);

  /// The place of the stack of all slices, as of a vtkImageData.
  const int* GetExtent() const { return this->Extent; }
  const double* GetOrigin() const { return this->Origin; }
  const double* GetSpacing() const { return this->Spacing; }

  /// Bytes of one slice.
  virtual std::int64_t GetSliceSize() const = 0;

  /// How many slices to read at a time: about 32 MiB, at least one.
  int GetSlicesAtATime() const;

  /// Puts the slices at indices first..last along z into pixels, GetSliceSize() bytes each, in the
  /// scalar type of the preview. In ascending order it is quickest: compressed files cannot be read
  /// otherwise than from the beginning. Throws std::exception with a text for the user.
  virtual void Read(int first, int last, void* pixels, lacuna::Execution& execution) = 0;

protected:
  vtkLacunaSliceStream() = default;
  ~vtkLacunaSliceStream() override = default;

  int Extent[6] = { 0, -1, 0, -1, 0, -1 };
  double Origin[3] = { 0, 0, 0 };
  double Spacing[3] = { 1, 1, 1 };

private:
  vtkLacunaSliceStream(const vtkLacunaSliceStream&) = delete;
  void operator=(const vtkLacunaSliceStream&) = delete;
};
#endif
