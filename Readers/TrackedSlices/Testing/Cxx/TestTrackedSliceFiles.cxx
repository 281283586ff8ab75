// SPDX-License-Identifier: BSD-3-Clause
// What the system refuses is said with the file's name and the reason, and nothing is lost; of a
// raw file no more is read than is asked for.
#include "TrackedSliceReaderTesting.h"
#include "vtkErrorCode.h"
#include "vtkImageData.h"
#include "vtkLacunaTrackedSliceWriter.h"

#include <algorithm>
#include <fstream>
#include <set>

#include <sys/stat.h>
#include <unistd.h>

namespace
{
/// For its lifetime the test is someone who may not do everything.
class Nobody
{
public:
  Nobody()
    : Changed(geteuid() == 0 && seteuid(65534) == 0)
  {
  }
  ~Nobody()
  {
    if (this->Changed && seteuid(0) != 0)
    {
      lacunaCheck::Fail(__FILE__, __LINE__, "cannot be root again");
    }
  }

private:
  bool Changed;
};

std::filesystem::path FolderOf(const ReaderOf& test)
{
  return std::filesystem::path(test.File.GetPath()).parent_path();
}

std::set<std::string> List(const std::filesystem::path& folder)
{
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
  {
    names.insert(entry.path().filename().string());
  }
  return names;
}

void ExpectReadError(ReaderOf& test, const std::string& file, const std::string& reason)
{
  test.Forget();
  test.Reader->Modified();
  test.Reader->Update();
  LACUNA_CHECK_CONTAINS(test.Errors, file);
  LACUNA_CHECK_CONTAINS(test.Errors, reason);
  LACUNA_CHECK(test.Reader->GetErrorCode() != vtkErrorCode::NoError);
  LACUNA_CHECK(test.Reader->GetOutput()->GetNumberOfPoints() == 0);
}

void TestUnreadable()
{
  ReaderOf test(MakeSequence().GetContent());
  const auto folder = FolderOf(test);
  const std::string sweep = test.File.GetPath();
  const auto read = [&](const std::string& name) { test.Reader->SetFileName(name.c_str()); };

  std::filesystem::create_directory(folder / "folder.mha");
  read((folder / "folder.mha").string());
  ExpectReadError(test, "folder.mha", "is not a file but a folder");
  if (std::filesystem::exists("/proc/self/mem")) // a file that gives an error when it is read
  {
    read("/proc/self/mem");
    ExpectReadError(test, "/proc/self/mem", "Input/output error");
  }
  if (std::filesystem::exists("/dev/zero"))
  {
    read("/dev/zero");
    ExpectReadError(test, "/dev/zero", "a device or pipe");
  }
  {
    chmod(sweep.c_str(), 0);
    const Nobody nobody;
    read(sweep);
    ExpectReadError(test, "sweep.igs.mha", "cannot be opened for reading: Permission denied");
    LACUNA_CHECK(!test.Reader->CanReadFile(sweep.c_str()));
  }
  chmod(sweep.c_str(), 0644);
  {
    chmod(folder.c_str(), 0);
    const Nobody nobody;
    ExpectReadError(test, "sweep.igs.mha", "Permission denied");
  }
  chmod(folder.c_str(), 0755);

  // the pixels
  SequenceFile detached = MakeSequence();
  for (const bool compressed : { false, true })
  {
    detached.DataFile = "pixels.raw";
    detached.Set("CompressedData", compressed ? "True" : "False");
    test.File.WriteBeside("detached.mhd", detached.GetContent());
    read((folder / "detached.mhd").string());
    ExpectReadError(test, "pixels.raw", "there is no such file");
    std::filesystem::create_directory(folder / "pixels.raw");
    ExpectReadError(test, "detached.mhd: the file of its pixels", "is not a file but a folder");
    std::filesystem::remove(folder / "pixels.raw");
    test.File.WriteBeside("pixels.raw", detached.Pixels);
    chmod((folder / "pixels.raw").c_str(), 0);
    {
      const Nobody nobody;
      ExpectReadError(test, "pixels.raw", "Permission denied");
    }
    std::filesystem::remove(folder / "pixels.raw");
  }

  // the calibration
  read(sweep);
  chmod(test.GetCalibrationName().c_str(), 0);
  {
    const Nobody nobody;
    ExpectReadError(test, "calibration.xml", "Permission denied");
  }
  test.Reader->SetCalibrationFileName(folder.c_str());
  ExpectReadError(test, "the calibration file '" + folder.string(), "a folder");

  test.Reader->SetCalibrationFileName(nullptr);
  test.Forget();
  test.Reader->Update();
  LACUNA_CHECK_THAT(test.Errors.empty(), test.Errors);
  LACUNA_CHECK(test.Reader->GetOutput()->GetNumberOfPoints() == 60);
}

void ExpectWriteError(
  ReaderOf& test, const std::string& path, const std::string& reason, unsigned long code)
{
  for (const int level : { 0, 1 })
  {
    vtkNew<vtkLacunaTrackedSliceWriter> writer;
    writer->SetInputConnection(test.Reader->GetOutputPort());
    writer->SetFileName(path.c_str());
    writer->SetCompressionLevel(level);
    const auto messages = lacunaCheck::Watch(writer);
    LACUNA_CHECK(writer->Write() == 0);
    LACUNA_CHECK_CONTAINS(messages->Errors, path.substr(0, path.size() - 4)); // .mhd or its .raw
    LACUNA_CHECK_CONTAINS(messages->Errors, reason);
    LACUNA_CHECK(writer->GetErrorCode() == code && writer->GetFileSize() == 0);
  }
}

void TestUnwritable()
{
  ReaderOf test(MakeSequence().GetContent());
  test.Reader->Update();
  const auto folder = FolderOf(test);
  const auto cannotOpen = vtkErrorCode::CannotOpenFileError;
  for (const std::string kind : { ".mha", ".mhd", ".nrrd", ".nhdr" })
  {
    const std::string path = (folder / ("old" + kind)).string();
    test.File.WriteBeside("old" + kind, "what was there before");
    test.File.WriteBeside("old.raw", "and its pixels");
    const auto before = List(folder);
    {
      const Nobody nobody; // may neither make files in the folder nor write over this one
      ExpectWriteError(test, path, "Permission denied", cannotOpen);
      ExpectWriteError(test, (folder / ("new" + kind)).string(), "Permission denied", cannotOpen);
    }
    const std::string folderPath = (folder / ("folder" + kind)).string();
    std::filesystem::create_directory(folderPath);
    ExpectWriteError(test, folderPath, "Is a directory", cannotOpen);
    std::filesystem::remove(folderPath);
    if (std::filesystem::exists("/proc/self")) // read-only also for root
    {
      ExpectWriteError(test, "/proc/self/sweep" + kind, "No such file", cannotOpen);
    }
    if (std::filesystem::exists("/dev/full"))
    {
      const auto link = folder / ("full" + kind);
      std::filesystem::create_symlink("/dev/full", link);
      ExpectWriteError(test, link.string(), "No space left", vtkErrorCode::OutOfDiskSpaceError);
      LACUNA_CHECK(std::filesystem::is_symlink(link));
      std::filesystem::remove(link);
    }
    LACUNA_CHECK(ReadAll(path) == "what was there before");
    LACUNA_CHECK(ReadAll((folder / "old.raw").string()) == "and its pixels");
    LACUNA_CHECK(List(folder) == before); // nor is anything left over
  }
}

// Pixels in a file of their own may have been there before.
void TestNeighbours()
{
  ReaderOf test(MakeSequence().GetContent());
  const auto folder = FolderOf(test);
  const auto write = [&](const std::string& name, int level)
  {
    vtkNew<vtkLacunaTrackedSliceWriter> writer;
    writer->SetInputConnection(test.Reader->GetOutputPort());
    writer->SetFileName((folder / name).c_str());
    writer->SetCompressionLevel(level);
    const auto messages = lacunaCheck::Watch(writer);
    LACUNA_CHECK(writer->Write() == 1);
    return messages->Warnings;
  };
  LACUNA_CHECK(write("a.mhd", 0).empty());
  LACUNA_CHECK(write("a.mhd", 0).empty());
  LACUNA_CHECK_CONTAINS(write("a.mhd", 1), "a.raw' was there before; this header does not name it");
  ReaderOf copy("");
  copy.Reader->SetFileName((folder / "a.mhd").c_str());
  copy.Reader->Update();
  LACUNA_CHECK_THAT(copy.Errors.empty(), copy.Errors);
  std::filesystem::remove(folder / "a.raw");
  LACUNA_CHECK(write("a.nhdr", 1).empty()); // .zraw and .raw.gz
  LACUNA_CHECK_CONTAINS(write("a.nhdr", 0), "a.raw.gz' was there before");
  std::filesystem::remove(folder / "a.raw.gz");
  std::filesystem::remove(folder / "a.zraw");
  LACUNA_CHECK_CONTAINS(write("a.mhd", 0), "have been written over; if '");
  LACUNA_CHECK(write("a.mha", 0).empty() && write("a.nrrd", 1).empty());
  LACUNA_CHECK(write("B.MHD", 1).empty()); // extensions in any case
  LACUNA_CHECK(std::filesystem::exists(folder / "B.zraw"));
  copy.Reader->SetFileName((folder / "B.MHD").c_str());
  copy.Reader->Update();
  LACUNA_CHECK_THAT(copy.Errors.empty(), copy.Errors);
  LACUNA_CHECK(copy.Reader->GetOutput()->GetNumberOfPoints() == 60);
}

/// Bytes that this process has asked files for; -1 where that cannot be known.
std::int64_t GetBytesRead()
{
  std::ifstream stream("/proc/self/io");
  std::string name;
  std::int64_t count = -1;
  return stream >> name >> count && name == "rchar:" ? count : -1;
}

// FrameRange and FrameStride read what they say: 4 MiB of pixels, slices of 64 KiB.
void TestBytesRead()
{
  constexpr int size = 256;
  constexpr std::int64_t slice = size * size;
  if (GetBytesRead() < 0)
  {
    std::cerr << "/proc/self/io is not there: bytes are not counted\n";
    return;
  }
  SequenceFile file = MakeSequence(64, size, size);
  const std::string pixels = file.Pixels;
  for (const bool local : { true, false })
  {
    file.DataFile = local ? "LOCAL" : "pixels.raw";
    ReaderOf test(file.GetContent());
    test.File.WriteBeside("pixels.raw", pixels);
    const auto header = static_cast<std::int64_t>(file.GetHeader().size());
    const auto expect = [&](std::int64_t slices)
    {
      test.Reader->Modified();
      const std::int64_t before = GetBytesRead();
      test.Reader->Update();
      const std::int64_t bytes = GetBytesRead() - before;
      LACUNA_CHECK_THAT(test.Errors.empty(), test.Errors);
      LACUNA_CHECK(test.Reader->GetOutput()->GetDimensions()[2] == slices);
      // the header, the calibration and what buffers and this test's own look at the count take
      const std::int64_t most = slices * slice + 2 * header + (1 << 16);
      LACUNA_CHECK_THAT(bytes >= slices * slice && bytes <= most,
        std::to_string(bytes) + " bytes for " + std::to_string(slices) + " slices");
    };
    test.Reader->SetFrameRange(60, 60);
    expect(1);
    test.Reader->SetFrameRange(10, 13);
    expect(4);
    test.Reader->SetFrameRange(3, -1);
    test.Reader->SetFrameStride(20);
    expect(4); // 3, 23, 43, 63
    test.Reader->SetFrameRange(0, -1);
    test.Reader->SetFrameStride(1);
    expect(64);
    // a replay reads the slices that come next
    test.Reader->ReplayInTimeOn();
    test.Reader->UpdateTimeStep(20.25); // slices 0 to 10
    const std::int64_t before = GetBytesRead();
    test.Reader->UpdateTimeStep(22.25);
    LACUNA_CHECK(GetBytesRead() - before < 2 * slice + (1 << 14));
  }
}
}

int TestTrackedSliceFiles(int, char*[])
{
  TestUnreadable();
  TestUnwritable();
  TestNeighbours();
  TestBytesRead();
  return lacunaCheck::Result();
}
