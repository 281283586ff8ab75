// SPDX-License-Identifier: BSD-3-Clause
// Gives pseudo-terminals what libserialport asks of a port: modem lines, and a link in /sys/class/tty
// (version 0.1.2 looks there for the terminal behind a link, 0.1.1 for the link). Linked before that
// library or preloaded (LD_PRELOAD), it answers where the kernel has no answer; real ports do not
// notice it.
#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstring>

#include <dlfcn.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace
{
// Where the links of terminals that are no devices of a driver lead.
const char* const Device = "../../devices/virtual/tty/pts";

// Whether it would be that of a terminal that there is.
bool IsOfPseudoTerminal(const char* link)
{
  constexpr char folder[] = "/sys/class/tty/pts/";
  constexpr std::size_t length = sizeof(folder) - 1;
  if (std::strncmp(link, folder, length) != 0)
  {
    return false;
  }
  char terminal[64];
  std::snprintf(terminal, sizeof(terminal), "/dev/pts/%s", link + length);
  return access(terminal, F_OK) == 0;
}
}

// NOLINTBEGIN(cert-dcl50-cpp): the C library's declarations
extern "C" int ioctl(int file, unsigned long request, ...) noexcept
{
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  using Function = int (*)(int, unsigned long, ...);
  static const auto kernel = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "ioctl"));
  const int result = kernel(file, request, argument);
  if (result != 0 && (errno == ENOTTY || errno == EINVAL))
  {
    switch (request)
    {
      case TIOCMGET:
        *static_cast<int*>(argument) = 0;
        return 0;
      case TIOCMBIS:
      case TIOCMBIC:
      case TIOCMSET:
        return 0;
      default:
        break;
    }
  }
  return result;
}

extern "C" int lstat(const char* name, struct stat* status) noexcept
{
  using Function = int (*)(const char*, struct stat*);
  static const auto kernel = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "lstat"));
  const int result = kernel(name, status);
  if (result != 0 && errno == ENOENT && IsOfPseudoTerminal(name))
  {
    *status = {};
    status->st_mode = S_IFLNK | 0777;
    return 0;
  }
  return result;
}

extern "C" ssize_t readlink(const char* name, char* target, size_t size) noexcept
{
  using Function = ssize_t (*)(const char*, char*, size_t);
  static const auto kernel = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "readlink"));
  const ssize_t result = kernel(name, target, size);
  if (result < 0 && errno == ENOENT && IsOfPseudoTerminal(name))
  {
    const std::size_t length = std::min(size, std::strlen(Device));
    std::copy_n(Device, length, target); // without a zero, as readlink
    return static_cast<ssize_t>(length);
  }
  return result;
}
// NOLINTEND(cert-dcl50-cpp)
