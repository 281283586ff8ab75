// SPDX-License-Identifier: BSD-3-Clause
// Time per sample of the speckle filters, against window size and against VTK's median.
//   bin/BenchmarkSpeckleFilter [--benchmark_filter=Goal]
// per_sample is wall time on all cores (of use on an idle machine only), cpu_per_sample what all
// threads took together. Goal cases carry what per_sample has to reach on two cores as goal, and
// how many times faster than vtkImageMedian3D in the same run they are as faster and cpu_faster.
#include "lacunaBenchmark.h"
#include "lacunaSpeckleFilter.h"
#include "vtkImageData.h"
#include "vtkImageGaussianSmooth.h"
#include "vtkImageMedian3D.h"
#include "vtkMultiThreader.h"
#include "vtkNew.h"

#include <chrono>
#include <cmath>
#include <cstring>
#include <random>
#include <type_traits>
#include <vector>

namespace
{
using lacuna::SpeckleOperation;
using Size = std::array<int, 3>;

constexpr Size Foetus{ 220, 172, 204 }; // the thesis's volume
constexpr Size Sweep{ 640, 480, 200 };

/// Speckle: Rayleigh distributed around a few grey levels, as in an envelope-detected B-scan.
template <class T>
const std::vector<T>& Speckle(const Size& size)
{
  static std::vector<T> samples;
  static Size made{};
  if (made != size)
  {
    made = size;
    samples.resize(std::size_t(size[0]) * size[1] * size[2]);
    std::mt19937 generator(1);
    std::uniform_real_distribution<float> uniform(1e-6f, 1.0f);
    const double scale = sizeof(T) == 1 ? 1 : std::is_floating_point_v<T> ? 0.37 : 100;
    std::size_t i = 0;
    for (int z = 0; z < size[2]; ++z)
    {
      for (int y = 0; y < size[1]; ++y)
      {
        for (int x = 0; x < size[0]; ++x, ++i)
        {
          const double level =
            30 + 25 * std::sin(x * 0.05) * std::cos(y * 0.04) * std::sin(z * 0.03);
          const double envelope = level * std::sqrt(-2 * std::log(uniform(generator)));
          samples[i] = static_cast<T>(scale * std::min(255.0, envelope));
        }
      }
    }
  }
  return samples;
}

/// Seconds for a sample.
struct Cost
{
  double Wall = 0;
  double Cpu = 0;
};

/// Counts from its making to its end.
class Clock
{
public:
  explicit Clock(benchmark::State& state, std::size_t samples)
    : State(state)
    , Samples(static_cast<double>(samples))
    , Start(std::chrono::steady_clock::now())
    , CpuStart(lacunaBenchmark::GetProcessSeconds())
  {
  }
  ~Clock()
  {
    const Cost cost = this->GetCost();
    this->State.counters["cpu_per_sample"] = cost.Cpu;
    this->State.counters["per_sample"] = cost.Wall;
  }

  Cost GetCost() const
  {
    const double count = this->Samples * static_cast<double>(this->State.iterations());
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - this->Start;
    return { wall.count() / count,
      (lacunaBenchmark::GetProcessSeconds() - this->CpuStart) / count };
  }

private:
  benchmark::State& State;
  double Samples;
  std::chrono::steady_clock::time_point Start;
  double CpuStart;
};

/// What the median of VTK cost in this run.
Cost& PeerCost()
{
  static Cost cost;
  return cost;
}

template <class T>
Cost Filter(benchmark::State& state, const Size& size, const lacuna::SpeckleParameters& parameters,
  int threads = 0)
{
  const lacuna::Extent box{ 0, size[0] - 1, 0, size[1] - 1, 0, size[2] - 1 };
  const std::vector<T>& samples = Speckle<T>(size);
  std::vector<T> result(samples.size());
  const lacuna::ImageView<const T> input(samples.data(), box);
  const lacuna::ImageView<T> output(result.data(), box);
  lacuna::ThreadExecution execution(threads);
  const Clock clock(state, samples.size());
  for (auto _ : state)
  {
    lacuna::FilterSpeckle(input, output, parameters, execution);
  }
  return clock.GetCost();
}

lacuna::SpeckleParameters Make(SpeckleOperation operation, int width, bool flat)
{
  lacuna::SpeckleParameters parameters;
  parameters.Operation = operation;
  parameters.KernelSize = { width, width, flat ? 1 : width };
  parameters.Percentile = 30;
  return parameters;
}

template <class Peer>
void RunPeer(benchmark::State& state, const Size& size, Peer* filter)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(size.data());
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  const std::vector<std::uint8_t>& samples = Speckle<std::uint8_t>(size);
  std::memcpy(image->GetScalarPointer(), samples.data(), samples.size());
  filter->SetInputData(image);
  filter->SetEnableSMP(false); // ParaView's default back end is sequential
  filter->SetNumberOfThreads(vtkMultiThreader::GetGlobalDefaultNumberOfThreads());
  const Clock clock(state, samples.size());
  for (auto _ : state)
  {
    filter->Modified();
    filter->Update();
  }
  PeerCost() = clock.GetCost();
}

