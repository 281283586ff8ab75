// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDecoderProcess.h"

#include "lacunaMemory.h"

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace lacuna
{
namespace
{
constexpr int FirstFree = 10; // above the descriptors that the process begins with

const std::string Cannot = "cannot be decoded: ";
const std::string Advice =
  "; get this slice from the archive again, or export the series uncompressed";

[[noreturn]] void Fail(const std::string& what, int code)
{
  throw std::runtime_error(Cannot + what + ": " + std::generic_category().message(code));
}

std::string DescribeSignal(int number)
{
  const char* name = sigdescr_np(number);
  return "signal " + std::to_string(number) + (name ? std::string(", ") + name : "");
}

// How the process begins. Nothing is open but what it needs, and what codecs write to the terminal is for
// nobody. Its signals do what they do in a new program, whatever this one has made of them. It has a group
// of its own, for which an interrupt of the terminal is not meant.
class SpawnSettings
{
public:
  SpawnSettings(int socket, int memory)
  {
    posix_spawn_file_actions_init(&this->Actions);
    posix_spawn_file_actions_adddup2(&this->Actions, socket, DecoderSocket);
    posix_spawn_file_actions_addopen(&this->Actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&this->Actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&this->Actions, memory, DecoderMemory);
    posix_spawn_file_actions_addclosefrom_np(&this->Actions, DecoderMemory + 1);
    sigset_t signals;
    posix_spawnattr_init(&this->Attributes);
    posix_spawnattr_setflags(
      &this->Attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&this->Attributes, &signals);
    sigfillset(&signals);
    posix_spawnattr_setsigdefault(&this->Attributes, &signals);
    posix_spawnattr_setpgroup(&this->Attributes, 0);
  }
  ~SpawnSettings()
  {
    posix_spawnattr_destroy(&this->Attributes);
    posix_spawn_file_actions_destroy(&this->Actions);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  posix_spawn_file_actions_t Actions{};
  posix_spawnattr_t Attributes{};
};
}

//------------------------------------------------------------------------------
std::string FindDecoderProgram()
{
  std::filesystem::path folder;
  Dl_info here{};
  // not the address of a function, which in some programs is one of their own
  static const char anchor = 0;
  if (dladdr(&anchor, &here) != 0 && here.dli_fname)
  {
    std::error_code wrong;
    const std::filesystem::path file = std::filesystem::canonical(here.dli_fname, wrong);
    folder = (wrong ? std::filesystem::path(here.dli_fname) : file).parent_path();
  }
  return (folder / LACUNA_DECODER).string();
}

//------------------------------------------------------------------------------
DecoderProcess::Descriptor::~Descriptor()
{
  this->Set(-1);
}

//------------------------------------------------------------------------------
void DecoderProcess::Descriptor::Set(int number)
{
  if (this->Number >= 0)
  {
    ::close(this->Number);
  }
  this->Number = number;
}

//------------------------------------------------------------------------------
DecoderProcess::DecoderProcess(const std::string& program, double patience)
  : Program(program)
  , Patience(patience)
{
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
  {
    Fail("there is no socket for the program that decodes", errno);
  }
  Descriptor theirs;
  theirs.Set(ends[1]);
  this->Socket.Set(ends[0]);
  // It cannot be shortened: that would end this program when it reads.
  this->Memory.Set(::memfd_create("lacuna-decode", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (this->Memory.Get() < 0 ||
    ::fcntl(this->Memory.Get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_SEAL) != 0)
  {
    Fail("there is no memory for the program that decodes", errno);
  }
  this->Start(theirs.Get());
  theirs.Set(-1); // so that its end is seen
  try
  {
    this->CheckHello();
  }
  catch (...)
  {
    this->End();
    throw;
  }
}

//------------------------------------------------------------------------------
void DecoderProcess::CheckHello()
{
  DecoderReply hello;
  if (!this->Receive(hello, this->Patience))
  {
    const bool missing = WIFEXITED(this->Status) && WEXITSTATUS(this->Status) == 127;
    const std::string why = this->TooLate
      ? " in " + std::to_string(std::lround(this->Patience)) + " s"
      : missing ? ", since a library that it needs is missing (Debian: libgdcm3.0)"
                : "";
    throw std::runtime_error(Cannot + this->Program + " does not start" + why);
  }
  if (hello.Version != DecoderVersion || hello.Status != DecoderStatus::Ready)
  {
    throw std::runtime_error(
      Cannot + this->Program + " is of another version; install Lacuna again");
  }
}

//------------------------------------------------------------------------------
DecoderProcess::~DecoderProcess()
{
  this->End();
  if (this->Bytes)
  {
    ::munmap(this->Bytes, this->Size);
  }
}

//------------------------------------------------------------------------------
// Not fork: threads of this program may hold locks, and MPI forbids it.
void DecoderProcess::Start(int socket)
{
  Descriptor high[2];
  high[0].Set(::fcntl(socket, F_DUPFD_CLOEXEC, FirstFree));
  high[1].Set(::fcntl(this->Memory.Get(), F_DUPFD_CLOEXEC, FirstFree));
  if (high[0].Get() < 0 || high[1].Get() < 0)
  {
    Fail("the program that decodes cannot be started", errno);
  }
  std::string name = this->Program;
  char* const arguments[] = { name.data(), nullptr };
  const SpawnSettings settings(high[0].Get(), high[1].Get());
  const int wrong = ::posix_spawn(
    &this->Child, name.c_str(), &settings.Actions, &settings.Attributes, arguments, environ);
  if (wrong == ENOENT)
  {
    this->Child = 0;
    throw std::runtime_error(Cannot + "there is no program " + this->Program +
      ", which comes with Lacuna when it is built with GDCM; install Lacuna again, or make an "
      "uncompressed copy of the file (gdcmconv --raw)");
  }
  if (wrong != 0)
  {
    this->Child = 0;
    Fail(this->Program + " cannot be started", wrong);
  }
}

//------------------------------------------------------------------------------
void DecoderProcess::Reserve(std::size_t size)
{
  if (size <= this->Size)
  {
    return;
  }
  if (this->Bytes)
  {
    ::munmap(this->Bytes, this->Size);
    this->Bytes = nullptr;
    this->Size = 0;
  }
  void* bytes = MAP_FAILED;
  if (::ftruncate(this->Memory.Get(), static_cast<off_t>(size)) == 0)
  {
    bytes = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, this->Memory.Get(), 0);
  }
  if (bytes == MAP_FAILED)
  {
    throw std::runtime_error(Cannot + "there are no " + DescribeBytes(static_cast<double>(size)) +
      " for the program that decodes");
  }
  this->Bytes = static_cast<unsigned char*>(bytes);
  this->Size = size;
}

//------------------------------------------------------------------------------
std::string DecoderProcess::Decode(
  DecoderRequest request, const unsigned char* stream, unsigned char* pixels, DecoderFormat& format)
{
  constexpr std::uint64_t Alignment = 4096;
  request.PixelOffset = (request.StreamBytes + Alignment - 1) / Alignment * Alignment;
  this->Reserve(static_cast<std::size_t>(request.PixelOffset + request.PixelBytes));
  request.MemoryBytes = this->Size;
  std::memcpy(this->Bytes, stream, static_cast<std::size_t>(request.StreamBytes));

  const double seconds = GetDecoderSeconds(request);
  DecoderReply reply;
  const bool sent = ::send(this->Socket.Get(), &request, sizeof request, MSG_NOSIGNAL) ==
    static_cast<ssize_t>(sizeof request);
  if (!sent)
  {
    this->End();
  }
  if (!sent || !this->Receive(reply, this->Patience * (1 + seconds)))
  {
    if (this->TooLate || (WIFSIGNALED(this->Status) && WTERMSIG(this->Status) == SIGPROF))
    {
      return Cannot + "GDCM takes more time than an image of this size may (" +
        std::to_string(std::lround(1000 * seconds)) + " ms of processor)" + Advice;
    }
    return Cannot + "they end the program that decodes them (GDCM: " +
      (WIFSIGNALED(this->Status) ? DescribeSignal(WTERMSIG(this->Status)) : "no reason is known") +
      ")" + Advice;
  }
  switch (reply.Status)
  {
    case DecoderStatus::Decoded:
      std::memcpy(
        pixels, this->Bytes + request.PixelOffset, static_cast<std::size_t>(request.PixelBytes));
      format = reply.Format;
      return {};
    case DecoderStatus::UnknownSyntax:
      return "are in a form that is not known; export the series uncompressed";
    case DecoderStatus::OutOfMemory:
      return Cannot + "GDCM takes more memory than an image of this size may (" +
        DescribeBytes(static_cast<double>(GetDecoderBytes(request))) + ")" + Advice;
    default:
      return Cannot + "GDCM finds them damaged" + Advice;
  }
}

//------------------------------------------------------------------------------
bool DecoderProcess::Receive(DecoderReply& reply, double seconds)
{
  // Counted in steps, so that time in which the whole machine slept is no time.
  constexpr int Step = 100; // ms
  const auto steps = static_cast<std::int64_t>(std::ceil(1000 * seconds / Step));
  pollfd watched{ this->Socket.Get(), POLLIN, 0 };
  int ready = 0;
  for (std::int64_t i = 0; i < steps && ready == 0;)
  {
    ready = ::poll(&watched, 1, Step);
    if (ready < 0 && errno == EINTR)
    {
      ready = 0;
      continue;
    }
    ++i;
  }
  this->TooLate = ready == 0;
  ssize_t got = -1;
  if (ready > 0)
  {
    do
    {
      got = ::recv(this->Socket.Get(), &reply, sizeof reply, 0);
    } while (got < 0 && errno == EINTR);
  }
  if (got == static_cast<ssize_t>(sizeof reply))
  {
    return true;
  }
  this->End();
  return false;
}

//------------------------------------------------------------------------------
void DecoderProcess::End()
{
  if (this->Child <= 0)
  {
    return;
  }
  // What has ended keeps its status. Where this program leaves that to the system, the number may be of
  // another process by now.
  int status = 0;
  pid_t ended = ::waitpid(this->Child, &status, WNOHANG);
  if (ended == 0)
  {
    ::kill(this->Child, SIGKILL);
    do
    {
      ended = ::waitpid(this->Child, &status, 0);
    } while (ended < 0 && errno == EINTR);
  }
  this->Status = ended == this->Child ? status : -1;
  this->Child = 0;
}
}
