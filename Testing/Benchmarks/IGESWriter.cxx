// SPDX-License-Identifier: BSD-3-Clause
// Points -> bicubic surface -> IGES file, 120 x 120 mm, 121 x 121 points, tolerance 1 um, beside
// OpenCASCADE's own approximation (GeomAPI_PointsToBSplineSurface) and IGES writer. Both end with a
// file on the disk. Counters: bytes of the file, control points, largest distance in um of a point
// from the surface (at its parameters for Lacuna, from its foot point for OpenCASCADE).
#include "lacunaAtomicFile.h"
#include "lacunaBenchmark.h"
#include "lacunaExecution.h"
#include "lacunaIGESDocument.h"
#include "lacunaSurfaceFit.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#ifdef LACUNA_WITH_OPENCASCADE
#include <GeomAPI_PointsToBSplineSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <TColgp_Array2OfPnt.hxx>
#endif

namespace
{
constexpr int Count = 121;
constexpr double Tolerance = 0.001;

// Shapes of a mould, x and y in mm from its centre.
double Waves(double x, double y)
{
  return 0.004 * (x * x + y * y) + 3 * std::sin(x / 17) * std::cos(y / 23) + 0.01 * x;
}

double Skull(double x, double y)
{
  return 70 - std::sqrt(95 * 95 - x * x - 1.1 * y * y);
}

double SkullWithBump(double x, double y)
{
  return Skull(x, y) + 5 * std::exp(-((x - 20) * (x - 20) + (y + 10) * (y + 10)) / 300);
}

// A thin-plate spline through nodes on a 10 mm grid, as a hole filler makes it: only C1 at nodes.
double ThinPlate(double x, double y)
{
  double sum = Skull(x, y);
  for (int a = -6; a <= 6; ++a)
  {
    for (int b = -6; b <= 6; ++b)
    {
      const double r2 = (x - 10 * a) * (x - 10 * a) + (y - 10 * b) * (y - 10 * b);
      sum += r2 > 0 ? 1e-4 * std::sin(3.0 * a + 5.0 * b) * 0.5 * r2 * std::log(r2) : 0;
    }
  }
  return sum;
}

using Shape = double (*)(double, double);
constexpr Shape Shapes[] = { Waves, Skull, SkullWithBump, ThinPlate };
const char* const Names[] = { "waves", "skull", "skull with bump", "thin plate" };

std::vector<lacuna::Vec3> Points(Shape shape, int count = Count)
{
  std::vector<lacuna::Vec3> points;
  for (int j = 0; j < count; ++j)
  {
    for (int i = 0; i < count; ++i)
    {
      const double x = 120.0 * i / (count - 1) - 60;
      const double y = 120.0 * j / (count - 1) - 60;
      points.push_back({ x, y, shape(x, y) });
    }
  }
  return points;
}

std::string OutputName(const char* name)
{
  return (std::filesystem::temp_directory_path() / name).string();
}

void Report(benchmark::State& state, const std::string& path, double points, double deviation)
{
  state.counters["bytes"] = static_cast<double>(std::filesystem::file_size(path));
  state.counters["control_points"] = points;
  state.counters["deviation_um"] = 1000 * deviation;
  std::filesystem::remove(path);
}

void Write(
  benchmark::State& state, const std::vector<lacuna::Vec3>& points, int count, double tolerance)
{
  const std::string path = OutputName("lacuna-benchmark.igs");
  lacuna::ThreadExecution execution(1); // as OpenCASCADE
  lacuna::SurfaceFitOptions options;
  options.Tolerance = tolerance;
  lacuna::SurfaceFit fit;
  for (auto _ : state)
  {
    fit = lacuna::FitPoints(execution, { count, count }, points, options);
    lacuna::IGESDocument document;
    document.AddSurface(fit.Surface, {});
    lacuna::IGESHeader header;
    header.Date = "20260101.000000";
    header.MinimumResolution = tolerance;
    lacuna::WriteFileAtomically(path, document.GetText(header));
  }
  Report(state, path, static_cast<double>(fit.Surface.ControlPoints.size()), fit.MaximumDeviation);
}

void Lacuna(benchmark::State& state)
{
  state.SetLabel(Names[state.range(0)]);
  Write(state, Points(Shapes[state.range(0)]), Count, Tolerance);
}

// argument: points along an edge of the skull with a bump
void LacunaOfPoints(benchmark::State& state)
{
  const int count = static_cast<int>(state.range(0));
  Write(state, Points(SkullWithBump, count), count, Tolerance);
}

#ifdef LACUNA_WITH_OPENCASCADE
// Distance of a point from its foot point, by Newton's method from OpenCASCADE's own guess.
double Distance(
  const Handle(Geom_BSplineSurface) & surface, ShapeAnalysis_Surface& analysis, const gp_Pnt& point)
{
  double bounds[4];
  surface->Bounds(bounds[0], bounds[1], bounds[2], bounds[3]);
  gp_Pnt2d uv = analysis.ValueOfUV(point, 1e-7);
  for (int round = 0; round < 8; ++round)
  {
    gp_Pnt p;
    gp_Vec du;
    gp_Vec dv;
    surface->D1(uv.X(), uv.Y(), p, du, dv);
    const gp_Vec r(p, point);
    const double a = du * du;
    const double b = dv * dv;
    const double c = du * dv;
    const double d = a * b - c * c;
    uv.SetX(std::clamp(uv.X() + ((r * du) * b - (r * dv) * c) / d, bounds[0], bounds[1]));
    uv.SetY(std::clamp(uv.Y() + ((r * dv) * a - (r * du) * c) / d, bounds[2], bounds[3]));
  }
  return surface->Value(uv.X(), uv.Y()).Distance(point);
}

TColgp_Array2OfPnt Array(const std::vector<lacuna::Vec3>& points, int count = Count)
{
  TColgp_Array2OfPnt array(1, count, 1, count);
  for (int k = 0; k < count * count; ++k)
  {
    array(k % count + 1, k / count + 1) = gp_Pnt(points[k][0], points[k][1], points[k][2]);
  }
  return array;
}

Handle(Geom_BSplineSurface) Approximate(const TColgp_Array2OfPnt& array, int degree)
{
  return GeomAPI_PointsToBSplineSurface(array, 3, degree, GeomAbs_C2, Tolerance).Surface();
}

double Deviation(
  const Handle(Geom_BSplineSurface) & surface, const std::vector<lacuna::Vec3>& points)
{
  ShapeAnalysis_Surface analysis(surface);
  double deviation = 0;
  const std::size_t step = 1 + points.size() / 20000; // foot points take long
  for (std::size_t k = 0; k < points.size(); k += step)
  {
    const lacuna::Vec3& p = points[k];
    deviation = std::max(deviation, Distance(surface, analysis, gp_Pnt(p[0], p[1], p[2])));
  }
  return deviation;
}

// No worse than what OpenCASCADE (range(1): the largest degree) reaches with the tolerance, however
// far below it.
void LacunaNoWorse(benchmark::State& state)
{
  state.SetLabel(Names[state.range(0)]);
  const std::vector<lacuna::Vec3> points = Points(Shapes[state.range(0)]);
  const auto surface = Approximate(Array(points), static_cast<int>(state.range(1)));
  Write(state, points, Count, std::min(Tolerance, Deviation(surface, points)));
}

// degree: the largest one OpenCASCADE may use; 8 is its default, 3 gives bicubic patches.
void WriteByOpenCASCADE(
  benchmark::State& state, const std::vector<lacuna::Vec3>& points, int count, int degree)
{
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  IGESControl_Controller::Init();
  const TColgp_Array2OfPnt array = Array(points, count);
  const std::string path = OutputName("opencascade-benchmark.igs");
  Handle(Geom_BSplineSurface) surface;
  for (auto _ : state)
  {
    surface = Approximate(array, degree);
    IGESControl_Writer writer("MM", 0);
    writer.AddGeom(surface);
    writer.ComputeModel();
    writer.Write(path.c_str());
  }
  Report(state, path, static_cast<double>(surface->NbUPoles() * surface->NbVPoles()),
    Deviation(surface, points));
}

void OpenCASCADE(benchmark::State& state)
{
  state.SetLabel(Names[state.range(0)]);
  WriteByOpenCASCADE(
    state, Points(Shapes[state.range(0)]), Count, static_cast<int>(state.range(1)));
}

void OpenCASCADEOfPoints(benchmark::State& state)
{
  const int count = static_cast<int>(state.range(0));
  WriteByOpenCASCADE(state, Points(SkullWithBump, count), count, 8);
}
#endif
}

BENCHMARK(Lacuna)->DenseRange(0, 3)->Apply(lacunaBenchmark::Measure);
BENCHMARK(LacunaOfPoints)
  ->ArgName("points")
  ->Arg(39)
  ->Arg(122)
  ->Arg(384)
  ->Apply(lacunaBenchmark::Measure);
#ifdef LACUNA_WITH_OPENCASCADE
BENCHMARK(LacunaNoWorse)
  ->ArgsProduct({ { 0, 1, 2, 3 }, { 8, 3 } })
  ->Apply(lacunaBenchmark::Measure);
BENCHMARK(OpenCASCADE)->ArgsProduct({ { 0, 1, 2, 3 }, { 8, 3 } })->Apply(lacunaBenchmark::Measure);
BENCHMARK(OpenCASCADEOfPoints)
  ->ArgName("points")
  ->Arg(39)
  ->Arg(122)
  ->Arg(384)
  ->Apply(lacunaBenchmark::Measure);
#endif
BENCHMARK_MAIN();
