// SPDX-License-Identifier: BSD-3-Clause
#include "OutlineTesting.h"

#include <cmath>

using namespace lacuna;

namespace
{
TEST(OutlineSet, TakesStructuresOfOneNameForOne)
{
  OutlineSet set;
  EXPECT_EQ(set.AddStructure("Liver", StructureColor{ 1, 2, 3 }), 0U);
  EXPECT_EQ(set.AddStructure("Kidney"), 1U);
  EXPECT_EQ(set.AddStructure(" Liver ", StructureColor{ 4, 5, 6 }), 0U);
  EXPECT_EQ(set.AddStructure("Cyst"), 2U);
  ASSERT_EQ(set.GetStructures().size(), 3U);
  EXPECT_EQ(set.GetStructures()[0].Name, "Liver");
  EXPECT_EQ(set.GetStructures()[0].Color, (StructureColor{ 1, 2, 3 }));
  EXPECT_NE(set.GetStructures()[1].Color, set.GetStructures()[2].Color);
}

TEST(OutlineSet, DropsALastPointThatRepeatsTheFirst)
{
  OutlineSet set;
  StructureOutline outline;
  outline.Points = MakeFlag();
  outline.Points.push_back(outline.Points.front());
  set.AddOutline(outline, "here");
  EXPECT_EQ(set.GetOutlines().at(0).Points, MakeFlag());
}

TEST(OutlineSet, RefusesWhatIsNoOutline)
{
  OutlineSet set;
  const auto add = [&](std::vector<Vec3> points)
  {
    StructureOutline outline;
    outline.Points = std::move(points);
    return ErrorOf([&] { set.AddOutline(outline, "line 5: outline 2"); });
  };
  EXPECT_EQ(add({}),
    "line 5: outline 2 has 0 different points, but an outline needs 3; add points or delete it in "
    "the program that wrote the file");
  ExpectContains(add({ { 1, 2, 3 } }), "has 1 point, but");
  ExpectContains(add({ { 1, 2, 3 }, { 4, 5, 6 }, { 1, 2, 3 } }), "has 2 different points, but");
  ExpectContains(add({ { 1, 2, 3 }, { 4, 5, 6 }, { 1, NAN, 3 } }), "point 3 is not finite");
  EXPECT_TRUE(set.GetOutlines().empty());
}
}
