// SPDX-License-Identifier: BSD-3-Clause
// The IGES Writer and groups of data, the frames they are in, mirrored and private ones, and disks that
// take no file.
#include "TestBadPlaces.h"
#include "TestIGESContent.h"
#include "lacunaCoordinates.h"
#include "lacunaMatrix4.h"
#include "lacunaProvenance.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

using namespace TestIGESContent;

namespace
{
void TestGroups()
{
  std::vector<lacuna::Vec3> points;
  auto grid = TestSurfaces::Grid(1, points);
  auto map = DefectMap();
  vtkNew<vtkLacunaIGESWriter> maker; // any algorithm's name will do for the provenance
  lacuna::Provenance::Record(map, maker, {}, "Of=map");
  lacuna::Provenance::Record(grid, maker, {}, "Of=grid");
  vtkNew<vtkPolyData> nothing;
  auto inner = Group({ { "Bar", grid }, { "", nothing }, { "", Lines(Corners, { { 0, 1, 2 } }) } });
  const Outcome outcome =
    Write(Group({ { "Implant", map }, { "Rest", inner }, { "Empty", nullptr } }));
  LACUNA_CHECK_THAT(
    outcome.Surfaces == 2 && outcome.Curves == 3 && outcome.Points == 0, "all blocks");
  const IGESParser file(outcome.Text);
  std::vector<std::string> names;
  for (const Entity* entity : OfType(file, 128))
  {
    names.push_back(NameOf(file, IGESSurface(*entity).Properties));
  }
  LACUNA_CHECK_THAT((names == std::vector<std::string>{ "Implant", "Bar" }), "names of blocks");
  LACUNA_CHECK_THAT(NameOf(file, *OfType(file, 102).back()) == "Rest/Block 2", "without name");
  for (const char* words : { "Of=map", "Of=grid", "DefectOutline=Curve", "Levels: 1 surfaces" })
  {
    LACUNA_CHECK_THAT(outcome.Text.find(words) != std::string::npos, words);
  }

  vtkNew<vtkPartitionedDataSetCollection> sets;
  sets->SetPartition(0, 0, grid);
  sets->SetPartition(1, 0, Lines(Corners, { { 0, 1 } }));
  sets->GetMetaData(0u)->Set(vtkCompositeDataSet::NAME(), "Mould");
  const Outcome collection = Write(sets);
  LACUNA_CHECK_THAT(collection.Surfaces == 1 && collection.Curves == 1, "a collection");
  const IGESParser read(collection.Text);
  LACUNA_CHECK_THAT(NameOf(read, IGESSurface(*OfType(read, 128).at(0)).Properties) == "Mould",
    "name of a partitioned data set");

  vtkNew<vtkUnstructuredGrid> mesh;
  mesh->SetPoints(grid->GetPoints());
  auto group = Group({ { "Implant", map }, { "Mesh", mesh } });
  Refuses(group, "'Mesh' is a vtkUnstructuredGrid");
  const Outcome skipped = Write(group, [](vtkLacunaIGESWriter* w) { w->SkipUnsupportedOn(); });
  LACUNA_CHECK_THAT(skipped.Surfaces == 1 &&
      skipped.Warning.find("'Mesh' is a vtkUnstructuredGrid") != std::string::npos,
    "left out");
  Refuses(Group({ { "Mesh", mesh } }), "nothing to write",
    [](vtkLacunaIGESWriter* w) { w->SkipUnsupportedOn(); });
  Refuses(Group({}), "nothing to write");
  // blocks of size zero are not missed in silence
  vtkNew<vtkStructuredGrid> failed;
  vtkNew<vtkPartitionedDataSetCollection> two;
  two->SetPartition(0, 0, grid);
  two->SetPartition(1, 0, failed);
  two->GetMetaData(1u)->Set(vtkCompositeDataSet::NAME(), "Failed");
  auto whole = Group({ { "Mould", grid }, { "Failed", failed } });
  for (vtkDataObject* input : std::vector<vtkDataObject*>{ two, whole })
  {
    const Outcome rest = Write(input);
    LACUNA_CHECK_THAT(rest.Surfaces == 1, "what there is");
    LACUNA_CHECK_CONTAINS(rest.Warning, "left out: block 'Failed' is empty");
  }
  two->SetPartition(0, 1, failed); // a piece
  LACUNA_CHECK_THAT(Write(two).Warning.find("Block 0") == std::string::npos, "a piece is empty");
  Refuses(Group({ { "Failed", failed } }), "nothing to write");
  map->GetPointData()->GetArray("Fitted")->SetComponent(3000, 0, TestSurfaces::NaN);
  Refuses(group, "block 'Implant': the surface has holes");
}

//------------------------------------------------------------------------------
void SetPress(vtkDataObject* data, const lacuna::Matrix4& matrix)
{
  lacuna::FieldData::SetMatrices(data, "PressToPatient", { matrix });
}

void TestFrames()
{
  const lacuna::Matrix4 matrix =
    lacuna::Matrix4::Translation({ 10, -20, 30 }) * lacuna::Matrix4::Rotation({ 1, 2, 3 }, 0.7);
  std::vector<lacuna::Vec3> points;
  auto mould = TestSurfaces::Grid(2, points);
  SetPress(mould, matrix);
  auto outline = Lines(Corners, { { 0, 1, 2, 3 } });
  auto group = Group({ { "Mould", mould }, { "Outline", outline } });
  Refuses(group, "block 'Mould' is in the coordinates of the press");
  const auto frame = [](int which)
  { return [which](vtkLacunaIGESWriter* w) { w->SetCoordinates(which); }; };
  for (const int which : { 1, 2 })
  {
    const Outcome outcome = Write(group, frame(which));
    const IGESParser file(outcome.Text);
    const IGESSurface surface(*OfType(file, 128).at(0));
    const lacuna::Vec3 first{ surface.Points[0], surface.Points[1], surface.Points[2] };
    const IGESPolygon curve(file, *OfType(file, 102).at(0));
    const bool press = which == 2;
    const lacuna::Vec3 corner = press ? points[0] : matrix.Point(points[0]);
    LACUNA_CHECK_THAT(lacuna::Norm(first - corner) < 0.001, "the mould's corner");
    const lacuna::Vec3 end = press ? matrix.Inverse().Point(Corners[3]) : Corners[3];
    LACUNA_CHECK_THAT(lacuna::Norm(Vec(curve.Corners.at(3)) - end) < 0.0002, "the curve's end");
    LACUNA_CHECK_THAT(
      (outcome.Text.find("Coordinates of the press") != std::string::npos) == press, "says so");
  }
  // for people to read: a row in each line
  const auto written = [](vtkDataObject* data, const lacuna::Matrix4& expected)
  {
    const std::vector<std::string> start = IGESParser(Write(data).Text).Start;
    const auto before = std::find_if(start.begin(), start.end(),
      [](const std::string& line) { return line.find("matrix of the rows") != std::string::npos; });
    LACUNA_CHECK(start.end() - before > 3);
    for (int row = 0; row < 3 && start.end() - before > 3; ++row)
    {
      std::istringstream line(before[row + 1]);
      for (int column = 0; column < 4; ++column)
      {
        double value = TestSurfaces::NaN;
        line >> value;
        LACUNA_CHECK_NEAR(value, expected(row, column), 6e-13);
      }
      std::string more;
      LACUNA_CHECK(!(line >> more));
    }
  };
  written(mould, matrix);
  const lacuna::Matrix4 far =
    lacuna::Matrix4::Translation({ -12345.678, 12345.678, -1e-5 }) * matrix;
  SetPress(mould, far);
  written(mould, far);
  SetPress(mould, matrix);
  const Outcome alone = Write(mould);
  LACUNA_CHECK_THAT(
    alone.Text.find("Coordinates of the press") != std::string::npos, "the mould alone");
  Refuses(outline, "no input says where the press is", frame(2));

  auto other = TestSurfaces::Grid(2, points);
  SetPress(other, lacuna::Matrix4());
  auto two = Group({ { "Mould", mould }, { "Other", other } });
  Refuses(two, "different presses");
  LACUNA_CHECK_THAT(Write(two, frame(1)).Surfaces == 2, "both to the patient");
  SetPress(other, lacuna::Matrix4::Scaling({ 1, 1, -1 }));
  Refuses(other, "mirrors");
  SetPress(other, lacuna::Matrix4::Scaling({ 1, TestSurfaces::NaN, 1 }));
  Refuses(other, "PressToPatient");
}

// The file says DICOM LPS only of data that are marked as the patient's.
void TestWhose()
{
  using namespace lacuna::Coordinates;
  const auto start = [](vtkDataObject* data, int frame)
  {
    std::string text;
    const auto set = [frame](vtkLacunaIGESWriter* w) { w->SetCoordinates(frame); };
    for (const std::string& line : IGESParser(Write(data, set).Text).Start)
    {
      text += line + ' ';
    }
    return text;
  };
  const auto isLPS = [](const std::string& text)
  { return text.find("LPS") != std::string::npos || text.find("atient co") != std::string::npos; };
  std::vector<lacuna::Vec3> points;
  auto surface = TestSurfaces::Grid(2, points);
  std::string text = start(surface, 0);
  LACUNA_CHECK_CONTAINS(text, "Coordinates of the input, in mm; not known whose");
  LACUNA_CHECK_THAT(!isLPS(text), text);
  Mark(surface, Patient);
  text = start(surface, 0);
  LACUNA_CHECK_CONTAINS(text, "Coordinates of the patient (DICOM LPS");
  LACUNA_CHECK_THAT(text.find("ot known") == std::string::npos, text);

  // in the press: where the matrix leads
  auto mould = TestSurfaces::Grid(2, points);
  SetPress(mould, lacuna::Matrix4::Translation({ 10, -20, 30 }));
  vtkNew<vtkImageData> unmarked;
  MarkPress(unmarked, mould);
  text = start(mould, 0);
  LACUNA_CHECK_CONTAINS(text, "To the input's coordinates (not known whose) by a matrix");
  LACUNA_CHECK_THAT(!isLPS(text), text);
  text = start(mould, 1); // led back
  LACUNA_CHECK_CONTAINS(text, "Coordinates of the input, in mm; not known whose");
  LACUNA_CHECK_THAT(!isLPS(text), text);
  MarkPress(surface, mould);
  LACUNA_CHECK_CONTAINS(start(mould, 0), "To patient coordinates (DICOM LPS) by a matrix");
  LACUNA_CHECK_CONTAINS(start(mould, 1), "Coordinates of the patient (DICOM LPS");

  // one of two is not known
  auto outline = Lines(Corners, { { 0, 1, 2, 3 } });
  auto group = Group({ { "Mould", mould }, { "Outline", outline } });
  for (const int frame : { 1, 2 })
  {
    LACUNA_CHECK_CONTAINS(start(group, frame), "NOT KNOWN to be placed by the patient's");
    LACUNA_CHECK_CONTAINS(start(group, frame), "'Outline'");
  }
  Mark(outline, Patient);
  LACUNA_CHECK_THAT(start(group, 2).find("NOT KNOWN") == std::string::npos, "both are known");

  // edges of Defect Model's block lie in the patient, whatever its top's matrix is
  SetPress(outline, lacuna::Matrix4::Translation({ 100, 0, 0 }));
  const IGESParser file(Write(outline, [](vtkLacunaIGESWriter* w) { w->SetCoordinates(1); }).Text);
  const IGESPolygon curve(file, *OfType(file, 102).at(0));
  LACUNA_CHECK(lacuna::Norm(Vec(curve.Corners.at(3)) - Corners[3]) < 0.0002);
}

// What has been moved since it was made for the press is not at the place that its matrix leads from,
// and the file says so; what was made of it, and a path that is mirrored or scaled, is known, too.
void TestMoved()
{
  using lacuna::Matrix4;
  const auto start = [](const Outcome& outcome)
  {
    std::string text;
    for (const std::string& line : IGESParser(outcome.Text).Start)
    {
      text += line + ' ';
    }
    return text;
  };
  std::vector<lacuna::Vec3> points;
  vtkNew<vtkImageData> patient;
  lacuna::Coordinates::Mark(patient, lacuna::Coordinates::Patient);
  const auto press = [&](vtkPointSet* data, const Matrix4& move)
  {
    SetPress(data, Matrix4::Translation({ 10, -20, 30 }));
    lacuna::Coordinates::MarkPress(patient, data);
    TestSurfaces::RecordAndMove(data, move);
  };
  const auto frame = [](int which)
  { return [which](vtkLacunaIGESWriter* w) { w->SetCoordinates(which); }; };
  auto mould = TestSurfaces::Grid(2, points);
  press(mould, {});
  LACUNA_CHECK_CONTAINS(start(Write(mould)), "To patient coordinates (DICOM LPS) by a matrix");
  auto moved = TestSurfaces::Grid(2, points);
  press(moved, Matrix4::Translation({ 50, 0, 0 }) * Matrix4::Rotation({ 0, 0, 1 }, 0.3));
  const Outcome outcome = Write(moved);
  LACUNA_CHECK_CONTAINS(outcome.Warning, "mm elsewhere, and PressToPatient does not lead");
  const std::string text = start(outcome);
  LACUNA_CHECK_CONTAINS(text, "The way to the patient is NOT KNOWN: it was MOVED since");
  for (const char* words :
    { "LPS", "matrix", "Coordinates of the press", "Coordinates of the pat" })
  {
    LACUNA_CHECK_THAT(text.find(words) == std::string::npos, words + (": " + text));
  }
  const auto first = [](const Outcome& written)
  {
    const IGESParser file(written.Text);
    return Vec(IGESPoint(IGESSurface(*OfType(file, 128).at(0)), 0, 0));
  };
  double p[3];
  moved->GetPoint(0, p);
  LACUNA_CHECK_THAT(
    lacuna::Norm(first(outcome) - lacuna::Vec3{ p[0], p[1], p[2] }) < 0.001, "where it is");
  for (const int which : { 1, 2 })
  {
    Refuses(moved, "it lies up to", frame(which));
  }
  // beside one that is where it was made
  const std::string both = start(Write(Group({ { "Moved", moved }, { "Mould", mould } })));
  LACUNA_CHECK_CONTAINS(both, "NOT KNOWN for 'Moved': it was MOVED");
  LACUNA_CHECK_CONTAINS(both, "To patient coordinates (DICOM LPS) by a matrix");
  auto outline = Lines(Corners, { { 0, 1, 2, 3 } });
  Refuses(Group({ { "Moved", moved }, { "Outline", outline } }), "nothing brings them together");

  // one point of it has been moved against the others, which none of the corners tell
  auto bent = TestSurfaces::Grid(2, points);
  press(bent, Matrix4::Translation({ 50, 0, 0 }));
  bent->GetPoint(517, p);
  bent->GetPoints()->SetPoint(517, p[0], p[1], p[2] + 0.01);
  Refuses(bent, "distances in it are other ones by up to 0.01 mm");

  // a path over a mould that had been moved
  auto path = Lines(Corners, { { 0, 1, 2, 3 } });
  lacuna::Coordinates::Mark(path, lacuna::Coordinates::Press);
  lacuna::FieldData::Set(path, "MovedSincePress", { 50 }, 1);
  LACUNA_CHECK_CONTAINS(start(Write(path)), "NOT KNOWN: what it is made of was MOVED since");
  for (const int which : { 1, 2 })
  {
    Refuses(path, "nothing says where the patient is: what it is made of was MOVED", frame(which));
  }

  // paths and curves that have been changed themselves
  const auto curve = [&](const Matrix4& move)
  {
    auto lines = Lines(Corners, { { 0, 1, 2, 3 } });
    press(lines, move);
    return lines;
  };
  for (const int which : { 0, 1, 2 })
  {
    LACUNA_CHECK(Write(curve({}), frame(which)).Curves == 1);
    Refuses(curve(Matrix4::Scaling({ -1, 1, 1 })), "the path or curve has been changed since",
      frame(which));
    Refuses(Group({ { "Path", curve(Matrix4::Scaling({ 1 / 25.4, 1 / 25.4, 1 / 25.4 })) } }),
      "block 'Path': the path or curve has been changed since", frame(which));
  }
  LACUNA_CHECK_CONTAINS(
    start(Write(curve(Matrix4::Translation({ 5, 0, 0 })))), "NOT KNOWN: it was MOVED");
  Refuses(curve(Matrix4::Translation({ 5, 0, 0 })), "up to 5 mm elsewhere", frame(1));
}

void TestMirrored()
{
  auto map = DefectMap();
  lacuna::FieldData::Set(map, "Mirrored", { 1 }, 1);
  auto group = Group({ { "Other side", map } });
  Refuses(map, "mirror image");
  Refuses(group, "block 'Other side' is a mirror image");
  LACUNA_CHECK_THAT(
    Write(group, [](vtkLacunaIGESWriter* w) { w->AllowMirroredOn(); }).Surfaces == 1, "allowed");
  lacuna::FieldData::Set(map, "Mirrored", { 0 }, 1);
  LACUNA_CHECK_THAT(Write(map).Surfaces == 1, "not mirrored");
}

// Nothing about a patient, nothing but ASCII.
void TestPrivacy()
{
  auto map = DefectMap();
  for (const char* name : { "PatientName", "PatientID" })
  {
    vtkNew<vtkStringArray> array;
    array->SetName(name);
    array->InsertNextValue("M\xc3\xbcller^Eva");
    map->GetFieldData()->AddArray(array);
  }
  const std::string text = Write(
    Group({ { "Sch\xc3\xa4"
              "del",
      map } })).Text;
  LACUNA_CHECK_THAT(text.find("ller") == std::string::npos, "no patient");
  LACUNA_CHECK_THAT(text.find("Sch__del") != std::string::npos, "ASCII names");
  const IGESParser file(text); // sees that all is ASCII
}
}

int TestIGESWriterGroups(int argc, char* argv[])
{
  return Run(argc, argv, "TestIGESWriterGroups.igs",
    [](const std::string& folder)
    {
      TestGroups();
      TestFrames();
      TestWhose();
      TestMoved();
      TestMirrored();
      TestPrivacy();
      vtkNew<vtkLacunaIGESWriter> writer;
      writer->SetInputData(DefectMap());
      TestBadPlaces(writer.Get(), folder + "/TestIGESWriterGroups");
    });
}
