// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A CT series of 512 x 512 pixels read by the reader, from opening the folder to the volume, beside
/// the least that anyone must do, in the same run and one after the other: read the bytes of all
/// files into memory, and decode their pixels (in this process). All from the page cache.
///
/// Counters in milliseconds: reader, and vtk for VTK's reader (it knows uncompressed files only, one
/// thread), medians over the iterations; raw and decode, which are to be the least possible, the least
/// of them; the same of processor time, which says more when others use the machine, as rawCpu and so
/// on; ratio is reader over (raw + decode), cpuRatio the same of processor time. apartRatio and
/// apartCpuRatio, of compressed series: the pixels decoded by the reader's processes over decode, the median
/// of the ratios within each iteration.
/// The files are written into a folder of the system's temporary one (500 slices take 260 MB) and
/// removed in the end.
#include "CTTestSeries.h"
#include "lacunaBenchmark.h"
#include "lacunaCTVolume.h"
#include "lacunaDicomDecoder.h"
#include "lacunaDicomHeader.h"
#include "lacunaExecution.h"
#include "lacunaGDCMDecoder.h"
#include "lacunaMemory.h"
#include "lacunaVTKThreads.h"
#include "vtkDICOMImageReader.h"
#include "vtkImageData.h"
#include "vtkLacunaCTSeriesReader.h"
#include "vtkNew.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <sys/resource.h>
#include <unistd.h>

using namespace lacuna;

namespace
{
enum Syntax
{
  Uncompressed,
  JpegLS,
  JpegLossless
};
constexpr const char* Uids[] = { "1.2.840.10008.1.2.1", "1.2.840.10008.1.2.4.80",
  "1.2.840.10008.1.2.4.70" };
constexpr const char* Names[] = { "uncompressed", "JPEG-LS", "JPEG lossless" };

// A head of soft tissue and bone with noise of some 15 HU, so that it compresses as scans do.
std::int64_t GetValue(int column, int row, int slice)
{
  const double r = std::hypot((column - 255.5) / 200, (row - 255.5) / 230);
  const double tissue = 40 + 20 * std::sin(0.05 * column) * std::cos(0.04 * row + 0.1 * slice);
  const double value = r > 1 ? -1000 : r > 0.93 ? 60 : r > 0.86 ? 1100 : tissue;
  std::uint64_t bits =
    (static_cast<std::uint64_t>(slice) << 40 | static_cast<std::uint64_t>(row) << 20 |
      static_cast<std::uint64_t>(column)) *
    0x9E3779B97F4A7C15ULL;
  bits = (bits ^ bits >> 29) * 0xBF58476D1CE4E5B9ULL;
  const auto noise = static_cast<double>((bits >> 16 & 63) + (bits >> 32 & 63)) - 63;
  return std::llround(value + 0.6 * noise) + 1024;
}

// A folder with a series, gone in the end.
class Series
{
public:
  Series(Syntax syntax, int slices)
    : Folder((std::filesystem::temp_directory_path() /
        ("lacuna-benchmark-" + std::to_string(getpid()) + "-" + std::to_string(syntax)))
               .string())
  {
    CTTestSeries series;
    series.Columns = series.Rows = 512;
    series.RowSpacing = series.ColumnSpacing = 0.5;
    series.Step = { 0, 0, 0.5 };
    series.Slices = slices;
    series.Signed = false;
    series.Intercept = -1024;
    series.BitsStored = 12;
    series.TransferSyntax = Uids[syntax];
    series.Stored = [](int column, int row, int slice)
    { return std::clamp<std::int64_t>(GetValue(column, row, slice), 0, 4095); };
    this->Files = series.Write(this->Folder);
  }
  ~Series()
  {
    std::error_code ignored;
    std::filesystem::remove_all(this->Folder, ignored);
  }
  Series(const Series&) = delete;
  Series& operator=(const Series&) = delete;

