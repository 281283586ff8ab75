// SPDX-License-Identifier: BSD-3-Clause
/// Each digit of good matrices is damaged in turn: what moves a pixel is told.
#include "lacunaGeometryGate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

using namespace lacuna;

namespace
{
constexpr double Moved = 0.5; // mm
constexpr double Columns = 640;
constexpr double Rows = 480;

using Texts = std::vector<std::string>; // 16 numbers

Texts Write(const Matrix4& matrix, const char* format)
{
  Texts texts;
  for (int i = 0; i < 16; ++i)
  {
    char text[64];
    std::snprintf(text, sizeof text, format, matrix.Data()[i]);
    texts.emplace_back(text);
  }
  return texts;
}

// False when the text is not one number: readers refuse it.
bool Read(const std::string& text, double& number)
{
  char* end = nullptr;
  number = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0';
}

Matrix4 Read(const Texts& texts)
{
  Matrix4 matrix;
  for (int i = 0; i < 16; ++i)
  {
    EXPECT_TRUE(Read(texts[i], matrix(i / 4, i % 4)));
  }
  return matrix;
}

// Each digit replaced by each other one; the sign, the point and the exponent dropped, one each.
Texts Damage(const std::string& text)
{
  Texts damaged;
  for (std::size_t i = 0; i < text.size(); ++i)
  {
    if (std::isdigit(static_cast<unsigned char>(text[i])))
    {
      for (char digit = '0'; digit <= '9'; ++digit)
      {
        damaged.push_back(text);
        damaged.back()[i] = digit;
      }
    }
    else
    {
      damaged.push_back(text.substr(0, i) + (text[i] == 'e' ? "" : text.substr(i + 1)));
    }
  }
  return damaged;
}

// The largest distance that a point moves, mm.
double GetMove(const Matrix4& good, const Matrix4& bad, const std::vector<Vec3>& points)
{
  double largest = 0;
  for (const Vec3& p : points)
  {
    largest = std::max(largest, Norm(bad.Point(p) - good.Point(p)));
  }
  return largest;
}

struct Tally
{
  int Moves = 0;     ///< damages of axes or the last row that move a point
  int Silent = 0;    ///< of these, those that the gate passes
  int Positions = 0; ///< damages of the position: no matrix alone tells of them
  std::string Worst;
};

template <class Check>
void DamageEach(const Matrix4& exact, const char* format, const std::vector<Vec3>& points,
  const Check& check, Tally& tally)
{
  const Texts texts = Write(exact, format);
  const Matrix4 good = Read(texts);
  ASSERT_FALSE(check(good)) << check(good).Text;
  for (int i = 0; i < 16; ++i)
  {
    for (const std::string& damage : Damage(texts[i]))
    {
      Matrix4 bad = good;
      double& element = bad(i / 4, i % 4);
      // the last row places nothing: any change of it shows damage
      const bool moves = Read(damage, element) &&
        (i >= 12 ? std::abs(element - good.Data()[i]) > 1e-8 : GetMove(good, bad, points) > Moved);
      if (moves && i % 4 == 3 && i < 12)
      {
        ++tally.Positions;
      }
      else if (moves)
      {
        ++tally.Moves;
        if (!check(bad))
        {
          ++tally.Silent;
          tally.Worst += texts[i] + " as " + damage + " moves " +
            std::to_string(GetMove(good, bad, points)) + " mm; ";
        }
      }
    }
  }
}

std::vector<Matrix4> MakeRotations()
{
  std::vector<Matrix4> rotations{ Matrix4(), Matrix4::Rotation({ 0, 0, 1 }, std::acos(-1.0) / 2),
    Matrix4::Rotation({ 1, 0, 0 }, std::acos(-1.0)), Matrix4::Rotation({ 0, 1, 0 }, 2e-5),
    Matrix4::Rotation({ 1, 1, 1 }, 2 * std::acos(-1.0) / 3), Matrix4::Rotation({ 1, 2, 3 }, 3e-3) };
  std::mt19937 random(48);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < 6; ++i)
  {
    rotations.push_back(
      Matrix4::Rotation({ any(random), any(random), any(random) }, 3.1 * any(random)));
  }
  return rotations;
}

// As programs write them: PLUS 6 digits, others 4 or 6 decimals, float32 and double in full.
constexpr const char* Formats[] = { "%.6g", "%.4f", "%.6f", "%.17g", "%.10e" };
}

