// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPoseColumnReader.h"

#include "lacunaTrackedSlices.h"
#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace
{
std::string ToLower(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}
}

//------------------------------------------------------------------------------
lacuna::PoseColumnReader::PoseColumnReader(vtkTable* table)
  : Rows(static_cast<std::size_t>(table->GetNumberOfRows()))
{
  for (vtkIdType c = 0; c < table->GetNumberOfColumns(); ++c)
  {
    vtkAbstractArray* array = table->GetColumn(c);
    const std::string name = array->GetName() ? array->GetName() : "";
    const int components = array->GetNumberOfComponents();
    for (int i = 0; i < components; ++i)
    {
      this->Names.push_back(components > 1 ? name + ":" + std::to_string(i) : name);
      this->Components.push_back({ array, i });
    }
  }
}

//------------------------------------------------------------------------------
vtkVariant lacuna::PoseColumnReader::GetValue(int column, std::size_t row) const
{
  const Component& component = this->Components[column];
  return component.Array->GetVariantValue(
    static_cast<vtkIdType>(row) * component.Array->GetNumberOfComponents() + component.Index);
}

//------------------------------------------------------------------------------
std::vector<double> lacuna::PoseColumnReader::GetNumbers(int column) const
{
  const Component& component = this->Components[column];
  std::vector<double> numbers(this->Rows);
  auto* data = vtkDataArray::SafeDownCast(component.Array);
  for (std::size_t i = 0; i < this->Rows; ++i)
  {
    if (data)
    {
      numbers[i] = data->GetComponent(static_cast<vtkIdType>(i), component.Index);
      continue;
    }
    bool valid = false;
    const double number = this->GetValue(column, i).ToDouble(&valid);
    numbers[i] = valid ? number : std::numeric_limits<double>::quiet_NaN();
  }
  return numbers;
}

//------------------------------------------------------------------------------
std::vector<double> lacuna::PoseColumnReader::GetNumbers(const std::vector<int>& columns) const
{
  std::vector<double> numbers(this->Rows * columns.size());
  for (std::size_t c = 0; c < columns.size(); ++c)
  {
    const std::vector<double> column = this->GetNumbers(columns[c]);
    for (std::size_t i = 0; i < this->Rows; ++i)
    {
      numbers[i * columns.size() + c] = column[i];
    }
  }
  return numbers;
}

//------------------------------------------------------------------------------
std::vector<unsigned char> lacuna::PoseColumnReader::GetStatus(int column) const
{
  const std::string& name = this->Names[column];
  const bool positive = ToLower(name).find("valid") != std::string::npos &&
    ToLower(name).find("invalid") == std::string::npos;
  const bool text = !vtkDataArray::SafeDownCast(this->Components[column].Array);
  const std::vector<double> numbers = this->GetNumbers(column);
  std::vector<unsigned char> status(this->Rows, lacuna::TrackedSlices::Valid);
  for (std::size_t i = 0; i < this->Rows; ++i)
  {
    const double number = numbers[i];
    if (text && std::isnan(number))
    {
      const std::string word = ToLower(this->GetValue(column, i).ToString());
      const bool valid =
        word == "ok" || (positive && (word == "true" || word == "yes" || word == "valid"));
      status[i] = valid ? lacuna::TrackedSlices::Valid : lacuna::TrackedSlices::PoseInvalid;
    }
    else if (positive || std::isnan(number))
    {
      status[i] = number != 0 && !std::isnan(number) ? lacuna::TrackedSlices::Valid
                                                     : lacuna::TrackedSlices::PoseInvalid;
    }
    else if (number >= 0 && number <= 255 && number == std::floor(number))
    {
      status[i] = static_cast<unsigned char>(number);
    }
    else
    {
      std::ostringstream message;
      message << "column '" << name << "' is " << number << " in row " << i
              << "; a state is a whole number from 0 (valid) to 255, or the text OK";
      throw std::runtime_error(message.str());
    }
  }
  return status;
}
