// SPDX-License-Identifier: BSD-3-Clause
// A shell with a hole, a piece of thin bone, a head holder and a speck: what is taken away, and that all
// else stays bit by bit.
#include "lacunaCheck.h"
#include "lacunaProvenance.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkFlyingEdges3D.h"
#include "vtkImageData.h"
#include "vtkLacunaSkullBone.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPlaneSource.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkSphereSource.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
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
  LACUNA_CHECK(lacuna::Provenance::Get(output).size() == 1);
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

// A skull of two ellipsoids in a turned, anisotropic grid, not symmetric: a burr hole, a crack, a pinhole, a large
// hole, and no base.
struct Vault
{
  static constexpr double Edges[3] = { 1.1, 1.4, 1.8 };
  static constexpr int Count[3] = { 148, 140, 84 };
  static constexpr double Middle[3] = { 80, 97, 58 };
  static constexpr double Burr[3] = { 0.5, -0.4, 0.768 };
  static constexpr double Large[3] = { -0.6, 0.6, 0.529 };

  // Of the direction from the middle.
  static double Outer(const double d[3])
  {
    return 1 / std::hypot(d[0] / 71, d[1] / 88, d[2] / 78) + 2 * d[0] * d[2];
  }
  static double Inner(const double d[3]) { return Outer(d) - 5 - d[1]; }
  // mm along the sphere of the radius
  static double Distance(const double d[3], const double hole[3], double radius)
  {
    const double norm = std::hypot(hole[0], hole[1], hole[2]);
    return radius *
      std::acos(std::min((d[0] * hole[0] + d[1] * hole[1] + d[2] * hole[2]) / norm, 1.0));
  }
  // How deep a voxel is within the whole skull, and how far from the nearest small hole and from the large one, mm.
  struct Place
  {
    double Depth;
    double Small;
    double Large;
  };
  static Place At(double i, double j, double k)
  {
    const double x[3] = { i * Edges[0] - Middle[0], j * Edges[1] - Middle[1],
      k * Edges[2] - Middle[2] };
    const double r = std::hypot(x[0], x[1], x[2]);
    if (r < 1)
    {
      return { -50, 50, 50 };
    }
    const double d[3] = { x[0] / r, x[1] / r, x[2] / r };
    constexpr double pin[3] = { 0, 0.9, 0.44 };
    const double crack =
      std::max(std::abs(r * (d[1] + 0.2)) - 1.2, Distance(d, Large, r) * -1 + 70);
    const double cracked = std::max(crack, Distance(d, Burr, r) - 60);
    return { std::min({ Outer(d) - r, r - Inner(d), x[2] + 30 }),
      std::min({ Distance(d, Burr, r) - 6, Distance(d, pin, r) - 1.1, cracked }),
      Distance(d, Large, r) - 30 };
  }
  static vtkSmartPointer<vtkImageData> Make()
  {
    auto head = vtkSmartPointer<vtkImageData>::New();
    head->SetExtent(4, Count[0] + 3, -7, Count[1] - 8, 0, Count[2] - 1);
    head->SetSpacing(Edges);
    head->SetOrigin(30, -20, 11);
    head->SetDirectionMatrix(0, -0.8, 0.6, 1, 0, 0, 0, 0.6, 0.8);
    head->AllocateScalars(VTK_SHORT, 1);
    vtkIdType p = 0;
    for (int k = 0; k < Count[2]; ++k)
    {
      for (int j = 0; j < Count[1]; ++j)
      {
        for (int i = 0; i < Count[0]; ++i, ++p)
        {
          const Place at = At(i, j, k);
          const double depth = std::min({ at.Depth, at.Small, at.Large });
          head->GetPointData()->GetScalars()->SetComponent(
            p, 0, std::round(std::clamp(Level + 300 * depth, 40.0, 1100.0)));
        }
      }
    }
    return head;
  }
};

