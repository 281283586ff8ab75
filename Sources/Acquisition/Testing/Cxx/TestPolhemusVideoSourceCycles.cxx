// SPDX-License-Identifier: BSD-3-Clause
// Sources that are made, take a sweep and are deleted, again and again, leave nothing behind: no memory, no
// open file, no thread. TestPolhemusVideoSourceCycles [COUNT]
#include "lacunaGrowth.h"
#include "lacunaTestBench.h"
#include "vtkImageData.h"

#include <chrono>
#include <iostream>
#include <string>
#include <thread>

using namespace lacunaTest;

namespace
{
void TakeSweep(const Bench& bench, const std::string& calibration)
{
  vtkNew<vtkLacunaPolhemusVideoSource> source;
  source->SetTrackerConnection(bench.Source->GetTrackerConnection());
  source->SetVideoURL(bench.Source->GetVideoURL());
  source->SetCalibrationFileName(calibration.c_str());
  source->SetCaptureMode(vtkLacunaPolhemusVideoSource::EveryFrame);
  source->Start();
  for (int i = 0; i < 6000 && source->GetSliceCount() < 2; ++i)
  {
    source->Poll();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  source->Stop();
  source->Update();
  LACUNA_CHECK(source->GetSliceCount() >= 2);
  LACUNA_CHECK(source->GetOutput(0)->GetDimensions()[0] == 64);
  LACUNA_CHECK(source->GetOutput(0)->GetDimensions()[2] == source->GetSliceCount());
}
}

int TestPolhemusVideoSourceCycles(int argc, char* argv[])
{
  const int cycles = argc > 1 ? std::stoi(argv[1]) : 30;
  const Bench bench([](double, int) { return Still; });
  const std::string calibration =
    bench.WriteCalibration(lacuna::Matrix4::Scaling({ 0.5, 0.5, 0.5 }));
  const auto run = [&](int count)
  {
    for (int i = 0; i < count; ++i)
    {
      TakeSweep(bench, calibration);
    }
  };
  run(3); // what is made once
  std::string story;
  const std::string fault = lacuna::FindGrowth(cycles, run, story);
  std::cout << story << fault << "\n";
  LACUNA_CHECK(fault.empty());
  return lacunaCheck::Result();
}
