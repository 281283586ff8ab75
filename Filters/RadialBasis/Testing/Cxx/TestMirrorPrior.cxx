// SPDX-License-Identifier: BSD-3-Clause
// A hole on one side of a surface that is symmetric but for known differences, filled with the
// surface's own mirror image as prior: what comes out is known, and how wrong it is.
#include "RBFTestMaps.h"
#include "lacunaCheck.h"
#include "lacunaCoordinates.h"
#include "vtkFieldData.h"
#include "vtkLacunaMirror.h"
#include "vtkLacunaRBFHoleFiller.h"
#include "vtkMath.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

namespace
{
double Bump(double u, double v, double width)
{
  return std::exp(-(u * u + v * v) / (width * width));
}

/// A dome with a nose and, on both sides of an inclined line, a brow of 2.5 mm and a hollow. Patient's own: a
/// slant and a twist, which the margin of the hole shows, and a lump of 0.8 mm on the sound side,
/// which it does not.
struct Face
{
  static constexpr double Hole = 9;    // mm, radius about u = Side, v = 2
  static constexpr double Side = 17;   // mm, on the side without the lump
  static constexpr double LumpU = -19; // mm
  static constexpr double LumpV = 4;   // mm
  static constexpr double LumpWidth = 3;
  lacuna::Vec2 Middle{ 49, 40 };
  lacuna::Vec2 Across{ std::cos(0.2), std::sin(0.2) }; // of the plane of symmetry, map axes

  double GetU(const lacuna::Vec2& p) const
  {
    return (p[0] - this->Middle[0]) * this->Across[0] + (p[1] - this->Middle[1]) * this->Across[1];
  }
  double GetV(const lacuna::Vec2& p) const
  {
    return (p[1] - this->Middle[1]) * this->Across[0] - (p[0] - this->Middle[0]) * this->Across[1];
  }
  bool IsHole(const lacuna::Vec2& p) const
  {
    return std::hypot(this->GetU(p) - Side, this->GetV(p) - 2) <= Hole;
  }
  static double Lump(double u, double v) { return -0.8 * Bump(u - LumpU, v - LumpV, LumpWidth); }
  double GetDepth(const lacuna::Vec2& p) const
  {
    const double u = this->GetU(p);
    const double v = this->GetV(p);
    const double dome = 95 - 75 * std::sqrt(1 - std::pow(u / 60, 2) - std::pow((v + 9) / 85, 2));
    const double brow = -2.5 * (Bump(u - 17, v - 3, 6) + Bump(u + 17, v - 3, 6));
    const double nose = -4 * Bump(u / 0.7, v - 10, 8) + 1.5 * Bump(std::abs(u) - 26, v + 14, 6);
    return dome + brow + nose + 0.004 * u + 0.0001 * u * v + Lump(u, v);
  }
};

struct Errors
{
  double Largest = 0;       // mm
  double RMS = 0;           // mm
  double BesideTheLump = 0; // largest difference of the error from the mirrored lump, mm
  lacuna::Vec2 Worst{ 0, 0 };
};

class Trial
{
public:
  TestMap Map;
  Face Truth;
  vtkNew<vtkLacunaRBFHoleFiller> Filler;

  Trial()
  {
    vtkDataArray* depth = this->Map.Image->GetPointData()->GetArray("Depth");
    for (vtkIdType i = 0; i < depth->GetNumberOfTuples(); ++i)
    {
      const lacuna::Vec2 p = this->Map.GetPosition(i);
      depth->SetComponent(i, 0, this->Truth.GetDepth(p));
      if (this->Truth.IsHole(p))
      {
        this->Map.Invalidate(i);
        this->Hole.push_back(i);
      }
    }
    this->Filler->SetInputData(this->Map.Image);
    this->Filler->SetAccuracy(0);
    this->Filler->SetSupportMargin(7);
  }

