// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTestDisk.h"

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace lacunaTest
{
std::atomic<int> DiskDelay{ 0 };
std::atomic<int> DiskFailures{ 0 };

namespace
{
// Whether it fails for this file; counts those of pixels only.
bool Fails(int file)
{
  static std::mutex mutex;
  static std::map<std::string, off_t> kept;
  const std::lock_guard<std::mutex> lock(mutex);
  const std::string path =
    std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(file)).string();
  struct stat status;
  if (path.find("raw") == std::string::npos || fstat(file, &status) != 0)
  {
    return false;
  }
  if (DiskFailures == 0)
  {
    kept[path] = status.st_size;
    return false;
  }
  --DiskFailures;
  for (off_t at = kept[path]; at < status.st_size; ++at)
  {
    if (pwrite(file, "", 1, at) != 1)
    {
      break;
    }
  }
  return true;
}
}
}

// The program's, instead of the library's.
extern "C" int fsync(int file)
{
  std::this_thread::sleep_for(std::chrono::milliseconds(lacunaTest::DiskDelay));
  if (lacunaTest::Fails(file))
  {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(syscall(SYS_fsync, file));
}
