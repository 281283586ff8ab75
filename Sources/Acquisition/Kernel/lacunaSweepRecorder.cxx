// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweepRecorder.h"

#include "lacunaClock.h"
#include "lacunaOutputFile.h"
#include "lacunaSequenceRecorder.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <iterator>
#include <limits>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double SyncInterval = 0.3; // s
constexpr double RetryInterval = 1;  // s

struct Slice
{
  SweepRecorder::Pixels Pixels;
  SequenceFields Fields;
  double Time; // when it was added
};

constexpr double Never = std::numeric_limits<double>::infinity();

// What the disk did not do last time it was asked to; until when it is left alone.
struct Refusal
{
  std::string Trouble; // empty: it did
  double RetryTime = 0;
};
}

struct SweepRecorder::Work
{
  // Begins the thread, which waits for the first slice.
  Work(const std::string& fileName, const SequenceDescription& description, int level)
    : FileName(fileName)
    , Kind(fileName, level > 0)
    , Bytes(static_cast<std::size_t>(description.Columns * description.Rows))
    , Thread([this] { this->Run(); })
  {
  }
  ~Work() { this->End(); }

  void End()
  {
    {
      const std::lock_guard<std::mutex> lock(this->Mutex);
      this->Ending = true;
      this->BeginRound();
    }
    if (this->Thread.joinable())
    {
      this->Thread.join();
    }
  }

  // From when on each is to be done.
  double GetWriteTime() const { return this->Queue.empty() ? Never : this->Writing.RetryTime; }
  double GetSyncTime() const
  {
    const bool last = this->Hurry || this->Ending; // once for all of them
    if (this->Unsynced.empty() || (last && !this->Queue.empty()))
    {
      return Never;
    }
    if (last)
    {
      return this->Syncing.RetryTime;
    }
    // a disk that takes long does not keep slices from being written
    const double begin = this->Queue.empty() ? this->Unsynced.front().Time
                                             : std::max(this->SyncEnd, this->Unsynced.front().Time);
    return std::max(this->Syncing.RetryTime, begin + SyncInterval);
  }
  bool HasAll() const { return this->Queue.empty() && this->Unsynced.empty(); }
  bool HasFailed() const { return this->FailedRound == this->Round; }
  // Everything is tried at once, also what fails while it begins.
  void BeginRound()
  {
    ++this->Round;
    this->Writing.RetryTime = 0;
    this->Syncing.RetryTime = 0;
    this->Changed.notify_all();
  }

  void Run();
  // Each is called with the lock and gives it up while the disk works.
  bool Try(std::unique_lock<std::mutex>& lock, Refusal& refusal, const char* advice,
    const std::function<void()>& action);
  void WriteFront(std::unique_lock<std::mutex>& lock);
  void Sync(std::unique_lock<std::mutex>& lock);

  SteadyClock Clock;
  const std::string FileName;
  const SequenceKind Kind;
  const std::size_t Bytes;
  std::optional<SequenceRecorder> Recorder; // used by the thread alone until that has ended

  mutable std::mutex Mutex;
  std::condition_variable Changed;
  std::deque<Slice> Queue;
  std::deque<Slice> Unsynced; // written, and to be written again should the disk have dropped them
  State Now;
  Refusal Writing;
  Refusal Syncing;
  double SyncEnd = 0; // of the last one, when
  // Of what was begun in the last round that failed.
  FileError::Kind FailedKind = FileError::Kind::Other;
  std::string Failure;
  int FailedRound = -1;
  int Round = 0;       // of tries to have all on the disk
  bool Hurry = false;  // Finish waits
  bool Ending = false; // the thread has to end, at the first failure or when all is done
  bool Finished = false;
  std::thread Thread; // last: it uses all the others
};

void SweepRecorder::Work::Run()
{
  std::unique_lock<std::mutex> lock(this->Mutex);
  while (!this->Ending || (!this->HasAll() && !this->HasFailed()))
  {
    const double now = this->Clock.Now();
    if (now >= this->GetSyncTime())
    {
      this->Sync(lock);
    }
    else if (now >= this->GetWriteTime())
    {
      this->WriteFront(lock);
    }
    else
    {
      const double next = std::min(this->GetSyncTime(), this->GetWriteTime());
      this->Changed.wait_for(
        lock, std::chrono::duration<double>(std::clamp(next - now, 0.001, RetryInterval)));
    }
  }
}

bool SweepRecorder::Work::Try(std::unique_lock<std::mutex>& lock, Refusal& refusal,
  const char* advice, const std::function<void()>& action)
{
  const int round = this->Round;
  lock.unlock();
  FileError::Kind kind = FileError::Kind::Other;
  std::string failure;
  try
  {
    action();
  }
  catch (const FileError& e)
  {
    kind = e.GetKind();
    failure = e.what();
  }
  catch (const std::exception& e)
  {
    failure = e.what();
  }
  std::error_code unknown;
  const std::uintmax_t free = std::filesystem::space(this->FileName, unknown).available;
  lock.lock();
  this->Now.FreeBytes = unknown ? -1 : static_cast<std::int64_t>(free);
  refusal = {};
  if (!failure.empty())
  {
    refusal.Trouble = failure + advice;
    refusal.RetryTime = round == this->Round ? this->Clock.Now() + RetryInterval : 0;
    this->FailedKind = kind;
    this->Failure = refusal.Trouble;
    this->FailedRound = round;
  }
  this->Now.Trouble = this->Writing.Trouble.empty() ? this->Syncing.Trouble : this->Writing.Trouble;
  this->Changed.notify_all();
  return failure.empty();
}