  std::string Folder;
  std::vector<std::string> Files;
};

const Series& GetSeries(Syntax syntax, int slices)
{
  static std::map<std::pair<Syntax, int>, std::unique_ptr<Series>> all;
  auto& series = all[{ syntax, slices }];
  if (!series)
  {
    all.clear();
    return *(all[{ syntax, slices }] = std::make_unique<Series>(syntax, slices));
  }
  return *series;
}

// Of this process and of those that it has started and seen end, s.
double GetAllSeconds()
{
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& time)
  { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
  return lacunaBenchmark::GetProcessSeconds() + seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Milliseconds of each run of a work: of the clock, and of the processors.
struct Times
{
  std::vector<double> Wall;
  std::vector<double> Cpu;

  template <class Work>
  double Measure(Work&& work)
  {
    const auto start = std::chrono::steady_clock::now();
    const double cpu = GetAllSeconds();
    work();
    this->Cpu.push_back(1e3 * (GetAllSeconds() - cpu));
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
    this->Wall.push_back(wall.count());
    return this->Wall.back();
  }
};

double Least(std::vector<double> times)
{
  return *std::min_element(times.begin(), times.end());
}

double Median(std::vector<double> times)
{
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

void ReadRaw(const std::vector<std::string>& files, Execution& execution)
{
  std::vector<std::size_t> offsets(1, 0);
  for (const std::string& file : files)
  {
    offsets.push_back(offsets.back() + std::filesystem::file_size(file));
  }
  const std::unique_ptr<char[]> bytes(new char[offsets.back()]);
  PreferLargePages(bytes.get(), offsets.back());
  execution.For(static_cast<std::int64_t>(files.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        FILE* file = std::fopen(files[i].c_str(), "rb");
        std::setvbuf(file, nullptr, _IONBF, 0);
        const std::size_t size = offsets[i + 1] - offsets[i];
        if (std::fread(bytes.get() + offsets[i], 1, size, file) != size)
        {
          std::abort();
        }
        std::fclose(file);
      }
    });
  benchmark::DoNotOptimize(bytes.get());
}

// Streams that are in memory already.
void Decode(const std::vector<CTFrame>& frames,
  const std::vector<std::vector<unsigned char>>& streams, Execution& execution)
{
  execution.For(static_cast<std::int64_t>(frames.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      CTPixels pixels;
      for (std::int64_t i = begin; i < end; ++i)
      {
        pixels.Stream = streams[i];
        pixels.Bytes.resize(static_cast<std::size_t>(frames[i].GetSize()));
        const CTFileHeader& header = *frames[i].Header;
        DecoderRequest request;
        request.StreamBytes = pixels.Stream.size();
        request.PixelBytes = pixels.Bytes.size();
        request.Columns = static_cast<std::uint32_t>(header.Columns);
        request.Rows = static_cast<std::uint32_t>(header.Rows);
        request.Format = { header.Format.BitsAllocated, header.Format.BitsStored,
          header.Format.HighBit, 0 };
        header.TransferSyntax.copy(request.TransferSyntax, sizeof request.TransferSyntax - 1);
        if (DecodeWithGDCM(request, pixels.Stream.data(), pixels.Bytes.data()).Status !=
          DecoderStatus::Decoded)
        {
          std::abort();
        }
      }
    });
}

// As the reader does, from the files.
void DecodeApart(const std::vector<CTFrame>& frames, Execution& execution)
{
  DicomDecoder decoder(LACUNA_DECODER_PROGRAM);
  execution.For(static_cast<std::int64_t>(frames.size()), 1,
    [&](std::int64_t begin, std::int64_t end)
    {
      CTPixels pixels;
      for (std::int64_t i = begin; i < end; ++i)
      {
        decoder.Read(frames[i], pixels);
      }
    });
}

void Read(const std::string& folder, int slices)
{
  vtkNew<vtkLacunaCTSeriesReader> reader;
  reader->SetFileName(folder.c_str());
  reader->Update();
  if (reader->GetOutput()->GetDimensions()[2] != slices)
  {
    std::abort();
  }
}

void ReadByVTK(const std::string& folder, int slices)
{
  vtkNew<vtkDICOMImageReader> reader;
  reader->SetDirectoryName(folder.c_str());
  reader->Update();
  if (reader->GetOutput()->GetDimensions()[2] != slices)
  {
    std::abort();
  }
}

void CTSeries(benchmark::State& state)
{
  const auto syntax = static_cast<Syntax>(state.range(0));
  const auto slices = static_cast<int>(state.range(1));
  const auto threads = static_cast<int>(state.range(2));
  const Series& series = GetSeries(syntax, slices);
  lacunaBenchmark::SetVTKThreads(threads);
  ThreadExecution execution(threads);
  std::vector<CTFrame> frames;
  std::vector<std::vector<unsigned char>> streams;
  if (syntax != Uncompressed)
  {
    for (const std::string& file : series.Files)
    {
      frames.push_back(ReadDicomFrames(file).at(0));
      streams.emplace_back(static_cast<std::size_t>(GetDicomSize(frames.back())));
      ReadDicomBytes(frames.back(), streams.back().data());
    }
  }
  Times raw;
  Times decode;
  Times apart;
  Times reader;
  Times vtk;
  // the first to ask for so much memory waits for the system to make it
  ReadRaw(series.Files, execution);
  Read(series.Folder, slices);
  for (auto _ : state)
  {
    double time = raw.Measure([&] { ReadRaw(series.Files, execution); });
    time += decode.Measure([&] { Decode(frames, streams, execution); });
    if (syntax != Uncompressed)
    {
      time += apart.Measure([&] { DecodeApart(frames, execution); });
    }
    time += reader.Measure([&] { Read(series.Folder, slices); });
    if (syntax == Uncompressed)
    {
      vtk.Measure([&] { ReadByVTK(series.Folder, slices); });
    }
    state.SetIterationTime(time / 1000);
  }
  state.SetLabel(Names[syntax]);
  auto& counters = state.counters;
  const auto count =
    [&counters](const std::string& name, const Times& times, double (*of)(std::vector<double>))
  {
    counters[name] = of(times.Wall);
    counters[name + "Cpu"] = of(times.Cpu);
  };
  count("raw", raw, Least);
  count("decode", decode, Least);
  count("reader", reader, Median);
  if (syntax == Uncompressed)
  {
    count("vtk", vtk, Median);
  }
  else
  {
    const auto ratio = [](std::vector<double> times, const std::vector<double>& least)
    {
      for (std::size_t i = 0; i < times.size(); ++i)
      {
        times[i] /= least[i];
      }
      return Median(times);
    };
    counters["apartRatio"] = ratio(apart.Wall, decode.Wall);
    counters["apartCpuRatio"] = ratio(apart.Cpu, decode.Cpu);
  }
  counters["ratio"] = counters["reader"] / (counters["raw"] + counters["decode"]);
  counters["cpuRatio"] = counters["readerCpu"] / (counters["rawCpu"] + counters["decodeCpu"]);
}
}

BENCHMARK(CTSeries)
  ->UseManualTime()
  ->Unit(benchmark::kMillisecond)
  ->ArgNames({ "syntax", "slices", "threads" })
  ->ArgsProduct({ { Uncompressed }, { 500 }, { 1, 2, 4 } })
  ->ArgsProduct({ { JpegLS, JpegLossless }, { 500 }, { 2 } })
  ->ArgsProduct({ { Uncompressed }, { 5, 20, 50 }, { 2 } })
  ->Args({ JpegLS, 20, 2 })
  ->Args({ JpegLossless, 100, 1 });
BENCHMARK_MAIN();
