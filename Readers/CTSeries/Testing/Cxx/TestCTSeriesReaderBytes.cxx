// SPDX-License-Identifier: BSD-3-Clause
// How much vtkLacunaCTSeriesReader reads of folders with many files and of large ones: beginnings
// once, and pixels once, of the images that are asked for; and no pixels of a file that is another one
// since.
#include "CTSeriesReaderTesting.h"
#include "lacunaProcessMemory.h"
#include "lacunaSanitized.h"
#include "vtkInformation.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <fstream>
#include <functional>
#include <sys/resource.h>

namespace
{
constexpr int Edge = 128;
constexpr int Slices = 150;
constexpr double ImageBytes = 2.0 * Edge * Edge; // 32 KiB: a beginning is a part of it
constexpr double Beginning = 8192;               // of a file, in which most headers lie
constexpr double Others = 65536;                 // what the process reads beside

CTTestSeries MakeSeries(const std::string& uid)
{
  CTTestSeries series;
  series.SeriesUid = uid;
  series.Columns = series.Rows = Edge;
  series.Slices = Slices;
  series.Stored = [](int column, int row, int slice) { return (column * 7 + row + slice) % 2000; };
  return series;
}

// Bytes that this process has read so far.
double GetBytesRead()
{
  std::ifstream io("/proc/self/io");
  std::string key;
  double bytes = 0;
  io >> key >> bytes; // rchar:
  return bytes;
}

double CountBytes(const std::function<void()>& work)
{
  const double before = GetBytesRead();
  work();
  return GetBytesRead() - before;
}

void CheckAbout(double bytes, double expected, const std::string& what)
{
  LACUNA_CHECK_THAT(expected <= bytes && bytes <= expected + Others,
    what + ": " + std::to_string(bytes) + " bytes are read, not " + std::to_string(expected));
}

// Three series and what else lies in a folder.
void TestManyFiles()
{
  ReaderOf test(MakeSeries("1.2.3.1"));
  for (const char* name : { "second", "third" })
  {
    MakeSeries(std::string("1.2.3.") + name[0]).Write(test.Folder + "/" + name);
  }
  const int others = 200;
  for (int i = 0; i < others; ++i)
  {
    std::ofstream(test.Folder + "/note " + std::to_string(i))
      << std::string(static_cast<std::size_t>(ImageBytes), 'x');
  }
  vtkLacunaCTSeriesReader* reader = test.Reader;
  reader->SetSeriesUID("1.2.3.1");
  const double files = 3 * Slices + others;
  CheckAbout(CountBytes([&] { reader->UpdateInformation(); }), files * Beginning, "the beginnings");
  LACUNA_CHECK(reader->GetSeriesList()->GetNumberOfValues() == 3);

  lacuna::ResetPeakMemory();
  const double memory = lacuna::GetProcessMemory("VmRSS");
  CheckAbout(CountBytes([&] { test.ExpectGood(); }), Slices * ImageBytes, "the series");
  LACUNA_CHECK(lacuna::Sanitized ||
    lacuna::GetProcessMemory("VmHWM") - memory < 1.5 * Slices * ImageBytes + 8e6);

  CheckAbout(CountBytes(
               [&]
               {
                 reader->SetSeriesUID("1.2.3.s");
                 reader->UpdateInformation();
               }),
    0, "another series is chosen");
  const int part[6] = { 0, Edge - 1, 0, Edge - 1, 20, 49 };
  CheckAbout(CountBytes([&] { reader->UpdateExtent(part); }), 30 * ImageBytes, "30 slices");
  LACUNA_CHECK(reader->GetOutput()->GetDimensions()[2] == 30);

  // what has changed is read, and no more
  std::ofstream(test.Folder + "/note 7", std::ios::app) << "more";
  CheckAbout(CountBytes(
               [&]
               {
                 reader->Modified();
                 reader->UpdateInformation();
               }),
    Beginning, "a file that has grown");
}

// A volume for which there is no room is refused with its bytes before it is read, and read when there is.
void TestTooLarge()
{
  if (lacuna::Sanitized)
  {
    return; // sanitizers take the address space
  }
  ReaderOf test(MakeSeries("1.2.3.1"));
  test.Reader->UpdateInformation();
  rlimit before;
  getrlimit(RLIMIT_AS, &before);
  const rlimit little{ static_cast<rlim_t>(lacuna::GetProcessMemory("VmSize")) + (1U << 20),
    before.rlim_max };
  setrlimit(RLIMIT_AS, &little);
  CheckAbout(CountBytes(
               [&]
               {
                 test.ExpectError("The CT volume would need " +
                   std::to_string(static_cast<int>(Slices * ImageBytes)) + " bytes");
               }),
    0, "a series that does not fit");
  setrlimit(RLIMIT_AS, &before);
  test.Reader->Modified();
  test.ExpectGood();
  LACUNA_CHECK(test.Reader->GetErrorCode() == vtkErrorCode::NoError);
}

// A series that is there twice: whether the images are the same is found once.
void TestCopies()
{
  ReaderOf test(MakeSeries("1.2.3.1"));
  for (const std::string& file : test.Files)
  {
    std::filesystem::copy_file(file, file + " copy");
  }
  CheckAbout(CountBytes([&] { test.Reader->UpdateInformation(); }),
    2 * Slices * (Beginning + ImageBytes), "beginnings, and pixels to compare");
  CheckAbout(CountBytes(
               [&]
               {
                 test.Reader->SetPaddingValue(-2000);
                 test.Reader->UpdateInformation();
               }),
    0, "another property");
  CheckAbout(CountBytes([&] { test.ExpectGood(); }), Slices * ImageBytes, "the series");
  LACUNA_CHECK_CONTAINS(
    test.Warnings, std::to_string(Slices) + " slices are there twice with the same image");

  // a copy that is another image now
  std::fstream file(test.Files[5] + " copy", std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(-1000, std::ios::end);
  file << "changed";
  file.close();
  const auto time = std::filesystem::last_write_time(test.Files[5] + " copy");
  std::filesystem::last_write_time(test.Files[5] + " copy", time + std::chrono::seconds(1));
  test.Reader->SetPaddingValue(-1000);
  CheckAbout(CountBytes([&] { test.Reader->UpdateInformation(); }), Beginning + 2 * ImageBytes,
    "one pair to compare again");
  test.ExpectError("1 slices are there twice with different images");
}

// Files are written over after the reader has looked at them: by another scan with images of the same
// size, which would come where the old ones were.
void TestChangedFiles()
{
  CTTestSeries series;
  series.Slices = 6;
  ReaderOf test(series);
  test.Reader->UpdateInformation();
  const int first[6] = { 0, series.Columns - 1, 0, series.Rows - 1, 0, 2 };
  test.Reader->UpdateExtent(first);
  LACUNA_CHECK_THAT(test.Errors.empty(), test.Errors);
  const auto time = std::filesystem::last_write_time(test.Files[0]);
  series.Edits = { { 0x0028, 0x1052, "DS", "-24", {} } };
  series.Write(test.Folder);
  for (const std::string& file : test.Files)
  {
    std::filesystem::last_write_time(file, time + std::chrono::seconds(1));
  }
  const int second[6] = { 0, series.Columns - 1, 0, series.Rows - 1, 4, 4 };
  test.Reader->UpdateExtent(second);
  LACUNA_CHECK_CONTAINS(test.Errors, "has changed since its header was read");
  LACUNA_CHECK_CONTAINS(test.Errors, "IM00");
  LACUNA_CHECK(test.Reader->GetOutput()->GetNumberOfPoints() == 0);
  test.Reader->Modified(); // as Reload Files does
  test.ExpectGood();
}

// One file of many frames.
void TestManyFrames()
{
  CTTestSeries series = MakeSeries("1.2.3.1");
  series.MultiFrame = true;
  series.Slices = 400;
  ReaderOf test(series);
  const auto size = static_cast<double>(std::filesystem::file_size(test.Files[0]));
  const double pixels = series.Slices * ImageBytes;
  const double bytes = CountBytes([&] { test.Reader->UpdateInformation(); });
  LACUNA_CHECK_THAT(bytes < size - pixels + 2 * Beginning + Others, std::to_string(bytes));
  lacuna::ResetPeakMemory();
  const double memory = lacuna::GetProcessMemory("VmRSS");
  CheckAbout(CountBytes([&] { test.ExpectGood(); }), pixels, "the frames");
  LACUNA_CHECK(
    lacuna::Sanitized || lacuna::GetProcessMemory("VmHWM") - memory < 1.5 * pixels + 8e6);
}
}

int TestCTSeriesReaderBytes(int, char*[])
{
  TestChangedFiles();
  if (GetBytesRead() <= 0)
  {
    std::cout << "the system does not tell how much is read\n";
    return lacunaCheck::Result();
  }
  TestManyFiles();
  TestTooLarge();
  TestCopies();
  TestManyFrames();
  return lacunaCheck::Result();
}
