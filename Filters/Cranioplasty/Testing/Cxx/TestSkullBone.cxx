// SPDX-License-Identifier: BSD-3-Clause
// A shell with a hole, a piece of thin bone, a head holder and a speck: what is taken away, and that all
// else stays bit by bit.
#include "lacunaCheck.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaProvenance.h"
#include "vtkLacunaSkullBone.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPlaneSource.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkSphereSource.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

namespace
{
constexpr double Level = 300;
constexpr double Spacing[3] = { 1, 1.2, 1.5 };
constexpr int Size[3] = { 60, 52, 36 };
constexpr int First[3] = { 3, -2, 1 };

enum Shape
{
  Shell,
  Thin,
  Holder,
  Speck
};

// How far (mm) a point, mm along the axes of the grid from its first voxel, is within a shape; rough.
double Inside(int shape, double x, double y, double z)
{
  switch (shape)
  {
    case Shell:
    {
      const double r = std::hypot((x - 30) / 24, (y - 34) / 21, (z - 26) / 18);
      const double shell = 2.5 - std::abs(20 * (r - 0.9));
      const double hole = 6 - std::hypot(x - 30, y - 34);
      return z > 26 ? std::min(shell, -hole) : shell;
    }
    case Thin: // outside of the shell, 2 mm from it
      return 1 - std::hypot(x - 56.5, 0.4 * (y - 34), 0.8 * (z - 26));
    case Holder:
      return 3 - std::hypot(y - 4, 1.2 * (z - 26));
    default:
      return 1.3 - std::hypot(x - 30, y - 34, z - 26);
  }
}

double Value(int shape, double x, double y, double z)
{
  return std::clamp(Level + 500 * Inside(shape, x, y, z), -900.0, 1400.0);
}

vtkSmartPointer<vtkImageData> MakeHead(int type, bool isTurned)
{
  auto head = vtkSmartPointer<vtkImageData>::New();
  head->SetExtent(First[0], First[0] + Size[0] - 1, First[1], First[1] + Size[1] - 1, First[2],
    First[2] + Size[2] - 1);
  head->SetSpacing(Spacing);
  head->SetOrigin(-20, 30, 7);
  if (isTurned)
  {
    head->SetDirectionMatrix(0, -0.8, 0.6, 1, 0, 0, 0, 0.6, 0.8);
  }
  head->AllocateScalars(type, 1);
  head->GetPointData()->GetScalars()->SetName("CT");
  vtkIdType p = 0;
  for (int k = 0; k < Size[2]; ++k)
  {
    for (int j = 0; j < Size[1]; ++j)
    {
      for (int i = 0; i < Size[0]; ++i, ++p)
      {
        double value = -900;
        for (const int shape : { Shell, Thin, Holder, Speck })
        {
          value = std::max(value, Value(shape, i * Spacing[0], j * Spacing[1], k * Spacing[2]));
        }
        head->GetPointData()->GetScalars()->SetComponent(p, 0, std::round(value));
      }
    }
  }
  return head;
}

std::vector<double> GetValues(vtkImageData* image)
{
  vtkDataArray* array = image->GetPointData()->GetScalars();
  std::vector<double> values(array ? array->GetNumberOfTuples() : 0);
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    values[i] = array->GetComponent(static_cast<vtkIdType>(i), 0);
  }
  return values;
}

double GetField(vtkDataObject* data, const char* name)
{
  vtkDataArray* array = data->GetFieldData()->GetArray(name);
  LACUNA_CHECK(array && array->GetNumberOfTuples() == 1);
  return array ? array->GetComponent(0, 0) : 0;
}

bool IsNear(const std::vector<char>& marks, int i, int j, int k)
{
  for (int c = std::max(k - 2, 0); c <= std::min(k + 2, Size[2] - 1); ++c)
  {
    for (int b = std::max(j - 2, 0); b <= std::min(j + 2, Size[1] - 1); ++b)
    {
      for (int a = std::max(i - 2, 0); a <= std::min(i + 2, Size[0] - 1); ++a)
      {
        if (marks[(c * Size[1] + b) * Size[0] + a])
        {
          return true;
        }
      }
    }
  }
  return false;
}

