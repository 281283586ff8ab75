// SPDX-License-Identifier: BSD-3-Clause
// Which data of the input there are, and in whose coordinates they and the file are.
#include "vtkLacunaIGESContent.h"

#include "vtkCompositeDataSet.h"
#include "vtkDataSet.h"
#include "vtkInformation.h"
#include "vtkLacunaCoordinates.h"
#include "vtkLacunaFieldData.h"
#include "vtkLacunaMirrored.h"
#include "vtkLacunaPressPosition.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPartitionedDataSetCollection.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>
#include <stdexcept>

namespace
{
std::string NameOf(vtkInformation* meta, const std::string& otherwise)
{
  const char* name =
    meta && meta->Has(vtkCompositeDataSet::NAME()) ? meta->Get(vtkCompositeDataSet::NAME()) : "";
  return name && *name ? name : otherwise;
}

// The matrix of data from the press; throws when it is no rotation and translation. The block of
// Defect Model has one, for its top, and lies in the patient.
std::optional<lacuna::Matrix4> FindPressToPatient(vtkDataObject* data)
{
  vtkDataArray* array = vtkLacunaFieldData::Find(data, "PressToPatient", 16, 1);
  if (!array || vtkLacunaCoordinates::Get(data) == vtkLacunaCoordinates::Patient)
  {
    return std::nullopt;
  }
  const lacuna::Matrix4 matrix = vtkLacunaFieldData::GetMatrix(array, 0);
  double error = matrix.IsFinite() && matrix.IsAffine() ? 0 : 1;
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      error = std::max(
        error, std::abs(lacuna::Dot(matrix.Column(i), matrix.Column(j)) - (i == j ? 1 : 0)));
    }
  }
  if (!(error <= 1e-6 && matrix.Determinant3() > 0))
  {
    throw std::runtime_error("field data array 'PressToPatient' is not a rotation and translation "
                             "(it scales, shears or mirrors), as Press Orientation gives it");
  }
  return matrix;
}

bool IsSame(const lacuna::Matrix4& a, const lacuna::Matrix4& b)
{
  return std::equal(a.Data(), a.Data() + 16, b.Data());
}
}

//------------------------------------------------------------------------------
void vtkLacunaIGESContent::Collect(vtkDataObject* data, const std::string& name, bool nested)
{
  const auto inner = [&](unsigned int i)
  { return (name.empty() ? "" : name + "/") + "Block " + std::to_string(i); };
  if (auto* blocks = vtkMultiBlockDataSet::SafeDownCast(data))
  {
    for (unsigned int i = 0; i < blocks->GetNumberOfBlocks(); ++i)
    {
      vtkInformation* meta = blocks->HasMetaData(i) ? blocks->GetMetaData(i) : nullptr;
      this->Collect(blocks->GetBlock(i), NameOf(meta, inner(i)), true);
    }
  }
  else if (auto* sets = vtkPartitionedDataSetCollection::SafeDownCast(data))
  {
    for (unsigned int i = 0; i < sets->GetNumberOfPartitionedDataSets(); ++i)
    {
      vtkInformation* meta = sets->HasMetaData(i) ? sets->GetMetaData(i) : nullptr;
      this->Collect(sets->GetPartitionedDataSet(i), NameOf(meta, inner(i)), true);
    }
  }
  else if (auto* parts = vtkPartitionedDataSet::SafeDownCast(data))
  {
    bool empty = parts->GetNumberOfPartitions() > 0;
    for (unsigned int i = 0; i < parts->GetNumberOfPartitions(); ++i)
    {
      vtkDataSet* part = parts->GetPartition(i);
      if (!part || part->GetNumberOfPoints() > 0) // some pieces of a whole may be empty
      {
        this->Collect(part, name.empty() ? inner(i) : name, true);
        empty = false;
      }
    }
    if (empty)
    {
      this->Warnings.push_back("left out: block '" + name + "' is empty");
    }
  }
  else if (data && nested && data->GetNumberOfElements(vtkDataObject::POINT) == 0)
  {
    this->Warnings.push_back("left out: block '" + name + "' is empty");
  }
  else if (data)
  {
    Item item{ data, name, FindPressToPatient(data), {} };
    item.Lost = this->FindLost(
      data, name.empty() ? "" : "block '" + name + "': ", item.PressToPatient.has_value());
    this->Items.push_back(std::move(item));
    if (vtkLacunaMirrored::IsMarked(data))
    {
      const std::string what = (name.empty() ? "the input" : "block '" + name + "'") +
        " is a mirror image of the patient (field data Mirrored)";
      if (!this->Settings.AllowMirrored)
      {
        throw std::runtime_error(what +
          ": nothing made from it fits the side it was taken from. "
          "Turn on AllowMirrored if the mirrored side is what you want");
      }
      this->Warnings.push_back(what + "; the file says so, too");
      this->Description.push_back("MIRROR IMAGE, left is right: " + what + ".");
    }
  }
}

