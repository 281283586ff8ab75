// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSpoiledData.h"
#include "lacunaTests.h"
#include "lacunaTrial.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace lacunaProperties
{
namespace
{
// Words of the standard library or of VTK's pipeline are no help to anybody.
bool IsPlain(const std::string& text)
{
  static const char* const foreign[] = { "std::", "vector::", "basic_string", "bad_alloc", "stoi",
    "map::at", "array::at", "out of memory", "bad_array" };
  return std::none_of(std::begin(foreign), std::end(foreign),
    [&](const char* word) { return text.find(word) != std::string::npos; });
}

bool HasGeometryOf(vtkImageData* image, vtkImageData* other)
{
  const auto same = [](double a, double b) // -0 and 0, NaN and NaN
  { return a == b || (std::isnan(a) && std::isnan(b)); };
  const double* const direction = image->GetDirectionMatrix()->GetData();
  return std::equal(image->GetExtent(), image->GetExtent() + 6, other->GetExtent()) &&
    std::equal(image->GetSpacing(), image->GetSpacing() + 3, other->GetSpacing()) &&
    std::equal(image->GetOrigin(), image->GetOrigin() + 3, other->GetOrigin()) &&
    std::equal(direction, direction + 9, other->GetDirectionMatrix()->GetData(), same);
}

std::string NameOf(vtkAbstractArray* array)
{
  return array->GetName() ? array->GetName() : "";
}

// So many values from there on, to the last bit.
bool AreSame(
  vtkAbstractArray* a, vtkIdType from, vtkAbstractArray* b, vtkIdType to, vtkIdType count)
{
  if (vtkDataArray::SafeDownCast(a))
  {
    return std::memcmp(a->GetVoidPointer(from), b->GetVoidPointer(to),
             static_cast<std::size_t>(count) * a->GetDataTypeSize()) == 0;
  }
  while (count > 0 && a->GetVariantValue(from).ToString() == b->GetVariantValue(to).ToString())
  {
    ++from, ++to, --count;
  }
  return count == 0; // texts
}

// Any part of the extent is what the whole has there, to the last bit.
std::string TestPart(const Trial& trial, vtkImageData* whole, Dice& dice)
{
  int part[6];
  for (int axis = 0; axis < 3; ++axis)
  {
    const int* extent = whole->GetExtent() + 2 * axis;
    part[2 * axis] = dice.Whole(extent[0], extent[1]);
    part[2 * axis + 1] = dice.Whole(part[2 * axis], extent[1]);
  }
  const vtkSmartPointer<vtkAlgorithm> algorithm = trial.Make();
  algorithm->UpdateInformation();
  algorithm->UpdateExtent(part);
  auto* image = vtkImageData::SafeDownCast(algorithm->GetOutputDataObject(0));
  vtkPointData* arrays = whole->GetPointData();
  if (image->GetPointData()->GetNumberOfArrays() != arrays->GetNumberOfArrays())
  {
    return "a part of the extent has other arrays";
  }
  const int* extent = image->GetExtent();
  for (int axis = 0; axis < 3; ++axis)
  {
    if (extent[2 * axis] > part[2 * axis] || extent[2 * axis + 1] < part[2 * axis + 1])
    {
      return "a part of the extent is not all there";
    }
  }
  for (int a = 0; a < arrays->GetNumberOfArrays(); ++a)
  {
    vtkAbstractArray* all = arrays->GetAbstractArray(a);
    vtkAbstractArray* some = image->GetPointData()->GetAbstractArray(a);
    const std::string name = NameOf(all);
    if (!some || name != NameOf(some) || all->GetDataType() != some->GetDataType() ||
      all->GetNumberOfComponents() != some->GetNumberOfComponents() ||
      some->GetNumberOfTuples() != image->GetNumberOfPoints())
    {
      return "a part of the extent has another array for " + name;
    }
    const vtkIdType row = (part[1] - part[0] + vtkIdType{ 1 }) * all->GetNumberOfComponents();
    for (int k = part[4]; k <= part[5]; ++k)
    {
      for (int j = part[2]; j <= part[3]; ++j)
      {
        int ijk[3] = { part[0], j, k };
        const vtkIdType from = whole->ComputePointId(ijk) * all->GetNumberOfComponents();
        const vtkIdType to = image->ComputePointId(ijk) * all->GetNumberOfComponents();
        if (!AreSame(all, from, some, to, row))
        {
          return "a part of the extent differs in " + name;
        }
      }
    }
  }
  return {};
}

std::string FindFaultInRun(const Trial& trial, vtkAlgorithm* algorithm, const Run& run)
{
  // the source of a spoiled input may complain of what it is to give
  if (!run.Stray.empty() &&
    !(trial.IsSpoiled() && run.Stray.find("vtkTrivialProducer") != std::string::npos))
  {
    return "a stray message: " + run.Stray;
  }
  if (!run.Errors.empty())
  {
    return !run.IsEmpty && !trial.What.KeepsOutput ? "an error and an output: " + run.Errors
      : !IsPlain(run.Errors)                       ? "no plain words: " + run.Errors
                                                   : std::string();
  }
  if (run.IsEmpty)
  {
    // what is empty gives nothing
    const bool isFull = trial.GetInputs().empty() || !IsEmpty(trial.GetInputs()[0]);
    return run.Warnings.empty() && isFull && !trial.IsSpoiled() && !trial.IsHostile()
      ? "no output, no error, no warning"
      : "";
  }
  const Inputs& inputs = trial.GetInputs();
  const bool isFinite = std::all_of(
    inputs.begin(), inputs.end(), [](vtkDataObject* data) { return !data || IsFinite(data); });
  const int ports = trial.What.SetFile ? 0 : algorithm->GetNumberOfOutputPorts();
  for (int port = 0; port < ports; ++port)
  {
    const std::string fault =
      FindFault(algorithm, port, isFinite && !trial.IsHostile(), trial.What.MayBeNaN);
    if (!fault.empty())
    {
      return "output " + std::to_string(port) + ": " + fault;
    }
  }
  if (trial.What.KeepsGeometry &&
    !HasGeometryOf(vtkImageData::SafeDownCast(algorithm->GetOutputDataObject(0)),
      vtkImageData::SafeDownCast(inputs[0])))
  {
    return "the output's geometry is not the input's";
  }
  return {};
}
}

//------------------------------------------------------------------------------
std::string TestOutcome(const Subject& subject, std::uint64_t seed, Account& account)
{
  const Trial trial(subject, seed, Trial::Hostile);
  std::string& story = account.Story;
  story = trial.GetStory();
  std::vector<Fingerprint> before;
  for (vtkDataObject* data : trial.GetInputs())
  {
    before.push_back(TakeFingerprint(data));
  }
  Dice dice(seed + 1);
  const vtkSmartPointer<vtkAlgorithm> algorithm = trial.Make();
  const Run first = trial.Execute(algorithm, 1);
  account.Succeeded = first.Errors.empty() && !first.IsEmpty;
  story += first.Errors.empty() ? "" : "  -> " + first.Errors;
  story += first.Warnings.empty() ? "" : "  -> " + first.Warnings;
  std::string fault = FindFaultInRun(trial, algorithm, first);
  if (!fault.empty())
  {
    return fault;
  }
  // a new algorithm, other threads; then the old one again
  const bool other = dice.Chance(0.5);
  fault = CompareRuns(first, trial.Execute(trial.Make(), other ? 2 : 5));
  if (!fault.empty())
  {
    return std::string(other ? "2" : "5") + " threads: " + fault;
  }
  algorithm->Modified();
  fault = CompareRuns(first, trial.Execute(algorithm, 0));
  if (!fault.empty())
  {
    return "once more: " + fault;
  }
  auto* image =
    subject.SetFile ? nullptr : vtkImageData::SafeDownCast(algorithm->GetOutputDataObject(0));
  if (image && !first.IsEmpty && !IsEmpty(image) && dice.Chance(0.3))
  {
    fault = TestPart(trial, image, dice);
    if (!fault.empty())
    {
      return fault;
    }
  }
  if (!first.Errors.empty() && trial.IsSpoiled())
  {
    trial.Connect(algorithm, true);
    fault = CompareRuns(trial.Execute(trial.Make(true), 1), trial.Execute(algorithm, 1));
    if (!fault.empty())
    {
      return "with sound inputs after the error: " + fault;
    }
  }
  for (std::size_t i = 0; i < before.size(); ++i)
  {
    const std::string changed = Compare(before[i], TakeFingerprint(trial.GetInputs()[i]));
    if (!changed.empty())
    {
      return "input " + std::to_string(i) + " has been changed in " + changed;
    }
  }
  return {};
}
}
