// SPDX-License-Identifier: BSD-3-Clause
// Calls what needs other libraries: OpenBLAS, pugixml, libserialport and FFmpeg.
#include "allHeaders.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

namespace
{
void Require(bool condition, const char* what)
{
  if (!condition)
  {
    throw std::runtime_error(what);
  }
}

template <class Function>
std::string GetError(const Function& function)
{
  try
  {
    function();
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return {};
}
}

int main(int argc, char* argv[])
{
  try
  {
    Require(argc == 2, "usage: Kernels FILE");
    lacuna::ThreadExecution execution(1);
    const lacuna::RadialBasis<2> plane(
      execution, { { 0, 0 }, { 9, 0 }, { 0, 7 }, { 8, 6 } }, { 1, 10, 8, 15 }, {});
    std::vector<double> values;
    plane.Evaluate(execution, { { 2, 3 } }, values);
    Require(std::abs(values.at(0) - 6) < 1e-9, "no plane through four points");

    const lacuna::Matrix4 matrix = lacuna::Matrix4::Translation({ 1, 2, 3 });
    std::ofstream(argv[1]) << lacuna::FormatCalibration({ { "Image", "Probe", matrix } }, "");
    const auto read = lacuna::ReadCalibrationFile(argv[1]);
    Require(read.size() == 1 && read[0].Matrix(1, 3) == 2, "another calibration than was written");

    const lacuna::SteadyClock clock;
    const auto stopped = [] { return false; };
    lacuna::TrackerChoice tracker;
    tracker.Connection = "/dev/none";
    std::puts(GetError([&] { lacuna::ChoosePoseDevice(tracker, clock)(stopped); }).c_str());
    lacuna::VideoSettings video;
    video.URL = "/none.avi"; // no camera: the libraries for these are only recommended
    const std::string error = GetError([&] { lacuna::ChooseFrameDevice(video, clock)(stopped); });
    std::puts(error.c_str());
    Require(error.find("/none.avi") != std::string::npos, "no word of the video");
  }
  catch (const std::exception& e)
  {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