void VTKMedian(benchmark::State& state, const Size& size, int width, bool flat)
{
  vtkNew<vtkImageMedian3D> median;
  median->SetKernelSize(width, width, flat ? 1 : width);
  RunPeer(state, size, median.Get());
}

void VTKGaussian(benchmark::State& state, const Size& size, double deviation)
{
  vtkNew<vtkImageGaussianSmooth> gaussian;
  gaussian->SetStandardDeviation(deviation);
  gaussian->SetRadiusFactors(3, 3, 3);
  RunPeer(state, size, gaussian.Get());
}

template <class Body>
void Register(const std::string& name, const Body& body)
{
  benchmark::RegisterBenchmark(name.c_str(), body)->Apply(lacunaBenchmark::Measure);
}

/// A goal: nanoseconds of wall time for a sample on two cores.
void RegisterGoal(const std::string& name, double goal, const Size& size,
  const lacuna::SpeckleParameters& parameters)
{
  Register("Goal/" + name,
    [=](benchmark::State& state)
    {
      Filter<std::uint8_t>(state, size, parameters);
      state.counters["goal"] = 1e-9 * goal;
    });
}

/// On the same images as the rows of the other filters, the peers.
void RegisterPeers(const Size& slab)
{
  for (const int width : { 3, 5, 9 })
  {
    Register("Size3D/VTKMedian_uint8/" + std::to_string(width),
      [=](benchmark::State& state) { VTKMedian(state, slab, width, false); });
  }
  const Size image{ 640, 480, 4 };
  Register("Image/VTKMedian_uint8/11",
    [=](benchmark::State& state) { VTKMedian(state, image, 11, true); });
  Register("Image/Median_uint8/11",
    [=](benchmark::State& state)
    { Filter<std::uint8_t>(state, image, Make(SpeckleOperation::Median, 11, true)); });
  Register("Gaussian3D/VTKGaussian_uint8/2",
    [=](benchmark::State& state) { VTKGaussian(state, slab, 2); });
  Register("Gaussian3D/Gaussian_uint8/2",
    [=](benchmark::State& state)
    {
      auto parameters = Make(SpeckleOperation::Gaussian, 3, false);
      parameters.StandardDeviation = 2;
      Filter<std::uint8_t>(state, slab, parameters);
    });
}

/// Median of 9 x 9 x 9 samples against the samples and the threads.
void RegisterScaling()
{
  const auto parameters = Make(SpeckleOperation::Median, 9, false);
  for (const int edge : { 46, 100, 215, 464 })
  {
    Register("Cube/Median_uint8/" + std::to_string(edge),
      [=](benchmark::State& state) {
        Filter<std::uint8_t>(state, { edge, edge, edge }, parameters, 2);
      });
    if (edge < 200)
    {
      Register("Cube/VTKMedian_uint8/" + std::to_string(edge),
        [=](benchmark::State& state) {
          VTKMedian(state, { edge, edge, edge }, 9, false);
        });
    }
  }
  for (const int threads : { 1, 2, 4 })
  {
    Register("Threads/Median_uint8/" + std::to_string(threads),
      [=](benchmark::State& state) {
        Filter<std::uint8_t>(state, { 215, 215, 215 }, parameters, threads);
      });
  }
}
}