TEST(GeometryGate, NoDamagedDigitOfAPosePassesInSilence)
{
  // a picture of 128 x 96 mm on a probe, its farthest corner 300 mm from the sensor
  const std::vector<Vec3> points{ { 40, 20, 250 }, { -88, 20, 250 }, { 40, 116, 250 },
    { -88, 140, 250.3 } };
  ASSERT_NEAR(Norm(points[3]), 300, 0.1);
  Tally tally;
  for (const Matrix4& rotation : MakeRotations())
  {
    for (const char* format : Formats)
    {
      DamageEach(Matrix4::Translation({ 123.456, -87.6543, 0.0123456 }) * rotation, format, points,
        CheckPose, tally);
    }
  }
  EXPECT_EQ(tally.Silent, 0) << tally.Worst.substr(0, 2000);
  EXPECT_GT(tally.Moves, 10000);
  EXPECT_GT(tally.Positions, 1000);
}

TEST(GeometryGate, NoDamagedDigitOfACalibrationPassesInSilence)
{
  const std::vector<Vec3> points{ { 0, 0, 0 }, { Columns, 0, 0 }, { 0, Rows, 0 },
    { Columns, Rows, 0 } };
  Tally tally;
  for (const Matrix4& rotation : MakeRotations())
  {
    for (const Vec2& pixel : { Vec2{ 0.2, 0.2 }, Vec2{ 0.0854, 0.079 }, Vec2{ 0.1936, 0.1841 } })
    {
      for (const double third : { (pixel[0] + pixel[1]) / 2, std::sqrt(pixel[0] * pixel[1]), 1.0 })
      {
        if (third == 1 && pixel[0] != pixel[1])
        {
          continue; // warned of as it is
        }
        for (const char* format : { "%.6g", "%.6f", "%.10e" })
        {
          DamageEach(Matrix4::Translation({ 12.3456, -87.6543, 0.0123456 }) * rotation *
              Matrix4::Scaling({ pixel[0], pixel[1], third }),
            format, points, CheckImage, tally);
        }
      }
    }
  }
  EXPECT_EQ(tally.Silent, 0) << tally.Worst.substr(0, 2000);
  EXPECT_GT(tally.Moves, 10000);
}

TEST(GeometryGate, WithoutAThirdColumnTheSidesConfirmEachOther)
{
  EXPECT_FALSE(CheckImage(Matrix4::Scaling({ 0.2, 0.2001, 1 })));
  for (const Vec2& pixel :
    { Vec2{ 0.2, 0.2005 }, Vec2{ 0.2, 0.21 }, Vec2{ 0.29, 0.2 }, Vec2{ 0.1, 0.3 } })
  {
    const GeometryFinding finding = CheckImage(Matrix4::Scaling({ pixel[0], pixel[1], 1 }));
    EXPECT_EQ(finding.Fault, GeometryFault::Inexact);
    EXPECT_NE(finding.Text.find("third column does not confirm: it is 1 long, not their mean"),
      std::string::npos)
      << finding.Text;
    EXPECT_NE(finding.Advice.find("the depth scale in the picture"), std::string::npos);
  }
}

TEST(GeometryGate, AChainIsJudgedAsAWhole)
{
  const Matrix4 turn = Matrix4::Rotation({ 1, 2, 3 }, 0.7);
  const Matrix4 crop = Matrix4::Translation({ -314, -60, 0 });
  const Matrix4 pixels = Matrix4::Scaling({ 0.2, 0.19, 0.195 });
  const Matrix4 mount = Matrix4::Translation({ 3, 40, -7 }) * turn;
  std::size_t link = 0;
  // the size of a pixel may come anywhere, and only once
  EXPECT_FALSE(CheckImageChain({ crop, pixels, mount, turn }, link));
  const Matrix4 quarter = Matrix4::Rotation({ 0, 0, 1 }, std::acos(-1.0) / 2);
  EXPECT_FALSE(CheckImageChain({ quarter, crop, mount * pixels }, link));
  EXPECT_FALSE(CheckImageChain({ pixels }, link));
  EXPECT_EQ(CheckImageChain({ crop, Matrix4::Scaling({ 0.2, 0.15, 0.2 }), mount }, link).Fault,
    GeometryFault::Inexact);
  EXPECT_EQ(link, 3u);
  // larger by a factor, or seen from the side from which the product has right angles
  const Matrix4 half = Matrix4::Rotation({ 0, 0, 1 }, std::acos(-1.0) / 4);
  Matrix4 sheared;
  sheared(0, 1) = 0.04;
  for (const Matrix4& bad : { mount * Matrix4::Scaling({ 1.2, 1.2, 1.2 }), sheared })
  {
    const GeometryFinding finding = CheckImageChain({ crop, half * pixels, bad, turn }, link);
    EXPECT_EQ(finding.Fault, GeometryFault::Inexact);
    EXPECT_EQ(link, 2u);
    EXPECT_NE(finding.Text.find("is not rigid"), std::string::npos) << finding.Text;
  }
  // two mirrors, of which the product shows nothing
  const Matrix4 mirror = Matrix4::Scaling({ 1, -1, 1 });
  const GeometryFinding twice = CheckImageChain({ mirror * pixels, mount * mirror }, link);
  EXPECT_EQ(twice.Fault, GeometryFault::Inexact);
  EXPECT_EQ(link, 1u);
  EXPECT_NE(twice.Text.find("mirrors"), std::string::npos) << twice.Text;
}

