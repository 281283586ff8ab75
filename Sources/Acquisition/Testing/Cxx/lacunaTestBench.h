// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A live source with an emulated FASTRAK behind the real libserialport.
#ifndef lacunaTestBench_h
#define lacunaTestBench_h

#include "lacunaCheck.h"
#include "lacunaTestUnit.h"
#include "vtkLacunaPolhemusVideoSource.h"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

namespace lacunaTest
{
inline const lacuna::Matrix4 Still = lacuna::Matrix4::Translation({ 120, 30, -40 }) *
  lacuna::FastrakRotation(lacuna::Vec3{ 10, 20, 30 });

inline std::string MakeFolder()
{
  std::string path = (std::filesystem::temp_directory_path() / "lacuna-source-XXXXXX").string();
  LACUNA_CHECK(mkdtemp(path.data()) != nullptr);
  return path;
}

/// A live source of an emulated FASTRAK and a test signal, every frame a slice.
struct Bench
{
  explicit Bench(lacuna::FastrakEmulator::PoseScript script)
    : Folder(MakeFolder())
    , Unit(this->Folder + "/tracker", MakeOptions(), std::move(script))
    , Messages(lacunaCheck::Watch(this->Source))
  {
    this->Source->SetTrackerConnection(GetPort(this->Folder + "/tracker").c_str());
    this->Source->SetVideoURL("lavfi:testsrc2=size=64x48:rate=25");
    this->Source->SetCaptureMode(vtkLacunaPolhemusVideoSource::EveryFrame);
  }
  ~Bench()
  {
    this->Source->Disconnect();
    std::filesystem::remove_all(this->Folder);
  }
  static lacuna::FastrakEmulatorOptions MakeOptions()
  {
    lacuna::FastrakEmulatorOptions options;
    options.Baud = 115200;
    return options;
  }
  /// Polls until something is so, for at most a minute.
  bool PollUntil(const std::function<bool()>& condition) const
  {
    for (int i = 0; i < 6000 && !condition(); ++i)
    {
      this->Source->Poll();
      if (i % 10 == 0)
      {
        this->Source->Update();
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    if (!condition())
    {
      std::cerr << this->Source->GetMessage() << "\n";
      return false;
    }
    return true;
  }
  bool PollFor(vtkIdType slices) const
  {
    return this->PollUntil([&] { return this->Source->GetSliceCount() >= slices; });
  }
  bool IsConnected() const
  {
    return this->PollUntil(
      [&] { return this->Source->GetTrackerWorks() && this->Source->GetVideoWorks(); });
  }
  std::string WriteCalibration(const lacuna::Matrix4& imageToProbe) const
  {
    const std::string path = this->Folder + "/calibration.xml";
    std::ofstream file(path);
    file << "<PlusConfiguration><CoordinateDefinitions><Transform From=\"Image\" To=\"Probe\" "
            "Matrix=\"";
    for (int i = 0; i < 16; ++i)
    {
      file << imageToProbe.Data()[i] << " ";
    }
    file << "\"/></CoordinateDefinitions></PlusConfiguration>";
    return path;
  }

  std::string Folder;
  EmulatedUnit Unit;
  vtkNew<vtkLacunaPolhemusVideoSource> Source;
  vtkSmartPointer<lacunaCheck::Messages> Messages;
};

/// The largest difference of two matrices' elements.
inline double Distance(const lacuna::Matrix4& a, const lacuna::Matrix4& b)
{
  double largest = 0;
  for (int i = 0; i < 16; ++i)
  {
    largest = std::max(largest, std::abs(a.Data()[i] - b.Data()[i]));
  }
  return largest;
}
}
#endif
