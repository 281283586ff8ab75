// SPDX-License-Identifier: BSD-3-Clause
// The numbers of scipy's RBFInterpolator.
#include "lacunaRadialBasisTest.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

using namespace lacunaRadialBasisTest;

namespace
{
std::vector<Point3> ReferencePoints()
{
  return Transformed(std::vector<double>{ 0, 1, 2, 3, 4, 5, 6, 7 },
    [](double k) {
      return Point3{ 12 * k - 5, 9 * k - 6, 33 - 5 * k };
    });
}
}

TEST(RadialBasis, AgreesWithScipyIn2D)
{
  // scipy 1.10.1, RBFInterpolator(..., degree=1, smoothing=0 or 50), points (12 k - 5, 9 k - 6)
  struct Case
  {
    RadialKernel Kernel;
    double Smoothing; // scipy's: on the diagonal, for nodes in their own unit
    double Values[8];
  };
  const Case cases[] = {
    { RadialKernel::ThinPlate, 0,
      { -0.678655355389798, 8.93862835393478, 21.2405077942396, 31.7763994534309, 40.8288740984248,
        48.8800729296956, 52.6556946949403, 57.8792749059984 } },
    { RadialKernel::ThinPlate, 50,
      { -0.192645326018322, 9.40182866168088, 21.46333714131, 32.0078257224993, 40.8873078657476,
        48.5929984706919, 53.0403116993781, 58.9986782448802 } },
    { RadialKernel::Linear, 0,
      { 2.91527707864838, 9.89162404172187, 21.5013748867553, 31.8747992749728, 40.9149840302041,
        48.6104683837481, 52.7462932684988, 61.787691704386 } },
    { RadialKernel::Linear, 50,
      { 5.39571020886955, 13.2136984249988, 22.8624624896759, 32.6520252915044, 41.2341041004175,
        48.4867689669802, 55.3971961380841, 64.3361968918948 } },
    { RadialKernel::Cubic, 0,
      { -3.97375699450769, 8.54912457672951, 21.0957623876342, 31.7507065051712, 40.7974130289724,
        48.9353499863187, 52.7212367306091, 53.6362268148826 } },
    { RadialKernel::Cubic, 50,
      { -3.95226230101882, 8.59251898780377, 21.1543107948047, 31.8099685960777, 40.8029073973235,
        48.8948797622167, 52.7710154339524, 53.964284238702 } },
  };
  const std::vector<Point3> nodes3 = ReferenceNodes();
  std::vector<Point2> nodes = Transformed(nodes3,
    [&](const Point3& p) {
      return Point2{ p[0], p[1] };
    });
  const std::vector<Point2> points = Transformed(ReferencePoints(),
    [](const Point3& p) {
      return Point2{ p[0], p[1] };
    });
  for (const Case& c : cases)
  {
    lacuna::RadialBasisOptions options;
    options.Kernel = c.Kernel;
    options.Smoothing = c.Smoothing / lacuna::GetRadialEnergyFactor(c.Kernel);
    const std::vector<double> values =
      Evaluate<2>(Fit<2>(nodes, ReferenceValues(nodes3), options), points);
    for (int k = 0; k < 8; ++k)
    {
      EXPECT_NEAR(values[k], c.Values[k], 1e-10 * 60) << static_cast<int>(c.Kernel) << " " << k;
    }
  }
}

