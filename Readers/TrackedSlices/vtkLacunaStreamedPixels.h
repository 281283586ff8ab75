// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The slices of a stream one by one, as the writer takes them.
#ifndef vtkLacunaStreamedPixels_h
#define vtkLacunaStreamedPixels_h

#include <cstdint>
#include <memory>
#include <vector>

class vtkLacunaSliceStream;
namespace lacuna
{
class Execution;
}

/// Reads some slices at a time and keeps them until others are asked for. Copies share them. Not a
/// part of the module's interface.
class vtkLacunaStreamedPixels
{
public:
  /// Both must outlive this object.
  vtkLacunaStreamedPixels(vtkLacunaSliceStream* stream, lacuna::Execution& execution);

  /// Pixels of a slice, counted from 0; valid until the next call.
  const void* operator()(std::int64_t slice) const;

private:
  struct Part
  {
    std::vector<unsigned char> Pixels;
    std::int64_t First = 0;
    std::int64_t Count = 0;
  };
  vtkLacunaSliceStream* Stream;
  lacuna::Execution* Execution;
  std::shared_ptr<Part> Loaded;
};
#endif