void SweepRecorder::Work::WriteFront(std::unique_lock<std::mutex>& lock)
{
  const Slice& slice = this->Queue.front(); // stays where it is while others are added
  if (this->Try(lock, this->Writing,
        ". The capture goes on, its slices wait in memory: make room on that disk, then they are "
        "written; or save the sweep elsewhere",
        [&] { this->Recorder->Append(slice.Pixels->data(), slice.Fields); }))
  {
    ++this->Now.Written;
    this->Now.WaitingBytes -= static_cast<std::int64_t>(this->Bytes);
    this->Unsynced.push_back(std::move(this->Queue.front()));
    this->Queue.pop_front();
  }
}

void SweepRecorder::Work::Sync(std::unique_lock<std::mutex>& lock)
{
  std::size_t written = this->Unsynced.size(); // only this thread uses it
  const auto sync = [&]
  {
    try
    {
      this->Recorder->Sync();
    }
    catch (...)
    {
      written = 0;
      for (const Slice& slice : this->Unsynced) // at once: now the file lacks them
      {
        this->Recorder->Append(slice.Pixels->data(), slice.Fields);
        ++written;
      }
      throw;
    }
  };
  const bool synced = this->Try(lock, this->Syncing,
    ". The capture goes on, its slices stay in memory, too, until the disk has taken them: look "
    "after that disk, or save the sweep elsewhere",
    sync);
  this->SyncEnd = this->Clock.Now();
  if (synced)
  {
    this->Now.LongestDelay =
      std::max(this->Now.LongestDelay, this->SyncEnd - this->Unsynced.front().Time);
    this->Unsynced.clear();
    this->Now.Synced = this->Now.Written;
  }
  else
  {
    const auto first = this->Unsynced.begin() + static_cast<std::ptrdiff_t>(written);
    const std::int64_t count = this->Unsynced.end() - first;
    this->Now.Written -= count;
    this->Now.WaitingBytes += count * static_cast<std::int64_t>(this->Bytes);
    this->Queue.insert(this->Queue.begin(), std::make_move_iterator(first),
      std::make_move_iterator(this->Unsynced.end()));
    this->Unsynced.erase(first, this->Unsynced.end());
  }
}

SweepRecorder::SweepRecorder(
  const std::string& fileName, const SequenceDescription& description, int compressionLevel)
{
  if (description.Type != ScalarType::UInt8)
  {
    throw std::invalid_argument("A sweep is recorded with 8-bit pixels");
  }
  try // before there is a file
  {
    this->Job = std::make_unique<Work>(fileName, description, compressionLevel);
  }
  catch (const std::system_error& e)
  {
    throw FileError(FileError::Kind::Other,
      "No thread can be started that writes '" + fileName + "': " + e.code().message());
  }
  this->Job->Recorder.emplace(fileName, description, compressionLevel);
}

SweepRecorder::~SweepRecorder() = default;

void SweepRecorder::Add(Pixels pixels, SequenceFields fields)
{
  Work& job = *this->Job;
  if (!pixels || pixels->size() != job.Bytes)
  {
    throw std::invalid_argument("A slice of the recording has " + std::to_string(job.Bytes) +
      " pixels, not " + std::to_string(pixels ? pixels->size() : 0));
  }
  job.Kind.GetFrame(0, fields); // throws for fields that cannot be written
  {
    const std::lock_guard<std::mutex> lock(job.Mutex);
    if (job.Finished)
    {
      throw std::invalid_argument("The recording has been finished");
    }
    job.Queue.push_back({ std::move(pixels), std::move(fields), job.Clock.Now() });
    ++job.Now.Added;
    job.Now.WaitingBytes += static_cast<std::int64_t>(job.Bytes);
  }
  job.Changed.notify_all();
}

SweepRecorder::State SweepRecorder::GetState() const
{
  const std::lock_guard<std::mutex> lock(this->Job->Mutex);
  return this->Job->Now;
}

void SweepRecorder::Finish()
{
  Work& job = *this->Job;
  {
    std::unique_lock<std::mutex> lock(job.Mutex);
    job.Hurry = true;
    job.BeginRound();
    job.Changed.wait(lock, [&] { return job.HasAll() || job.HasFailed(); });
    job.Hurry = false;
    if (!job.HasAll())
    {
      throw FileError(job.FailedKind, job.Failure);
    }
    job.Finished = true;
  }
  job.End();
  try
  {
    job.Recorder->Close();
  }
  catch (const FileError& e)
  {
    const std::lock_guard<std::mutex> lock(job.Mutex);
    job.Now.Trouble = e.what() +
      std::string(". All its slices can be read, but it lacks its end: make room on that disk "
                  "before the next sweep is begun, which tries again");
    throw;
  }
  const std::lock_guard<std::mutex> lock(job.Mutex);
  job.Now.Trouble.clear();
}
}
