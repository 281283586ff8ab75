// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaAtomicFile.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <unistd.h>

namespace fs = std::filesystem;
using lacuna::FileError;
using lacuna::WriteFileAtomically;

namespace
{
class AtomicFile : public ::testing::Test
{
protected:
  void SetUp() override
  {
    this->Folder = fs::path(::testing::TempDir()) / ("lacuna-atomic-" + std::to_string(getpid()));
    fs::remove_all(this->Folder);
    fs::create_directory(this->Folder);
  }
  void TearDown() override
  {
    fs::permissions(this->Folder, fs::perms::owner_all);
    fs::remove_all(this->Folder);
  }
  std::string Path(const std::string& name) const { return (this->Folder / name).string(); }
  std::size_t CountFiles() const
  {
    return std::distance(fs::directory_iterator(this->Folder), fs::directory_iterator());
  }
  static std::string Read(const std::string& path)
  {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }
  static FileError::Kind KindOf(const std::string& path, const std::string& content)
  {
    try
    {
      WriteFileAtomically(path, content);
    }
    catch (const FileError& e)
    {
      EXPECT_NE(std::string(e.what()).find(path), std::string::npos) << e.what();
      return e.GetKind();
    }
    ADD_FAILURE() << "no error for " << path;
    return FileError::Kind::Other;
  }
  // The file that is written under another name; empty: none.
  std::string FindUnfinished() const
  {
    for (const auto& entry : fs::directory_iterator(this->Folder))
    {
      if (entry.path().filename().string().rfind(".lacuna-", 0) == 0)
      {
        return entry.path().string();
      }
    }
    return {};
  }
  fs::path Folder;
};

// A disk that has only files with names.
class NoUnnamedFiles
{
public:
  NoUnnamedFiles() { Fail = true; }
  ~NoUnnamedFiles() { Fail = false; }
  NoUnnamedFiles(const NoUnnamedFiles&) = delete;
  NoUnnamedFiles& operator=(const NoUnnamedFiles&) = delete;
  static inline bool Fail = false; // every one
};

// The super-user may write everywhere, so the tests of permissions act as nobody.
class AsNobody
{
public:
  AsNobody()
    : Changed(geteuid() == 0 && seteuid(65534) == 0)
  {
  }
  ~AsNobody()
  {
    if (this->Changed && seteuid(0) != 0)
    {
      std::abort();
    }
  }

private:
  bool Changed;
};
}

namespace
{
constexpr const char* AccessList = "system.posix_acl_access";

// As the system keeps them.
std::string Entry(int tag, int rights, unsigned int id)
{
  std::string bytes{ static_cast<char>(tag), 0, static_cast<char>(rights), 0 };
  for (int shift = 0; shift < 32; shift += 8)
  {
    bytes += static_cast<char>(id >> shift);
  }
  return bytes;
}

// user::rw-, the users named, group::---, mask, other::---
std::string List(const std::vector<std::string>& users, int mask)
{
  constexpr unsigned int none = 0xFFFFFFFF;
  std::string list = std::string("\2\0\0\0", 4) + Entry(1, 6, none);
  for (const std::string& user : users)
  {
    list += user;
  }
  return list + Entry(4, 0, none) + Entry(16, mask, none) + Entry(32, 0, none);
}
}

// The program's, instead of the library's.
extern "C" int open(const char* path, int flags, ...)
{
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = (flags & (O_CREAT | __O_TMPFILE)) ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  if (NoUnnamedFiles::Fail && (flags & __O_TMPFILE))
  {
    errno = EOPNOTSUPP;
    return -1;
  }
  return static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

TEST_F(AtomicFile, OutlivesNoWriterThatIsKilled)
{
  const std::string path = this->Path("a");
  WriteFileAtomically(path, "old");
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0)
  {
    lacuna::AtomicFile file(path);
    file.Write("new");
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(Read(path), "old");
  EXPECT_EQ(this->CountFiles(), 1u);
}

TEST_F(AtomicFile, WritesWhereAllFilesHaveNames)
{
  const NoUnnamedFiles none;
  const std::string path = this->Path("a");
  WriteFileAtomically(path, "new");
  EXPECT_EQ(Read(path), "new");
  {
    lacuna::AtomicFile first(path);
    lacuna::AtomicFile second(path); // of the same process
    first.Write("first");
    second.Write("second");
    EXPECT_EQ(this->CountFiles(), 3u);
    second.Commit();
    EXPECT_EQ(Read(path), "second");
  }
  EXPECT_EQ(this->CountFiles(), 1u);
}

TEST_F(AtomicFile, WritesAndReplacesTheWholeFile)
{
  const std::string path = this->Path("a.igs");
  const std::string large(3000000, 'x');
  WriteFileAtomically(path, large);
  EXPECT_EQ(Read(path), large);
  WriteFileAtomically(path, "small\n");
  EXPECT_EQ(Read(path), "small\n");
  EXPECT_EQ(this->CountFiles(), 1u); // no temporary file is left
}

TEST_F(AtomicFile, RespectsTheUmask)
{
  const mode_t before = umask(027);
  WriteFileAtomically(this->Path("a"), "x");
  umask(before);
  EXPECT_EQ(fs::status(this->Path("a")).permissions(), static_cast<fs::perms>(0640));
}

// A patient's data do not become everybody's to read, nor a group's file its last writer's.
TEST_F(AtomicFile, PassesOnWhoMayDoWhat)
{
  const std::string path = this->Path("file");
  WriteFileAtomically(path, "old");
  for (const mode_t mode : { 0600, 0640, 0666, 0755 })
  {
    ASSERT_EQ(chmod(path.c_str(), mode), 0);
    const bool given = geteuid() == 0 && chown(path.c_str(), 65534, 65533) == 0;
    WriteFileAtomically(path, "new");
    struct stat status;
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, mode);
    if (given)
    {
      EXPECT_EQ(status.st_uid, 65534u);
      EXPECT_EQ(status.st_gid, 65533u);
    }
  }
}

