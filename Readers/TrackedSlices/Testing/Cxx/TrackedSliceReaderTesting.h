// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the tests of the reader share.
#ifndef TrackedSliceReaderTesting_h
#define TrackedSliceReaderTesting_h

#include "SequenceFile.h"
#include "lacunaCheck.h"
#include "vtkCallbackCommand.h"
#include "vtkExecutive.h"
#include "vtkLacunaTrackedSliceReader.h"
#include "vtkNew.h"

#include <filesystem>
#include <string>

/// A reader of a sequence on disk, whose errors and warnings are caught.
struct ReaderOf
{
  TemporaryFile File;
  vtkNew<vtkLacunaTrackedSliceReader> Reader;
  vtkNew<lacunaCheck::Messages> Messages;
  std::string& Errors = Messages->Errors;
  std::string& Warnings = Messages->Warnings;

  explicit ReaderOf(const std::string& content, bool calibrated = true)
    : File("sweep.igs.mha", content)
  {
    this->Reader->SetFileName(this->File.GetPath().c_str());
    if (calibrated)
    {
      this->File.WriteBeside("calibration.xml", MakeCalibration());
      const std::string name = this->GetCalibrationName();
      this->Reader->SetCalibrationFileName(name.c_str());
    }
    this->Messages->Watch(this->Reader);
    // executives repeat what algorithms report
    vtkNew<vtkCallbackCommand> nothing;
    nothing->SetCallback([](vtkObject*, unsigned long, void*, void*) {});
    this->Reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, nothing);
  }
  std::string GetCalibrationName() const
  {
    return (std::filesystem::path(this->File.GetPath()).parent_path() / "calibration.xml").string();
  }
  void Forget()
  {
    this->Errors.clear();
    this->Warnings.clear();
  }
};
#endif
