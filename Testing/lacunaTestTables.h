// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Tables of numbers, for tests of filters that take them.
#ifndef lacunaTestTables_h
#define lacunaTestTables_h

#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkTable.h"

#include <string>
#include <vector>

inline void AddColumn(vtkTable* table, const std::string& name, const std::vector<double>& values)
{
  vtkNew<vtkDoubleArray> column;
  column->SetName(name.c_str());
  for (const double value : values)
  {
    column->InsertNextValue(value);
  }
  table->AddColumn(column);
}
#endif
