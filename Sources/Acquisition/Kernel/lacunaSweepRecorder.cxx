// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSweepRecorder.h"

#include "lacunaClock.h"
#include "lacunaOutputFile.h"
#include "lacunaPixelSource.h"
#include "lacunaSequenceHeader.h"
#include "lacunaSequenceRecorder.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <functional>
#include <iterator>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

namespace lacuna
{
namespace
{
constexpr double SyncInterval = 0.3;  // s
constexpr double RetryInterval = 1;   // s
constexpr double CheckInterval = 0.5; // s
constexpr double VerifyPart = 0.1;    // s; then slices that came meanwhile are written
constexpr int MostUnlike = 3; // files that are written anew since they are not what was written
constexpr const char* MoveAdvice =
  ". The capture goes on, its slices wait in memory: mend that, then they are written; or save the "
  "sweep elsewhere";

struct Slice
{
  SweepRecorder::Pixels Pixels;
  SequenceFields Fields;
  double Time; // when it was added
};

// What a written slice is compared with.
struct Written
{
  SequenceFields Fields;
  std::size_t Hash;
};

std::size_t HashPixels(const void* pixels, std::size_t size)
{
  return std::hash<std::string_view>()({ static_cast<const char*>(pixels), size });
}

// A file that was lost, and what is known of it: its pixels can still be read where it is open.
struct LostFile
{
  std::unique_ptr<SequenceRecorder> Recorder;
  std::deque<Written> Slices; // that were on the disk
  std::size_t Next = 0;       // of these, the first that is not in the new file
  std::int64_t Lost = 0;      // of those before
  std::string Reason;
};

// A file as others find it.
struct ReadFile
{
  explicit ReadFile(SequenceHeader header)
    : Header(std::move(header))
    , Source(PixelSource::Open(this->Header))
    , Pixels(static_cast<std::size_t>(this->Source->GetFrameSize()))
  {
  }
  // Whether slice i has these pixels; then they are in Pixels. Throws std::runtime_error.
  bool HasPixels(std::size_t i, std::size_t hash)
  {
    const auto frame = static_cast<std::int64_t>(i);
    if (frame >= this->Source->GetNumberOfWholeFrames())
    {
      return false;
    }
    this->Source->ReadFrame(frame, this->Pixels.data());
    return HashPixels(this->Pixels.data(), this->Pixels.size()) == hash;
  }
  bool HasFields(std::size_t i, const SequenceFields& fields) const
  {
    const auto has = [&](const auto& field)
    {
      const auto found = this->Header.FrameFields.find(field.first);
      return field.second.empty() ||
        (found != this->Header.FrameFields.end() && i < found->second.size() &&
          found->second[i] == field.second);
    };
    return std::all_of(fields.begin(), fields.end(), has);
  }

