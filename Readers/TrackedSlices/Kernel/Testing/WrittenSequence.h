// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Sequences to be written by tests, and what is read of a file.
#ifndef WrittenSequence_h
#define WrittenSequence_h

#include "SequenceFile.h"
#include "lacunaPixelSource.h"
#include "lacunaSequenceHeader.h"
#include "lacunaSequenceWriter.h"

#include <filesystem>
#include <string>
#include <vector>

/// A folder of its own for a test.
class TemporaryFolder
{
public:
  TemporaryFolder()
    : Inside("inside")
  {
  }
  std::string operator/(const std::string& name) const
  {
    return (std::filesystem::path(this->Inside.GetPath()).parent_path() / name).string();
  }
  std::vector<std::string> List() const
  {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator((*this) / ""))
    {
      if (entry.path().filename() != "inside")
      {
        names.push_back(entry.path().filename().string());
      }
    }
    std::sort(names.begin(), names.end());
    return names;
  }

private:
  TemporaryFile Inside;
};

/// 5 x 4 pixels.
inline lacuna::SequenceDescription MakeDescription()
{
  lacuna::SequenceDescription description;
  description.Columns = 5;
  description.Rows = 4;
  description.CustomFields = { { "Operator", "nobody" }, { "A path", "C:\\new\\folder" } };
  return description;
}

/// Fields of a frame, different in every one.
inline lacuna::SequenceFields MakeFields(int frame)
{
  lacuna::SequenceFields fields = {
    { "ProbeToTrackerTransform", "1 0 0 " + std::to_string(frame) + " 0 1 0 20 0 0 1 30 0 0 0 1" },
    { "Timestamp", std::to_string(10 + frame) + ".25" },
    { "ProbeToTrackerTransformStatus", frame == 2 ? "OUT_OF_VIEW" : "OK" },
    { "ImageStatus", frame == 1 ? "INVALID" : "OK" }, { "FrameNumber", std::to_string(100 + frame) }
  };
  if (frame == 3)
  {
    fields.emplace_back("Zebra", "sorted, but before ImageStatus");
  }
  return fields;
}

inline std::string MakePixels(int frame, int columns = 5, int rows = 4)
{
  std::string pixels;
  for (int i = 0; i < columns * rows; ++i)
  {
    pixels += static_cast<char>(GetGrey(i % columns, i / columns, frame));
  }
  return pixels;
}

inline lacuna::SequenceContent MakeContent(int frames)
{
  lacuna::SequenceContent content;
  content.Description = MakeDescription();
  std::vector<std::string> pixels;
  for (int i = 0; i < frames; ++i)
  {
    content.Frames.push_back(MakeFields(i));
    pixels.push_back(MakePixels(i));
  }
  content.GetPixels = [pixels](std::int64_t frame)
  { return pixels[static_cast<std::size_t>(frame)].data(); };
  return content;
}

/// A file as it is read, all frames; throws when it cannot be.
struct ReadBack
{
  lacuna::SequenceHeader Header;
  std::vector<std::string> Frames;
  std::string Warning;

  explicit ReadBack(const std::string& fileName)
    : Header(lacuna::ReadSequenceHeader(fileName))
  {
    const auto source = lacuna::PixelSource::Open(this->Header);
    this->Warning = source->GetWarning();
    for (std::int64_t i = 0; i < source->GetNumberOfWholeFrames(); ++i)
    {
      this->Frames.emplace_back(static_cast<std::size_t>(source->GetFrameSize()), '?');
      source->ReadFrame(i, this->Frames.back().data());
    }
  }
  /// The fields that a frame has.
  lacuna::SequenceFields GetFields(std::size_t frame) const
  {
    lacuna::SequenceFields fields;
    for (const auto& [name, texts] : this->Header.FrameFields)
    {
      if (!texts[frame].empty())
      {
        fields.emplace_back(name, texts[frame]);
      }
    }
    return fields;
  }
};

inline lacuna::SequenceFields Sorted(lacuna::SequenceFields fields)
{
  std::sort(fields.begin(), fields.end());
  return fields;
}
#endif
