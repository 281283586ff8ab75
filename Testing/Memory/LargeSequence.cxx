// SPDX-License-Identifier: BSD-3-Clause
// A sequence that is larger than the memory it may take: previewed, reconstructed, gated, written
// compressed, and reconstructed from that.
//
//   TestLargeSequence <gigabytes> <MemoryLimit in MiB> <folder>
//
// The file is sparse: its pixels are 0 but for a block of slices in the middle. The volume around
// this block must be that of the block alone, bit by bit, which is made in memory.
#include "lacunaCheck.h"
#include "lacunaProcessMemory.h"
#include "lacunaSanitized.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLacunaGateSlices.h"
#include "vtkLacunaSweptVolume.h"
#include "vtkLacunaTrackedSliceReader.h"
#include "vtkLacunaTrackedSliceWriter.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

namespace
{
constexpr int Columns = 640;
constexpr int Rows = 480;
constexpr std::int64_t SliceSize = std::int64_t{ Columns } * Rows;
constexpr int Block = 200;    // slices that are not 0
constexpr double Step = 0.05; // mm from slice to slice
constexpr double Mebibyte = 1048576;

unsigned char GetGrey(int column, int row, int slice)
{
  return static_cast<unsigned char>(1 + (3 * column + row * row / 7 + 11 * slice) % 255);
}

// Slices of 0.1 mm pixels along z, turning slowly; returns the first one of the block.
int WriteSparse(const std::string& name, int frames)
{
  std::ofstream stream(name, std::ios::binary);
  stream << "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
            "CompressedData = False\nDimSize = "
         << Columns << " " << Rows << " " << frames
         << "\nKinds = domain domain list\nElementType = MET_UCHAR\n"
            "UltrasoundImageOrientation = MFA\nUltrasoundImageType = BRIGHTNESS\n";
  for (int i = 0; i < frames; ++i)
  {
    const std::string frame = "Seq_Frame" +
      std::string(i < 10 ? 3
          : i < 100      ? 2
          : i < 1000     ? 1
                         : 0,
        '0') +
      std::to_string(i) + "_";
    const double lean = 0.001 * (i % 7); // slices are not parallel
    stream << frame << "ImageToReferenceTransform = 0.1 0 0 0 0 0.1 0 0 " << 0.1 * lean << " 0 0.1 "
           << Step * i << " 0 0 0 1\n"
           << frame << "ImageToReferenceTransformStatus = OK\n"
           << frame << "Timestamp = " << 0.04 * i << "\n"
           << frame << "ImageStatus = OK\n";
  }
  stream << "ElementDataFile = LOCAL\n";
  const auto header = static_cast<std::int64_t>(stream.tellp());
  const int first = frames / 2;
  std::vector<unsigned char> slice(SliceSize);
  for (int k = first; k < first + Block; ++k)
  {
    for (int row = 0; row < Rows; ++row)
    {
      for (int column = 0; column < Columns; ++column)
      {
        slice[static_cast<std::size_t>(row) * Columns + column] = GetGrey(column, row, k);
      }
    }
    stream.seekp(header + k * SliceSize);
    stream.write(reinterpret_cast<const char*>(slice.data()), SliceSize);
  }
  stream.close();
  std::filesystem::resize_file(name, static_cast<std::uintmax_t>(header + frames * SliceSize));
  return first;
}

// Runs body and says how long it took and how much memory it needed more than there was in use; gives
// 0 where a sanitizer needs its own.
double Measure(const std::string& name, const std::function<void()>& body)
{
  lacuna::ResetPeakMemory();
  const double before = lacuna::GetProcessMemory("VmRSS");
  const auto start = std::chrono::steady_clock::now();
  body();
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  const double used = lacuna::GetProcessMemory("VmHWM") - before;
  std::cout << name << ": " << time.count() << " s, " << used / Mebibyte << " MiB\n" << std::flush;
  return lacuna::Sanitized ? 0 : used;
}

void Prepare(vtkLacunaSweptVolume* volume, vtkAlgorithmOutput* input, int frames)
{
  volume->SetInputConnection(input);
  volume->SetOutputSpacing(0.5, 0.5, 0.5);
  volume->SetOutputBounds(0, 0.1 * (Columns - 1), 0, 0.1 * (Rows - 1), 0, Step * (frames - 1));
}

template <class T>
const T* GetArray(vtkLacunaSweptVolume* volume, const char* name)
{
  return static_cast<const T*>(
    volume->GetOutput()->GetPointData()->GetArray(name)->GetVoidPointer(0));
}

// Voxels of layers first..last that differ in grey level or number of samples.
std::int64_t CountDifferences(
  vtkLacunaSweptVolume* a, vtkLacunaSweptVolume* b, std::int64_t first, std::int64_t last)
{
  int size[3];
  a->GetOutput()->GetDimensions(size);
  const std::int64_t layer = std::int64_t{ size[0] } * size[1];
  const auto* const greyA = GetArray<unsigned char>(a, "Intensity");
  const auto* const greyB = GetArray<unsigned char>(b, "Intensity");
  const auto* const countA = GetArray<unsigned>(a, "Contributions");
  const auto* const countB = GetArray<unsigned>(b, "Contributions");
  std::int64_t differences = 0;
  for (std::int64_t i = first * layer; i < (last + 1) * layer; ++i)
  {
    differences += greyA[i] != greyB[i] || countA[i] != countB[i] ? 1 : 0;
  }
  return differences;
}
}

