// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomHeader.h"

#include "lacunaDicomDataSet.h"
#include "lacunaDicomText.h"
#include "lacunaFileBytes.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr int MostFrames = 100000;
constexpr std::size_t LongestImageType = 128;                // bytes: each frame keeps its own
constexpr std::int64_t LargestImage = 65535;                 // columns or rows
constexpr const char* CTClass = "1.2.840.10008.5.1.4.1.1.2"; // and what begins so: enhanced CT
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

  /// Throws where a group says otherwise than the file itself, which may be the right one.
  std::optional<std::vector<double>> GetNumbers(
    DicomTag group, DicomTag tag, std::size_t count, const char* name) const
  {
    const DicomDataSet& values = this->Get(group);
    auto numbers = values.GetNumbers(tag, count);
    const auto others = this->File.GetNumbers(tag, count);
    if (!numbers || !others || this->IsOfOneOfSeveral(group))
    {
      return numbers;
    }
    const auto close = [](double a, double b) {
      return std::abs(a - b) <= 1e-4 * std::max({ 1.0, std::abs(a), std::abs(b) });
    };
    if (!std::equal(numbers->begin(), numbers->end(), others->begin(), close))
    {
      throw std::runtime_error(std::string(name) + " is " + values.GetText(tag) +
        " in a functional group and " + this->File.GetText(tag) + " in the file itself");
    }
    return numbers;
  }

private:
  // A frame may differ from what the file says of all of them, such as the position of the first.
  bool IsOfOneOfSeveral(DicomTag group) const
  {
    return this->Own && !this->Own->GetItems(group).empty() &&
      this->File.GetItems(FrameGroups).size() > 1;
  }

  const DicomDataSet& File;
  const DicomDataSet* Own;
  const DicomDataSet* Shared;
};

// A number of 2 bytes; -1 when it is absent or no such number.
int ReadShort(const DicomDataSet& data, DicomTag tag)
{
  const std::int64_t number = data.GetBinary(tag, false).value_or(-1);
  return number <= 0xFFFF ? static_cast<int>(number) : -1;
}

CTPixelFormat ReadFormat(const DicomDataSet& data)
{
  CTPixelFormat format;
  format.BitsAllocated = ReadShort(data, 0x00280100);
  format.BitsStored = ReadShort(data, 0x00280101);
  format.HighBit = ReadShort(data, 0x00280102);
  if (format.HighBit == -1)
  {
    format.HighBit = format.BitsStored - 1; // the standard allows no other today
  }
  format.Signed = ReadShort(data, 0x00280103) == 1;
  return format;
}

// What is wrong with the description of the pixels, without which they cannot be understood.
std::string WhyNotPixels(const DicomDataSet& data, const CTFileHeader& header)
{
  if (header.Columns < 1 || header.Rows < 1)
  {
    return "has no valid Rows (0028,0010) and Columns (0028,0011)";
  }
  const int bits = header.Format.BitsAllocated;
  if (bits != 8 && bits != 16 && bits != 32)
  {
    return "has no Bits Allocated (0028,0100) that are read: 8, 16 or 32";
  }
  if (header.Format.BitsStored < 1)
  {
    return "has no valid Bits Stored (0028,0101)";
  }
  const int representation = ReadShort(data, 0x00280103);
  if (representation != 0 && representation != 1)
  {
    return "has no valid Pixel Representation (0028,0103), so whether its values have a sign is "
           "unknown";
  }
  return {};
}

