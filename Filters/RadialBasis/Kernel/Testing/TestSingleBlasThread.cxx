// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaRadialBasisTest.h"
#include "lacunaSanitized.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <vector>

#include <sys/resource.h>
#include <unistd.h>

namespace
{
constexpr rlim_t Mebibyte = 1048576;
constexpr int Fitted = 0;
constexpr int Refused = 3;

// Fits in a process that may have so many bytes more, and ends it, also when the fit does not end.
[[noreturn]] void FitWithin(rlim_t bytes, lacuna::RadialSolver solver, int threads)
{
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + bytes;
  setrlimit(RLIMIT_AS, &limit);
  alarm(60);
  const std::vector<lacunaRadialBasisTest::Point3> nodes = lacunaRadialBasisTest::Scatter(600);
  std::vector<double> values(nodes.size());
  std::transform(nodes.begin(), nodes.end(), values.begin(),
    [](const lacunaRadialBasisTest::Point3& p) { return p[0] * p[1] + p[2] * p[2]; });
  lacuna::RadialBasisOptions options;
  options.Accuracy = 1e-4;
  options.Solver = solver;
  try
  {
    lacunaRadialBasisTest::Fit<3>(nodes, values, options, threads);
  }
  catch (const std::runtime_error& e)
  {
    std::cerr << e.what() << "\n";
    std::_Exit(Refused);
  }
  std::_Exit(Fitted);
}

// In a process of its own, where BLAS has no buffers yet, nor threads that make theirs meanwhile.
class SingleBlasThread : public testing::Test
{
protected:
  void SetUp() override
  {
    if (lacuna::Sanitized)
    {
      GTEST_SKIP() << "the sanitizers have taken the address space";
    }
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    setenv("OPENBLAS_NUM_THREADS", "1", 1);
  }
  void TearDown() override { unsetenv("OPENBLAS_NUM_THREADS"); }
};
}

TEST_F(SingleBlasThread, RefusesWithoutRoomForTheBuffersOfBlas)
{
  const auto refused = testing::ExitedWithCode(Refused);
  EXPECT_EXIT(FitWithin(100 * Mebibyte, lacuna::RadialSolver::Direct, 1), refused,
    "^the buffers of OpenBLAS would need 135266304 bytes .*have 0 bytes .*ulimit -v");
  EXPECT_EXIT(FitWithin(200 * Mebibyte, lacuna::RadialSolver::Fast, 2), refused,
    "^the buffers of OpenBLAS would need 270532608 bytes .*have 135266304 bytes");
}

TEST_F(SingleBlasThread, FitsWhereThereIsRoom)
{
  const auto fitted = testing::ExitedWithCode(Fitted);
  EXPECT_EXIT(FitWithin(180 * Mebibyte, lacuna::RadialSolver::Direct, 1), fitted, "");
  EXPECT_EXIT(FitWithin(180 * Mebibyte, lacuna::RadialSolver::Fast, 1), fitted, "");
  EXPECT_EXIT(FitWithin(420 * Mebibyte, lacuna::RadialSolver::Fast, 2), fitted, "");
}

TEST_F(SingleBlasThread, EndsWhateverRoomThereIs)
{
  const auto ended = [](int status) {
    return WIFEXITED(status) && (WEXITSTATUS(status) == Fitted || WEXITSTATUS(status) == Refused);
  };
  for (rlim_t room = 112; room < 160; room += 4)
  {
    SCOPED_TRACE(room);
    EXPECT_EXIT(FitWithin(room * Mebibyte, lacuna::RadialSolver::Direct, 1), ended, "");
    EXPECT_EXIT(FitWithin(2 * room * Mebibyte, lacuna::RadialSolver::Fast, 2), ended, "");
  }
}
