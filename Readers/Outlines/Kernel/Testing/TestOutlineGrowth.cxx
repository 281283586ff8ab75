// SPDX-License-Identifier: BSD-3-Clause
// What reading takes grows as the bytes of the file.
#include "DicomTestFile.h"
#include "OutlineTesting.h"
#include "lacunaDoubling.h"
#include "lacunaOutlineTable.h"
#include "lacunaStructureSet.h"

#include <memory>

using namespace lacuna;

namespace
{
void ExpectLinear(int size, const std::function<std::string(int)>& make, bool isTable)
{
  const double growth = GetGrowthOfThreeDoublings(size,
    [&](int n) -> std::function<void()>
    {
      const auto folder = std::make_shared<Temporary>();
      const std::string file = folder->Write(make(n));
      return [folder, file, isTable]
      { ErrorOf([&] { isTable ? ReadOutlineTable(file) : ReadStructureSet(file); }); };
    });
  EXPECT_LT(growth, MostGrowth);
}

std::string Rows(int count, const std::function<std::string(int)>& row)
{
  std::string text = "structure,outline,x,y,z\n";
  for (int i = 0; i < count; ++i)
  {
    text += row(i) + "\n";
  }
  return text;
}

std::string Element(DicomTag tag, std::string value)
{
  value += value.size() % 2 ? " " : "";
  return Implicit(tag, value);
}

std::string Item(const std::string& content)
{
  return Implicit(0xFFFEE000, content);
}

// structures with so many contours each
std::string StructureSet(
  int structures, int contours, const std::string& name, const std::string& type = "CLOSED_PLANAR")
{
  const std::string contour = Item(Element(0x30060042, type) + Element(0x30060046, "3") +
    Element(0x30060050, "0\\0\\5\\1\\0\\5\\0\\1\\5"));
  std::string names;
  std::string all;
  for (int i = 0; i < structures; ++i)
  {
    const std::string number = std::to_string(i);
    std::string items;
    for (int k = 0; k < contours; ++k)
    {
      items += contour;
    }
    names += Item(Element(0x30060022, number) + Element(0x30060024, "1.2") +
      Element(0x30060026, name + number));
    all += Item(Implicit(0x30060040, items) + Element(0x30060084, number));
  }
  return Head("1.2.840.10008.1.2") + Element(0x00080016, "1.2.840.10008.5.1.4.1.1.481.3") +
    Element(0x00080060, "RTSTRUCT") + Implicit(0x30060020, names) + Implicit(0x30060039, all);
}
}

TEST(OutlineGrowth, Tables)
{
  const auto number = [](int i) { return std::to_string(i); };
  // points of one outline, outlines, structures
  ExpectLinear(
    4000, [&](int n) { return Rows(n, [&](int i) { return "liver,1," + number(i) + ",2,3"; }); },
    true);
  ExpectLinear(
    4000,
    [&](int n)
    { return Rows(n, [&](int i) { return "liver," + number(i / 3) + "," + number(i) + ",2,3"; }); },
    true);
  ExpectLinear(
    4000,
    [&](int n)
    { return Rows(n, [&](int i) { return "s" + number(i / 3) + ",1," + number(i) + ",2,3"; }); },
    true);
  // columns, blanks and quotes
  const auto repeat = [](int n, const std::string& text)
  {
    std::string all;
    for (int i = 0; i < n; ++i)
    {
      all += text;
    }
    return all;
  };
  ExpectLinear(
    20000, [&](int n) { return "structure,outline,x,y,z" + repeat(n, ",c") + "\n"; }, true);
  ExpectLinear(
    40000, [&](int n) { return Rows(1, [&](int) { return repeat(n, " \t") + repeat(n, ", "); }); },
    true);
  ExpectLinear(
    40000, [&](int n) { return Rows(1, [&](int) { return "\"" + repeat(n, "\"\"\n"); }); }, true);
  ExpectLinear(
    40000, [&](int n) { return repeat(n, "\n"); }, true);
}

TEST(OutlineGrowth, StructureSets)
{
  ExpectLinear(
    1000, [](int n) { return StructureSet(n, 1, "s"); }, false);
  ExpectLinear(
    1000, [](int n) { return StructureSet(1, n, "s"); }, false);
  ExpectLinear(
    1000, [](int n) { return StructureSet(n, 0, "s"); }, false);
  ExpectLinear(
    1000, [](int n) { return StructureSet(1, n, "s", "OPEN_PLANAR"); }, false);
  // each contour of a structure has its name
  ExpectLinear(
    1000, [](int n) { return StructureSet(1, n, std::string(100 * n, 's')); }, false);
  const Temporary folder;
  const std::string file = folder.Write(StructureSet(1, 1, std::string(1024, 's')), "RS");
  ExpectContains(ErrorOf([&] { ReadStructureSet(file); }),
    "RS: a structure has a name (3006,0026) of 1025 bytes, where 64 characters are allowed");
}