void FindNativePixels(const DicomFile& file, CTFileHeader& header)
{
  const std::int64_t width =
    header.Format.BitsAllocated / 8 * std::clamp(header.SamplesPerPixel, 1, 4);
  const std::int64_t size = header.Columns * header.Rows * width;
  const std::int64_t there = std::min(file.PixelLength, file.FileSize - file.PixelOffset);
  // Padding is less than a row; more means that the numbers of rows, columns or frames are wrong,
  // and then rows would be shifted against each other.
  const std::int64_t row = std::min(header.Columns, header.Rows) * width;
  if (there < size * header.Frames ||
    file.PixelLength >= size * header.Frames + std::max(row, std::int64_t{ 2 }))
  {
    header.PixelError = "has " + std::to_string(there) + " bytes of Pixel Data (7FE0,0010), but " +
      std::to_string(header.Frames) + " x " + std::to_string(header.Columns) + " x " +
      std::to_string(header.Rows) + " pixels (0028,0008), (0028,0011), (0028,0010) of " +
      std::to_string(header.Format.BitsAllocated) + " bits take " +
      std::to_string(size * header.Frames) + (there < file.PixelLength ? ": it is cut off" : "");
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
  else if (file.FrameOffsets.size() == frames && !fragments.empty() &&
    std::is_sorted(file.FrameOffsets.begin(), file.FrameOffsets.end()))
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
  else if (std::string why = WhyNotPixels(file.Data, header); !why.empty())
  {
    header.PixelError = std::move(why);
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

// A file that says by its class that it is CT, and then has not what makes it so, is damaged.
std::string WhyNotCT(const CTFileHeader& header)
{
  if (header.SopClassUid != CTClass && header.SopClassUid.rfind(CTClass + std::string("."), 0) != 0)
  {
    return {}; // may be anything else
  }
  if (header.Modality != "CT")
  {
    return "is CT by its SOP Class (0008,0016), but its Modality (0008,0060) is " +
      (header.Modality.empty() ? "missing" : header.Modality);
  }
  return header.SeriesUid.empty() ? "has no Series Instance UID (0020,000E)" : "";
}

std::shared_ptr<CTFileHeader> ReadHeader(const std::string& path, const DicomFile& file)
{
  const DicomDataSet& data = file.Data;
  const std::string characters = data.GetText(0x00080005);
  const auto text = [&](DicomTag tag) { return DicomTextToUtf8(data.GetBytes(tag), characters); };
  auto header = std::make_shared<CTFileHeader>();
  header->File = path;
  header->State = file.State;
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
  if (const std::string why = WhyNotCT(*header); !why.empty())
  {
    throw std::runtime_error(path + ": " + why);
  }
  const auto size = [&](DicomTag tag)
  {
    const std::int64_t number = data.GetBinary(tag, false).value_or(0);
    return number <= LargestImage ? number : 0;
  };
  header->Rows = size(0x00280010);
  header->Columns = size(0x00280011);
  header->SamplesPerPixel = static_cast<int>(
    std::min<std::int64_t>(LargestImage, data.GetBinary(0x00280002, false).value_or(1)));
  header->Format = ReadFormat(data);
  header->Padding = data.GetBinary(0x00280120, header->Format.Signed);
  header->PaddingLimit = data.GetBinary(0x00280121, header->Format.Signed);
  header->GantryTilt = data.GetNumber(0x00181120);
  const std::string frames = data.GetText(0x00280008);
  header->Frames = frames.empty() ? 1 : data.GetInteger(0x00280008).value_or(0);
  if (header->Frames < 1 || header->Frames > MostFrames)
  {
    throw std::runtime_error(path + ": Number of Frames (0028,0008) is " + frames);
  }
  const std::size_t groups = data.GetItems(FrameGroups).size();
  if (groups > 0 && groups != static_cast<std::size_t>(header->Frames))
  {
    throw std::runtime_error(path + ": Number of Frames (0028,0008) is " +
      std::to_string(header->Frames) + ", but positions are there for " + std::to_string(groups) +
      " (Per-frame Functional Groups Sequence (5200,9230))");
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
  const DicomDataSet& data, const std::shared_ptr<const CTFileHeader>& header, int index)
{
  const FrameValues values(data, static_cast<std::size_t>(index));
  CTFrame frame;
  frame.Header = header;
  frame.Number = index;
  const DicomDataSet& type = values.Get(0x00189329);
  const auto split = [](const std::string& text)
  { return SplitDicomValues(std::string_view(text).substr(0, LongestImageType)); };
  frame.ImageType = split(type.GetText(0x00089007));
  if (frame.ImageType.empty())
  {
    frame.ImageType = split(data.GetText(0x00080008));
  }
  constexpr DicomTag Measures = 0x00289110;
  constexpr DicomTag Rescale = 0x00289145;
  const auto number = [&](DicomTag group, DicomTag tag, const char* name)
  {
    const auto one = values.GetNumbers(group, tag, 1, name);
    return one ? std::optional<double>(one->front()) : std::nullopt;
  };
  if (const auto p =
        values.GetNumbers(0x00209113, 0x00200032, 3, "Image Position (Patient) (0020,0032)"))
  {
    frame.Position = Vec3{ (*p)[0], (*p)[1], (*p)[2] };
  }
  if (const auto a =
        values.GetNumbers(0x00209116, 0x00200037, 6, "Image Orientation (Patient) (0020,0037)"))
  {
    frame.Axes = { (*a)[0], (*a)[1], (*a)[2], (*a)[3], (*a)[4], (*a)[5] };
  }
  if (const auto s = values.GetNumbers(Measures, 0x00280030, 2, "Pixel Spacing (0028,0030)"))
  {
    frame.Spacing = { (*s)[0], (*s)[1] };
  }
  frame.Thickness = number(Measures, 0x00180050, "Slice Thickness (0018,0050)");
  frame.RescaleSlope = number(Rescale, 0x00281053, "Rescale Slope (0028,1053)");
  frame.RescaleIntercept = number(Rescale, 0x00281052, "Rescale Intercept (0028,1052)");
  frame.RescaleType = values.Get(Rescale).GetText(0x00281054);
  const DicomDataSet& content = values.Get(0x00209111);
  const auto acquisition = content.GetBinary(0x00209156, false);
  frame.Acquisition =
    acquisition ? std::optional<int>(static_cast<int>(*acquisition)) : data.GetInteger(0x00200012);
  frame.Instance = header->Frames > 1 ? index + 1 : data.GetInteger(0x00200013);
  return frame;
}
}

//------------------------------------------------------------------------------
std::vector<CTFrame> ReadDicomFrames(const std::string& path)
{
  const DicomFile file = ReadDicomFile(path);
  const std::shared_ptr<const CTFileHeader> header = ReadHeader(path, file);
  std::vector<CTFrame> frames;
  // without pixels one stands for all, of which the file may claim any number
  const int count = header->PixelError.empty() ? header->Frames : 1;
  for (int i = 0; i < count; ++i)
  {
    try
    {
      frames.push_back(ReadFrame(file.Data, header, i));
    }
    catch (const std::runtime_error& error)
    {
      throw std::runtime_error(path + ": " + error.what());
    }
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
  if (!(file.GetState() == header.State))
  {
    // other pixels would stand at the place and in the unit of the old ones
    throw std::runtime_error(header.File +
      ": has changed since its header was read; open it anew (ParaView: File > Reload Files)");
  }
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
