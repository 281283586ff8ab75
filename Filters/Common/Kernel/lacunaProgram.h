// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Programs of Lacuna that work for it in a process of their own.
#ifndef lacunaProgram_h
#define lacunaProgram_h

#include <initializer_list>
#include <string>

#include <spawn.h>
#include <sys/types.h>

namespace lacuna
{
/// The path of a program that is below the folder of the library (or program) that has anchor, a variable
/// that no other one has: static and constant. (Functions may be taken from another library.)
std::string FindBeside(const void* anchor, const std::string& name);

/// How a process begins. Nothing is open but what it needs. Its signals do what they do in a new program,
/// whatever this one has made of them. It has a group of its own, for which an interrupt of the terminal is not
/// meant.
class ProgramSettings
{
public:
  /// descriptors become 0, 1, 2 and so on of the process; -1: it has /dev/null.
  explicit ProgramSettings(std::initializer_list<int> descriptors);
  ~ProgramSettings();
  ProgramSettings(const ProgramSettings&) = delete;
  ProgramSettings& operator=(const ProgramSettings&) = delete;

  /// Returns the process, or 0 and why as errno has it. arguments ends with a null pointer. Not fork: threads
  /// of this program may hold locks, and MPI forbids it.
  pid_t Start(const std::string& program, char* const* arguments, int& why) const;

private:
  posix_spawn_file_actions_t Actions{};
  posix_spawnattr_t Attributes{};
};

/// What waitpid says of a process that a signal ended, for people: its number and name.
std::string DescribeSignal(int number);
}
#endif