// By the shapes' formulas, and not by what hangs together: all that is expected of the output.
void Compare(vtkImageData* head, vtkImageData* output,
  const std::function<bool(int shape, const double x[3])>& isKept)
{
  const auto before = GetValues(head);
  const auto after = GetValues(output);
  LACUNA_CHECK(before.size() == after.size());
  if (before.size() != after.size())
  {
    return;
  }
  std::vector<char> kept(before.size());
  std::vector<char> removed(before.size());
  double sum = 0;
  int shapes[4] = { 0, 0, 0, 0 };
  std::size_t p = 0;
  for (int k = 0; k < Size[2]; ++k)
  {
    for (int j = 0; j < Size[1]; ++j)
    {
      for (int i = 0; i < Size[0]; ++i, ++p)
      {
        for (const int shape : { Shell, Thin, Holder, Speck })
        {
          if (std::round(Value(shape, i * Spacing[0], j * Spacing[1], k * Spacing[2])) >= Level)
          {
            double x[3];
            head->TransformIndexToPhysicalPoint(i + First[0], j + First[1], k + First[2], x);
            (isKept(shape, x) ? kept : removed)[p] = 1;
            ++shapes[shape];
          }
        }
        sum += kept[p] ? before[p] - Level : 0;
      }
    }
  }
  LACUNA_CHECK(*std::min_element(shapes, shapes + 4) >= 5);
  const auto count = [](const std::vector<char>& marks)
  { return static_cast<double>(std::count(marks.begin(), marks.end(), 1)); };
  const double wanted = Level - sum / count(kept);
  const bool isFloat = head->GetScalarType() == VTK_FLOAT;
  const double lowered = isFloat ? static_cast<float>(wanted) : std::floor(wanted);
  LACUNA_CHECK(lowered < Level && lowered > -900);
  int halo = 0;
  int edge = 0;
  int wrong = 0;
  p = 0;
  for (int k = 0; k < Size[2]; ++k)
  {
    for (int j = 0; j < Size[1]; ++j)
    {
      for (int i = 0; i < Size[0]; ++i, ++p)
      {
        double expected = before[p];
        if (removed[p])
        {
          expected = lowered;
        }
        else if (!kept[p] && IsNear(kept, i, j, k))
        {
          edge += before[p] > lowered;
        }
        else if (!kept[p] && IsNear(removed, i, j, k))
        {
          halo += before[p] > lowered;
          expected = std::min(before[p], lowered);
        }
        wrong += after[p] != expected;
      }
    }
  }
  LACUNA_CHECK(wrong == 0);
  LACUNA_CHECK(halo > 10 && edge > 100);
  LACUNA_CHECK_NEAR(GetField(output, "RemovedVolume"), count(removed) * 1.8 / 1000, 1e-9);
  LACUNA_CHECK(GetField(output, "BoneLevel") == Level);
}

void TestParts(int type, bool isTurned)
{
  const auto head = MakeHead(type, isTurned);
  vtkNew<vtkLacunaSkullBone> bone;
  bone->SetInputData(head);
  bone->Update();
  vtkImageData* output = bone->GetOutput();
  vtkDataArray* scalars = output->GetPointData()->GetScalars();
  LACUNA_CHECK(
    scalars && scalars->GetDataType() == type && scalars->GetName() == std::string("CT"));
  for (int e = 0; e < 6; ++e)
  {
    LACUNA_CHECK(output->GetExtent()[e] == head->GetExtent()[e]);
  }
  for (int e = 0; e < 9; ++e)
  {
    LACUNA_CHECK(
      output->GetDirectionMatrix()->GetData()[e] == head->GetDirectionMatrix()->GetData()[e]);
  }
  LACUNA_CHECK(vtkLacunaProvenance::Get(output).size() == 1);
  Compare(head, output, [](int shape, const double*) { return shape == Shell || shape == Thin; });
}

void TestExclude()
{
  const auto head = MakeHead(VTK_SHORT, true);
  double center[3];
  head->TransformIndexToPhysicalPoint(First[0] + 52, First[1] + 28, First[2] + 17, center);
  vtkNew<vtkSphereSource> flap;
  flap->SetCenter(center);
  flap->SetRadius(9);
  flap->SetThetaResolution(200);
  flap->SetPhiResolution(200);
  vtkNew<vtkLacunaSkullBone> bone;
  bone->SetInputData(head);
  bone->SetExcludeConnection(flap->GetOutputPort());
  bone->Update();
  // the sphere takes a cap of the shell, and all of the thin part
  int capped = 0;
  Compare(head, bone->GetOutput(),
    [&](int shape, const double x[3])
    {
      const bool isOut =
        std::hypot(x[0] - center[0], x[1] - center[1], x[2] - center[2]) > 9 - 1e-3;
      capped += !isOut && shape == Shell;
      return isOut && shape == Shell;
    });
  LACUNA_CHECK(capped > 20);
}

void CheckError(const std::function<void(vtkLacunaSkullBone*)>& set, const std::string& text)
{
  vtkNew<vtkLacunaSkullBone> bone;
  vtkNew<lacunaCheck::Messages> messages;
  messages->Watch(bone);
  messages->Watch(bone->GetExecutive());
  bone->SetInputData(MakeHead(VTK_SHORT, false));
  set(bone);
  bone->Update();
  LACUNA_CHECK(bone->GetOutput()->GetNumberOfPoints() == 0);
  if (messages->Errors.find(text) == std::string::npos)
  {
    lacunaCheck::Fail(__FILE__, __LINE__, "'" + text + "' is not in '" + messages->Errors + "'");
  }
}

void TestErrors()
{
  CheckError([](auto* f) { f->SetLevel(1500); }, "no voxel is at or above Level, 1500");
  CheckError([](auto* f) { f->SetLevel(std::nan("")); }, "finite");
  CheckError(
    [](auto* f)
    {
      vtkNew<vtkImageData> colours;
      colours->SetDimensions(3, 4, 5);
      colours->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
      f->SetInputData(colours);
    },
    "one component");
  CheckError(
    [](auto* f)
    {
      vtkNew<vtkPlaneSource> plane;
      plane->Update();
      f->SetInputData(1, plane->GetOutput());
    },
    "not a closed surface");
  CheckError(
    [](auto* f)
    {
      vtkNew<vtkSphereSource> all;
      all->SetRadius(500);
      all->Update();
      f->SetInputData(1, all->GetOutput());
    },
    "no bone is left");
}
}

int TestSkullBone(int, char*[])
{
  TestParts(VTK_SHORT, false);
  TestParts(VTK_FLOAT, true);
  TestExclude();
  TestErrors();
  return lacunaCheck::Result();
}
