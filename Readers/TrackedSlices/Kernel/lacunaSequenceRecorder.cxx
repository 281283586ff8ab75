// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSequenceRecorder.h"

#include "lacunaByteOrder.h"
#include "lacunaStreamCompressor.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

namespace lacuna
{
namespace
{
// Undoes what a failed step has done. What cannot be undone does no harm, see the reader's rules.
template <class Step>
void Try(const Step& step)
{
  try
  {
    step();
  }
  catch (const FileError&)
  {
  }
}
}

//------------------------------------------------------------------------------
SequenceRecorder::SequenceRecorder(
  const std::string& fileName, const SequenceDescription& description, int compressionLevel)
  : Kind(fileName, compressionLevel > 0)
  , Description(description)
{
  if (!this->Kind.IsDetached())
  {
    throw std::invalid_argument("'" + fileName +
      "' cannot be recorded to: a single file has its header before the pixels and cannot grow; "
      "record to .mhd or .nhdr, and convert the finished recording");
  }
  this->HeaderName = std::filesystem::absolute(fileName).string();
  this->DataName = std::filesystem::absolute(this->Kind.GetDataFileName()).string();
  this->HeaderStart = this->Kind.GetBeginning(description);
  if (compressionLevel > 0)
  {
    this->Now.Compressor = std::make_unique<StreamCompressor>(
      this->Kind.IsNrrd() ? StreamCompressor::Wrapping::Gzip : StreamCompressor::Wrapping::Zlib,
      compressionLevel);
  }
  const std::string& dataName = this->Kind.GetDataFileName();
  this->Data = std::make_unique<OutputFile>(dataName, OutputFile::Mode::CreateNew, dataName);
  try
  {
    this->Header = std::make_unique<OutputFile>(fileName, OutputFile::Mode::CreateNew, fileName);
    if (this->Now.Compressor)
    {
      this->DataStart = this->Now.Compressor->GetBeginning();
      this->Data->WriteAt(0, this->DataStart);
      this->Now.DataSize = static_cast<std::int64_t>(this->DataStart.size());
    }
    this->CountsOffset =
      static_cast<std::int64_t>(this->HeaderStart.find(this->Kind.GetCounts(description, 0, 0)));
    this->Header->WriteAt(0, this->HeaderStart + this->Kind.GetEnd());
    this->Now.HeaderSize = static_cast<std::int64_t>(this->HeaderStart.size());
    SyncFolderOf(fileName);
    this->Synced = this->Now;
  }
  catch (const FileError&)
  {
    // Nothing has been recorded: leave nothing behind, but for a header that was there before.
    std::error_code error;
    if (this->Header)
    {
      std::filesystem::remove(fileName, error);
    }
    std::filesystem::remove(dataName, error);
    throw;
  }
}

//------------------------------------------------------------------------------
SequenceRecorder::~SequenceRecorder()
{
  Try([&] { this->End(); }); // nobody would append slices once more
}

//------------------------------------------------------------------------------
void SequenceRecorder::Append(const void* pixels, SequenceFields fields)
{
  if (!this->Header)
  {
    throw std::invalid_argument("the recording is closed");
  }
  this->CheckSizes(); // before more is written behind what is missing
  if (std::none_of(fields.begin(), fields.end(),
        [](const auto& field) { return field.first == "ImageStatus" && !field.second.empty(); }))
  {
    fields.emplace_back("ImageStatus", "OK"); // marks the end of a slice's fields, too
  }
  const std::string text = this->Kind.GetFrame(this->Now.Slices, fields);

  const std::size_t elementSize = GetScalarSize(this->Description.Type);
  const auto size =
    static_cast<std::size_t>(this->Description.Columns * this->Description.Rows) * elementSize;
  const auto* bytes = static_cast<const unsigned char*>(pixels);
  if (IsBigEndianMachine())
  {
    this->Frame.assign(bytes, bytes + size);
    SwapElementBytes(this->Frame.data(), size / elementSize, elementSize);
    bytes = this->Frame.data();
  }
  std::unique_ptr<StreamCompressor> compressor;
  std::string packed;
  std::int64_t stored = static_cast<std::int64_t>(size);
  if (this->Now.Compressor)
  {
    compressor = std::make_unique<StreamCompressor>(*this->Now.Compressor);
    ThreadExecution execution(1);
    packed = compressor->Compress(bytes, size, execution);
    stored = static_cast<std::int64_t>(packed.size());
  }

  try
  {
    this->Data->WriteAt(this->Now.DataSize,
      compressor ? static_cast<const void*>(packed.data()) : bytes,
      static_cast<std::size_t>(stored));
    this->WriteHeader(text, this->Now.Slices + 1, 0);
  }
  catch (const FileError&)
  {
    Try([&] { this->Data->Truncate(this->Now.DataSize); });
    throw;
  }
  this->Now.DataSize += stored;
  this->Now.HeaderSize += static_cast<std::int64_t>(text.size());
  ++this->Now.Slices;
  if (compressor)
  {
    this->Now.Compressor = std::move(compressor);
  }
}

//------------------------------------------------------------------------------
void SequenceRecorder::CheckSizes() const
{
  this->Data->CheckSize(this->Now.DataSize);
  this->Header->CheckSize(
    this->Now.HeaderSize + static_cast<std::int64_t>(this->Kind.GetEnd().size()));
}

//------------------------------------------------------------------------------
void SequenceRecorder::Check() const
{
  if (this->Header)
  {
    this->CheckSizes();
    this->Data->CheckName(this->DataName);
    this->Header->CheckName(this->HeaderName);
  }
}

//------------------------------------------------------------------------------
SequenceHeader SequenceRecorder::GetOpenHeader() const
{
  SequenceHeader header;
  header.FileName = this->HeaderName;
  header.Columns = this->Description.Columns;
  header.Rows = this->Description.Rows;
  header.Type = this->Description.Type;
  header.Frames = this->Now.Slices;
  header.Encoding = this->Now.Compressor ? PixelEncoding::Zlib : PixelEncoding::Raw;
  header.DataFileName = this->Data->GetOpenName();
  return header;
}

//------------------------------------------------------------------------------
// Adds fields to the header, or leaves it as it was.
void SequenceRecorder::WriteHeader(
  const std::string& fields, std::int64_t slices, std::int64_t compressedSize)
{
  const std::string end = this->Kind.GetEnd();
  try
  {
    this->Header->WriteAt(this->Now.HeaderSize, fields + end);
    this->Header->WriteAt(
      this->CountsOffset, this->Kind.GetCounts(this->Description, slices, compressedSize));
  }
  catch (const FileError&)
  {
    this->RestoreHeader();
    throw;
  }
}

//------------------------------------------------------------------------------
// As it was when there were Now.Slices: these bytes were there, so a full disk has room for them.
void SequenceRecorder::RestoreHeader()
{
  const std::string end = this->Kind.GetEnd();
  Try(
    [&]
    {
      this->Header->WriteAt(
        this->CountsOffset, this->Kind.GetCounts(this->Description, this->Now.Slices, 0));
      this->Header->WriteAt(this->Now.HeaderSize, end);
      this->Header->Truncate(this->Now.HeaderSize + static_cast<std::int64_t>(end.size()));
    });
}

//------------------------------------------------------------------------------
void SequenceRecorder::SyncFiles()
{
  this->Data->Sync();
  this->Header->Sync();
}

//------------------------------------------------------------------------------
void SequenceRecorder::Sync()
{
  if (!this->Header)
  {
    return;
  }
  try
  {
    this->SyncFiles();
    this->Synced = this->Now;
    this->Begun = true;
  }
  catch (...) // also when there is no memory for an error
  {
    this->Now = this->Synced;
    if (!this->Begun)
    {
      Try([&] { this->Data->WriteAt(0, this->DataStart); });
      Try([&] { this->Header->WriteAt(0, this->HeaderStart); });
    }
    this->RestoreHeader();
    throw;
  }
}

//------------------------------------------------------------------------------
void SequenceRecorder::Close()
{
  if (!this->Begun || this->Now.Slices != this->Synced.Slices)
  {
    this->Sync();
  }
  this->End();
}

//------------------------------------------------------------------------------
void SequenceRecorder::End()
{
  if (!this->Header)
  {
    return;
  }
  if (this->Now.Compressor)
  {
    const std::string end = this->Now.Compressor->GetEnd();
    try
    {
      this->Data->WriteAt(this->Now.DataSize, end);
      this->Data->Truncate(this->Now.DataSize + static_cast<std::int64_t>(end.size()));
    }
    catch (const FileError&)
    {
      Try([&] { this->Data->Truncate(this->Now.DataSize); });
      throw;
    }
    this->WriteHeader(
      {}, this->Now.Slices, this->Now.DataSize + static_cast<std::int64_t>(end.size()));
  }
  this->SyncFiles();
  this->Data->Close();
  this->Header->Close();
  this->Data.reset();
  this->Header.reset();
}
}