TEST(RadialBasis, AgreesWithScipyForKernelsWithALength)
{
  // epsilon = 1/15, degree=1, smoothing 0 and 0.1; 2-D and 3-D as above
  struct Case
  {
    RadialKernel Kernel;
    double Smoothing;
    double In2D[8];
    double In3D[8];
  };
  const Case cases[] = {
    { RadialKernel::Gaussian, 0,
      { 5.56216136643894, 9.17831629655737, 21.1116920547309, 31.7400332417173, 41.0232889881519,
        49.1824286324345, 52.6492760587631, 61.8776412553371 },
      { 10.6114716592203, 17.5586817124308, 24.5531577296492, 33.0574522142688, 41.4412933981483,
        48.9282199043449, 53.0153404354986, 61.5872212490504 } },
    { RadialKernel::Gaussian, 0.1,
      { 6.13639008648213, 10.1684071299766, 21.4528133305727, 32.0624048734074, 40.8386261030583,
        48.8747935585192, 53.3234291029227, 63.5924278084337 },
      { 10.727920406838, 17.7728282206379, 24.7960645600204, 33.0737868627194, 41.5749020970324,
        48.8721310739911, 53.2574782382396, 62.0771762578205 } },
    { RadialKernel::Multiquadric, 0,
      { -0.0246895614505025, 8.6706976893438, 21.0298504985773, 31.7332681185497, 40.8256745417551,
        49.0336650636264, 52.6918030874923, 56.3796387819426 },
      { 5.70359022732377, 13.7213482886832, 23.5465200097424, 32.9427404799796, 41.0977727591233,
        48.7371366656099, 53.2488734283112, 58.5165653289918 } },
    { RadialKernel::Multiquadric, 0.1,
      { 1.22816328808854, 9.9550011019481, 21.6177451991337, 32.2117848747529, 40.9292754084277,
        48.3451983790275, 53.4923481502332, 60.4187307280803 },
      { 6.65409596798197, 14.6611879177078, 23.7185854276251, 32.9079602294481, 41.3562625606282,
        48.3951117687937, 53.4547118314893, 60.0060649995027 } },
  };
  const std::vector<Point3> nodes3 = ReferenceNodes();
  const std::vector<Point3> points3 = ReferencePoints();
  const auto flat = [](const Point3& p) { return Point2{ p[0], p[1] }; };
  const std::vector<Point2> nodes2 = Transformed(nodes3, flat);
  const std::vector<Point2> points2 = Transformed(points3, flat);
  for (const Case& c : cases)
  {
    lacuna::RadialBasisOptions options;
    options.Kernel = c.Kernel;
    options.Shape = 15;
    options.Smoothing = c.Smoothing;
    const std::vector<double> in2D =
      Evaluate<2>(Fit<2>(nodes2, ReferenceValues(nodes3), options), points2);
    const std::vector<double> in3D =
      Evaluate<3>(Fit<3>(nodes3, ReferenceValues(nodes3), options), points3);
    for (int k = 0; k < 8; ++k)
    {
      EXPECT_NEAR(in2D[k], c.In2D[k], 1e-10 * 60) << static_cast<int>(c.Kernel) << " " << k;
      EXPECT_NEAR(in3D[k], c.In3D[k], 1e-10 * 60) << static_cast<int>(c.Kernel) << " " << k;
    }
  }
}

TEST(RadialBasis, AgreesWithScipyIn3D)
{
  // as in 2-D, points (12 k - 5, 9 k - 6, 33 - 5 k)
  const double expected[3][8] = {
    { 4.93262567166045, 13.7714421357928, 23.5101854556742, 32.815657744407, 41.2709081485725,
      48.7177977049631, 53.1098137255275, 58.5511283441737 },
    { 7.71821490009533, 15.4199171317895, 23.9694363372085, 33.0220125231671, 41.4852099286192,
      48.5873216293172, 53.1309677115243, 60.942359957944 },
    { 1.45529034757249, 12.1869690078542, 23.2783924912451, 32.8117653793574, 41.02700477362,
      48.6802458972429, 53.3155951917787, 56.2851044955532 },
  };
  const std::vector<Point3> nodes = ReferenceNodes();
  const std::vector<Point3> points = ReferencePoints();
  for (int i = 0; i < 3; ++i)
  {
    lacuna::RadialBasisOptions options;
    options.Kernel = Kernels[i];
    const std::vector<double> values =
      Evaluate<3>(Fit<3>(nodes, ReferenceValues(nodes), options), points);
    for (int k = 0; k < 8; ++k)
    {
      EXPECT_NEAR(values[k], expected[i][k], 1e-10 * 60) << i << " " << k;
    }
  }
}
