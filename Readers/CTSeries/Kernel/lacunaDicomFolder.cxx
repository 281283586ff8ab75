// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomFolder.h"

#include "lacunaDicomDataSet.h"
#include "lacunaDicomHeader.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <sys/stat.h>
#include <utility>

namespace lacuna
{
namespace
{
namespace fs = std::filesystem;

constexpr std::size_t MostFiles = 200000;
constexpr int MostTried = 200; // files of a folder, until one is CT
constexpr std::size_t MostNamed = 3;

bool IsDirectoryRecord(const fs::path& path)
{
  return path.filename() == "DICOMDIR" || path.filename() == "dicomdir";
}

// Calls visit with each regular file until it returns false.
template <class Visit>
void ForEachFile(const fs::path& folder, bool deep, Visit&& visit)
{
  std::error_code error;
  fs::recursive_directory_iterator file(
    folder, fs::directory_options::skip_permission_denied, error);
  if (error)
  {
    throw std::runtime_error(folder.string() + ": the folder cannot be read: " + error.message());
  }
  std::string last;
  for (; file != fs::recursive_directory_iterator(); file.increment(error))
  {
    if (!deep)
    {
      file.disable_recursion_pending();
    }
    std::error_code ignored;
    if (file->is_regular_file(ignored) && !visit(*file))
    {
      return;
    }
    last = file->path().string();
  }
  if (error)
  {
    throw std::runtime_error(folder.string() + ": the folder cannot be read to its end, only to " +
      last + ": " + error.message());
  }
}

bool IsNamedDicom(const fs::path& path)
{
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
    [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return extension == ".dcm" || extension == ".ima";
}

// "a, b, c and 5 more"
std::string JoinNames(const std::vector<std::string>& paths)
{
  std::string names;
  for (std::size_t i = 0; i < std::min(paths.size(), MostNamed); ++i)
  {
    names += (i == 0 ? "" : ", ") + fs::path(paths[i]).filename().string();
  }
  return paths.size() > MostNamed
    ? names + " and " + std::to_string(paths.size() - MostNamed) + " more"
    : names;
}

bool IsCTFile(const std::string& path)
{
  try
  {
    return IsDicomFile(path) && ReadDicomFile(path).Data.GetText(0x00080060) == "CT";
  }
  catch (const std::exception&)
  {
    return false;
  }
}
}

//------------------------------------------------------------------------------
bool IsCTFileOrFolder(const std::string& path)
{
  std::error_code error;
  if (!fs::is_directory(path, error))
  {
    return IsCTFile(path) || (IsDirectoryRecord(path) && IsDicomFile(path));
  }
  int tried = 0;
  bool found = false;
  try
  {
    ForEachFile(path, true,
      [&](const fs::directory_entry& file)
      {
        found = IsCTFile(file.path().string());
        return !found && ++tried < MostTried;
      });
  }
  catch (const std::exception&)
  {
    return false;
  }
  return found;
}

//------------------------------------------------------------------------------
void DicomFolder::Scan(const std::string& path, Execution& execution)
{
  this->Frames.clear();
  this->Notes.clear();
  this->Warnings.clear();
  this->Opened.clear();
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
  {
    throw std::runtime_error(path + ": there is no such file or folder");
  }
  const bool single = !fs::is_directory(status) && !IsDirectoryRecord(path);
  fs::path folder = path;
  if (!fs::is_directory(status))
  {
    folder = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
  }

  std::map<std::string, Entry> files = this->List(folder, !single);
  ReadNew(files, execution);
  this->Files = std::move(files);
  this->Gather();
  if (single)
  {
    const std::string name = fs::path(path).filename().string();
    for (const auto& file : this->Files)
    {
      if (fs::path(file.first).filename() == name)
      {
        this->Opened = file.first;
      }
    }
  }
}

//------------------------------------------------------------------------------
std::map<std::string, DicomFolder::Entry> DicomFolder::List(
  const std::string& folder, bool deep) const
{
  std::map<std::string, Entry> files;
  ForEachFile(folder, deep,
    [&](const fs::directory_entry& file)
    {
      Entry entry;
      std::string name = file.path().string();
      struct stat state = {};
      ::stat(name.c_str(), &state); // one question for what std::filesystem asks twice
      entry.Size = state.st_size;
      entry.Time = std::int64_t{ state.st_mtim.tv_sec } * 1000000000 + state.st_mtim.tv_nsec;
      entry.Error = "new";
      const auto known = this->Files.find(name);
      const bool same = known != this->Files.end() && known->second.Size == entry.Size &&
        known->second.Time == entry.Time;
      if (same)
      {
        entry = known->second;
      }
      files.emplace(std::move(name), std::move(entry));
      if (files.size() > MostFiles)
      {
        throw std::runtime_error(
          folder + ": holds more than 200000 files; open the folder of one patient");
      }
      return true;
    });
  return files;
}

//------------------------------------------------------------------------------
void DicomFolder::ReadNew(std::map<std::string, Entry>& files, Execution& execution)
{
  std::vector<std::pair<const std::string, Entry>*> fresh;
  for (auto& file : files)
  {
    if (file.second.Error == "new")
    {
      fresh.push_back(&file);
    }
  }
  execution.For(static_cast<std::int64_t>(fresh.size()), 8,
    [&](std::int64_t begin, std::int64_t end)
    {
      for (std::int64_t i = begin; i < end; ++i)
      {
        auto& [name, entry] = *fresh[static_cast<std::size_t>(i)];
        entry.Error.clear();
        entry.IsDicom = true;
        try
        {
          entry.Frames = ReadDicomFrames(name);
        }
        catch (const NotDicomError& e)
        {
          entry.IsDicom = false;
          entry.NoDicom = e.what();
        }
        catch (const std::exception& e)
        {
          entry.Error = e.what();
        }
      }
    });
}

//------------------------------------------------------------------------------
void DicomFolder::Gather()
{
  std::vector<std::string> others;
  std::size_t bare = 0;
  for (const auto& [name, entry] : this->Files)
  {
    if (!entry.IsDicom && IsNamedDicom(name))
    {
      this->Warnings.push_back(
        name + ": is not a DICOM file, though its name says so; the file is left out");
    }
    if (!entry.IsDicom)
    {
      others.push_back(name);
    }
    bare += !entry.Frames.empty() && entry.Frames[0].Header->IsBare ? 1 : 0;
    if (!entry.Error.empty())
    {
      this->Warnings.push_back(entry.Error + "; the file is left out");
    }
    if (!IsDirectoryRecord(name))
    {
      this->Frames.insert(this->Frames.end(), entry.Frames.begin(), entry.Frames.end());
    }
  }
  if (!others.empty())
  {
    this->Notes.push_back(
      std::to_string(others.size()) + " files are no DICOM files: " + JoinNames(others));
  }
  if (bare > 0)
  {
    this->Notes.push_back(std::to_string(bare) +
      " files have no DICOM preamble; their transfer syntax was told from their first elements");
  }
}

//------------------------------------------------------------------------------
std::string DicomFolder::GetOpenedSeries() const
{
  if (this->Opened.empty())
  {
    return {};
  }
  const Entry& entry = this->Files.at(this->Opened);
  if (!entry.Error.empty() || entry.Frames.empty())
  {
    throw std::runtime_error(!entry.Error.empty() ? entry.Error
        : !entry.NoDicom.empty()                  ? entry.NoDicom
                                                  : this->Opened + ": is not a DICOM file");
  }
  const std::string& uid = entry.Frames.front().Header->SeriesUid;
  if (uid.empty())
  {
    throw std::runtime_error(this->Opened + ": has no Series Instance UID (0020,000E)");
  }
  return uid;
}
}
