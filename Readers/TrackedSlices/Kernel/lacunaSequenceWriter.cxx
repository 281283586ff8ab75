// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSequenceWriter.h"

#include "lacunaAtomicFile.h"
#include "lacunaByteOrder.h"
#include "lacunaSequenceText.h"
#include "lacunaStreamCompressor.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <set>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr std::size_t BatchSize = 1 << 24; // what is compressed at a time, on all cores

class SequenceFileWriter
{
public:
  SequenceFileWriter(
    const std::string& fileName, const SequenceContent& content, int compressionLevel)
    : Content(content)
    , Kind(fileName, compressionLevel > 0)
    , Level(compressionLevel)
    , HeaderFile(fileName)
    , DataFile(Kind.IsDetached() ? std::make_unique<AtomicFile>(Kind.GetDataFileName(), fileName)
                                 : nullptr)
    , FrameSize(static_cast<std::size_t>(content.Description.Columns * content.Description.Rows) *
        GetScalarSize(content.Description.Type))
  {
  }

  std::int64_t Write(Execution& execution)
  {
    const auto frames = static_cast<std::int64_t>(this->Content.Frames.size());
    std::string header = this->Kind.GetBeginning(this->Content.Description);
    const std::size_t countsAt = header.find(this->Kind.GetCounts(this->Content.Description, 0, 0));
    const std::string counts = this->Kind.GetCounts(this->Content.Description, frames, 0);
    header.replace(countsAt, counts.size(), counts);
    for (std::size_t i = 0; i < this->Content.Frames.size(); ++i)
    {
      header += this->Kind.GetFrame(static_cast<std::int64_t>(i), this->Content.Frames[i]);
    }
    header += this->Kind.GetEnd();
    this->HeaderFile.Write(header);

    AtomicFile& data = this->DataFile ? *this->DataFile : this->HeaderFile;
    const std::int64_t bytes = this->Kind.IsCompressed() ? this->WriteCompressed(data, execution)
                                                         : this->WriteRaw(data, execution);
    if (this->Kind.IsCompressed() && !this->HeaderFile.IsStream())
    {
      this->HeaderFile.WriteAt(static_cast<std::int64_t>(countsAt),
        this->Kind.GetCounts(this->Content.Description, frames, bytes));
    }
    this->HeaderFile.Finish();
    if (this->DataFile)
    {
      this->DataFile->Commit();
    }
    this->HeaderFile.Commit();
    return static_cast<std::int64_t>(header.size()) + bytes;
  }

private:
  // A frame in the file's byte order.
  const unsigned char* GetFrame(std::int64_t frame)
  {
    const auto* pixels = static_cast<const unsigned char*>(this->Content.GetPixels(frame));
    const std::size_t elementSize = GetScalarSize(this->Content.Description.Type);
    if (!IsBigEndianMachine() || elementSize == 1)
    {
      return pixels;
    }
    this->Swapped.assign(pixels, pixels + this->FrameSize);
    SwapElementBytes(this->Swapped.data(), this->FrameSize / elementSize, elementSize);
    return this->Swapped.data();
  }

  std::int64_t WriteRaw(AtomicFile& file, Execution& execution)
  {
    const auto frames = static_cast<std::int64_t>(this->Content.Frames.size());
    for (std::int64_t i = 0; i < frames; ++i)
    {
      execution.Report(static_cast<double>(i) / static_cast<double>(frames));
      file.Write(this->GetFrame(i), this->FrameSize);
    }
    execution.Report(1);
    return frames * static_cast<std::int64_t>(this->FrameSize);
  }

