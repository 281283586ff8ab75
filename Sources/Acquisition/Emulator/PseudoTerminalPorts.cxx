// SPDX-License-Identifier: BSD-3-Clause
// Gives pseudo-terminals the modem lines that libserialport asks a port for. Linked before that
// library or preloaded (LD_PRELOAD), it answers for the kernel where this says that a terminal has
// none; real ports do not notice it.
#include <cerrno>
#include <cstdarg>

#include <dlfcn.h>
#include <sys/ioctl.h>

// NOLINTBEGIN(cert-dcl50-cpp): the C library's declaration
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
// NOLINTEND(cert-dcl50-cpp)
