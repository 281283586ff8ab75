// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What the tests of the reader share.
#ifndef OutlineReaderTesting_h
#define OutlineReaderTesting_h

#include "SequenceFile.h"
#include "lacunaCheck.h"
#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkExecutive.h"
#include "vtkLacunaOutlineReader.h"
#include "vtkNew.h"
#include "vtkPolyData.h"

#include <string>

/// A reader of a file on disk, whose errors and warnings are caught.
struct ReaderOf
{
  TemporaryFile File;
  vtkNew<vtkLacunaOutlineReader> Reader;
  vtkNew<lacunaCheck::Messages> Messages;
  std::string& Errors = Messages->Errors;
  std::string& Warnings = Messages->Warnings;

  explicit ReaderOf(const std::string& content, const std::string& name = "Liver.mrk.json")
    : File(name, content)
  {
    this->Reader->SetFileName(this->File.GetPath().c_str());
    this->Messages->Watch(this->Reader);
    vtkNew<vtkCallbackCommand> nothing; // executives repeat what algorithms report
    nothing->SetCallback([](vtkObject*, unsigned long, void*, void*) {});
    this->Reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, nothing);
  }
  vtkPolyData* Update()
  {
    this->Errors.clear();
    this->Warnings.clear();
    this->Reader->Update();
    return this->Reader->GetOutput();
  }
  vtkPolyData* Update(const std::string& content)
  {
    this->File.Write(content);
    this->Reader->Modified();
    return this->Update();
  }
};

inline void CheckPoint(vtkPolyData* outlines, vtkIdType at, double x, double y, double z)
{
  LACUNA_CHECK(at < outlines->GetNumberOfPoints());
  if (at < outlines->GetNumberOfPoints())
  {
    const double* point = outlines->GetPoint(at);
    LACUNA_CHECK(point[0] == x && point[1] == y && point[2] == z);
  }
}
#endif
