// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What tests of devices need: places for them, and what they complain of.
#ifndef lacunaTestDevice_h
#define lacunaTestDevice_h

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>

#include <unistd.h>

#define EXPECT_HAS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

namespace lacunaTest
{
/// A folder that everyone may enter; removed in the end.
class Folder
{
public:
  Folder()
  {
    this->Path = testing::TempDir() + "lacuna-device-XXXXXX";
    EXPECT_NE(mkdtemp(this->Path.data()), nullptr);
    std::filesystem::permissions(this->Path, std::filesystem::perms(0755));
  }
  ~Folder() { std::filesystem::remove_all(this->Path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string operator/(const std::string& name) const { return this->Path + "/" + name; }
  const std::string& GetPath() const { return this->Path; }

private:
  std::string Path;
};

/// Permissions do not bind root: goes on as another user, and back in the end.
class AsUser
{
public:
  AsUser() { this->Changed = geteuid() == 0 && seteuid(65534) == 0; }
  ~AsUser() { EXPECT_TRUE(!this->Changed || seteuid(0) == 0); }
  AsUser(const AsUser&) = delete;
  AsUser& operator=(const AsUser&) = delete;

private:
  bool Changed;
};

/// What a call complains of by an Error of a kind; a failure when it does not.
template <class Error>
std::string Complaint(typename Error::Kind kind, const std::function<void()>& call)
{
  try
  {
    call();
  }
  catch (const Error& e)
  {
    EXPECT_EQ(e.GetKind(), kind) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "no complaint of kind " << static_cast<int>(kind);
  return {};
}
}
#endif
