// SPDX-License-Identifier: BSD-3-Clause
// The program as users run it, with the driver at the other end of the port.
#include "lacunaClock.h"
#include "lacunaFastrakTracker.h"
#include "lacunaSerialPort.h"
#include "lacunaTestProgram.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <unistd.h>

using namespace lacuna;
using namespace lacunaTest;

TEST(EmulatorProgram, ServesTheDriver)
{
  const std::string folder = testing::TempDir();
  const std::string link =
    std::filesystem::canonical(folder) / ("lacuna-emulator-" + std::to_string(getpid()));
  const std::string poses = link + ".txt";
  std::ofstream(poses) << "# still\n0, 1, 120, 30, -40, 10, 20, 30\n";
  Program program({ "--link", link, "--baud", "115200", "--poses", poses });
  EXPECT_EQ(program.ReadLine(), "FASTRAK at 115200 baud on " + link + "\n");
  {
    SerialPort port("/dev/../../.." + link, 115200);
    const SteadyClock clock;
    FastrakTracker tracker(port, clock);
    tracker.SetUp();
    std::vector<TrackedPose> taken;
    const double begin = clock.Now();
    while (taken.size() < 20 && clock.Now() < begin + 60)
    {
      tracker.Poll(taken);
    }
    ASSERT_GE(taken.size(), 20u);
    const Matrix4 expected =
      Matrix4::Translation({ 120, 30, -40 }) * FastrakRotation(Vec3{ 10, 20, 30 });
    for (int i = 0; i < 16; ++i)
    {
      EXPECT_NEAR(taken.back().ReceiverToTransmitter.Data()[i], expected.Data()[i], 1e-4);
    }
  }
  EXPECT_EQ(program.End(), 0);
  EXPECT_FALSE(std::filesystem::is_symlink(link));
  std::filesystem::remove(poses);
}

TEST(EmulatorProgram, EndsInTimeAndSaysWhatIsWrong)
{
  Program brief({ "--seconds", "0.2" });
  EXPECT_EQ(brief.ReadLine().rfind("FASTRAK at 19200 baud on /dev/pts/", 0), 0u);
  EXPECT_EQ(brief.Wait(), 0);
  Program help({ "--help" });
  EXPECT_EQ(help.ReadLine(), "lacuna-fastrak-emulator [option]...\n");
  EXPECT_EQ(help.Wait(), 0);
  Program wrong({ "--speed", "3" });
  EXPECT_NE(wrong.ReadLine().find("'--speed'"), std::string::npos);
  EXPECT_EQ(wrong.Wait(), 2);
  Program taken({ "--link", "/" });
  EXPECT_NE(taken.ReadLine().find("cannot be made to point"), std::string::npos);
  EXPECT_EQ(taken.Wait(), 1);
}