// The isosurface near the small holes is that of a skull without them.
void TestBridge()
{
  const auto head = Vault::Make();
  vtkNew<vtkLacunaSkullBone> bone;
  bone->SetInputData(head);
  bone->Update();
  const auto before = GetValues(bone->GetOutput());
  LACUNA_CHECK(before == GetValues(head));
  LACUNA_CHECK(GetField(bone->GetOutput(), "BridgedVolume") == 0);
  bone->SetBridgeDiameter(13);
  bone->Update();
  const auto after = GetValues(bone->GetOutput());
  const double edge = *std::max_element(Vault::Edges, Vault::Edges + 3);
  int made = 0;
  int open = 0;    // where there must be bone
  int thick = 0;   // where there must be none
  int changed = 0; // far from the small holes
  int darker = 0;
  std::size_t p = 0;
  for (int k = 0; k < Vault::Count[2]; ++k)
  {
    for (int j = 0; j < Vault::Count[1]; ++j)
    {
      for (int i = 0; i < Vault::Count[0]; ++i, ++p)
      {
        const Vault::Place at = Vault::At(i, j, k);
        made += before[p] < Level && after[p] >= Level;
        darker += after[p] < before[p];
        changed += after[p] != before[p] && at.Small > 4 * edge;
        thick += after[p] >= Level && before[p] < Level && at.Depth < -0.5 * edge;
        open += at.Small < 2 && at.Depth > 0.5 * edge && after[p] < Level;
      }
    }
  }
  LACUNA_CHECK(made > 500);
  LACUNA_CHECK(open == 0);
  LACUNA_CHECK(thick == 0);
  LACUNA_CHECK(changed == 0);
  LACUNA_CHECK(darker == 0);
  LACUNA_CHECK_NEAR(GetField(bone->GetOutput(), "BridgedVolume"),
    made * Vault::Edges[0] * Vault::Edges[1] * Vault::Edges[2] / 1000, 1e-9);
  // The surface near the middle of the burr hole, smooth to a fraction of a voxel.
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(bone->GetOutput());
  contour->SetValue(0, Level);
  contour->ComputeScalarsOff();
  contour->ComputeNormalsOff();
  contour->Update();
  int surface = 0;
  double farthest = 0;
  for (vtkIdType n = 0; n < contour->GetOutput()->GetNumberOfPoints(); ++n)
  {
    double x[3];
    double index[3];
    contour->GetOutput()->GetPoint(n, x);
    head->TransformPhysicalPointToContinuousIndex(x, index);
    const Vault::Place at = Vault::At(index[0] - 4, index[1] + 7, index[2]);
    if (at.Small < 2 && at.Large > 10 && at.Depth > -10 && at.Depth < 10)
    {
      ++surface;
      farthest = std::max(farthest, std::abs(at.Depth));
    }
  }
  LACUNA_CHECK(surface > 200);
  LACUNA_CHECK(farthest < 0.5);
  std::cout << made << " voxels made, " << surface << " points, " << farthest << " mm" << std::endl;
  // a burr hole of 12 mm is too wide for 10, a crack is not
  bone->SetBridgeDiameter(10);
  bone->Update();
  const double less = GetField(bone->GetOutput(), "BridgedVolume");
  LACUNA_CHECK(
    less > 0.1 && less < made * Vault::Edges[0] * Vault::Edges[1] * Vault::Edges[2] / 1000 - 0.5);
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
  CheckError(
    [](auto* f) { f->SetLevel(std::nan("")); }, "Level is nan HU; it must be a finite number");
  CheckError([](auto* f) { f->SetBridgeDiameter(20.5); },
    "BridgeDiameter is 20.5 mm; it must be 0 (none) or above 0 and at most 20 mm");
  CheckError([](auto* f) { f->SetBridgeDiameter(-1); }, "0 (none) or above 0 and at most 20");
  CheckError(
    [](auto* f) { f->SetBridgeDiameter(std::nan("")); }, "0 (none) or above 0 and at most 20");
  CheckError([](auto* f) { f->SetBridgeDiameter(5); }, "smooth vault"); // a head of 48 mm
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
  TestBridge();
  TestErrors();
  return lacunaCheck::Result();
}
