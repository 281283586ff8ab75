// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The columns of a table as names and numbers.
#ifndef lacunaPoseColumnReader_h
#define lacunaPoseColumnReader_h

#include "vtkLacunaFiltersCommonModule.h" // for export macro
#include "vtkVariant.h"

#include <string>
#include <vector>

class vtkAbstractArray;
class vtkTable;

namespace lacuna
{
/// Columns of a table that outlives this object; each component of a column with several is a
/// column "name:0", "name:1", ...
class VTKLACUNAFILTERSCOMMON_EXPORT PoseColumnReader
{
public:
  explicit PoseColumnReader(vtkTable* table);

  const std::vector<std::string>& GetNames() const { return this->Names; }
  std::size_t GetNumberOfRows() const { return this->Rows; }

  /// One number for each row; NaN where a text is none.
  std::vector<double> GetNumbers(int column) const;
  /// The numbers of several columns, row by row.
  std::vector<double> GetNumbers(const std::vector<int>& columns) const;

  /// SliceStatus flags of each row. Numbers are flags, 0 valid; text is valid when it is OK, in
  /// upper or lower case. In a column whose name has "valid" every number but 0 is valid, and the
  /// texts true, yes and valid are. Throws std::runtime_error for numbers that are no flags.
  std::vector<unsigned char> GetStatus(int column) const;

private:
  struct Component
  {
    vtkAbstractArray* Array;
    int Index;
  };

  vtkVariant GetValue(int column, std::size_t row) const;

  std::vector<std::string> Names;
  std::vector<Component> Components;
  std::size_t Rows;
};
}
#endif
