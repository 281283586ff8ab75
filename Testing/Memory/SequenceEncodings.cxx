// SPDX-License-Identifier: BSD-3-Clause
// Sequences of every format and encoding that are larger than MemoryLimit: previewed, reconstructed
// and written slice by slice, they give what all slices in memory give, bit by bit.
//
//   TestSequenceEncodings <folder>
#include "lacunaCheck.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLacunaSweptVolume.h"
#include "vtkLacunaTrackedSliceReader.h"
#include "vtkLacunaTrackedSliceWriter.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

using lacuna::Matrix4;

namespace
{
constexpr int Columns = 640;
constexpr int Rows = 480;
constexpr int Slices = 90; // 53 MiB: more than are read at a time
constexpr int Limit = 4;   // MiB
using Bytes = std::vector<unsigned char>;

// Of 16 bits with a sign, so that an order of bytes and numbers below 0 count.
vtkSmartPointer<vtkImageData> MakeStack()
{
  auto stack = vtkSmartPointer<vtkImageData>::New();
  stack->SetDimensions(Columns, Rows, Slices);
  stack->AllocateScalars(VTK_SHORT, 1);
  std::vector<Matrix4> poses;
  std::vector<double> times;
  std::vector<int> frames;
  auto* pixel = static_cast<std::int16_t*>(stack->GetScalarPointer());
  for (int k = 0; k < Slices; ++k)
  {
    for (int j = 0; j < Rows; ++j)
    {
      for (int i = 0; i < Columns; ++i)
      {
        *pixel++ = static_cast<std::int16_t>((i * 7 + j * j / 5 + k * 311) % 3000 - 1000);
      }
    }
    poses.push_back(Matrix4::Translation({ 0, 0, 0.2 * k }) *
      Matrix4::Rotation({ 0.3, 1, 0 }, 0.01 * (k % 5)) * Matrix4::Scaling({ 0.1, 0.1, 1 }));
    times.push_back(0.04 * k);
    frames.push_back(k);
  }
  lacuna::TrackedSlices::Write(stack, poses, times, std::vector<unsigned char>(Slices, 0), frames);
  return stack;
}

Bytes ReadFile(const std::string& name)
{
  std::ifstream stream(name, std::ios::binary);
  return { std::istreambuf_iterator<char>(stream), {} };
}

// A raw file with its pixels in another encoding: changes its header, from line to line, and encodes
// what follows it.
void Rewrite(const std::string& from, const std::string& to,
  const std::vector<std::pair<std::string, std::string>>& lines,
  const std::function<std::string(const std::int16_t*, std::size_t)>& encode)
{
  const Bytes raw = ReadFile(from);
  const std::size_t count = std::size_t{ Columns } * Rows * Slices;
  const std::size_t size = raw.size() - count * sizeof(std::int16_t);
  std::string header(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
  for (const auto& [before, after] : lines)
  {
    const std::size_t place = header.find(before + "\n");
    LACUNA_CHECK_THAT(place != std::string::npos, "the header has " + before);
    header.replace(place, before.size(), after);
  }
  std::vector<std::int16_t> pixels(count);
  std::memcpy(pixels.data(), raw.data() + size, count * sizeof(std::int16_t));
  std::ofstream(to, std::ios::binary) << header << encode(pixels.data(), count);
}

std::string ToText(const std::int16_t* pixels, std::size_t count)
{
  std::string text;
  for (std::size_t i = 0; i < count; ++i)
  {
    text += std::to_string(pixels[i]) + (i % 20 == 19 ? '\n' : ' ');
  }
  return text;
}

std::string ToHex(const std::int16_t* pixels, std::size_t count)
{
  constexpr const char* Digits = "0123456789abcdef";
  std::string text;
  for (std::size_t i = 0; i < count; ++i)
  {
    const auto bits = static_cast<std::uint16_t>(pixels[i]);
    for (const int shift : { 4, 0, 12, 8 }) // the low byte first
    {
      text += Digits[bits >> shift & 15];
    }
  }
  return text;
}

std::string ToBigEndian(const std::int16_t* pixels, std::size_t count)
{
  std::string bytes;
  for (std::size_t i = 0; i < count; ++i)
  {
    const auto bits = static_cast<std::uint16_t>(pixels[i]);
    bytes += static_cast<char>(bits >> 8);
    bytes += static_cast<char>(bits & 255);
  }
  return bytes;
}

Bytes GetBytes(vtkImageData* image)
{
  Bytes bytes;
  for (int i = 0; i < image->GetPointData()->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = image->GetPointData()->GetArray(i);
    const auto* values = static_cast<const unsigned char*>(array->GetVoidPointer(0));
    bytes.insert(
      bytes.end(), values, values + array->GetNumberOfValues() * array->GetDataTypeSize());
  }
  return bytes;
}

Bytes MakeVolume(vtkLacunaSweptVolume* volume)
{
  volume->SetOutputSpacing(0.7, 0.7, 0.7);
  volume->Update();
  return GetBytes(volume->GetOutput());
}
}

int main(int argc, char* argv[])
{
  const std::string folder = (argc > 1 ? std::string(argv[1]) : ".") + "/encodings";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const auto path = [&](const std::string& name) { return folder + "/" + name; };

  const auto stack = MakeStack();
  const Bytes pixels = GetBytes(stack);
  vtkNew<vtkLacunaSweptVolume> truth;
  truth->SetInputData(stack);
  const Bytes expected = MakeVolume(truth);
  const vtkIdType voxels = truth->GetOutput()->GetNumberOfPoints();
  const auto* const mask = static_cast<const char*>(
    truth->GetOutput()->GetPointData()->GetArray("vtkValidPointMask")->GetVoidPointer(0));
  LACUNA_CHECK(voxels > 10000 && std::count(mask, mask + voxels, 1) > voxels / 2);

  const std::vector<std::pair<std::string, int>> written = { { "raw.mha", 0 }, { "raw.mhd", 0 },
    { "raw.nrrd", 0 }, { "detached.nhdr", 0 }, { "deflated.mha", 1 }, { "gzip.nrrd", 1 },
    { "packed.nhdr", 1 } };
  std::vector<std::string> names;
  for (const auto& [name, level] : written)
  {
    vtkNew<vtkLacunaTrackedSliceWriter> writer;
    writer->SetInputData(stack);
    writer->SetFileName(path(name).c_str());
    writer->SetCompressionLevel(level);
    LACUNA_CHECK_THAT(writer->Write() == 1, name);
    names.push_back(name);
  }
  const auto derive = [&](const std::string& from, const std::string& to, auto lines, auto encode)
  {
    Rewrite(path(from), path(to), lines, encode);
    names.push_back(to);
  };
  using Lines = std::vector<std::pair<std::string, std::string>>;
  derive("raw.mha", "ascii.mha", Lines{ { "BinaryData = True", "BinaryData = False" } }, ToText);
  derive("raw.nrrd", "ascii.nrrd", Lines{ { "encoding: raw", "encoding: ascii" } }, ToText);
  derive("raw.nrrd", "hex.nrrd", Lines{ { "encoding: raw", "encoding: hex" } }, ToHex);
  derive("raw.nrrd", "big.nrrd", Lines{ { "endian: little", "endian: big" } }, ToBigEndian);

  for (const std::string& name : names)
  {
    vtkNew<vtkLacunaTrackedSliceReader> whole;
    whole->SetFileName(path(name).c_str());
    whole->Update();
    LACUNA_CHECK_THAT(!*whole->GetPreview(), "all slices of " + name);
    LACUNA_CHECK_THAT(GetBytes(whole->GetOutput()) == pixels, "the pixels of " + name);

    vtkNew<vtkLacunaTrackedSliceReader> reader;
    const auto messages = lacunaCheck::Watch(reader);
    reader->SetFileName(path(name).c_str());
    reader->SetMemoryLimit(Limit);
    reader->Update();
    LACUNA_CHECK_CONTAINS(messages->Warnings, "this is a preview of every 15th of 90 slices");
    LACUNA_CHECK_THAT(reader->GetOutput()->GetDimensions()[2] == 6, "a preview of " + name);
    for (int k = 0; k < reader->GetOutput()->GetDimensions()[2]; ++k)
    {
      LACUNA_CHECK_THAT(!std::memcmp(reader->GetOutput()->GetScalarPointer(0, 0, k),
                          stack->GetScalarPointer(0, 0, 15 * k), 2 * Columns * Rows),
        "slice " + std::to_string(k) + " of the preview of " + name);
    }
    vtkNew<vtkLacunaSweptVolume> volume;
    volume->SetInputConnection(reader->GetOutputPort());
    LACUNA_CHECK_THAT(MakeVolume(volume) == expected, "the volume of " + name);

    vtkNew<vtkLacunaTrackedSliceWriter> writer;
    writer->SetInputConnection(reader->GetOutputPort());
    writer->SetFileName(path("copy.mha").c_str());
    writer->SetCompressionLevel(0);
    LACUNA_CHECK_THAT(writer->Write() == 1, name);
    const Bytes copy = ReadFile(path("copy.mha"));
    LACUNA_CHECK_THAT(copy.size() > pixels.size() &&
        std::equal(
          pixels.begin(), pixels.end(), copy.end() - static_cast<std::ptrdiff_t>(pixels.size())),
      "a copy of " + name);
  }
  std::filesystem::remove_all(folder);
  return lacunaCheck::Result();
}
