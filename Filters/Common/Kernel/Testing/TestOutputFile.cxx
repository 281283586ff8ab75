// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaAtomicFile.h"
#include "lacunaOutputFile.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include <unistd.h>

namespace fs = std::filesystem;
using namespace lacuna;

namespace
{
class OutputFileTest : public ::testing::Test
{
protected:
  void SetUp() override
  {
    this->Folder = fs::path(::testing::TempDir()) / ("lacuna-output-" + std::to_string(getpid()));
    fs::remove_all(this->Folder);
    fs::create_directory(this->Folder);
  }
  void TearDown() override { fs::remove_all(this->Folder); }
  std::string Path(const std::string& name) const { return (this->Folder / name).string(); }
  static std::string Read(const std::string& path)
  {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }
  fs::path Folder;
};
}

TEST_F(OutputFileTest, WritesCutsAndPatches)
{
  OutputFile file(this->Path("a"), OutputFile::Mode::CreateNew, "a");
  file.Write("0123456789", 10);
  file.WriteAt(3, "abc");
  EXPECT_EQ(Read(this->Path("a")), "012abc6789"); // there before the file is closed
  file.Write("xy", 2);
  file.Truncate(11);
  file.Sync();
  file.Close();
  file.Close(); // twice does no harm
  EXPECT_EQ(Read(this->Path("a")), "012abc6789x");
}

TEST_F(OutputFileTest, BeyondFourGigabytes)
{
  OutputFile file(this->Path("sparse"), OutputFile::Mode::CreateNew, "sparse");
  file.WriteAt(std::int64_t{ 5 } << 30, "end");
  EXPECT_EQ(fs::file_size(this->Path("sparse")), (std::uintmax_t{ 5 } << 30) + 3);
}

TEST_F(OutputFileTest, NeverTakesWhatIsThere)
{
  {
    std::ofstream(this->Path("a")) << "old";
  }
  try
  {
    OutputFile file(this->Path("a"), OutputFile::Mode::CreateNew, "the shown name");
    ADD_FAILURE();
  }
  catch (const FileError& e)
  {
    EXPECT_EQ(e.GetKind(), FileError::Kind::CannotOpen);
    EXPECT_NE(std::string(e.what()).find("'the shown name': File exists"), std::string::npos);
  }
  EXPECT_EQ(Read(this->Path("a")), "old");
  OutputFile file(this->Path("a"), OutputFile::Mode::Existing, "a");
  file.WriteAt(1, "L");
  EXPECT_EQ(Read(this->Path("a")), "oLd");
}

TEST_F(OutputFileTest, AnAtomicFileInParts)
{
  {
    AtomicFile given(this->Path("a"));
    given.Write("given up");
  }
  EXPECT_TRUE(fs::is_empty(this->Folder));
  AtomicFile file(this->Path("a"));
  file.Write("size 0000 ");
  file.Write("content");
  file.WriteAt(5, "0007");
  EXPECT_FALSE(fs::exists(this->Path("a")));
  file.Finish();
  EXPECT_FALSE(fs::exists(this->Path("a")));
  file.Commit();
  EXPECT_EQ(Read(this->Path("a")), "size 0007 content");
  EXPECT_FALSE(file.IsStream());
  EXPECT_TRUE(AtomicFile("/dev/null").IsStream());
}
