// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaMillingToolPath
 * @brief three-axis roughing and finishing paths over a mould, and what they leave
 *
 * Input: a vtkStructuredGrid with one dimension of 1 in press coordinates, mm, that the mill, which
 * looks along -z, sees in one layer; the output of vtkLacunaPressOrientation. Its cells are cut
 * into triangles along the diagonal from point (i, j) to (i + 1, j + 1), and these are the part.
 *
 * Output 0: vtkPolyData, poly lines of the tool's tip in the order in which they are run, each of
 * one kind of motion; the first point of a line is the last one of the line before. Coordinates are
 * whole micrometres. Point data: Motion (unsigned char: 0 rapid, 1 plunge, 2 cut, 3 lead), Pass
 * (int: levels of roughing from 0, then the finishing), FeedRate (mm/min), Time (s from the start).
 *
 * Output 1: vtkPolyData, the surface, its cells divided evenly. Point data: LeftOver (mm from the
 * surface to what was taken away), MachinedHeight (z of what is left of the stock), Unreachable (mm,
 * what a tool of this shape leaves however dense the path, as it does not fit). Exact for the
 * motions as they are, but for Unreachable, see lacuna::FindUnreachable.
 *
 * Both have the point data PressPosition (double x 4: where the point was made, and 1), by which the
 * writers see that they have been moved.
 *
 * Both carry the input's field data (PressToPatient) and
 * | array           | meaning                                                                    |
 * |-----------------|----------------------------------------------------------------------------|
 * | ToolShape       | 0 ball, 1 flat                                                             |
 * | ToolRadius      | mm                                                                         |
 * | SpindleSpeed    | 1/min                                                                      |
 * | StepOver        | least and largest distance of finishing lines, mm                          |
 * | StockTop, SafeZ | z, mm, as used                                                             |
 * | Levels          | of roughing                                                                |
 * | Positions       | number of points that are not rapid                                        |
 * | PathLength      | mm, without and with rapid motions                                         |
 * | MachiningTime   | s, without acceleration                                                    |
 * | LargestLeftOver | mm, on the map                                                             |
 * | LargestGouge    | mm, depth of the deepest point of the map within the swept tool            |
 * | MovedSincePress | mm by which the surface had been moved since it was made for the press;    |
 * |                 | only then, and without PressToPatient, which would lead elsewhere          |
 *
 * A surface that is marked as a mirror image (lacuna::Mirrored) gives marked outputs and a warning;
 * vtkLacunaGCodeWriter refuses them unless AllowMirrored is on.
 *
 * Warns where the tool does not fit, where a border that slopes down needs Overrun, and when the
 * surface has been moved since it was made (PressPosition). Errors: holes, folded surfaces, surfaces
 * that have been mirrored or stretched since, options out of range.
 *
 * Source: Carr 1996, ch. 6, ends at the surface for CAM; paths are beyond it.
 * @sa lacuna::MakeToolPath lacuna::MapLeftOver vtkLacunaGCodeWriter
 */
#ifndef vtkLacunaMillingToolPath_h
#define vtkLacunaMillingToolPath_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersFabricationModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"

#include <string> // for parameters

namespace lacuna
{
struct ToolPathOptions;
}

