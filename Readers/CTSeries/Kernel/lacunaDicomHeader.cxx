// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomHeader.h"

#include "lacunaDicomDataSet.h"
#include "lacunaDicomText.h"
#include "lacunaFileBytes.h"

#include <algorithm>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr int MostFrames = 100000;
constexpr std::int64_t LargestImage = 65535; // columns or rows
constexpr DicomTag SharedGroups = 0x52009229;
constexpr DicomTag FrameGroups = 0x52009230;

// Native, or a stream of fragments.
bool IsNative(const std::string& syntax)
{
  return syntax == "1.2.840.10008.1.2" || syntax == "1.2.840.10008.1.2.1" ||
    syntax == "1.2.840.10008.1.2.2" || syntax == "1.2.840.10008.1.2.1.99";
}

// Where the values of a frame are: its own functional group, that of all frames, the file.
class FrameValues
{
public:
  FrameValues(const DicomDataSet& file, std::size_t frame)
    : File(file)
  {
    const std::vector<DicomDataSet>& own = file.GetItems(FrameGroups);
    const std::vector<DicomDataSet>& shared = file.GetItems(SharedGroups);
    this->Own = frame < own.size() ? &own[frame] : nullptr;
    this->Shared = shared.empty() ? nullptr : &shared[0];
  }

  const DicomDataSet& Get(DicomTag group) const
  {
    for (const DicomDataSet* groups : { this->Own, this->Shared })
    {
      if (groups && !groups->GetItems(group).empty())
      {
        return groups->GetItems(group)[0];
      }
    }
    return this->File;
  }

private:
  const DicomDataSet& File;
  const DicomDataSet* Own;
  const DicomDataSet* Shared;
};

CTPixelFormat ReadFormat(const DicomDataSet& data)
{
  CTPixelFormat format;
  format.BitsAllocated = static_cast<int>(data.GetBinary(0x00280100, false).value_or(0));
  format.BitsStored =
    static_cast<int>(data.GetBinary(0x00280101, false).value_or(format.BitsAllocated));
  format.HighBit =
    static_cast<int>(data.GetBinary(0x00280102, false).value_or(format.BitsStored - 1));
  format.Signed = data.GetBinary(0x00280103, false).value_or(0) == 1;
  return format;
}

void FindNativePixels(const DicomFile& file, CTFileHeader& header)
{
  if (header.Format.BitsAllocated > 64 || header.SamplesPerPixel > 4)
  {
    header.PixelError = "has " + std::to_string(header.SamplesPerPixel) +
      " samples per pixel "
      "(0028,0002) of " +
      std::to_string(header.Format.BitsAllocated) + " bits (0028,0100)";
    return;
  }
  const std::int64_t size = header.Columns * header.Rows * (header.Format.BitsAllocated / 8) *
    std::max(1, header.SamplesPerPixel);
  const std::int64_t there = std::min(file.PixelLength, file.FileSize - file.PixelOffset);
  if (size < 1 || there < size * header.Frames)
  {
    header.PixelError = "has " + std::to_string(there) + " bytes of Pixel Data (7FE0,0010), but " +
      std::to_string(header.Frames) + " x " + std::to_string(header.Columns) + " x " +
      std::to_string(header.Rows) + " pixels of " + std::to_string(header.Format.BitsAllocated) +
      " bits take " + std::to_string(size * header.Frames) +
      (there < file.PixelLength ? ": it is cut off" : "");
    return;
  }
  for (int i = 0; i < header.Frames; ++i)
  {
    header.Pixels.push_back({ { file.PixelOffset + i * size, size } });
  }
}

