// SPDX-License-Identifier: BSD-3-Clause
// lacuna-decode: the process in which a DecoderProcess has pixels decoded. It serves one image after the
// other until the socket closes. A limit that is exceeded ends it, or gives an error.
#include "lacunaGDCMDecoder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#ifndef __has_feature // clang's
#define __has_feature(feature) 0
#endif

namespace
{
using namespace lacuna;

// Sanitizers have terabytes of addresses.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) ||                               \
  __has_feature(address_sanitizer)
constexpr bool Sanitized = true;
#else
constexpr bool Sanitized = false;
#endif

// Bytes of addresses that the process has.
std::uint64_t GetAddresses()
{
  unsigned long long pages = 0;
  if (FILE* file = std::fopen("/proc/self/statm", "r"))
  {
    if (std::fscanf(file, "%llu", &pages) != 1)
    {
      pages = 0;
    }
    std::fclose(file);
  }
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void SetMemoryLimit(std::uint64_t bytes)
{
  if (Sanitized)
  {
    return;
  }
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  const std::uint64_t most = limit.rlim_max;
  limit.rlim_cur = std::min(most, GetAddresses() + bytes);
  setrlimit(RLIMIT_AS, &limit);
}

// Of processor time, after which SIGPROF ends the process; 0: none.
void SetTimeLimit(double seconds)
{
  const double whole = std::floor(seconds);
  itimerval limit{};
  limit.it_value.tv_sec = static_cast<time_t>(whole);
  limit.it_value.tv_usec = static_cast<suseconds_t>(1e6 * (seconds - whole));
  setitimer(ITIMER_PROF, &limit, nullptr);
}

// The memory that the other program has given; its size grows.
class SharedMemory
{
public:
  unsigned char* Get(std::uint64_t size)
  {
    if (size != this->Size)
    {
      if (this->Bytes)
      {
        munmap(this->Bytes, this->Size);
      }
      void* bytes = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, DecoderMemory, 0);
      this->Bytes = bytes == MAP_FAILED ? nullptr : static_cast<unsigned char*>(bytes);
      this->Size = this->Bytes ? size : 0;
    }
    return this->Bytes;
  }

private:
  unsigned char* Bytes = nullptr;
  std::uint64_t Size = 0;
};

// What codecs write to stderr. libjpeg makes up the pixels of damaged data and GDCM takes them, so a message
// is all that tells.
class Messages
{
public:
  Messages()
  {
    int ends[2];
    if (pipe2(ends, O_NONBLOCK | O_CLOEXEC) == 0)
    {
      dup2(ends[1], STDERR_FILENO); // what it has no room for is lost
      this->End = ends[0];
    }
  }
  bool TellOfDamage() const
  {
    std::string text;
    std::array<char, 4096> part;
    for (ssize_t size = 0; (size = read(this->End, part.data(), part.size())) > 0;)
    {
      text.append(part.data(), static_cast<std::size_t>(size));
    }
    const std::array<const char*, 3> damages = { "premature end of data segment",
      "bad Huffman code", "Premature end of JPEG file" };
    return std::any_of(damages.begin(), damages.end(),
      [&](const char* damage) { return text.find(damage) != std::string::npos; });
  }

private:
  int End = -1;
};

bool Send(const DecoderReply& reply)
{
  return send(DecoderSocket, &reply, sizeof reply, MSG_NOSIGNAL) ==
    static_cast<ssize_t>(sizeof reply);
}

DecoderReply Decode(const DecoderRequest& request, SharedMemory& memory, const Messages& messages)
{
  DecoderReply reply;
  SetMemoryLimit(request.MemoryBytes + GetDecoderBytes(request));
  unsigned char* bytes = memory.Get(request.MemoryBytes);
  if (!bytes)
  {
    reply.Status = DecoderStatus::OutOfMemory;
    return reply;
  }
  SetTimeLimit(GetDecoderSeconds(request));
  reply = DecodeWithGDCM(request, bytes, bytes + request.PixelOffset);
  SetTimeLimit(0);
  if (messages.TellOfDamage() && reply.Status == DecoderStatus::Decoded)
  {
    reply.Status = DecoderStatus::Damaged;
  }
  return reply;
}
}

int main()
{
  struct stat socket
  {
  };
  if (fstat(DecoderSocket, &socket) != 0 || !S_ISSOCK(socket.st_mode))
  {
    std::fputs(
      "lacuna-decode is started by Lacuna's CT Series Reader, to decode JPEG in DICOM files.\n",
      stderr);
    return EXIT_FAILURE;
  }
  prctl(PR_SET_DUMPABLE, 0); // no core is kept of what is expected
  // memory of one image serves for the next: pages that the system gives anew take a third of decoding
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  const Messages messages;
  SharedMemory memory;
  DecoderRequest request;
  if (Send(DecoderReply()))
  {
    while (recv(DecoderSocket, &request, sizeof request, 0) == static_cast<ssize_t>(sizeof request))
    {
      if (!Send(Decode(request, memory, messages)))
      {
        break;
      }
    }
  }
  _exit(EXIT_SUCCESS); // nothing to put in order
}