int main(int argc, char* argv[])
{
  // The goals: against VTK on 40 slices, where whole windows dominate.
  const Size slab{ Foetus[0], Foetus[1], 40 };
  Register("Goal/VTKMedian_9x9x9_uint8_40slices",
    [=](benchmark::State& state) { VTKMedian(state, slab, 9, false); });
  Register("Goal/Median_9x9x9_uint8_40slices",
    [=](benchmark::State& state)
    {
      const Cost cost = Filter<std::uint8_t>(state, slab, Make(SpeckleOperation::Median, 9, false));
      state.counters["faster"] = PeerCost().Wall / cost.Wall; // goal: 100
      state.counters["cpu_faster"] = PeerCost().Cpu / cost.Cpu;
    });
  RegisterGoal("Median_9x9x9_uint8", 80, Foetus, Make(SpeckleOperation::Median, 9, false));
  RegisterGoal("Median_11x11_uint8", 12, Sweep, Make(SpeckleOperation::Median, 11, true));
  for (const double deviation : { 1.0, 1.4142, 2.0, 3.0, 4.0 })
  {
    auto parameters = Make(SpeckleOperation::Gaussian, 3, false);
    parameters.StandardDeviation = deviation;
    RegisterGoal(
      "Gaussian_3D_uint8/" + std::to_string(deviation).substr(0, 4), 5, Foetus, parameters);
  }
  // Independent of the window: compare the lines.
  for (const int width : { 3, 9, 15, 31 })
  {
    for (const bool flat : { true, false })
    {
      const std::string suffix = (flat ? "_2D_uint8/" : "_3D_uint8/") + std::to_string(width);
      const auto run = [=](const char* name, SpeckleOperation operation)
      {
        Register(name + suffix,
          [=](benchmark::State& state)
          { Filter<std::uint8_t>(state, Foetus, Make(operation, width, flat)); });
      };
      run("Goal/Minimum", SpeckleOperation::Minimum);
      run("Goal/Maximum", SpeckleOperation::Maximum);
      run("Goal/Opening", SpeckleOperation::Opening);
    }
  }

  // Cost against window size.
  const std::vector<std::pair<std::string, SpeckleOperation>> operations{
    { "Median", SpeckleOperation::Median }, { "Rank", SpeckleOperation::Rank },
    { "Mode", SpeckleOperation::Mode }, { "Minimum", SpeckleOperation::Minimum },
    { "Opening", SpeckleOperation::Opening }, { "OpenClose", SpeckleOperation::OpenClose },
    { "Mean", SpeckleOperation::Mean }, { "AdaptiveMedian", SpeckleOperation::AdaptiveMedian }
  };
  for (const auto& [name, operation] : operations)
  {
    const bool slow = operation == SpeckleOperation::AdaptiveMedian;
    const SpeckleOperation what = operation;
    for (const int width : { 3, 5, 7, 9, 11, 15, 21, 31 })
    {
      if (width > 11 && slow)
      {
        continue;
      }
      const Size flatSize{ 640, 480, slow ? 4 : 40 };
      Register("Size2D/" + name + "_uint8/" + std::to_string(width),
        [=](benchmark::State& state)
        { Filter<std::uint8_t>(state, flatSize, Make(what, width, true)); });
      Register("Size3D/" + name + "_uint8/" + std::to_string(width),
        [=](benchmark::State& state) {
          Filter<std::uint8_t>(state, slow ? Size{ 64, 64, 64 } : slab, Make(what, width, false));
        });
    }
  }
  for (const int width : { 3, 5, 9, 15 })
  {
    for (const SpeckleOperation what : { SpeckleOperation::Median, SpeckleOperation::Opening })
    {
      const std::string name = what == SpeckleOperation::Median ? "Median" : "Opening";
      Register("Ellipsoid3D/" + name + "_uint8/" + std::to_string(width),
        [=](benchmark::State& state)
        {
          auto parameters = Make(what, width, false);
          parameters.Shape = lacuna::WindowShape::Ellipsoid;
          Filter<std::uint8_t>(state, slab, parameters);
        });
    }
  }

  // Other types.
  for (const int width : { 3, 5, 9 })
  {
    const std::string suffix = "_" + std::to_string(width);
    const auto parameters = Make(SpeckleOperation::Median, width, false);
    Register("Types3D/Median_int16" + suffix,
      [=](benchmark::State& state) { Filter<std::int16_t>(state, slab, parameters); });
    Register("Types3D/Median_float" + suffix,
      [=](benchmark::State& state) { Filter<float>(state, slab, parameters); });
    Register("Types3D/Median_double" + suffix,
      [=](benchmark::State& state) { Filter<double>(state, slab, parameters); });
  }

  // Vector widths.
  for (int set = 0; set <= static_cast<int>(lacuna::BestVectorUnit()); ++set)
  {
    auto parameters = Make(SpeckleOperation::Median, 9, false);
    parameters.Set = static_cast<lacuna::VectorUnit>(set);
    const char* const names[] = { "Baseline", "AVX2", "AVX512" };
    Register(std::string("Vectors/Median_9x9x9_uint8_") + names[set],
      [=](benchmark::State& state) { Filter<std::uint8_t>(state, slab, parameters); });
    parameters.KernelSize = { 11, 11, 1 };
    Register(std::string("Vectors/Median_11x11_uint8_") + names[set],
      [=](benchmark::State& state) { Filter<std::uint8_t>(state, slab, parameters); });
  }

  RegisterPeers(slab);
  RegisterScaling();
  return lacunaBenchmark::RunRows(argc, argv);
}
