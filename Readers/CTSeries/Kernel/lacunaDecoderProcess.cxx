// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDecoderProcess.h"

#include "lacunaMemory.h"
#include "lacunaProgram.h"

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
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
}

//------------------------------------------------------------------------------
std::string FindDecoderProgram()
{
  static const char anchor = 0;
  return FindBeside(&anchor, LACUNA_DECODER);
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
  int wrong = 0;
  // what codecs write to the terminal is for nobody
  this->Child =
    ProgramSettings({ high[0].Get(), -1, -1, high[1].Get() }).Start(name, arguments, wrong);
  if (wrong == ENOENT)
  {
    throw std::runtime_error(Cannot + "there is no program " + this->Program +
      ", which comes with Lacuna when it is built with GDCM; install Lacuna again, or make an "
      "uncompressed copy of the file (gdcmconv --raw)");
  }
  if (wrong != 0)
  {
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