// What is made while a file is written holds when it is there.
TEST_F(AtomicFile, PassesOnWhatWasChangedMeanwhile)
{
  const std::string path = this->Path("file");
  WriteFileAtomically(path, "old");
  lacuna::AtomicFile file(path);
  file.Write("new");
  ASSERT_EQ(chmod(path.c_str(), 0600), 0);
  file.Commit();
  EXPECT_EQ(Read(path), "new");
  EXPECT_EQ(fs::status(path).permissions(), static_cast<fs::perms>(0600));
}

// In a folder of all somebody puts a link to another's file where the unfinished file was.
TEST_F(AtomicFile, OpensNoOtherFileToAnyone)
{
  const std::string path = this->Path("file");
  const std::string secret = this->Path("secret");
  for (const std::string& each : { path, secret })
  {
    WriteFileAtomically(each, "old");
  }
  ASSERT_EQ(chmod(path.c_str(), 0666), 0);
  ASSERT_EQ(chmod(secret.c_str(), 0600), 0);
  const NoUnnamedFiles none; // else there is nothing to be replaced
  lacuna::AtomicFile file(path);
  file.Write("new");
  const std::string unfinished = this->FindUnfinished();
  ASSERT_TRUE(fs::remove(unfinished));
  fs::create_symlink("secret", unfinished);
  file.Finish();
  EXPECT_EQ(fs::status(secret).permissions(), static_cast<fs::perms>(0600));
}

// A second file of the same data, which is not there yet, is as private as the first.
TEST_F(AtomicFile, TakesTheAccessOfItsCompanion)
{
  const std::string header = this->Path("a.mhd");
  for (const mode_t mode : { 0600, 0664 })
  {
    WriteFileAtomically(header, "header");
    ASSERT_EQ(chmod(header.c_str(), mode), 0);
    lacuna::AtomicFile pixels(this->Path("a.raw"), header);
    pixels.Write("pixels");
    pixels.Commit();
    struct stat status;
    ASSERT_EQ(stat(this->Path("a.raw").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777, mode);
    fs::remove(this->Path("a.raw"));
  }
}

// Those whom a group or a list kept out are not let in as others, where neither can be given.
TEST_F(AtomicFile, LetsNobodyInWhenItCannotGiveGroupOrList)
{
  if (geteuid() != 0)
  {
    GTEST_SKIP() << "only the super-user can make files of others";
  }
  const std::string path = this->Path("file");
  fs::permissions(this->Folder, fs::perms::all);
  const auto becomes = [&](mode_t mode, const std::string& list) -> mode_t
  {
    fs::remove(path);
    WriteFileAtomically(path, "old");
    if (!list.empty() && setxattr(path.c_str(), AccessList, list.data(), list.size(), 0) != 0)
    {
      return 07777;
    }
    if (chown(path.c_str(), 1, 1) != 0 || chmod(path.c_str(), mode) != 0)
    {
      return 07777;
    }
    {
      const AsNobody nobody;
      WriteFileAtomically(path, "new");
    }
    EXPECT_EQ(Read(path), "new");
    struct stat status;
    EXPECT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_uid, 65534u);
    return status.st_mode & 07777;
  };
  EXPECT_EQ(becomes(0606, {}), 0600u);
  EXPECT_EQ(becomes(0646, {}), 0604u);
  EXPECT_EQ(becomes(0666, {}), 0606u);
  EXPECT_EQ(becomes(0466, {}), 0404u);
  // of user 65534 alone, who writes; and group::---
  const mode_t listed = becomes(0666, List({ Entry(2, 6, 65534) }, 6));
  if (listed == 07777)
  {
    GTEST_SKIP() << "the file system has no access lists";
  }
  EXPECT_EQ(listed, 0600u);
}