void FindFragments(const DicomFile& file, CTFileHeader& header)
{
  const auto frames = static_cast<std::size_t>(header.Frames);
  const std::vector<DicomFragment>& fragments = file.Fragments;
  if (!file.FragmentsComplete)
  {
    header.PixelError = "is cut off in its compressed Pixel Data (7FE0,0010), after " +
      std::to_string(fragments.size()) + " fragments";
    return;
  }
  header.Pixels.resize(frames);
  if (frames == 1)
  {
    header.Pixels[0] = fragments;
  }
  else if (fragments.size() == frames)
  {
    for (std::size_t i = 0; i < frames; ++i)
    {
      header.Pixels[i] = { fragments[i] };
    }
  }
  else if (file.FrameOffsets.size() == frames && !fragments.empty())
  {
    // the table counts from the first fragment's item, 8 bytes before its bytes
    const std::int64_t first = fragments[0].Offset;
    for (const DicomFragment& fragment : fragments)
    {
      const auto after = std::upper_bound(
        file.FrameOffsets.begin(), file.FrameOffsets.end(), fragment.Offset - first);
      if (after != file.FrameOffsets.begin())
      {
        header.Pixels[static_cast<std::size_t>(after - file.FrameOffsets.begin()) - 1].push_back(
          fragment);
      }
    }
  }
  const bool whole = std::all_of(header.Pixels.begin(), header.Pixels.end(),
    [](const std::vector<DicomFragment>& pieces) { return !pieces.empty(); });
  if (!whole)
  {
    header.PixelError = "has " + std::to_string(fragments.size()) +
      " fragments of compressed Pixel Data (7FE0,0010), which cannot be shared out to " +
      std::to_string(frames) + " frames";
  }
}

void FindPixels(const DicomFile& file, CTFileHeader& header)
{
  header.Compressed = !IsNative(file.TransferSyntax);
  header.BigEndian = file.BigEndian;
  if (file.PixelOffset == 0)
  {
    header.PixelError = "has no Pixel Data (7FE0,0010)";
  }
  else if (header.Compressed != (file.PixelLength == -1))
  {
    header.PixelError =
      "has Pixel Data (7FE0,0010) that do not fit its transfer syntax " + file.TransferSyntax;
  }
  else if (header.Compressed)
  {
    FindFragments(file, header);
  }
  else
  {
    FindNativePixels(file, header);
  }
}

std::shared_ptr<CTFileHeader> ReadHeader(const std::string& path, const DicomFile& file)
{
  const DicomDataSet& data = file.Data;
  const std::string characters = data.GetText(0x00080005);
  const auto text = [&](DicomTag tag) { return DicomTextToUtf8(data.GetBytes(tag), characters); };
  auto header = std::make_shared<CTFileHeader>();
  header->File = path;
  header->TransferSyntax = file.TransferSyntax;
  header->SopClassUid = text(0x00080016);
  header->SopInstanceUid = text(0x00080018);
  header->Modality = text(0x00080060);
  header->StudyUid = text(0x0020000D);
  header->StudyDate = text(0x00080020);
  header->SeriesUid = text(0x0020000E);
  header->SeriesNumber = text(0x00200011);
  header->SeriesDescription = text(0x0008103E);
  header->FrameOfReferenceUid = text(0x00200052);
  header->PatientPosition = text(0x00185100);
  if (text(0x00102210) != "QUADRUPED") // which has letters of its own
  {
    header->PatientOrientation = SplitDicomValues(data.GetText(0x00200020));
  }
  header->ConvolutionKernel = text(0x00181210);
  header->Patient = { text(0x00100010), text(0x00100020), text(0x00100030), text(0x00100040) };
  const auto size = [&](DicomTag tag)
  {
    const std::int64_t number = data.GetBinary(tag, false).value_or(0);
    return number <= LargestImage ? number : 0;
  };
  header->Rows = size(0x00280010);
  header->Columns = size(0x00280011);
  header->SamplesPerPixel = static_cast<int>(data.GetBinary(0x00280002, false).value_or(1));
  header->Format = ReadFormat(data);
  header->Padding = data.GetBinary(0x00280120, header->Format.Signed);
  header->PaddingLimit = data.GetBinary(0x00280121, header->Format.Signed);
  header->GantryTilt = data.GetNumber(0x00181120);
  header->Frames = data.GetInteger(0x00280008).value_or(1);
  if (header->Frames < 1 || header->Frames > MostFrames)
  {
    throw std::runtime_error(
      path + ": Number of Frames (0028,0008) is " + data.GetText(0x00280008));
  }
  header->IsBare = file.IsBare;
  if (file.Inflated)
  {
    header->DeflatedFrom = file.Inflated->First;
    // else it would be inflated as often as it has frames
    header->Inflated = header->Frames > 1 ? file.Inflated : nullptr;
  }
  FindPixels(file, *header);
  return header;
}

