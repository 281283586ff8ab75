// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRanks.h"

#include <exception>

namespace lacuna
{
OtherRankStopped::OtherRankStopped()
  : std::runtime_error("another rank has stopped; its own message says why")
{
}

void Ranks::Together(const std::function<void()>& body) const
{
  std::exception_ptr error;
  try
  {
    body();
  }
  catch (...)
  {
    error = std::current_exception();
  }
  const bool fine = this->AllFine(!error);
  if (error)
  {
    std::rethrow_exception(error);
  }
  if (!fine)
  {
    throw OtherRankStopped();
  }
}

void Ranks::Sum(std::uint32_t*, std::int64_t) const {}
void Ranks::Sum(std::uint64_t*, std::int64_t) const {}
}