// user::rw-, user:65534:r--, group::---, mask::r--, other::---
TEST_F(AtomicFile, PassesOnTheAccessList)
{
  const std::string path = this->Path("file");
  WriteFileAtomically(path, "old");
  const std::string list = List({ Entry(2, 4, 65534) }, 4);
  const char* name = AccessList;
  if (setxattr(path.c_str(), name, list.data(), list.size(), 0) != 0)
  {
    GTEST_SKIP() << "the file system has no access lists";
  }
  WriteFileAtomically(path, "new");
  char found[4096];
  const ssize_t size = getxattr(path.c_str(), name, found, sizeof found);
  ASSERT_EQ(size, static_cast<ssize_t>(list.size()));
  EXPECT_EQ(std::string(found, list.size()), list);
}

TEST_F(AtomicFile, WritesToTheSystemsNamesOfPipes)
{
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  WriteFileAtomically("/proc/self/fd/" + std::to_string(ends[1]), "through a pipe");
  char text[20] = {};
  EXPECT_EQ(read(ends[0], text, sizeof text), 14);
  EXPECT_STREQ(text, "through a pipe");
  close(ends[0]);
  close(ends[1]);
}

TEST_F(AtomicFile, WritesRelativePaths)
{
  const fs::path before = fs::current_path();
  fs::current_path(this->Folder);
  WriteFileAtomically("relative.igs", "x");
  fs::current_path(before);
  EXPECT_EQ(Read(this->Path("relative.igs")), "x");
}

TEST_F(AtomicFile, FollowsSymbolicLinks)
{
  fs::create_directory(this->Folder / "other");
  fs::create_symlink("other/real.igs", this->Folder / "link.igs");
  WriteFileAtomically(this->Path("link.igs"), "x");
  EXPECT_TRUE(fs::is_symlink(this->Folder / "link.igs"));
  EXPECT_EQ(Read(this->Path("other/real.igs")), "x");
}

TEST_F(AtomicFile, RefusesLoopsOfLinks)
{
  fs::create_symlink("b", this->Folder / "a");
  fs::create_symlink("a", this->Folder / "b");
  EXPECT_EQ(KindOf(this->Path("a"), "x"), FileError::Kind::CannotOpen);
}

TEST_F(AtomicFile, NoFolderOrAFolderInTheWay)
{
  EXPECT_EQ(KindOf(this->Path("no/such/a.igs"), "x"), FileError::Kind::CannotOpen);
  fs::create_directory(this->Folder / "folder.igs");
  EXPECT_EQ(KindOf(this->Path("folder.igs"), "x"), FileError::Kind::CannotOpen);
  EXPECT_TRUE(fs::is_directory(this->Folder / "folder.igs"));
}

TEST_F(AtomicFile, ReadOnlyFolder)
{
  fs::permissions(
    this->Folder, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_exec);
  {
    const AsNobody nobody;
    EXPECT_EQ(KindOf(this->Path("a.igs"), "x"), FileError::Kind::CannotOpen);
  }
  EXPECT_EQ(this->CountFiles(), 0u);
}

TEST_F(AtomicFile, ReadOnlyFileStays)
{
  const std::string path = this->Path("a.igs");
  WriteFileAtomically(path, "old");
  fs::permissions(path, static_cast<fs::perms>(0444));
  fs::permissions(this->Folder, fs::perms::all);
  {
    const AsNobody nobody;
    EXPECT_EQ(KindOf(path, "new"), FileError::Kind::CannotOpen);
  }
  EXPECT_EQ(Read(path), "old");
}

TEST_F(AtomicFile, FullDevice)
{
  if (!fs::exists("/dev/full"))
  {
    GTEST_SKIP() << "no /dev/full";
  }
  EXPECT_EQ(KindOf("/dev/full", "x"), FileError::Kind::NoSpace);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

// A limit of the file size stands for a full disk: writing stops halfway.
TEST_F(AtomicFile, FullDiskLeavesWhatWasThere)
{
  const std::string path = this->Path("a.igs");
  WriteFileAtomically(path, "old");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 4096;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const FileError::Kind kind = KindOf(path, std::string(100000, 'x'));
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(kind, FileError::Kind::NoSpace);
  EXPECT_EQ(Read(path), "old");
  EXPECT_EQ(this->CountFiles(), 1u);
}
