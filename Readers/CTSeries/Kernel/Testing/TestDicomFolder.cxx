// SPDX-License-Identifier: BSD-3-Clause
#include "DicomTestFile.h"
#include "lacunaDicomFolder.h"
#include "lacunaExecution.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <sys/resource.h>

using namespace lacuna;

// The system refuses in the middle: what was found before is not taken for all there is.
TEST(DicomFolder, StopsWhereItCannotBeRead)
{
  const Temporary temporary;
  std::filesystem::path deep = temporary.Path;
  for (int level = 0; level < 60; ++level) // each open while those within are read
  {
    deep /= "d";
  }
  std::filesystem::create_directories(deep);
  temporary.Write("no image", "text");
  DicomFolder folder;
  ThreadExecution execution(1);
  folder.Scan(temporary.Path.string(), execution);
  EXPECT_EQ(folder.GetNotes().size(), 1U);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit few = before;
  few.rlim_cur = 40;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  std::string error;
  try
  {
    folder.Scan(temporary.Path.string(), execution);
  }
  catch (const std::runtime_error& e)
  {
    error = e.what();
  }
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_NE(error.find("the folder cannot be read to its end, only to " + temporary.Path.string()),
    std::string::npos)
    << error;
}
