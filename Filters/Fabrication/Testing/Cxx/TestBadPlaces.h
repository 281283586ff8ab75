// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Disks and folders that take no file.
#ifndef TestBadPlaces_h
#define TestBadPlaces_h

#include "lacunaCheck.h"
#include "vtkErrorCode.h"

#include <vtksys/Directory.hxx>
#include <vtksys/SystemTools.hxx>

#include <csignal>
#include <fstream>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

/// A disk that is full after 5000 bytes and a read-only folder leave what was there, and no rest of
/// the new file, which has to be larger. place: a folder of the test's own.
template <class Writer>
void TestBadPlaces(Writer* writer, const std::string& place)
{
  vtksys::SystemTools::RemoveADirectory(place);
  vtksys::SystemTools::MakeDirectory(place);
  const std::string path = place + "/a";
  std::ofstream(path) << "old";
  writer->SetFileName(path.c_str());
  const auto refused = [writer](const std::string& words)
  {
    auto messages = lacunaCheck::Watch(writer);
    const int written = writer->Write();
    LACUNA_CHECK_THAT(written == 0 && messages->HasError(words), words + ": " + messages->Errors);
  };
  struct rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  struct rlimit small = before;
  small.rlim_cur = 5000;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  refused("File too large");
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  vtksys::SystemTools::SetPermissions(place, 0555);
  const bool changed = geteuid() == 0 && seteuid(65534) == 0; // root may write everywhere
  refused("Permission denied");
  LACUNA_CHECK(writer->GetErrorCode() == vtkErrorCode::CannotOpenFileError);
  LACUNA_CHECK_THAT(!changed || seteuid(0) == 0, "root again");
  vtksys::SystemTools::SetPermissions(place, 0755);
  LACUNA_CHECK_THAT(vtksys::SystemTools::FileLength(path) == 3, "the old file stays");
  LACUNA_CHECK_THAT(
    vtksys::Directory::GetNumberOfFilesInDirectory(place) == 3, "nothing else (., .., a)");
}
#endif