CTFrame ReadFrame(
  const DicomDataSet& data, const std::shared_ptr<const CTFileHeader>& header, int number)
{
  const FrameValues values(data, static_cast<std::size_t>(number));
  CTFrame frame;
  frame.Header = header;
  frame.Number = number;
  const DicomDataSet& type = values.Get(0x00189329);
  frame.ImageType = SplitDicomValues(type.GetText(0x00089007));
  if (frame.ImageType.empty())
  {
    frame.ImageType = SplitDicomValues(data.GetText(0x00080008));
  }
  if (const auto p = values.Get(0x00209113).GetNumbers(0x00200032, 3))
  {
    frame.Position = Vec3{ (*p)[0], (*p)[1], (*p)[2] };
  }
  if (const auto a = values.Get(0x00209116).GetNumbers(0x00200037, 6))
  {
    frame.Axes = { (*a)[0], (*a)[1], (*a)[2], (*a)[3], (*a)[4], (*a)[5] };
  }
  const DicomDataSet& measures = values.Get(0x00289110);
  if (const auto s = measures.GetNumbers(0x00280030, 2))
  {
    frame.Spacing = { (*s)[0], (*s)[1] };
  }
  frame.Thickness = measures.GetNumber(0x00180050);
  const DicomDataSet& rescale = values.Get(0x00289145);
  frame.RescaleSlope = rescale.GetNumber(0x00281053);
  frame.RescaleIntercept = rescale.GetNumber(0x00281052);
  frame.RescaleType = rescale.GetText(0x00281054);
  const DicomDataSet& content = values.Get(0x00209111);
  const auto acquisition = content.GetBinary(0x00209156, false);
  frame.Acquisition =
    acquisition ? std::optional<int>(static_cast<int>(*acquisition)) : data.GetInteger(0x00200012);
  frame.Instance = header->Frames > 1 ? number + 1 : data.GetInteger(0x00200013);
  return frame;
}
}

//------------------------------------------------------------------------------
std::vector<CTFrame> ReadDicomFrames(const std::string& path)
{
  const DicomFile file = ReadDicomFile(path);
  const std::shared_ptr<const CTFileHeader> header = ReadHeader(path, file);
  std::vector<CTFrame> frames;
  for (int i = 0; i < header->Frames; ++i)
  {
    frames.push_back(ReadFrame(file.Data, header, i));
  }
  return frames;
}

//------------------------------------------------------------------------------
std::int64_t GetDicomSize(const CTFrame& frame)
{
  std::int64_t size = 0;
  for (const DicomFragment& fragment :
    frame.Header->Pixels.at(static_cast<std::size_t>(frame.Number)))
  {
    size += fragment.Length;
  }
  return size;
}

//------------------------------------------------------------------------------
void ReadDicomBytes(const CTFrame& frame, unsigned char* bytes)
{
  const CTFileHeader& header = *frame.Header;
  FileBytes file(header.File);
  if (header.Inflated)
  {
    file.SetInflated(header.Inflated);
  }
  else if (header.DeflatedFrom > 0)
  {
    file.Inflate(header.DeflatedFrom);
  }
  unsigned char* end = bytes;
  for (const DicomFragment& fragment : header.Pixels.at(static_cast<std::size_t>(frame.Number)))
  {
    if (!file.Read(fragment.Offset, fragment.Length, end))
    {
      throw std::runtime_error(header.File + ": its pixels cannot be read; has the file changed?");
    }
    end += fragment.Length;
  }
  if (header.BigEndian && header.Format.BitsAllocated > 8)
  {
    const std::ptrdiff_t width = header.Format.BitsAllocated / 8;
    for (unsigned char* p = bytes; end - p >= width; p += width)
    {
      std::reverse(p, p + width);
    }
  }
}
}
