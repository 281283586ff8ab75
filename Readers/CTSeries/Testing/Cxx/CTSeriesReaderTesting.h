// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the tests of the reader share.
#ifndef CTSeriesReaderTesting_h
#define CTSeriesReaderTesting_h

#include "CTTestSeries.h"
#include "lacunaCheck.h"
#include "vtkCallbackCommand.h"
#include "vtkErrorCode.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkLacunaCTSeriesReader.h"
#include "vtkNew.h"
#include "vtkStringArray.h"

#include <filesystem>
#include <string>
#include <unistd.h>

/// A folder that is gone in the end.
struct TemporaryFolder
{
  std::string Path;

  TemporaryFolder()
  {
    static int number = 0;
    this->Path = (std::filesystem::temp_directory_path() /
      ("lacuna ct \xC3\xBC " + std::to_string(getpid()) + " " + std::to_string(++number)))
                   .string();
    std::filesystem::create_directories(this->Path);
  }
  ~TemporaryFolder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(this->Path, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
};

/// A reader of the folder of a series, whose errors and warnings are caught.
struct ReaderOf
{
  TemporaryFolder Temporary;
  std::string Folder = Temporary.Path;
  std::vector<std::string> Files; ///< by slice
  vtkNew<vtkLacunaCTSeriesReader> Reader;
  vtkNew<lacunaCheck::Messages> Messages;
  std::string& Errors = Messages->Errors;
  std::string& Warnings = Messages->Warnings;

  explicit ReaderOf(const CTTestSeries& series)
    : Files(series.Write(Folder))
  {
    this->Reader->SetFileName(this->Folder.c_str());
    this->Messages->Watch(this->Reader);
    // executives repeat what algorithms report
    vtkNew<vtkCallbackCommand> nothing;
    nothing->SetCallback([](vtkObject*, unsigned long, void*, void*) {});
    this->Reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, nothing);
  }

  void ExpectError(const std::string& part, unsigned long code = vtkErrorCode::FileFormatError)
  {
    this->Errors.clear();
    this->Warnings.clear();
    this->Reader->Update();
    LACUNA_CHECK_CONTAINS(this->Errors, part);
    LACUNA_CHECK(this->Reader->GetErrorCode() == code);
    LACUNA_CHECK(this->Reader->GetOutput()->GetNumberOfPoints() == 0);
  }
  void ExpectGood()
  {
    this->Errors.clear();
    this->Warnings.clear();
    this->Reader->Update();
    LACUNA_CHECK_THAT(this->Errors.empty(), this->Errors);
    LACUNA_CHECK(this->Reader->GetOutput()->GetNumberOfPoints() > 0);
  }
  std::string GetNotes() { return Join(this->Reader->GetNotes()); }
  std::string GetSeriesList() { return Join(this->Reader->GetSeriesList()); }

  static std::string Join(vtkStringArray* array)
  {
    std::string all;
    for (vtkIdType i = 0; i < array->GetNumberOfValues(); ++i)
    {
      all += array->GetValue(i) + "\n";
    }
    return all;
  }
};
#endif
