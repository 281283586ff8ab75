// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaStepProgram.h"

#include "lacunaProgram.h"
#include "lacunaStepProtocol.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <type_traits>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace lacuna
{
namespace
{
constexpr int FirstFree = 10; // above the descriptors that the process begins with
constexpr useconds_t Pause = 20000;
constexpr std::size_t LongestLine = 250;
constexpr const char* Output = "/proc/self/fd/3"; // of the process

[[noreturn]] void Fail(const std::string& what, int code)
{
  throw std::runtime_error(what + ": " + std::generic_category().message(code));
}

[[noreturn]] void FailWithoutProgram()
{
  throw std::runtime_error(
    "STEP files need OpenCASCADE, and this Lacuna was built without it. Install it (Debian: "
    "libocct-data-exchange-dev) and build Lacuna again, or write 3MF or STL");
}

//------------------------------------------------------------------------------
// Numbers and words, a line each or several.
class Text
{
public:
  template <class Value>
  Text& Add(Value value)
  {
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, value);
    this->Content.append(digits, end.ptr);
    this->Content += ' ';
    return *this;
  }
  Text& Add(const Vec3& x) { return this->Add(x[0]).Add(x[1]).Add(x[2]); }
  void End() { this->Content += '\n'; }
  void AddLine(std::string_view line)
  {
    for (const char each : line)
    {
      this->Content += each >= ' ' && each <= '~' ? each : '?';
    }
    this->End();
  }
  const std::string& Get() const { return this->Content; }

private:
  std::string Content;
};

std::vector<std::string> BreakLines(const std::vector<std::string>& lines)
{
  std::vector<std::string> broken;
  for (std::string_view rest : lines)
  {
    while (rest.size() > LongestLine)
    {
      const std::size_t space = rest.rfind(' ', LongestLine);
      const std::size_t size = space == std::string_view::npos || space == 0 ? LongestLine : space;
      broken.emplace_back(rest.substr(0, size));
      rest.remove_prefix(size);
    }
    broken.emplace_back(rest);
  }
  return broken;
}

//------------------------------------------------------------------------------
// A file without a name, in memory.
class MemoryFile
{
public:
  MemoryFile()
  {
    const int file = ::memfd_create("lacuna-step", MFD_CLOEXEC);
    this->Number = file < 0 ? -1 : ::fcntl(file, F_DUPFD_CLOEXEC, FirstFree);
    const int why = errno;
    if (file >= 0)
    {
      ::close(file);
    }
    if (this->Number < 0)
    {
      Fail("there is no memory for the program that writes STEP", why);
    }
  }
  ~MemoryFile() { ::close(this->Number); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int Get() const { return this->Number; }
  void Write(std::string_view content)
  {
    for (off_t at = 0; !content.empty();)
    {
      const ssize_t written = ::pwrite(this->Number, content.data(), content.size(), at);
      if (written <= 0)
      {
        Fail("there is no memory for the program that writes STEP", written == 0 ? ENOSPC : errno);
      }
      content.remove_prefix(static_cast<std::size_t>(written));
      at += written;
    }
  }
  std::string Read() const
  {
    struct stat state
    {
    };
    ::fstat(this->Number, &state);
    std::string content(static_cast<std::size_t>(state.st_size), '\0');
    for (std::size_t at = 0; at < content.size();)
    {
      const ssize_t got =
        ::pread(this->Number, &content[at], content.size() - at, static_cast<off_t>(at));
      if (got <= 0)
      {
        Fail("what the program that writes STEP wrote cannot be read", got == 0 ? EIO : errno);
      }
      at += static_cast<std::size_t>(got);
    }
    return content;
  }

private:
  int Number;
};

// A process, which ends with this.
class Child
{
public:
  explicit Child(pid_t process)
    : Process(process)
  {
  }
  ~Child()
  {
    if (this->Process > 0)
    {
      ::kill(this->Process, SIGKILL);
      this->Wait(0);
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Whether it has ended. options: of waitpid.
  bool Wait(int options)
  {
    int status = 0;
    pid_t ended = 0;
    do
    {
      ended = ::waitpid(this->Process, &status, options);
    } while (ended < 0 && errno == EINTR);
    if (ended == 0)
    {
      return false;
    }
    this->Status =
      ended == this->Process ? status : -1; // -1: the system keeps none for this program
    this->Process = 0;
    return true;
  }
  int GetStatus() const { return this->Status; }

private:
  pid_t Process;
  int Status = -1;
};
}

//------------------------------------------------------------------------------
std::string MakeStepRequest(const FacetedSolid& solid, const StepHeader& header)
{
  Text text;
  text.AddLine(StepProtocol);
  text.AddLine(header.Title);
  text.AddLine(header.FileName);
  text.AddLine(header.System);
  const std::vector<std::string> lines = BreakLines(header.Description);
  text.AddLine(std::to_string(lines.size()));
  for (const std::string& line : lines)
  {
    text.AddLine(line);
  }
  text.Add(solid.Flatness).Add(solid.Points.size()).End();
  for (const Vec3& point : solid.Points)
  {
    text.Add(point).End();
  }
  text.Add(solid.Bodies.size()).End();
  for (const FacetedSolid::Body& body : solid.Bodies)
  {
    text.Add(body.Volume).Add(body.Shells.size()).End();
    for (const std::vector<FacetedSolid::Face>& shell : body.Shells)
    {
      text.Add(shell.size()).End();
      for (const FacetedSolid::Face& face : shell)
      {
        text.Add(face.Origin).Add(face.Normal).Add(face.Loops.size());
        for (const std::vector<std::int32_t>& loop : face.Loops)
        {
          text.Add(loop.size());
          for (const std::int32_t id : loop)
          {
            text.Add(id);
          }
        }
        text.End();
      }
    }
  }
  return text.Get();
}

//------------------------------------------------------------------------------
void CheckStepProgram(const std::string& program)
{
  if (::access(program.c_str(), X_OK) != 0)
  {
    FailWithoutProgram();
  }
}

//------------------------------------------------------------------------------
std::string MakeStep(const std::string& program, const FacetedSolid& solid,
  const StepHeader& header, Execution& execution)
{
  CheckStepProgram(program);
  MemoryFile input;
  const MemoryFile messages;
  const MemoryFile output;
  input.Write(MakeStepRequest(solid, header));
  if (::lseek(input.Get(), 0, SEEK_SET) != 0)
  {
    Fail(program + " cannot be started", errno);
  }
  std::string name = program;
  std::string target = Output;
  char* const arguments[] = { name.data(), target.data(), nullptr };
  int why = 0;
  Child child(ProgramSettings({ input.Get(), -1, messages.Get(), output.Get() })
                .Start(program, arguments, why));
  if (why != 0)
  {
    Fail(program + " cannot be started", why);
  }
  for (int waits = 0; !child.Wait(WNOHANG); ++waits)
  {
    execution.Report(1 - 50.0 / (50 + waits)); // half of it in a second
    ::usleep(Pause);
  }
  const int status = child.GetStatus();
  const std::string said = messages.Read();
  const std::string_view done = StepDone;
  if (said.size() >= done.size() && said.compare(said.size() - done.size(), done.size(), done) == 0)
  {
    return output.Read();
  }
  if (status != -1 && WIFSIGNALED(status))
  {
    throw std::runtime_error("OpenCASCADE ended while it wrote the solid (" +
      DescribeSignal(WTERMSIG(status)) + "). Write 3MF or STL");
  }
  if (status != -1 && WEXITSTATUS(status) == 127)
  {
    throw std::runtime_error(program +
      " does not start, since a library of OpenCASCADE is missing (Debian: "
      "libocct-data-exchange-dev)");
  }
  throw std::runtime_error("OpenCASCADE makes no STEP file of this solid: " +
    (said.empty() ? std::string("no reason is known") : said) + ". Write 3MF or STL");
}
}
