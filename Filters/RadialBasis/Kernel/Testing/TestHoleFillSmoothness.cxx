// SPDX-License-Identifier: BSD-3-Clause
// How smoothly the surface passes from the bone into the filling: slope and curvature along a line
// across the border of the hole, through nodes.
#include "lacunaHoleFillTest.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

using namespace lacunaHoleFillTest;

namespace
{
constexpr double Fine = 0.05; // mm
constexpr double Border = 30; // mm: the defect begins here, the last node is at 28.5 mm

// The fit along row 27 at steps of Fine.
class Profile
{
public:
  explicit Profile(lacuna::RadialKernel kernel)
  {
    HoleFillOptions options;
    options.Kernel = kernel;
    options.Accuracy = 0;
    options.Solver = lacuna::RadialSolver::Direct;
    options.OutputSpacing = { Fine, 1 };
    const HoleFillResult result = Fill(MakeMap(Sphere), options);
    const std::size_t width = static_cast<std::size_t>(result.Grid.Width);
    for (std::size_t i = 0; i < width; ++i)
    {
      this->Depths.push_back(result.Fitted[27 * width + i]);
    }
  }

  double GetDepth(double x) const { return this->Depths[std::lround(x / Fine)]; }
  double GetSlope(double x, double h) const
  {
    return (this->GetDepth(x + h) - this->GetDepth(x)) / h;
  }
  double GetBend(double x, double h) const
  {
    return (this->GetDepth(x + h) - 2 * this->GetDepth(x) + this->GetDepth(x - h)) / (h * h);
  }
  // The largest change of slope or curvature over a step of h, from 4 mm outside to 4 mm inside.
  double GetSlopeChange(double h) const
  {
    return this->GetLargest(h, [&](double x) { return this->GetSlope(x, h); });
  }
  double GetBendChange(double h) const
  {
    return this->GetLargest(h, [&](double x) { return this->GetBend(x, h); });
  }

private:
  template <class Function>
  double GetLargest(double h, const Function& function) const
  {
    double largest = 0;
    for (double x = Border - 4; x < Border + 4; x += Fine)
    {
      largest = std::max(largest, std::abs(function(x + h) - function(x)));
    }
    return largest;
  }

  std::vector<double> Depths;
};

double GetTrueBend(double x)
{
  const double rest = 90 * 90 - 3 * 3; // of y = 27, 3 mm off the sphere's middle
  return rest / std::pow(rest - (x - 50) * (x - 50), 1.5);
}
}

TEST(HoleFill, PassesTheBorderAsSmoothlyAsItsKernel)
{
  const Profile linear(lacuna::RadialKernel::Linear);
  const Profile plate(lacuna::RadialKernel::ThinPlate);
  const Profile cubic(lacuna::RadialKernel::Cubic);
  const Profile triharmonic(lacuna::RadialKernel::Triharmonic);
  for (const Profile* p : { &linear, &plate, &cubic, &triharmonic })
  {
    std::cout << "slope changes by " << p->GetSlopeChange(0.2) << " in 0.2 mm and "
              << p->GetSlopeChange(0.05) << " in 0.05 mm, curvature by " << p->GetBendChange(0.2)
              << " and " << p->GetBendChange(0.05) << " / mm; curvature in the middle "
              << p->GetBend(45, 0.2) << ", truly " << GetTrueBend(45) << " / mm\n";
  }
  // A continuous slope (curvature) changes in proportion to the step, or nearly.
  for (const Profile* p : { &plate, &cubic, &triharmonic })
  {
    EXPECT_LT(p->GetSlopeChange(0.05), 0.3 * p->GetSlopeChange(0.2));
  }
  for (const Profile* p : { &cubic, &triharmonic })
  {
    EXPECT_LT(p->GetBendChange(0.05), 0.3 * p->GetBendChange(0.2));
    EXPECT_LT(p->GetBendChange(0.2), 0.005 * GetTrueBend(Border));
    EXPECT_NEAR(p->GetBend(Border + 1, 0.2), GetTrueBend(Border + 1), 0.02 * GetTrueBend(Border));
    EXPECT_NEAR(p->GetBend(45, 0.2), GetTrueBend(45), 0.03 * GetTrueBend(45));
  }
  // r^2 log r has a curvature without limit at its node, r a crease.
  EXPECT_GT(plate.GetBendChange(0.05), 0.4 * plate.GetBendChange(0.2));
  EXPECT_GT(linear.GetBendChange(0.05), 3 * linear.GetBendChange(0.2));
}