  const SequenceHeader Header;
  const std::unique_ptr<PixelSource> Source;
  std::vector<std::uint8_t> Pixels;
};

std::string CountSlices(std::int64_t slices)
{
  return std::to_string(slices) + (slices == 1 ? " slice" : " slices");
}

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
    : Name(std::filesystem::path(fileName).filename().string())
    , Path(std::filesystem::absolute(fileName).string())
    , Description(description)
    , Level(level)
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
  double GetWriteTime() const
  {
    return this->Queue.empty() && !this->Old ? Never : this->Writing.RetryTime;
  }
  double GetSyncTime() const
  {
    const bool last = this->Hurry || this->Ending; // once for all of them
    if (this->Old || this->Unsynced.empty() || (last && !this->Queue.empty()))
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
  double GetCheckTime() const
  {
    return this->Old || this->Slices.empty() ? Never : this->Checking.RetryTime;
  }
  bool HasAllOnDisk() const { return this->Queue.empty() && this->Unsynced.empty() && !this->Old; }
  bool MayVerify() const
  {
    return this->ToVerify && this->HasAllOnDisk() && this->Now.Verified < this->Now.Synced;
  }
  double GetVerifyTime() const { return this->MayVerify() ? this->Verifying.RetryTime : Never; }
  bool HasAll() const { return this->HasAllOnDisk() && !this->MayVerify(); }
  bool HasFailed() const { return this->FailedRound == this->Round; }
  // Everything is tried at once, also what fails while it begins.
  void BeginRound()
  {
    ++this->Round;
    this->Writing.RetryTime = 0;
    this->Syncing.RetryTime = 0;
    this->Verifying.RetryTime = 0;
    this->Changed.notify_all();
  }

  void Run();
  // Each is called with the lock and gives it up while the disk works.
  bool Try(std::unique_lock<std::mutex>& lock, Refusal& refusal, const char* advice,
    const std::function<void()>& action);
  void WriteFront(std::unique_lock<std::mutex>& lock);
  void Sync(std::unique_lock<std::mutex>& lock);
  void Check(std::unique_lock<std::mutex>& lock);
  void Verify(std::unique_lock<std::mutex>& lock);
  void Move(std::unique_lock<std::mutex>& lock);
  // Those only with the lock, and those only without it.
  void BeginToMove(const std::string& reason);
  void QueueUnsynced(std::size_t first);
  void OpenElsewhere();
  void Copy();

  SteadyClock Clock;
  const std::string Name; // of the first file; others get numbers
  std::string
    Path; // absolute, as the program may change its folder; the thread's, as the next ones
  const SequenceDescription Description;
  const int Level;
  const SequenceKind Kind;
  const std::size_t Bytes;
  std::unique_ptr<SequenceRecorder> Recorder; // null while none can be opened
  std::deque<Written> Slices;                 // of Recorder
  std::unique_ptr<LostFile> Old;              // null unless there is one to be replaced
  std::unique_ptr<ReadFile> Back;             // null unless slices are being read back
  int Unlike = 0;                             // files that were not what was written

  mutable std::mutex Mutex;
  std::condition_variable Changed;
  std::deque<Slice> Queue;
  std::deque<Slice> Unsynced; // written, and to be written again should the disk have dropped them
  State Now;
  Refusal Writing;
  Refusal Syncing;
  Refusal Checking;
  Refusal Verifying;
  double SyncEnd = 0; // of the last one, when
  // Of what was begun in the last round that failed.
  FileError::Kind FailedKind = FileError::Kind::Other;
  std::string Failure;
  int FailedRound = -1;
  int Round = 0;      // of tries to have all on the disk
  bool Hurry = false; // Finish waits
  bool ToVerify = false;
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
    if (now >= this->GetCheckTime())
    {
      this->Check(lock);
    }
    else if (now >= this->GetSyncTime())
    {
      this->Sync(lock);
    }
    else if (now >= this->GetWriteTime())
    {
      this->Old ? this->Move(lock) : this->WriteFront(lock);
    }
    else if (now >= this->GetVerifyTime())
    {
      this->Verify(lock);
    }
    else
    {
      const double next = std::min(
        { this->GetSyncTime(), this->GetWriteTime(), this->GetCheckTime(), this->GetVerifyTime() });
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
  std::string lost;
  try
  {
    action();
  }
  catch (const FileLost& e)
  {
    lost = e.what();
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
  const std::uintmax_t free = std::filesystem::space(this->Path, unknown).available;
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
  this->Now.Trouble.clear();
  for (const Refusal* each : { &this->Writing, &this->Syncing, &this->Checking, &this->Verifying })
  {
    this->Now.Trouble = this->Now.Trouble.empty() ? each->Trouble : this->Now.Trouble;
  }
  if (!lost.empty())
  {
    this->BeginToMove(lost);
  }
  this->Changed.notify_all();
  return failure.empty() && lost.empty();
}

void SweepRecorder::Work::WriteFront(std::unique_lock<std::mutex>& lock)
{
  const Slice& slice = this->Queue.front(); // stays where it is while others are added
  std::size_t hash = 0;
  this->Back.reset();
  if (this->Try(lock, this->Writing,
        ". The capture goes on, its slices wait in memory: make room on that disk, then they are "
        "written; or save the sweep elsewhere",
        [&]
        {
          this->Recorder->Append(slice.Pixels->data(), slice.Fields);
          hash = HashPixels(slice.Pixels->data(), slice.Pixels->size());
        }))
  {
    this->Slices.push_back({ slice.Fields, hash });
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
    this->Recorder->Check(); // a file without a name can be synced, too
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
  else if (!this->Old) // else all are in the queue
  {
    this->QueueUnsynced(written);
    this->Slices.resize(static_cast<std::size_t>(this->Now.Written));
  }
}

// Has unsynced slices from first on written again.
void SweepRecorder::Work::QueueUnsynced(std::size_t first)
{
  const auto begin = this->Unsynced.begin() + static_cast<std::ptrdiff_t>(first);
  const std::int64_t count = this->Unsynced.end() - begin;
  this->Now.Written -= count;
  this->Now.WaitingBytes += count * static_cast<std::int64_t>(this->Bytes);
  this->Queue.insert(this->Queue.begin(), std::make_move_iterator(begin),
    std::make_move_iterator(this->Unsynced.end()));
  this->Unsynced.erase(begin, this->Unsynced.end());
}

void SweepRecorder::Work::Check(std::unique_lock<std::mutex>& lock)
{
  if (this->Try(lock, this->Checking,
        ". The capture goes on, and whether its slices are there is not known: look after that "
        "disk",
        [&] { this->Recorder->Check(); }))
  {
    this->Checking.RetryTime = this->Clock.Now() + CheckInterval;
  }
}

// Reads back some of the slices.
void SweepRecorder::Work::Verify(std::unique_lock<std::mutex>& lock)
{
  std::int64_t verified = this->Now.Verified;
  const auto verify = [&]
  {
    this->Recorder->Check();
    const double end = this->Clock.Now() + VerifyPart;
    bool right = true;
    try // whatever cannot be read in a file that is there is not what was written
    {
      if (!this->Back)
      {
        this->Back = std::make_unique<ReadFile>(ReadSequenceHeader(this->Path));
      }
      const auto count = static_cast<std::int64_t>(this->Slices.size());
      while (right && verified < count && this->Clock.Now() < end)
      {
        const auto i = static_cast<std::size_t>(verified);
        right = this->Back->HasPixels(i, this->Slices[i].Hash) &&
          this->Back->HasFields(i, this->Slices[i].Fields);
        verified += right ? 1 : 0;
      }
    }
    catch (const std::runtime_error&)
    {
      right = false;
    }
    if (!right)
    {
      const std::string what = "'" + this->Path + "' was changed: its slice " +
        std::to_string(verified) + " is not what was recorded";
      if (this->Unlike == MostUnlike) // another copy would be no better
      {
        throw FileError(FileError::Kind::Other,
          what + ", as in " + std::to_string(MostUnlike) +
            " files before: the disk may be failing, save the sweep on another one (Save Data)");
      }
      ++this->Unlike;
      throw FileLost(what);
    }
  };
  if (this->Try(lock, this->Verifying, ". The slices cannot be read back", verify))
  {
    this->Now.Verified = verified;
    if (!this->MayVerify())
    {
      this->Back.reset();
    }
  }
}

// The file is not there any more; what is not on the disk is in memory.
void SweepRecorder::Work::BeginToMove(const std::string& reason)
{
  this->Back.reset();
  this->QueueUnsynced(0);
  this->Slices.resize(static_cast<std::size_t>(this->Now.Written));
  if (!this->Old)
  {
    this->Old = std::make_unique<LostFile>();
    this->Old->Recorder = std::move(this->Recorder);
    this->Old->Slices = std::move(this->Slices);
    this->Old->Reason = reason;
  }
  this->Recorder.reset();
  this->Slices.clear();
  this->Old->Next = 0;
  this->Old->Lost = 0;
  this->Now.Written = this->Now.Synced = this->Now.Verified = 0;
  this->Now.Notice =
    reason + ". What its open files and the memory still have is written elsewhere";
  this->Checking = {};
  this->Verifying = {};
  this->Syncing = {};
}

// To the first folder that takes a file.
void SweepRecorder::Work::OpenElsewhere()
{
  namespace fs = std::filesystem;
  const fs::path before = this->Path;
  std::error_code unknown;
  const char* home = std::getenv("HOME");
  std::vector<fs::path> folders{ before.parent_path(), before.parent_path().parent_path() };
  if (home && *home)
  {
    folders.emplace_back(home);
  }
  folders.push_back(fs::temp_directory_path(unknown));
  std::string error;
  for (const fs::path& folder : folders)
  {
    try
    {
      const std::string path = FindFreeSweepName((folder / this->Name).string(), this->Level);
      this->Recorder = std::make_unique<SequenceRecorder>(path, this->Description, this->Level);
      this->Path = path;
      return;
    }
    catch (const FileError& e)
    {
      error += (error.empty() ? "" : "; ") + std::string(e.what());
    }
  }
  throw FileError(FileError::Kind::CannotOpen, error);
}

// Writes to the new file what can still be read of the old one, and has it on the disk.
void SweepRecorder::Work::Copy()
{
  LostFile& old = *this->Old;
  std::unique_ptr<ReadFile> open;
  try
  {
    open = std::make_unique<ReadFile>(old.Recorder->GetOpenHeader());
  }
  catch (const std::runtime_error&) // not one slice is left
  {
  }
  const auto isThere = [&](std::size_t i)
  {
    try
    {
      return open && open->HasPixels(i, old.Slices[i].Hash);
    }
    catch (const std::runtime_error&)
    {
      return false;
    }
  };
  for (; old.Next < old.Slices.size(); ++old.Next)
  {
    if (isThere(old.Next))
    {
      this->Recorder->Append(open->Pixels.data(), old.Slices[old.Next].Fields);
      this->Slices.push_back(old.Slices[old.Next]);
    }
    else
    {
      ++old.Lost;
    }
  }
  try
  {
    this->Recorder->Check();
    this->Recorder->Sync();
  }
  catch (...) // the recording has no slice now
  {
    old.Next = 0;
    old.Lost = 0;
    this->Slices.clear();
    throw;
  }
}

void SweepRecorder::Work::Move(std::unique_lock<std::mutex>& lock)
{
  const auto move = [&]
  {
    if (!this->Recorder)
    {
      this->OpenElsewhere();
    }
    this->Copy();
  };
  if (!this->Try(lock, this->Writing, MoveAdvice, move))
  {
    return;
  }
  const std::unique_ptr<LostFile> old = std::move(this->Old);
  this->Now.FileName = this->Path;
  this->Now.Written = this->Now.Synced = static_cast<std::int64_t>(this->Slices.size());
  this->Now.Lost += old->Lost;
  this->Now.Notice = old->Reason + ". " +
    (this->Now.Lost == 0 ? "All its slices, and those to come, are in '"
                         : CountSlices(this->Now.Lost) +
          " of it can be read nowhere and are only in the memory of this program: save the sweep "
          "(Save Data). The others, and those to come, are in '") +
    this->Path + "'";
  lock.unlock(); // its files take time to close
  old->Recorder.reset();
  lock.lock();
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
  this->Job->Now.FileName = fileName;
  this->Job->Recorder = std::make_unique<SequenceRecorder>(fileName, description, compressionLevel);
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
    job.ToVerify = false;
    job.Now.WaitingBytes += static_cast<std::int64_t>(job.Bytes);
  }
  job.Changed.notify_all();
}

SweepRecorder::State SweepRecorder::GetState() const
{
  const std::lock_guard<std::mutex> lock(this->Job->Mutex);
  return this->Job->Now;
}

void SweepRecorder::Verify()
{
  Work& job = *this->Job;
  const std::lock_guard<std::mutex> lock(job.Mutex);
  if (!job.ToVerify && !job.Finished)
  {
    job.ToVerify = true;
    job.Changed.notify_all();
  }
}

void SweepRecorder::Finish()
{
  Work& job = *this->Job;
  {
    std::unique_lock<std::mutex> lock(job.Mutex);
    job.Hurry = true;
    job.ToVerify = true;
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
  if (job.Now.Lost > 0)
  {
    throw FileError(FileError::Kind::Other, job.Now.Notice);
  }
}
}
