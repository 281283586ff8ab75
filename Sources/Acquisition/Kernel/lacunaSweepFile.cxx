// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweepFile.h"

#include "lacunaOutputFile.h"
#include "lacunaParameterText.h"
#include "lacunaPixelSpacing.h"
#include "lacunaSequenceText.h"
#include "lacunaSweep.h"

#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double RetryInterval = 1;                  // s
constexpr std::chrono::milliseconds ShortWait{ 10 }; // enough for most disks, and no device is late

SequenceKind MakeKind(const std::string& fileName, int compressionLevel)
{
  SequenceKind kind(fileName, compressionLevel > 0);
  if (!kind.IsDetached())
  {
    throw std::invalid_argument(
      "A sweep is recorded to a file of its header and another one of its "
      "pixels, which can grow: name it .mhd or .nhdr, not '" +
      fileName + "'");
  }
  return kind;
}

void AddTransform(
  SequenceFields& fields, const std::string& name, const Matrix4& matrix, bool valid)
{
  fields.emplace_back(name + "Transform", FormatMatrix(valid ? matrix : Matrix4()));
  fields.emplace_back(name + "TransformStatus", valid ? "OK" : "INVALID");
}

void AddNumber(SequenceFields& fields, const std::string& name, double value)
{
  if (std::isfinite(value))
  {
    fields.emplace_back(name, FormatNumber(value));
  }
}
}

SequenceFields MakeSliceFields(const AcquiredSlice& slice, const SweepFrame& frame)
{
  SequenceFields fields;
  AddTransform(
    fields, "ProbeToTracker", slice.ProbeToTracker, (slice.Status & Sweep::PoseInvalid) == 0);
  AddTransform(fields, "TrackerToReference", frame.TrackerToReference, true);
  if (frame.Calibrated)
  {
    const Vec3 corner{ double(frame.Window[0]), double(frame.Window[1]), 0 };
    AddTransform(fields, "ImageToProbe", frame.ImageToProbe * Matrix4::Translation(corner), true);
  }
  if (slice.PixelSpacing)
  {
    const auto [column, row] = *slice.PixelSpacing;
    fields.emplace_back(PixelSpacingField, FormatNumber(column) + " " + FormatNumber(row));
  }
  AddNumber(fields, "Timestamp", slice.Timestamp);
  AddNumber(fields, "Residual", slice.Residual);
  if (slice.Held)
  {
    AddNumber(fields, "PoseHeld", slice.Residual);
  }
  AddNumber(fields, "Speed", slice.Speed);
  fields.emplace_back("FrameNumber", std::to_string(slice.FrameNumber));
  fields.emplace_back("SliceStatus", std::to_string(int(slice.Status)));
  fields.emplace_back("ImageStatus", (slice.Status & Sweep::ImageInvalid) == 0 ? "OK" : "INVALID");
  return fields;
}

SweepFile::SweepFile(const std::string& fileName, int compressionLevel)
  : FileName(fileName)
  , CompressionLevel(compressionLevel)
{
  MakeKind(fileName, compressionLevel);
}

SweepFile::~SweepFile()
{
  if (this->Opening.valid())
  {
    this->HandOver(true);
  }
}

void SweepFile::Rename(const std::string& fileName, int compressionLevel)
{
  if (!this->Recorder && fileName != this->FileName)
  {
    MakeKind(fileName, compressionLevel);
    this->FileName = fileName;
    this->CompressionLevel = compressionLevel;
    this->RetryTime = 0;
  }
}

void SweepFile::Retry()
{
  if (this->Clock.Now() >= this->RetryTime)
  {
    this->HandOver(false);
  }
}

void SweepFile::HandOver(bool patiently)
{
  try
  {
    if (this->Waiting.empty() || !this->IsOpen(patiently))
    {
      return;
    }
    while (!this->Waiting.empty())
    {
      this->Recorder->Add(this->Waiting.front().Pixels, this->Waiting.front().Fields);
      this->Waiting.pop_front();
    }
    this->Now.Trouble.clear();
  }
  catch (const std::exception& e) // of the disk, or of a system that has nothing left to give
  {
    this->Now.Trouble = e.what() +
      std::string(". The capture goes on, its slices wait in memory: mend that, then they are "
                  "written; or save the sweep elsewhere");
    this->RetryTime = this->Clock.Now() + RetryInterval;
  }
}

// Throws why it cannot be opened.
bool SweepFile::IsOpen(bool patiently)
{
  if (this->Recorder)
  {
    return true;
  }
  const bool begins = !this->Opening.valid();
  if (begins)
  {
    this->BeginToOpen();
  }
  const auto patience = begins ? ShortWait : std::chrono::milliseconds(0);
  if (!patiently && this->Opening.wait_for(patience) != std::future_status::ready)
  {
    return false;
  }
  Opened opened = this->Opening.get();
  this->Recorder = std::move(opened.Recorder);
  this->Now.FileName = std::move(opened.FileName);
  return true;
}

void SweepFile::BeginToOpen()
{
  try
  {
    this->Opening = std::async(std::launch::async,
      [fileName = this->FileName, level = this->CompressionLevel, description = this->Description]
      {
        Opened opened;
        opened.FileName = FindFreeSweepName(fileName, level);
        opened.Recorder = std::make_unique<SweepRecorder>(opened.FileName, description, level);
        return opened;
      });
  }
  catch (const std::system_error& e)
  {
    throw FileError(FileError::Kind::Other,
      "No thread can be started that opens '" + this->FileName + "': " + e.code().message());
  }
}

void SweepFile::Add(const AcquiredSlice& slice, const SweepFrame& frame)
{
  if (!this->Recorder)
  {
    this->Description.Columns = frame.Window[2];
    this->Description.Rows = frame.Window[3];
    this->Description.CustomFields = { { FirstColumnField, std::to_string(frame.Window[0]) },
      { FirstRowField, std::to_string(frame.Window[1]) } };
  }
  this->Waiting.push_back({ slice.Pixels, MakeSliceFields(slice, frame) });
  ++this->Now.Added;
  this->Retry();
}

SweepFile::State SweepFile::GetState() const
{
  State state = this->Now;
  if (this->Recorder)
  {
    const SweepRecorder::State recorded = this->Recorder->GetState();
    state.FileName = recorded.FileName;
    state.Synced = recorded.Synced;
    state.Verified = recorded.Verified;
    state.Lost = recorded.Lost;
    state.Notice = recorded.Notice;
    state.WaitingBytes = recorded.WaitingBytes;
    state.FreeBytes = recorded.FreeBytes;
    state.Trouble = state.Trouble.empty() ? recorded.Trouble : state.Trouble;
  }
  for (const Entry& entry : this->Waiting)
  {
    state.WaitingBytes += static_cast<std::int64_t>(entry.Pixels->size());
  }
  return state;
}

void SweepFile::Verify()
{
  if (this->Recorder && this->Waiting.empty())
  {
    this->Recorder->Verify();
  }
}

void SweepFile::Finish()
{
  const bool began = this->Opening.valid(); // and may have failed for what has been mended since
  this->HandOver(true);
  if (began)
  {
    this->HandOver(true);
  }
  if (!this->Waiting.empty())
  {
    throw FileError(FileError::Kind::CannotOpen, this->Now.Trouble);
  }
  if (this->Recorder)
  {
    this->Recorder->Finish();
  }
}
}