TEST(GeometryGate, NoDamagedDigitOfAChainPassesInSilence)
{
  int moves = 0;
  std::string silent;
  for (const Matrix4& rotation : MakeRotations())
  {
    const std::vector<Matrix4> exact{ Matrix4::Translation({ -314, -60, 0 }),
      Matrix4::Scaling({ 0.1936, 0.1841, 0.18885 }), Matrix4::Translation({ 3, 40, -7 }) * rotation,
      rotation * Matrix4::Translation({ 30, -20, 10 }) };
    const auto place = [](const std::vector<Matrix4>& links)
    { return links[3] * links[2] * links[1] * links[0]; };
    const std::vector<Vec3> points{ { 0, 0, 0 }, { Columns, 0, 0 }, { 0, Rows, 0 },
      { Columns, Rows, 0 } };
    for (std::size_t link = 0; link < exact.size(); ++link)
    {
      const Texts texts = Write(exact[link], "%.6f");
      std::vector<Matrix4> good = exact;
      good[link] = Read(texts);
      std::size_t found = 0;
      ASSERT_FALSE(CheckImageChain(good, found)) << CheckImageChain(good, found).Text;
      for (int i = 0; i < 12; ++i)
      {
        for (const std::string& damage : Damage(texts[i]))
        {
          std::vector<Matrix4> bad = good;
          const bool number = Read(damage, bad[link](i / 4, i % 4));
          if (i % 4 == 3 || !number || GetMove(place(good), place(bad), points) <= Moved)
          {
            continue;
          }
          ++moves;
          silent += CheckImageChain(bad, found)
            ? ""
            : std::to_string(link) + ": " + texts[i] + " as " + damage + "; ";
        }
      }
    }
  }
  EXPECT_GT(moves, 5000);
  EXPECT_EQ(silent, "");
}

TEST(GeometryGate, GoodMatricesPass)
{
  for (const Matrix4& rotation : MakeRotations())
  {
    Matrix4 rounded = Matrix4::Translation({ 1e3, -2e3, 5e5 }) * rotation;
    EXPECT_FALSE(CheckPose(rounded));
    for (int i = 0; i < 12; ++i)
    {
      rounded(i / 4, i % 4) = static_cast<double>(static_cast<float>(rounded(i / 4, i % 4)));
    }
    EXPECT_FALSE(CheckPose(rounded));
    for (const auto& [format, worst] :
      { std::pair<const char*, GeometryFault>{ "%.3f", GeometryFault::Rounded },
        { "%.2f", GeometryFault::Rounded }, { "%.4f", GeometryFault::None } })
    {
      rounded = Read(Write(rotation, format));
      const GeometryFinding finding = CheckPose(rounded);
      EXPECT_TRUE(!finding || finding.Fault == worst) << format << " " << finding.Text;
    }
    // scan lines 0.3 mm apart, sampled every 0.02 mm
    const Matrix4 lines = rotation * Matrix4::Scaling({ 0.02, 0.3, 0.16 });
    EXPECT_FALSE(CheckImage(lines)) << CheckImage(lines).Text;
  }
  for (const double length : { 1.0, 0.9991, 1.0009 })
  {
    EXPECT_FALSE(CheckQuaternion(length));
  }
  EXPECT_EQ(CheckQuaternion(0.991).Fault, GeometryFault::Rounded);
  EXPECT_EQ(CheckQuaternion(1.011).Fault, GeometryFault::NotRigid);
}

