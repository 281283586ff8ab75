// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the tests of the reader share.
#ifndef TrackedSliceReaderTesting_h
#define TrackedSliceReaderTesting_h

#include "SequenceFile.h"
#include "vtkCallbackCommand.h"
#include "vtkExecutive.h"
#include "vtkLacunaTrackedSliceReader.h"
#include "vtkNew.h"
#include "vtkObject.h"

#include <iostream>
#include <string>

inline int& Failures()
{
  static int failures = 0;
  return failures;
}

#define CHECK(condition)                                                                           \
  if (!(condition))                                                                                \
  {                                                                                                \
    std::cout << __FILE__ << ":" << __LINE__ << ": failed: " #condition "\n";                      \
    ++Failures();                                                                                  \
  }

#define CHECK_CONTAINS(text, part)                                                                 \
  if ((text).find(part) == std::string::npos)                                                      \
  {                                                                                                \
    std::cout << __FILE__ << ":" << __LINE__ << ": '" << (text) << "' lacks '" << (part) << "'\n"; \
    ++Failures();                                                                                  \
  }

/// A reader of a sequence on disk, whose errors and warnings are caught.
struct ReaderOf
{
  TemporaryFile File;
  vtkNew<vtkLacunaTrackedSliceReader> Reader;
  std::string Errors;
  std::string Warnings;

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
    this->Catch(vtkCommand::ErrorEvent, this->Errors);
    this->Catch(vtkCommand::WarningEvent, this->Warnings);
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

private:
  void Catch(unsigned long event, std::string& text)
  {
    vtkNew<vtkCallbackCommand> command;
    command->SetClientData(&text);
    command->SetCallback([](vtkObject*, unsigned long, void* client, void* data)
      { *static_cast<std::string*>(client) += static_cast<const char*>(data); });
    this->Reader->AddObserver(event, command);
  }
};
#endif
