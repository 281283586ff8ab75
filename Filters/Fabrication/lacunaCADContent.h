// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What of VTK data goes to a file for CAD.
#ifndef lacunaCADContent_h
#define lacunaCADContent_h

#include "lacunaCADSurface.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

class vtkDataObject;
class vtkPolyData;

namespace lacuna
{
/// The surfaces, curves, lines and points of a data object and of all blocks in it, in one frame.
class CADContent
{
public:
  enum OutlineType
  {
    NoOutline,
    OutlineCurve,
    TrimToOutline
  };
  static constexpr std::array<const char*, 3> OutlineNames{ "None", "Curve", "Trim" };
  enum FrameType
  {
    AsGiven,
    Patient,
    Press
  };
  static constexpr std::array<const char*, 3> FrameNames{ "AsGiven", "Patient", "Press" };
  struct Options
  {
    SurfaceFitOptions Fit;
    int Outline = OutlineCurve;
    int Frame = AsGiven;
    bool AllowMirrored = false;
    bool SkipUnsupported = false;

    void Describe(Properties& properties) const; ///< with what each may be
  };
  struct Curve
  {
    BSplineCurve Shape;
    std::string Name;
  };
  struct Polygon
  {
    std::vector<Vec3> Corners;
    std::string Name;
  };
  struct Line
  {
    Vec3 From;
    Vec3 To;
    std::string Name;
    bool IsAxis = false;
  };
  struct Point
  {
    Vec3 Position;
    std::string Name;
  };

  /// Throws std::runtime_error or std::invalid_argument that says what cannot be written, and of
  /// which block; also when nothing at all is there to write.
  CADContent(vtkDataObject* input, const Options& options, Execution& execution);

  std::vector<CADSurface> Surfaces;
  std::vector<Curve> Curves;
  std::vector<Polygon> Polygons;
  std::vector<Line> Lines;
  std::vector<Point> Points;
  std::vector<std::string> Description; ///< of the frame, for people
  std::vector<std::string> Warnings;
  std::vector<vtkDataObject*> Inputs; ///< the data sets written

private:
  struct Item
  {
    vtkDataObject* Data;
    std::string Name; ///< of the block; empty when the input is no collection
    std::optional<Matrix4> PressToPatient;
    std::string Lost; ///< of what lies in a press: why nothing leads to the patient; empty: it does
    Matrix4 ToFile = {};
    /// The input, before it was laid into a press, is marked as the patient's.
    bool IsPatient() const;
  };
  std::string FindLost(vtkDataObject* data, const std::string& prefix, bool hasMatrix);

  void Collect(vtkDataObject* data, const std::string& name, bool nested);
  void PlaceItems();
  void DescribeFrame(const Item* press);
  void AddItem(const Item& item, Execution& execution);
  void AddMap(const Item& item, Execution& execution);
  void AddPolyData(const Item& item);
  void AddScrews(const Item& item);
  std::size_t CountThings() const;
  void Unsupported(const std::string& what);

  Options Settings;
  std::vector<Item> Items;
};
}
#endif