TEST(GeometryGate, SaysWhatIsWrongAndWhatToDo)
{
  const auto pose = [](const Matrix4& m, GeometryFault fault, const std::string& part)
  {
    const GeometryFinding finding = CheckPose(m);
    EXPECT_EQ(finding.Fault, fault) << finding.Text;
    EXPECT_NE(finding.Text.find(part), std::string::npos) << finding.Text;
    EXPECT_FALSE(finding.Advice.empty());
  };
  const auto image = [](const Matrix4& m, GeometryFault fault, const std::string& part)
  {
    const GeometryFinding finding = CheckImage(m);
    EXPECT_EQ(finding.Fault, fault) << finding.Text;
    EXPECT_NE(finding.Text.find(part), std::string::npos) << finding.Text;
    EXPECT_FALSE(finding.Advice.empty());
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  pose(Matrix4::Scaling({ nan, 1, 1 }), GeometryFault::NotFinite, "not finite");
  pose(Matrix4::Scaling({ 1.2, 1.2, 1.2 }), GeometryFault::NotRigid, "lengths 1.2, 1.2 and 1.2");
  pose(Matrix4::FromColumns({ 1, 0.3, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, {}), GeometryFault::NotRigid,
    "not perpendicular");
  pose(Matrix4::FromColumns({ 1, 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 }, {}), GeometryFault::Singular,
    "singular");
  pose(Matrix4::Scaling({ -1, 1, 1 }), GeometryFault::Mirrored, "mirrors");
  pose(Matrix4::Scaling({ 1.003, 1, 1 }), GeometryFault::Rounded, "by 0.006");
  pose(Matrix4::Translation({ 0, 1.1e6, 0 }), GeometryFault::FarAway, "1.1e+06");
  Matrix4 last;
  last(3, 1) = 0.1;
  pose(last, GeometryFault::LastRow, "last row 0 0.1 0 1");
  image(last, GeometryFault::LastRow, "last row 0 0.1 0 1");

  image(Matrix4::Scaling({ 0.2, 20, 0.2 }), GeometryFault::PixelSize, "0.2 x 20 mm");
  image(Matrix4::Scaling({ 2e-4, 2e-4, 2e-4 }), GeometryFault::PixelSize, "0.0002 x 0.0002 mm");
  image(Matrix4::Scaling({ 0.2, 0, 0.2 }), GeometryFault::PixelSize, "0.2 x 0 mm");
  image(Matrix4::Scaling({ 0.2, 0.2, 0 }), GeometryFault::Singular, "singular");
  image(Matrix4::FromColumns({ 0.2, 0, 0 }, { 0.15, 0.2, 0 }, { 0, 0, 0.2 }, {}),
    GeometryFault::Skewed, "53.1301 degrees");
  image(Matrix4::FromColumns({ 0.2, 0, 0 }, { 0.01, 0.2, 0 }, { 0, 0, 0.2 }, {}),
    GeometryFault::Inexact, "100 mm down, pixels are off by 4.99");
  image(Matrix4::Scaling({ -0.2, 0.2, 0.2 }), GeometryFault::MirroredImage, "mirrors");
  // a change of the third column's sign says that it is meant
  EXPECT_FALSE(CheckImage(Matrix4::Scaling({ -0.2, 0.2, -0.2 })));
  image(
    Matrix4::Scaling({ 0.3, 0.2, 0.2 }), GeometryFault::Inexact, "0.2 long, not their mean 0.25");
  image(Matrix4::FromColumns({ 0.2, 0, 0.01 }, { 0, 0.2, 0 }, { 0, 0, 0.2 }, {}),
    GeometryFault::Inexact, "not perpendicular");
}

// The table of the user guide says what the code does.
TEST(GeometryGate, TheGuideHasTheRules)
{
  constexpr const char* words[] = { "used", "warned of", "flagged", "refused" };
  std::ifstream page(LACUNA_RULES_PAGE);
  ASSERT_TRUE(page) << LACUNA_RULES_PAGE;
  int fault = 0;
  for (std::string line; std::getline(page, line);)
  {
    if (line.rfind("| **", 0) != 0)
    {
      continue;
    }
    ++fault;
    std::istringstream cells(line.substr(line.find('|', 1) + 1));
    std::string cell;
    for (int o = 0; o <= static_cast<int>(GeometryOrigin::Picks); ++o)
    {
      ASSERT_TRUE(std::getline(cells, cell, '|')) << line;
      const auto action =
        GetAction(static_cast<GeometryOrigin>(o), static_cast<GeometryFault>(fault));
      EXPECT_EQ(cell, " " + std::string(words[static_cast<int>(action)]) + " ") << line << o;
    }
  }
  EXPECT_EQ(fault, static_cast<int>(GeometryFault::Inexact));
}

// What no origin may do: take in silence what cannot be.
TEST(GeometryGate, EveryOriginHasARuleForEveryFault)
{
  for (int o = 0; o <= static_cast<int>(GeometryOrigin::Picks); ++o)
  {
    const auto origin = static_cast<GeometryOrigin>(o);
    EXPECT_EQ(GetAction(origin, GeometryFault::None), GeometryAction::Use);
    for (int f = 1; f <= static_cast<int>(GeometryFault::Inexact); ++f)
    {
      const auto fault = static_cast<GeometryFault>(f);
      const bool doubtful = fault == GeometryFault::Rounded || fault == GeometryFault::Inexact ||
        fault == GeometryFault::MirroredImage;
      if (origin != GeometryOrigin::Slices) // their readers have told
      {
        EXPECT_GE(GetAction(origin, fault), doubtful ? GeometryAction::Warn : GeometryAction::Flag)
          << o << " " << f;
      }
    }
  }
}