  Errors Fill(const char* what)
  {
    const auto messages = lacunaCheck::Watch(this->Filler);
    this->Filler->Update();
    LACUNA_CHECK_THAT(messages->Errors.empty(), messages->Errors);
    LACUNA_CHECK_THAT(messages->Warnings.empty(), messages->Warnings);
    vtkImageData* output = this->Filler->GetOutput();
    LACUNA_CHECK(!lacuna::Coordinates::IsMirrored(output)); // it is the patient, only shaped
    vtkDataArray* depth = output->GetPointData()->GetArray("Depth");
    vtkDataArray* filled = output->GetPointData()->GetArray("FilledMask");
    Errors errors;
    std::size_t marked = 0;
    for (const vtkIdType i : this->Hole)
    {
      marked += filled && filled->GetComponent(i, 0) == 1;
      const lacuna::Vec2 p = this->Map.GetPosition(i);
      const double error =
        (depth ? depth->GetComponent(i, 0) : vtkMath::Nan()) - this->Truth.GetDepth(p);
      const double lump = Face::Lump(-this->Truth.GetU(p), this->Truth.GetV(p));
      errors.RMS += error * error / static_cast<double>(this->Hole.size());
      if (!(std::abs(error) <= errors.Largest))
      {
        errors.Largest = std::abs(error);
        errors.Worst = p;
      }
      if (!(std::abs(error - lump) <= errors.BesideTheLump))
      {
        errors.BesideTheLump = std::abs(error - lump);
      }
    }
    LACUNA_CHECK(marked == this->Hole.size());
    errors.RMS = std::sqrt(errors.RMS);
    std::cout << what << ": largest error " << errors.Largest << " mm, RMS " << errors.RMS
              << " mm, beside the lump " << errors.BesideTheLump << " mm\n";
    return errors;
  }

private:
  std::vector<vtkIdType> Hole;
};
}

int TestMirrorPrior(int, char*[])
{
  Trial trial;
  const Errors plain = trial.Fill("without a prior");
  LACUNA_CHECK(plain.Largest > 1.5); // the brow is not known to the margin

  vtkNew<vtkLacunaMirror> mirror;
  mirror->SetInputData(trial.Map.Image);
  mirror->SetPlaneMethod(vtkLacunaMirror::Given);
  const TestMap& map = trial.Map;
  const Face& face = trial.Truth;
  const lacuna::Vec3 origin = map.Origin + face.Middle[0] * map.Right + face.Middle[1] * map.Down;
  const lacuna::Vec3 at = origin + face.GetDepth(face.Middle) * map.View;
  const lacuna::Vec3 normal = face.Across[0] * map.Right + face.Across[1] * map.Down;
  mirror->SetOrigin(at.data());
  mirror->SetNormal(normal[0], normal[1], normal[2]);
  trial.Filler->SetInputConnection(
    vtkLacunaRBFHoleFiller::PriorSurfacePort, mirror->GetOutputPort());
  const Errors given = trial.Fill("mirrored in the plane");
  // The sound side's lump comes over, on the right place, and nothing else: slant and twist of this
  // side are the residual's. Triangles of 1 x 0.8 mm miss bends of 0.34 / mm by 0.07 mm.
  LACUNA_CHECK(given.BesideTheLump < 0.07);
  LACUNA_CHECK_NEAR(face.GetU(given.Worst), -Face::LumpU, 1);
  LACUNA_CHECK_NEAR(face.GetV(given.Worst), Face::LumpV, 1);
  LACUNA_CHECK_NEAR(given.Largest, 0.8, 0.1);
  LACUNA_CHECK(given.RMS < plain.RMS / 3);

  // What is not symmetric turns and moves the plane that it finds: the brow comes to lie beside its
  // place by twice as much.
  mirror->SetPlaneMethod(vtkLacunaMirror::BestSymmetry);
  const Errors found = trial.Fill("mirrored in the plane that was found");
  lacuna::Vec3 foundNormal{ 0, 0, 0 };
  lacuna::Vec3 foundOrigin{ 0, 0, 0 };
  for (int a = 0; a < 3; ++a)
  {
    vtkFieldData* fields = mirror->GetOutput()->GetFieldData();
    foundNormal[a] = fields->GetArray(lacuna::Coordinates::MirrorNormalName)->GetComponent(0, a);
    foundOrigin[a] = fields->GetArray(lacuna::Coordinates::MirrorOriginName)->GetComponent(0, a);
  }
  const double away = std::abs(Dot(at - foundOrigin, foundNormal));
  const double turned = Norm(Cross(foundNormal, normal));
  std::cout << "the plane is " << away << " mm away and turned by "
            << vtkMath::DegreesFromRadians(turned) << " degrees\n";
  LACUNA_CHECK(away < 0.2 && turned < 0.02);
  // brow and lump rise by 0.36 and 0.23 mm per mm; its brow is 19 mm from the middle
  LACUNA_CHECK(found.BesideTheLump < 0.07 + 2 * (away + 19 * turned) * (0.36 + 0.23));
  LACUNA_CHECK(found.RMS < plain.RMS / 3 && found.Largest < plain.Largest / 2);
  return lacunaCheck::Result();
}