class VTKLACUNAFILTERSFABRICATION_EXPORT vtkLacunaMillingToolPath
  : public vtkLacunaAlgorithmOf(vtkPolyDataAlgorithm)
{
public:
  static vtkLacunaMillingToolPath* New();
  vtkTypeMacro(vtkLacunaMillingToolPath, vtkPolyDataAlgorithm);

  /// Field data of both outputs: what was warned of, a text each; vtkLacunaGCodeWriter asks about it.
  static constexpr const char* WarningsName = "Warnings";
  static constexpr const char* MotionName = "Motion";
  static constexpr const char* PassName = "Pass";
  static constexpr const char* FeedRateName = "FeedRate";
  static constexpr const char* TimeName = "Time";

  enum ToolShapeType
  {
    Ball = 0,
    Flat = 1
  };
  enum PatternType
  {
    ZigZag = 0,
    OneWay = 1
  };

  ///@{
  /** End of the tool. Default Ball. */
  vtkSetMacro(ToolShape, int);
  vtkGetMacro(ToolShape, int);
  ///@}
  ///@{
  /** mm, > 0. Default 4. */
  vtkSetMacro(ToolRadius, double);
  vtkGetMacro(ToolRadius, double);
  ///@}
  ///@{
  /** mm, largest distance of finishing lines; they divide the surface evenly. Default 1. */
  vtkSetMacro(StepOver, double);
  vtkGetMacro(StepOver, double);
  ///@}
  ///@{
  /** mm: when > 0 the lines are as far apart as keeps scallops below it, closer on slopes across
   * them (down to a quarter of the distance on level ground). Ball only. Default 0. */
  vtkSetMacro(ScallopHeight, double);
  vtkGetMacro(ScallopHeight, double);
  ///@}
  ///@{
  /** mm of the lines beyond the rectangle around the surface, on each side, where the tool goes on
   * level or down as it reaches the border: on the extension of a flat border, and over a sloping one
   * as far as a ball has to go to touch it, at most a radius below the surface's lowest point.
   * Default 0. */
  vtkSetMacro(Overrun, double);
  vtkGetMacro(Overrun, double);
  ///@}
  ///@{
  /** Of the lines, degrees from x towards y. Default 0. */
  vtkSetMacro(Direction, double);
  vtkGetMacro(Direction, double);
  ///@}
  ///@{
  /** To and fro, or all lines the same way. Default ZigZag. */
  vtkSetMacro(Pattern, int);
  vtkGetMacro(Pattern, int);
  ///@}
  ///@{
  /** Whether the surface is finished. Default on. */
  vtkSetMacro(Finishing, bool);
  vtkGetMacro(Finishing, bool);
  vtkBooleanMacro(Finishing, bool);
  ///@}
  ///@{
  /** mm between the levels of roughing; 0: none. -1: half of the tool's radius where finishing alone
   * would take off more than the radius, else none. Default -1. */
  vtkSetMacro(RoughingStep, double);
  vtkGetMacro(RoughingStep, double);
  ///@}
  ///@{
  /** mm; 0: the tool's radius. Default 0. */
  vtkSetMacro(RoughingStepOver, double);
  vtkGetMacro(RoughingStepOver, double);
  ///@}
  ///@{
  /** mm that roughing leaves on the surface. Default 0.5. */
  vtkSetMacro(StockAllowance, double);
  vtkGetMacro(StockAllowance, double);
  ///@}
  ///@{
  /** z of the stock's top, mm; the surface's highest point if that is higher. Default 0. */
  vtkSetMacro(StockTop, double);
  vtkGetMacro(StockTop, double);
  ///@}
  ///@{
  /** mm above the stock at which rapid motions are. Default 5. */
  vtkSetMacro(SafeHeight, double);
  vtkGetMacro(SafeHeight, double);
  ///@}
  ///@{
  /** mm, of the quarter circles that lead into and out of finishing cuts; 0: none. Default 2. */
  vtkSetMacro(LeadRadius, double);
  vtkGetMacro(LeadRadius, double);
  ///@}
  ///@{
  /** mm, largest distance of positions on a line; 0: the spacing of the surface. Default 0. */
  vtkSetMacro(PathStep, double);
  vtkGetMacro(PathStep, double);
  ///@}
  ///@{
  /** mm, what a straight motion may leave above a hollow; positions are added. Default 0.005. */
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}
  ///@{
  /** mm/min of cuts and leads. Default 800. */
  vtkSetMacro(FeedRate, double);
  vtkGetMacro(FeedRate, double);
  ///@}
  ///@{
  /** mm/min. Default 200. */
  vtkSetMacro(PlungeFeedRate, double);
  vtkGetMacro(PlungeFeedRate, double);
  ///@}
  ///@{
  /** mm/min, of the machine; for the time only. Default 5000. */
  vtkSetMacro(RapidFeedRate, double);
  vtkGetMacro(RapidFeedRate, double);
  ///@}
  ///@{
  /** Turns per minute, for the G-code. Default 6000. */
  vtkSetMacro(SpindleSpeed, double);
  vtkGetMacro(SpindleSpeed, double);
  ///@}
  ///@{
  /**
   * mm between points of the left-over map; 0: a quarter of the step-over. Default 0. Larger with a
   * warning where there would be more than 4 million points.
   */
  vtkSetMacro(MapSpacing, double);
  vtkGetMacro(MapSpacing, double);
  ///@}
  ///@{
  /** mm: where the tool leaves more because it does not fit that is warned of. Default 0.1. */
  vtkSetMacro(LeftOverLimit, double);
  vtkGetMacro(LeftOverLimit, double);
  ///@}

protected:
  vtkLacunaMillingToolPath();
  ~vtkLacunaMillingToolPath() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaMillingToolPath(const vtkLacunaMillingToolPath&) = delete;
  void operator=(const vtkLacunaMillingToolPath&) = delete;

  lacuna::ToolPathOptions GetOptions() const;
  // mm that may be left at the border; more is warned of.
  double GetBorderLimit(double stepOver) const;

  int ToolShape = Ball;
  double ToolRadius = 4;
  double StepOver = 1;
  double ScallopHeight = 0;
  double Overrun = 0;
  double Direction = 0;
  int Pattern = ZigZag;
  bool Finishing = true;
  double RoughingStep = -1;
  double RoughingStepOver = 0;
  double StockAllowance = 0.5;
  double StockTop = 0;
  double SafeHeight = 5;
  double LeadRadius = 2;
  double PathStep = 0;
  double Tolerance = 0.005;
  double FeedRate = 800;
  double PlungeFeedRate = 200;
  double RapidFeedRate = 5000;
  double SpindleSpeed = 6000;
  double MapSpacing = 0;
  double LeftOverLimit = 0.1;
};
#endif
