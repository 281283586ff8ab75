// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSequenceFile.h"

#include "lacunaMemory.h"
#include "lacunaSliceStack.h"
#include "lacunaSweepTransforms.h"
#include "vtkObjectFactory.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace
{
constexpr double Mebibyte = 1048576;

// All wanted slices of a file, which stays open as long as anyone needs them.
class FileSliceStream : public vtkLacunaSliceStream
{
public:
  static FileSliceStream* New();
  vtkTypeMacro(FileSliceStream, vtkLacunaSliceStream);

  void SetFile(const std::shared_ptr<lacuna::SequenceFile>& file)
  {
    this->File = file;
    file->GetPlace(file->GetWanted(), this->Extent, this->Origin, this->Spacing);
  }

  std::int64_t GetSliceSize() const override { return this->File->GetSliceSize(); }

  void Read(int first, int last, void* pixels, lacuna::Execution& execution) override
  {
    const int* whole = this->GetExtent();
    const int part[6] = { whole[0], whole[1], whole[2], whole[3], first, last };
    this->File->Read(this->File->GetWanted(), part, pixels, execution);
  }

private:
  std::shared_ptr<lacuna::SequenceFile> File;
};
vtkStandardNewMacro(FileSliceStream);

std::string DescribeNumber(std::int64_t n)
{
  const char* const ending = n % 100 / 10 == 1 ? "th"
    : n % 10 == 1                              ? "st"
    : n % 10 == 2                              ? "nd"
    : n % 10 == 3                              ? "rd"
                                               : "th";
  return std::to_string(n) + ending;
}
}

//------------------------------------------------------------------------------
lacuna::SequenceFile::SequenceFile(
  const char* fileName, const int range[2], int stride, double mostBytes)
  : Header(lacuna::ReadSequenceHeader(fileName))
  , Pixels(lacuna::PixelSource::Open(Header))
  , MostBytes(mostBytes)
{
  const auto frames = static_cast<int>(this->Header.Frames);
  const auto whole = static_cast<int>(this->Pixels->GetNumberOfWholeFrames());
  const int first = range[0];
  const int last = range[1] == -1 ? frames - 1 : range[1];
  if (first < 0 || last < first || last >= frames || first >= whole)
  {
    std::ostringstream message;
    message << fileName << ": FrameRange " << first << " " << range[1]
            << " does not fit; the file has the pixels of slices 0 to " << whole - 1
            << " (a last slice of -1 means the end)";
    throw std::runtime_error(message.str());
  }
  this->Wanted = { first, stride, (std::min(last, whole - 1) - first) / stride + 1 };

  const auto sliceSize = static_cast<double>(this->GetSliceSize());
  if (sliceSize > mostBytes)
  {
    throw std::runtime_error(std::string(fileName) + ": one slice of " +
      std::to_string(this->Header.Columns) + " x " + std::to_string(this->Header.Rows) +
      " pixels takes " + lacuna::DescribeBytes(sliceSize) + ", but MemoryLimit allows " +
      lacuna::DescribeBytes(mostBytes) + "; raise it");
  }
  const double most = std::min(std::floor(mostBytes / sliceSize), 2e9);
  const auto step =
    static_cast<std::int64_t>(std::ceil(static_cast<double>(this->Wanted.Slices) / most));
  this->Stack = { first, stride * step, static_cast<int>((this->Wanted.Slices - 1) / step) + 1 };
}

//------------------------------------------------------------------------------
std::string lacuna::SequenceFile::DescribePreview() const
{
  if (!this->IsPreview())
  {
    return {};
  }
  const double bytes =
    static_cast<double>(this->GetSliceSize()) * static_cast<double>(this->Wanted.Slices);
  std::ostringstream text;
  text << "a preview of every " << DescribeNumber(this->Stack.Stride / this->Wanted.Stride)
       << " of " << this->Wanted.Slices << " slices, since all of them take "
       << lacuna::DescribeBytes(bytes) << " and MemoryLimit allows "
       << lacuna::DescribeBytes(this->MostBytes)
       << ". Swept Volume and the Tracked Slice Writer take all of them from the file. To see some "
          "at full rate give a FrameRange; to load all set MemoryLimit to "
       << static_cast<std::int64_t>(std::ceil(bytes / Mebibyte)) << " MiB";
  return text.str();
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkLacunaSliceStream> lacuna::SequenceFile::MakeStream()
{
  if (!this->IsPreview())
  {
    return nullptr;
  }
  const auto stream = vtkSmartPointer<FileSliceStream>::New();
  stream->SetFile(this->shared_from_this());
  return stream;
}

//------------------------------------------------------------------------------
void lacuna::SequenceFile::GetPlace(
  const Choice& choice, int extent[6], double origin[3], double spacing[3]) const
{
  // (column, row) of the scanner's picture; z is the number of the slice in the file
  const lacuna::Vec3 corner = lacuna::GetPictureOrigin(this->Header);
  const int sizes[3] = { static_cast<int>(this->Header.Columns),
    static_cast<int>(this->Header.Rows), choice.Slices };
  for (int a = 0; a < 3; ++a)
  {
    extent[2 * a] = 0;
    extent[2 * a + 1] = sizes[a] - 1;
    origin[a] = a < 2 ? corner[a] : choice.First;
    spacing[a] = a < 2 ? 1 : static_cast<double>(choice.Stride);
  }
}

//------------------------------------------------------------------------------
std::int64_t lacuna::SequenceFile::GetSliceSize() const
{
  return this->Header.Columns * this->Header.Rows *
    static_cast<std::int64_t>(lacuna::GetScalarSize(this->Pixels->GetScalarType()));
}

//------------------------------------------------------------------------------
void lacuna::SequenceFile::Read(
  const Choice& choice, const int extent[6], void* pixels, lacuna::Execution& execution)
{
  lacuna::SliceRegion region;
  region.FirstColumn = extent[0];
  region.Columns = extent[1] - extent[0] + 1;
  region.FirstRow = extent[2];
  region.Rows = extent[3] - extent[2] + 1;
  region.FirstFrame = choice.First + extent[4] * choice.Stride;
  region.FrameStride = choice.Stride;
  region.Frames = extent[5] - extent[4] + 1;
  lacuna::ReadSliceStack(this->Header, *this->Pixels, region, pixels, execution);
}
