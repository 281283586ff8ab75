// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaProgram.h"

#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

namespace lacuna
{
//------------------------------------------------------------------------------
std::string FindBeside(const void* anchor, const std::string& name)
{
  std::filesystem::path folder;
  Dl_info here{};
  if (dladdr(anchor, &here) != 0 && here.dli_fname)
  {
    std::error_code wrong;
    const std::filesystem::path file = std::filesystem::canonical(here.dli_fname, wrong);
    folder = (wrong ? std::filesystem::path(here.dli_fname) : file).parent_path();
  }
  return (folder / name).string();
}

//------------------------------------------------------------------------------
ProgramSettings::ProgramSettings(std::initializer_list<int> descriptors)
{
  posix_spawn_file_actions_init(&this->Actions);
  int number = 0;
  for (const int descriptor : descriptors)
  {
    if (descriptor >= 0)
    {
      posix_spawn_file_actions_adddup2(&this->Actions, descriptor, number);
    }
    else
    {
      posix_spawn_file_actions_addopen(&this->Actions, number, "/dev/null", O_RDWR, 0);
    }
    ++number;
  }
  posix_spawn_file_actions_addclosefrom_np(&this->Actions, number);
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

//------------------------------------------------------------------------------
ProgramSettings::~ProgramSettings()
{
  posix_spawnattr_destroy(&this->Attributes);
  posix_spawn_file_actions_destroy(&this->Actions);
}

//------------------------------------------------------------------------------
pid_t ProgramSettings::Start(const std::string& program, char* const* arguments, int& why) const
{
  pid_t process = 0;
  why =
    posix_spawn(&process, program.c_str(), &this->Actions, &this->Attributes, arguments, environ);
  return why == 0 ? process : 0;
}

//------------------------------------------------------------------------------
std::string DescribeSignal(int number)
{
  const char* name = sigdescr_np(number);
  return "signal " + std::to_string(number) + (name ? std::string(", ") + name : "");
}
}
