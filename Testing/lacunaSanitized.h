// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Whether a test runs under a sanitizer.
#ifndef lacunaSanitized_h
#define lacunaSanitized_h

#ifndef __has_feature // clang's, which does not define __SANITIZE_ADDRESS__
#define __has_feature(feature) 0
#endif

namespace lacuna
{
/// Red zones and shadows are in what the system counts as memory, and all takes ten to a hundred times
/// as long: of studies of many random cases, a few do, since it is no statistics that is looked for.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) ||                               \
  __has_feature(address_sanitizer)
constexpr bool Sanitized = true;
#else
constexpr bool Sanitized = false;
#endif
}
#endif
