// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What of VTK data goes to an IGES file.
#ifndef vtkLacunaIGESContent_h
#define vtkLacunaIGESContent_h

#include "vtkLacunaIGESSurface.h"

#include <optional>
#include <string>
#include <vector>

class vtkDataObject;
class vtkPolyData;

/// The surfaces, curves, lines and points of a data object and of all blocks in it, in one frame.
class vtkLacunaIGESContent
{
public:
  enum OutlineType
  {
    NoOutline,
    OutlineCurve,
    TrimToOutline
  };
  enum FrameType
  {
    AsGiven,
    Patient,
    Press
  };
  struct Options
  {
    lacuna::SurfaceFitOptions Fit;
    int Outline = OutlineCurve;
    int Frame = AsGiven;
    bool AllowMirrored = false;
    bool SkipUnsupported = false;
  };
  struct Curve
  {
    lacuna::BSplineCurve Shape;
    std::string Name;
  };
  struct Polygon
  {
    std::vector<lacuna::Vec3> Corners;
    std::string Name;
  };
  struct Line
  {
    lacuna::Vec3 From;
    lacuna::Vec3 To;
    std::string Name;
    bool IsAxis = false;
  };
  struct Point
  {
    lacuna::Vec3 Position;
    std::string Name;
  };

  /// Throws std::runtime_error or std::invalid_argument that says what cannot be written, and of
  /// which block; also when nothing at all is there to write.
  vtkLacunaIGESContent(vtkDataObject* input, const Options& options, lacuna::Execution& execution);

  std::vector<vtkLacunaIGESSurface> Surfaces;
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
    std::optional<lacuna::Matrix4> PressToPatient;
    std::string Lost; ///< of what lies in a press: why nothing leads to the patient; empty: it does
    lacuna::Matrix4 ToFile = {};
    /// The input, before it was laid into a press, is marked as the patient's.
    bool IsPatient() const;
  };
  std::string FindLost(vtkDataObject* data, const std::string& prefix, bool hasMatrix);

  void Collect(vtkDataObject* data, const std::string& name, bool nested);
  void PlaceItems();
  void DescribeFrame(const Item* press);
  void AddItem(const Item& item, lacuna::Execution& execution);
  void AddMap(const Item& item, lacuna::Execution& execution);
  void AddPolyData(const Item& item);
  void AddScrews(const Item& item);
  std::size_t CountThings() const;
  void Unsupported(const std::string& what);

  Options Settings;
  std::vector<Item> Items;
};
#endif
