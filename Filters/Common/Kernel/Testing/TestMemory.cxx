// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaControlGroup.h"
#include "lacunaMemory.h"
#include "lacunaProcessMemory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

TEST(Memory, RefusesWhatTheMachineDoesNotHave)
{
  EXPECT_GT(lacuna::GetAvailableMemory(), 1e8);
  EXPECT_NO_THROW(lacuna::RequireMemory("a small thing", 1e6));
  try
  {
    lacuna::RequireMemory("a volume of 2e9 x 2e9 x 2e9 voxels", 8e27);
    FAIL();
  }
  catch (const std::runtime_error& e)
  {
    const std::string text = e.what();
    EXPECT_NE(text.find("2e9 x 2e9 x 2e9"), std::string::npos);
    EXPECT_NE(text.find("8e+27 bytes (7.45e+18 GiB)"), std::string::npos) << text;
  }
}

TEST(Memory, IsDescribedInFull)
{
  EXPECT_EQ(lacuna::DescribeBytes(20e9), "20000000000 bytes (18.6 GiB)");
  EXPECT_EQ(lacuna::DescribeBytes(0), "0 bytes (0 GiB)");
}

TEST(Memory, IsAtMostWhatTheProcessMayHave)
{
  constexpr double gibibyte = 1 << 30;
  EXPECT_GE(lacuna::GetPhysicalMemory(), lacuna::GetAvailableMemory());
  struct Limit
  {
    int Resource;
    const char* Used;
    const char* Option;
  };
  for (const Limit& limit :
    { Limit{ RLIMIT_AS, "VmSize", "ulimit -v" }, Limit{ RLIMIT_DATA, "VmData", "ulimit -d" } })
  {
    rlimit old{};
    ASSERT_EQ(getrlimit(limit.Resource, &old), 0);
    rlimit little = old;
    little.rlim_cur = static_cast<rlim_t>(lacuna::GetProcessMemory(limit.Used) + gibibyte);
    ASSERT_EQ(setrlimit(limit.Resource, &little), 0);
    const double available = lacuna::GetAvailableMemory();
    const double physical = lacuna::GetPhysicalMemory();
    std::string text;
    try
    {
      lacuna::RequireMemory("two gibibytes", 2 * gibibyte);
    }
    catch (const std::runtime_error& e)
    {
      text = e.what();
    }
    setrlimit(limit.Resource, &old);
    EXPECT_NE(text.find(limit.Option), std::string::npos) << text;
    EXPECT_LE(available, gibibyte);
    EXPECT_GT(available, 0.9 * gibibyte); // what is stored is counted
    EXPECT_LE(physical, static_cast<double>(little.rlim_cur));
  }
}

namespace
{
// The files of a system with control groups, in a folder of their own.
class System
{
public:
  System()
    : Root(std::filesystem::temp_directory_path() /
        ("lacuna-control-groups-" + std::to_string(getpid())))
  {
  }
  ~System() { std::filesystem::remove_all(this->Root); }

  void Write(const std::string& name, const std::string& text) const
  {
    const std::filesystem::path path = this->Root / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }

  lacuna::ControlGroupMemory Read() const
  {
    return lacuna::ReadControlGroupMemory(this->Root.string());
  }

private:
  std::filesystem::path Root;
};
}

TEST(ControlGroup, LimitsNothingWithoutOne)
{
  System system;
  EXPECT_TRUE(std::isinf(system.Read().Limit));
  system.Write("proc/self/cgroup", "0::/user.slice\n");
  system.Write("sys/fs/cgroup/user.slice/memory.max", "max\n");
  system.Write("sys/fs/cgroup/user.slice/memory.current", "5000\n");
  EXPECT_TRUE(std::isinf(system.Read().Limit));
  EXPECT_TRUE(std::isinf(system.Read().Free));
}

TEST(ControlGroup, FilesInMemoryAreFree)
{
  System system;
  system.Write("proc/self/cgroup", "0::/a/b\n");
  system.Write("sys/fs/cgroup/a/b/memory.max", "8000000\n");
  system.Write("sys/fs/cgroup/a/b/memory.current", "7999000\n");
  system.Write("sys/fs/cgroup/a/b/memory.stat",
    "anon 1000000\nfile 6900000\ninactive_file 5000000\nactive_file 1500000\nslab 3\n");
  EXPECT_EQ(system.Read().Limit, 8e6);
  EXPECT_EQ(system.Read().Free, 8e6 - (7999000 - 6500000));
  system.Write("sys/fs/cgroup/a/b/memory.current", "9000000\n");
  system.Write("sys/fs/cgroup/a/b/memory.stat", "anon 9000000\n");
  EXPECT_EQ(system.Read().Free, 0);
}

TEST(ControlGroup, GroupsAboveCount)
{
  System system;
  system.Write("proc/self/cgroup", "1:name=systemd:/x\n0::/a/b/c\n");
  system.Write("sys/fs/cgroup/a/b/c/memory.max", "max\n");
  system.Write("sys/fs/cgroup/a/memory.max", "3000000\n");
  system.Write("sys/fs/cgroup/a/memory.current", "2000000\n");
  EXPECT_EQ(system.Read().Limit, 3e6);
  EXPECT_EQ(system.Read().Free, 1e6);
  // the container's own group, of which its path says nothing
  system.Write("sys/fs/cgroup/memory.max", "2000000\n");
  system.Write("sys/fs/cgroup/memory.current", "500000\n");
  EXPECT_EQ(system.Read().Limit, 2e6);
  EXPECT_EQ(system.Read().Free, 1e6);
}

TEST(ControlGroup, OfVersion1)
{
  System system;
  system.Write("proc/self/cgroup", "5:cpu:/z\n4:cpuset,memory:/x/y\n0::/\n");
  const std::string folder = "sys/fs/cgroup/memory/x/y/";
  system.Write(folder + "memory.limit_in_bytes", "4000000\n");
  system.Write(folder + "memory.usage_in_bytes", "3500000\n");
  system.Write(folder + "memory.stat",
    "cache 9\ninactive_file 1\ntotal_inactive_file 1000000\ntotal_active_file 500000\n");
  system.Write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(system.Read().Limit, 4e6);
  EXPECT_EQ(system.Read().Free, 2e6);
}

TEST(Memory, OfAnySizeMayAskForLargePages)
{
  lacuna::PreferLargePages(nullptr, 0);
  for (const std::size_t size : { 1, 5000, 3000000, 20000000 })
  {
    const std::unique_ptr<char, void (*)(void*)> memory(
      static_cast<char*>(std::calloc(size, 1)), std::free);
    lacuna::PreferLargePages(memory.get(), size);
    EXPECT_EQ(memory.get()[0], 0);
    EXPECT_EQ(memory.get()[size - 1], 0);
    memory.get()[size - 1] = 1;
  }
}