  std::int64_t WriteCompressed(AtomicFile& file, Execution& execution)
  {
    StreamCompressor compressor(
      this->Kind.IsNrrd() ? StreamCompressor::Wrapping::Gzip : StreamCompressor::Wrapping::Zlib,
      this->Level);
    std::int64_t bytes = 0;
    const auto write = [&](const std::string& part)
    {
      file.Write(part);
      bytes += static_cast<std::int64_t>(part.size());
    };
    write(compressor.GetBeginning());
    std::vector<unsigned char> batch(
      std::min(BatchSize, this->FrameSize * this->Content.Frames.size()));
    std::size_t filled = 0;
    const double all =
      static_cast<double>(this->FrameSize) * static_cast<double>(this->Content.Frames.size());
    double done = 0;
    for (std::size_t frame = 0; frame < this->Content.Frames.size(); ++frame)
    {
      const unsigned char* pixels = this->GetFrame(static_cast<std::int64_t>(frame));
      for (std::size_t left = this->FrameSize; left > 0;)
      {
        const std::size_t part = std::min(left, batch.size() - filled);
        std::memcpy(batch.data() + filled, pixels, part);
        filled += part;
        pixels += part;
        left -= part;
        const bool last = left == 0 && frame + 1 == this->Content.Frames.size();
        if (filled == batch.size() || last)
        {
          const double after = done + static_cast<double>(filled);
          execution.SetStage(done / all, after / all);
          write(compressor.Compress(batch.data(), filled, execution));
          done = after;
          filled = 0;
        }
      }
    }
    write(compressor.GetEnd());
    return bytes;
  }

  const SequenceContent& Content;
  SequenceKind Kind;
  int Level;
  AtomicFile HeaderFile;
  std::unique_ptr<AtomicFile> DataFile;
  std::size_t FrameSize;
  std::vector<unsigned char> Swapped;
};
}

//------------------------------------------------------------------------------
std::int64_t WriteSequence(const std::string& fileName, const SequenceContent& content,
  int compressionLevel, Execution& execution)
{
  if (content.Frames.empty())
  {
    throw std::invalid_argument("a sequence without slices cannot be written");
  }
  return SequenceFileWriter(fileName, content, compressionLevel).Write(execution);
}

//------------------------------------------------------------------------------
namespace
{
constexpr std::size_t LongestLine = 990; // PLUS reads 1000 characters at a time
}

//------------------------------------------------------------------------------
SequenceFieldList::SequenceFieldList(
  const SequenceKind& kind, SequenceContent& content, std::vector<std::string>& warnings)
  : Kind(kind)
  , Content(content)
  , Warnings(warnings)
{
}

//------------------------------------------------------------------------------
void SequenceFieldList::AddToHeader(const std::string& name, const std::string& text)
{
  if (this->Accepts(name, { text }, false))
  {
    this->Content.Description.CustomFields.emplace_back(name, text);
  }
}

//------------------------------------------------------------------------------
void SequenceFieldList::AddToFrames(const std::string& name, const std::vector<std::string>& texts)
{
  if (!this->Accepts(name, texts, true))
  {
    return;
  }
  for (std::size_t i = 0; i < texts.size(); ++i)
  {
    if (!texts[i].empty())
    {
      this->Content.Frames[i].emplace_back(name, texts[i]);
    }
  }
}

//------------------------------------------------------------------------------
void SequenceFieldList::RemoveFromFrames(const std::string& name)
{
  for (SequenceFields& fields : this->Content.Frames)
  {
    fields.erase(std::remove_if(fields.begin(), fields.end(),
                   [&](const auto& field) { return field.first == name; }),
      fields.end());
  }
}

//------------------------------------------------------------------------------
const std::string* SequenceFieldList::Find(std::size_t frame, const std::string& name) const
{
  const SequenceFields& fields = this->Content.Frames.at(frame);
  const auto found = std::find_if(
    fields.begin(), fields.end(), [&](const auto& field) { return field.first == name; });
  return found == fields.end() ? nullptr : &found->second;
}

//------------------------------------------------------------------------------
void SequenceFieldList::CheckLines()
{
  std::set<std::string> names;
  const auto check = [&](const SequenceFields& fields)
  {
    for (const auto& [name, text] : fields)
    {
      if (name.size() + text.size() > LongestLine)
      {
        names.insert(name);
      }
    }
  };
  check(this->Content.Description.CustomFields);
  std::for_each(this->Content.Frames.begin(), this->Content.Frames.end(), check);
  if (!names.empty())
  {
    this->Warnings.push_back("fields are longer than 1000 characters; PLUS would cut them: " +
      JoinSome({ names.begin(), names.end() }));
  }
}

//------------------------------------------------------------------------------
bool SequenceFieldList::Accepts(
  const std::string& name, const std::vector<std::string>& texts, bool ofFrame)
{
  for (const std::string& text : texts)
  {
    const std::string problem = this->Kind.GetProblem(name, text, ofFrame);
    if (!problem.empty())
    {
      this->Warnings.push_back("field '" + name + "' is not written: " + problem);
      return false;
    }
  }
  return true;
}
}
