// SPDX-License-Identifier: BSD-3-Clause
// The program with video, and clients of it.
#include "lacunaCalibrationFile.h"
#include "lacunaTestDevice.h"
#include "lacunaTestPort.h"
#include "lacunaTestProgram.h"
#include "lacunaVideoSource.h"

#include <cmath>
#include <filesystem>

using namespace lacuna;
using namespace lacunaTest;

TEST(VideoProgram, ServesTheVideoBesideTheTracker)
{
  const Folder folder;
  const std::string url = FreeAddress();
  const std::string calibration = folder / "truth.xml";
  Program program({ "--video", url, "--calibration", calibration, "--size", "320", "240", "--rate",
    "30", "--seed", "3" });
  EXPECT_EQ(program.ReadLine().rfind("FASTRAK at 19200 baud on /dev/pts/", 0), 0u);
  EXPECT_HAS(program.ReadLine(), "Video of 320 x 240 pixels of ");
  EXPECT_HAS(program.ReadLine(), "FanAngles -26 26");
  EXPECT_EQ(ReadCalibrationFile(calibration).size(), 2u);
  const SteadyClock clock;
  VideoSettings settings;
  settings.URL = url;
  for (int client = 0; client < 2; ++client)
  {
    {
      VideoSource source(settings, clock);
      EXPECT_NEAR(source.GetFrameRate(), 30, 0.01);
      VideoFrame frame;
      std::vector<std::uint8_t> last;
      for (int i = 0; i < 10; ++i)
      {
        ASSERT_EQ(source.Read(frame), VideoEvent::Frame);
        EXPECT_EQ(frame.Columns, 320);
        EXPECT_EQ(frame.Rows, 240);
        EXPECT_NE(frame.Grey, last);
        last = frame.Grey;
      }
    }
    EXPECT_HAS(program.ReadLine(), "frames sent, ");
  }
  EXPECT_EQ(program.End(), 0);
}

TEST(VideoProgram, WritesAFileForATime)
{
  const Folder folder;
  Program program({ "--video", folder / "a.mkv", "--size", "320", "240", "--seconds", "2" });
  EXPECT_EQ(program.Wait(), 0);
  const SteadyClock clock;
  VideoSettings settings;
  settings.URL = folder / "a.mkv";
  settings.InRealTime = false;
  VideoSource source(settings, clock);
  VideoFrame frame;
  double first = -1;
  double last = -1;
  while (source.Read(frame) != VideoEvent::End)
  {
    last = frame.StreamTime.value();
    first = first < 0 ? last : first;
  }
  EXPECT_GE(source.GetCounts().Frames, 3u);
  EXPECT_EQ(source.GetCounts().Frames + source.GetCounts().Missing,
    static_cast<std::uint64_t>(std::lround(25 * (last - first)) + 1));
}

TEST(VideoProgram, SaysWhatIsWrong)
{
  const Folder folder;
  Program none({ "--video", folder / "none/a.mkv" });
  for (int line = 0; line < 3; ++line)
  {
    none.ReadLine();
  }
  EXPECT_HAS(none.ReadLine(), "none/a.mkv' cannot be opened for writing");
  EXPECT_EQ(none.Wait(), 1);
  Program nameless({ "--video", folder / "video" });
  std::string line = nameless.ReadLine();
  while (!line.empty() && line.find("lacuna-fastrak-emulator: ") == std::string::npos)
  {
    line = nameless.ReadLine(); // FFmpeg's own words
  }
  EXPECT_HAS(line, ".mkv");
  EXPECT_EQ(nameless.Wait(), 1);
  Program folderless({ "--video", FreeAddress(), "--calibration", folder / "none/a.xml" });
  folderless.ReadLine();
  EXPECT_HAS(folderless.ReadLine(), "none/a.xml");
  EXPECT_EQ(folderless.Wait(), 1);
}