//------------------------------------------------------------------------------
// Why nothing leads from data in a press to the patient; empty when it is known or data lie in none.
std::string vtkLacunaIGESContent::FindLost(
  vtkDataObject* data, const std::string& prefix, bool hasMatrix)
{
  std::string moved;
  try
  {
    moved = vtkLacunaPressPosition::Check(data);
  }
  catch (const std::runtime_error& e)
  {
    throw std::runtime_error(prefix + e.what());
  }
  const bool asGiven = this->Settings.Frame == AsGiven;
  if (!moved.empty())
  {
    if (!asGiven) // PressToPatient would be used
    {
      throw std::runtime_error(prefix + moved + ", or write it where it is (Coordinates AsGiven)");
    }
    this->Warnings.push_back(prefix + moved);
    return "it was MOVED since it was made for the press";
  }
  if (hasMatrix || vtkLacunaCoordinates::Get(data) != vtkLacunaCoordinates::Press)
  {
    return {};
  }
  const bool before = vtkLacunaFieldData::Find(data, vtkLacunaPressPosition::MovedName, 1, 1);
  std::string why = before ? "what it is made of was MOVED since it was made for the press"
                           : "it has no PressToPatient";
  if (!asGiven)
  {
    throw std::runtime_error(prefix +
      "these are the coordinates of a press (field data "
      "Coordinates), and nothing says where the patient is: " +
      why + ". Write it where it is (Coordinates AsGiven)");
  }
  return why;
}

//------------------------------------------------------------------------------
// Decides on the frame of the file and how each item gets there.
void vtkLacunaIGESContent::PlaceItems()
{
  const Item* press = nullptr;
  const Item* patient = nullptr;
  const Item* lost = nullptr;
  for (const Item& item : this->Items)
  {
    if (!item.Lost.empty())
    {
      lost = &item;
      continue;
    }
    if (!item.PressToPatient)
    {
      patient = &item;
      continue;
    }
    if (press && this->Settings.Frame != Patient &&
      !IsSame(*press->PressToPatient, *item.PressToPatient))
    {
      throw std::runtime_error("blocks '" + press->Name + "' and '" + item.Name +
        "' lie in different presses (PressToPatient differs); set Coordinates to Patient, or write "
        "two files");
    }
    press = press ? press : &item;
  }
  if (press && patient && this->Settings.Frame == AsGiven)
  {
    throw std::runtime_error("block '" + press->Name +
      "' is in the coordinates of the press (PressToPatient), block '" + patient->Name +
      "' is not; set Coordinates to Patient or Press to bring them together");
  }
  if (lost && patient) // AsGiven, see FindLost
  {
    throw std::runtime_error("block '" + lost->Name + "' lies in a press and block '" +
      patient->Name + "' does not, and nothing brings them together: of the first one " +
      lost->Lost + "; write two files");
  }
  if (!press && this->Settings.Frame == Press)
  {
    throw std::runtime_error("Coordinates is Press, but no input says where the press is (field "
                             "data PressToPatient, as Press Orientation gives it)");
  }
  const bool inPress = press && this->Settings.Frame != Patient;
  for (Item& item : this->Items)
  {
    if (!item.Lost.empty())
    {
      continue; // it stays where it is
    }
    if (inPress && !item.PressToPatient)
    {
      item.ToFile = press->PressToPatient->Inverse();
    }
    else if (!inPress && item.PressToPatient)
    {
      item.ToFile = *item.PressToPatient;
    }
  }
  this->DescribeFrame(inPress ? press : nullptr);
}

//------------------------------------------------------------------------------
bool vtkLacunaIGESContent::Item::IsPatient() const
{
  return this->Lost.empty() &&
    (this->PressToPatient ? vtkLacunaCoordinates::GetBeforePress(this->Data)
                          : vtkLacunaCoordinates::Get(this->Data)) == vtkLacunaCoordinates::Patient;
}

//------------------------------------------------------------------------------
// For people, in the file: nobody may take for the patient's what is not known to be. press: whose
// coordinates the file has, or nullptr.
void vtkLacunaIGESContent::DescribeFrame(const Item* press)
{
  std::string unknown;
  bool any = false;
  bool allLost = true;
  for (const Item& item : this->Items)
  {
    any = any || item.IsPatient();
    allLost = allLost && !item.Lost.empty();
    if (!item.Lost.empty())
    {
      this->Description.push_back("The way to the patient is NOT KNOWN" +
        (item.Name.empty() ? "" : " for '" + item.Name + "'") + ": " + item.Lost + '.');
    }
    else if (!item.IsPatient() && !item.Name.empty())
    {
      unknown += (unknown.empty() ? "'" : ", '") + item.Name + "'";
    }
  }
  if (any && !unknown.empty())
  {
    this->Description.push_back("NOT KNOWN to be placed by the patient's coordinates: " + unknown +
      " (no mark says whose theirs are).");
  }
  if (allLost)
  {
    this->Description.emplace_back("Coordinates of the input, in mm.");
    return;
  }
  if (!press)
  {
    this->Description.emplace_back(any
        ? "Coordinates of the patient (DICOM LPS: left, back, up), in mm, by the input's mark."
        : "Coordinates of the input, in mm; not known whose they are (it has no mark).");
    return;
  }
  this->Description.emplace_back("Coordinates of the press, in mm: z is up, towards the mill.");
  this->Description.emplace_back(press->IsPatient()
      ? "To patient coordinates (DICOM LPS) by a matrix of the rows"
      : "To the input's coordinates (not known whose) by a matrix of the rows");
  for (int row = 0; row < 3; ++row)
  {
    // a row in a line of 72 characters
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << std::fixed << std::setprecision(12);
    for (int column = 0; column < 4; ++column)
    {
      text << ' ' << std::setw(column < 3 ? 16 : 18) << (*press->PressToPatient)(row, column);
    }
    this->Description.push_back(text.str());
  }
}