int main(int argc, char* argv[])
{
  const double gigabytes = argc > 1 ? std::atof(argv[1]) : 0.3;
  const int limit = argc > 2 ? std::atoi(argv[2]) : 8;
  const std::string folder = argc > 3 ? argv[3] : ".";
  const auto frames = static_cast<int>(1e9 * gigabytes / SliceSize) + 1;
  std::filesystem::create_directories(folder);
  const std::string name = folder + "/large-" + std::to_string(frames) + ".igs.mha";
  const std::string written = folder + "/large-" + std::to_string(frames) + "-written.igs.mha";
  const int block = WriteSparse(name, frames);
  std::cout << frames << " slices, " << std::filesystem::file_size(name) << " bytes\n";
  // poses, texts of fields and what goes with them
  const double fields = 4e3 * frames;
  // the code itself is in memory by then
  const std::string small = folder + "/large-small.igs.mha";
  WriteSparse(small, 3);
  vtkNew<vtkLacunaTrackedSliceReader> warm;
  warm->SetFileName(small.c_str());
  warm->Update();

  vtkNew<vtkLacunaTrackedSliceReader> reader;
  const auto messages = lacunaCheck::Watch(reader);
  reader->SetFileName(name.c_str());
  reader->SetMemoryLimit(limit);
  const double preview = Measure("preview", [&] { reader->Update(); });
  int size[3];
  reader->GetOutput()->GetDimensions(size);
  const auto stride = static_cast<int>(reader->GetOutput()->GetSpacing()[2]);
  std::cout << reader->GetPreview() << "\n";
  LACUNA_CHECK(static_cast<double>(size[2]) * SliceSize <= limit * Mebibyte);
  const int more = (frames - 1) / (stride - 1) + 1; // of the next smaller stride
  LACUNA_CHECK(static_cast<double>(more) * SliceSize > limit * Mebibyte);
  LACUNA_CHECK(size[2] == (frames - 1) / stride + 1);
  LACUNA_CHECK_CONTAINS(messages->Warnings, "this is a preview of every " + std::to_string(stride));
  LACUNA_CHECK_CONTAINS(messages->Warnings, "MemoryLimit to ");
  LACUNA_CHECK_THAT(preview < limit * Mebibyte + fields, "memory of the preview");
  const int seen = (block + stride) / stride;
  LACUNA_CHECK(reader->GetOutput()->GetScalarComponentAsDouble(7, 5, seen, 0) ==
    (seen * stride < block + Block ? GetGrey(7, 5, seen * stride) : 0));

  // all slices, but for those that are gated out
  vtkNew<vtkLacunaSweptVolume> volume;
  Prepare(volume, reader->GetOutputPort(), frames);
  const double swept = Measure("volume", [&] { volume->Update(); });
  const double voxels = static_cast<double>(volume->GetOutput()->GetNumberOfPoints());
  const double parts = 80 * Mebibyte; // 32 MiB of slices, and footprints of 16
  LACUNA_CHECK_THAT(swept < 15 * voxels + parts + fields, "memory of the volume");

  vtkNew<vtkLacunaTrackedSliceReader> part;
  part->SetFileName(name.c_str());
  part->SetFrameRange(block - 1, block + Block);
  vtkNew<vtkLacunaSweptVolume> truth;
  Prepare(truth, part->GetOutputPort(), frames);
  truth->Update();
  LACUNA_CHECK(!*part->GetPreview());
  // layers well inside of the block, whose voxels no other slice has to do with
  const auto first = static_cast<std::int64_t>(Step * block / 0.5) + 2;
  const auto last = static_cast<std::int64_t>(Step * (block + Block - 1) / 0.5) - 2;
  LACUNA_CHECK(last - first > 10);
  LACUNA_CHECK(CountDifferences(volume, truth, first, last) == 0);
  int center[3] = { 60, 40, static_cast<int>(first) };
  const vtkIdType id = volume->GetOutput()->ComputePointId(center);
  LACUNA_CHECK(GetArray<unsigned char>(volume, "Intensity")[id] > 0);
  const std::int64_t filled = std::count(GetArray<char>(volume, "vtkValidPointMask"),
    GetArray<char>(volume, "vtkValidPointMask") + volume->GetOutput()->GetNumberOfPoints(), 1);
  LACUNA_CHECK_THAT(static_cast<double>(filled) > 0.97 * voxels, "all slices were taken");

  vtkNew<vtkLacunaTrackedSliceWriter> writer;
  writer->SetInputConnection(reader->GetOutputPort());
  writer->SetFileName(written.c_str());
  const double wrote = Measure("writer", [&] { LACUNA_CHECK(writer->Write() == 1); });
  std::cout << writer->GetFileSize() << " bytes, compressed\n";
  LACUNA_CHECK_THAT(wrote < 120 * Mebibyte + fields, "memory of the writer");

  vtkNew<vtkLacunaTrackedSliceReader> compressed;
  compressed->SetFileName(written.c_str());
  compressed->SetMemoryLimit(limit);
  vtkNew<vtkLacunaGateSlices> gate; // passes all of them
  gate->SetInputConnection(compressed->GetOutputPort());
  gate->SetSpeedLimit(1000);
  vtkNew<vtkLacunaSweptVolume> again;
  Prepare(again, gate->GetOutputPort(), frames);
  const double inflated = Measure("volume of compressed slices", [&] { again->Update(); });
  LACUNA_CHECK_THAT(inflated < 15 * voxels + parts + fields, "memory of compressed slices");
  LACUNA_CHECK(again->GetOutput()->GetNumberOfPoints() == volume->GetOutput()->GetNumberOfPoints());
  LACUNA_CHECK(
    CountDifferences(volume, again, 0, volume->GetOutput()->GetDimensions()[2] - 1) == 0);
  LACUNA_CHECK(!std::strcmp(compressed->GetPreview(), reader->GetPreview()));
  LACUNA_CHECK_THAT(compressed->GetOutput()->GetDimensions()[2] == 1, "the preview was not read");

  std::filesystem::remove(small);
  std::filesystem::remove(name);
  std::filesystem::remove(written);
  return lacunaCheck::Result();
}
