// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// pqLacunaOutlinePanel: its widgets, and what they do.
#include "pqLacunaFetch.h"
#include "pqLacunaOutlinePanel.h"

#include "pqApplicationCore.h"
#include "pqPipelineSource.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkLacunaOutlineTools.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMTrace.h"
#include "vtkStringArray.h"

#include <QButtonGroup>
#include <QCheckBox>
#include <QColorDialog>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFile>
#include <QFileDialog>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QInputDialog>
#include <QLabel>
#include <QMessageBox>
#include <QSaveFile>
#include <QSlider>
#include <QSpinBox>
#include <QTableWidget>
#include <QTextStream>
#include <QToolButton>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>

namespace
{
constexpr double FreehandTolerance = 1; // pixels
constexpr double TraceTolerance = 0.7;  // pixels
constexpr double SnapReach = 6;         // pixels
constexpr int MedianSize = 5;           // pixels, against speckle

QToolButton* MakeButton(const QString& text, const char* name, const QString& tip)
{
  auto* button = new QToolButton;
  button->setText(text);
  button->setObjectName(name);
  button->setToolTip(tip);
  button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  return button;
}

QHBoxLayout* MakeRow()
{
  auto* row = new QHBoxLayout;
  row->setContentsMargins(0, 0, 0, 0);
  return row;
}
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::ToPoints(const QPolygonF& places, vtkPoints* points)
{
  points->SetDataTypeToDouble();
  for (const QPointF& place : places)
  {
    points->InsertNextPoint(place.x(), place.y(), 0);
  }
}

QPolygonF pqLacunaOutlinePanel::ToPlaces(vtkPoints* points)
{
  QPolygonF places;
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    double x[3];
    points->GetPoint(i, x);
    places.push_back({ x[0], x[1] });
  }
  return places;
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Build()
{
  auto* inside = new QWidget(this);
  auto* layout = new QVBoxLayout(inside);
  layout->setContentsMargins(4, 4, 4, 4);
  this->Canvas = new pqLacunaOutlineCanvas(inside);
  layout->addWidget(this->BuildTools());
  layout->addWidget(this->Canvas, 1);
  layout->addWidget(this->BuildResults());
  this->setWidget(inside);
  QObject::connect(
    this->Canvas, &pqLacunaOutlineCanvas::drawn, this, &pqLacunaOutlinePanel::AddOutline);
  QObject::connect(
    this->Canvas, &pqLacunaOutlineCanvas::moved, this, &pqLacunaOutlinePanel::MoveOutline);
  QObject::connect(
    this->Canvas, &pqLacunaOutlineCanvas::traceWanted, this, &pqLacunaOutlinePanel::TraceOutline);
  QObject::connect(
    this->Canvas, &pqLacunaOutlineCanvas::stepped, this, &pqLacunaOutlinePanel::Step);
  QObject::connect(this->Canvas, &pqLacunaOutlineCanvas::windowDragged, this,
    [this](double level, double width)
    {
      const double size = this->Window[1] - this->Window[0];
      this->Window[0] += size * (level - 0.5 * width);
      this->Window[1] += size * (level + 0.5 * width);
      this->ShowPicture();
    });
}

//------------------------------------------------------------------------------
QWidget* pqLacunaOutlinePanel::BuildTools()
{
  auto* box = new QWidget(this);
  auto* layout = new QVBoxLayout(box);
  layout->setContentsMargins(0, 0, 0, 0);

  auto* row = MakeRow();
  this->Structures = new QComboBox(box);
  this->Structures->setObjectName("Structures");
  this->Structures->setToolTip(tr("The structure that you outline now"));
  row->addWidget(new QLabel(tr("Structure"), box));
  row->addWidget(this->Structures, 1);
  this->ColorButton = MakeButton({}, "StructureColor", tr("Colour of the structure"));
  row->addWidget(this->ColorButton);
  auto* rename = MakeButton(tr("Rename"), "RenameStructure", tr("Name the structure"));
  row->addWidget(rename);
  auto* add = MakeButton(tr("New"), "NewStructure", tr("Outline another structure"));
  row->addWidget(add);
  layout->addLayout(row);
  QObject::connect(this->Structures, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
    [this]
    {
      this->ShowStructures();
      this->ShowOutlines();
      this->ShowTable();
    });
  QObject::connect(
    this->ColorButton, &QToolButton::clicked, this, &pqLacunaOutlinePanel::ChooseColor);
  QObject::connect(rename, &QToolButton::clicked, this, &pqLacunaOutlinePanel::Rename);
  QObject::connect(add, &QToolButton::clicked, this, &pqLacunaOutlinePanel::AddStructure);

  row = MakeRow();
  auto* tools = new QButtonGroup(box);
  const auto addTool = [&](const QString& text, const char* name, const QString& tip, int id)
  {
    auto* button = MakeButton(text, name, tip);
    button->setCheckable(true);
    button->setChecked(id == 0);
    tools->addButton(button, id);
    row->addWidget(button);
  };
  addTool(tr("Points"), "ToolPoints",
    tr("Click points along the border; click the first one again to close"),
    pqLacunaOutlineCanvas::Points);
  addTool(tr("Freehand"), "ToolFreehand", tr("Draw along the border with the button held"),
    pqLacunaOutlineCanvas::Freehand);
  addTool(tr("Trace"), "ToolTrace",
    tr(
      "Click into the structure: the contour at the level around that place. Drag a rectangle: the "
      "largest contour in it"),
    pqLacunaOutlineCanvas::Trace);
  this->Snap = new QCheckBox(tr("Snap to edge"), box);
  this->Snap->setObjectName("SnapToEdge");
  this->Snap->setToolTip(tr("Points go to the strongest edge within 6 pixels"));
  row->addWidget(this->Snap);
  row->addStretch(1);
  layout->addLayout(row);

  this->LevelRow = new QWidget(box);
  auto* level = MakeRow();
  this->LevelRow->setLayout(level);
  this->Level = new QSlider(Qt::Horizontal, box);
  this->Level->setObjectName("TraceLevel");
  this->Level->setRange(0, LevelSteps);
  this->Level->setToolTip(tr("Grey level between the structure and what is around it"));
  level->addWidget(new QLabel(tr("Level"), box));
  level->addWidget(this->Level, 1);
  this->LevelRow->hide();
  layout->addWidget(this->LevelRow);
  QObject::connect(tools, QOverload<int>::of(&QButtonGroup::idClicked), this,
    [this](int id)
    {
      this->Canvas->SetTool(static_cast<pqLacunaOutlineCanvas::Tools>(id));
      this->LevelRow->setVisible(id == pqLacunaOutlineCanvas::Trace);
    });
  return box;
}

//------------------------------------------------------------------------------
QWidget* pqLacunaOutlinePanel::BuildResults()
{
  auto* box = new QWidget(this);
  auto* layout = new QVBoxLayout(box);
  layout->setContentsMargins(0, 0, 0, 0);

  auto* row = MakeRow();
  this->SliceSlider = new QSlider(Qt::Horizontal, box);
  this->SliceSlider->setObjectName("SliceSlider");
  this->SliceSlider->setToolTip(
    tr("Slice; also with the mouse wheel, the arrow keys, Page Up and Page Down"));
  this->SliceNumber = new QSpinBox(box);
  this->SliceNumber->setObjectName("SliceNumber");
  row->addWidget(new QLabel(tr("Slice"), box));
  row->addWidget(this->SliceSlider, 1);
  row->addWidget(this->SliceNumber);
  layout->addLayout(row);
  QObject::connect(
    this->SliceSlider, &QSlider::valueChanged, this->SliceNumber, &QSpinBox::setValue);
  QObject::connect(this->SliceNumber, QOverload<int>::of(&QSpinBox::valueChanged), this,
    [this](int slice)
    {
      const QSignalBlocker blocker(this->SliceSlider);
      this->SliceSlider->setValue(slice);
      this->Slice = slice;
      this->SliceTimer.start(0); // of many steps at once the last
    });

  row = MakeRow();
  auto* copy = MakeButton(tr("Copy last outline"), "CopyOutline",
    tr("The outline of this structure in the nearest slice, into this slice"));
  auto* remove =
    MakeButton(tr("Delete outline"), "DeleteOutline", tr("Those of this structure in this slice"));
  this->UndoButton = MakeButton(tr("Undo"), "UndoOutline", tr("Ctrl+Z in the picture"));
  this->RedoButton = MakeButton(tr("Redo"), "RedoOutline", tr("Ctrl+Shift+Z in the picture"));
  for (QToolButton* button : { copy, remove, this->UndoButton, this->RedoButton })
  {
    row->addWidget(button);
  }
  row->addStretch(1);
  layout->addLayout(row);
  QObject::connect(copy, &QToolButton::clicked, this, &pqLacunaOutlinePanel::CopyOutline);
  QObject::connect(remove, &QToolButton::clicked, this, &pqLacunaOutlinePanel::DeleteOutline);
  QObject::connect(this->UndoButton, &QToolButton::clicked, this, &pqLacunaOutlinePanel::Undo);
  QObject::connect(this->RedoButton, &QToolButton::clicked, this, &pqLacunaOutlinePanel::Redo);
  QObject::connect(this->Canvas, &pqLacunaOutlineCanvas::undoWanted, this,
    [this](bool isRedo) { isRedo ? this->Redo() : this->Undo(); });

  this->Summary = new QLabel(box);
  this->Summary->setObjectName("VolumeSummary");
  QFont font = this->Summary->font();
  font.setPointSizeF(1.5 * font.pointSizeF());
  font.setBold(true);
  this->Summary->setFont(font);
  layout->addWidget(this->Summary);

  this->Table = new QTableWidget(0, 5, box);
  this->Table->setObjectName("StructureTable");
  this->Table->setHorizontalHeaderLabels(
    { tr("Structure"), tr("Outlines"), tr("Volume"), tr("Area (cm\u00b2)"), tr("Diameter (mm)") });
  this->Table->horizontalHeader()->setStretchLastSection(true);
  this->Table->verticalHeader()->hide();
  this->Table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  this->Table->setMaximumHeight(120);
  layout->addWidget(this->Table);

  row = MakeRow();
  this->RegistrationError = new QDoubleSpinBox(box);
  this->RegistrationError->setObjectName("RegistrationError");
  this->RegistrationError->setRange(0, 20);
  this->RegistrationError->setSingleStep(0.1);
  this->RegistrationError->setSuffix(tr(" mm"));
  this->RegistrationError->setToolTip(tr("How far a slice may lie from its true place: Slice "
                                         "Planes shows it for a tracker. It counts for \u00b1"));
  auto* save =
    MakeButton(tr("Save\u2026"), "SaveOutlines", tr("All outlines into a CSV file, pixels and mm"));
  auto* load = MakeButton(
    tr("Load\u2026"), "LoadOutlines", tr("Outlines of a CSV file, beside those that are there"));
  row->addWidget(new QLabel(tr("Error of a slice's place"), box));
  row->addWidget(this->RegistrationError);
  row->addStretch(1);
  row->addWidget(load);
  row->addWidget(save);
  layout->addLayout(row);
  QObject::connect(this->RegistrationError, QOverload<double>::of(&QDoubleSpinBox::valueChanged),
    this,
    [this](double error)
    {
      if (this->Surfaces)
      {
        vtkSMProxy* proxy = this->Surfaces->getProxy();
        SM_SCOPED_TRACE(PropertiesModified).arg("proxy", proxy);
        vtkSMPropertyHelper(proxy, "RegistrationError").Set(error);
        proxy->UpdateVTKObjects();
        this->ShowTable();
      }
    });
  QObject::connect(save, &QToolButton::clicked, this, &pqLacunaOutlinePanel::Save);
  QObject::connect(load, &QToolButton::clicked, this, &pqLacunaOutlinePanel::Load);
  return box;
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::ShowSlice(int slice)
{
  if (!this->Source)
  {
    return;
  }
  vtkSMProxy* proxy = this->Source->getProxy();
  if (vtkSMPropertyHelper(proxy, "Slice").GetAsInt() != slice)
  {
    SM_SCOPED_TRACE(PropertiesModified).arg("proxy", proxy);
    vtkSMPropertyHelper(proxy, "Slice").Set(slice);
    proxy->UpdateVTKObjects();
    this->IsWriting = true;
    pqApplicationCore::instance()->render();
    this->IsWriting = false;
  }
  this->Canvas->Forget();
  this->ReadPicture();
  this->ShowPicture();
  this->ShowOutlines();
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Step(int slices)
{
  this->SliceNumber->setValue(this->SliceNumber->value() + slices);
}

//------------------------------------------------------------------------------
int pqLacunaOutlinePanel::NextNumber(int structure) const
{
  int number = 0;
  for (const Outline& outline : this->Now.Outlines)
  {
    if (outline.Structure == structure)
    {
      number = std::max(number, outline.Number + 1);
    }
  }
  return number;
}

//------------------------------------------------------------------------------
QPolygonF pqLacunaOutlinePanel::Snapped(const QPolygonF& handles) const
{
  if (!this->Snap->isChecked() || !this->Picture)
  {
    return handles;
  }
  vtkNew<vtkPoints> points;
  ToPoints(handles, points);
  vtkLacunaOutlineTools::Snap(this->Picture, points, SnapReach);
  return ToPlaces(points);
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::AddOutline(const QPolygonF& points, bool isFreehand)
{
  QPolygonF handles = points.translated(this->GetFirstPixel());
  if (isFreehand)
  {
    vtkNew<vtkPoints> line;
    vtkNew<vtkPoints> few;
    ToPoints(handles, line);
    vtkLacunaOutlineTools::Simplify(line, FreehandTolerance, few);
    handles = ToPlaces(few);
  }
  Drawing drawing = this->Now;
  const int structure = this->GetStructure();
  drawing.Outlines.push_back(
    { structure, this->NextNumber(structure), this->Slice, this->Snapped(handles) });
  this->Push(drawing);
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::MoveOutline(int shown, const QPolygonF& handles)
{
  if (shown < 0 || shown >= this->Shown.size())
  {
    return;
  }
  Drawing drawing = this->Now;
  drawing.Outlines[this->Shown[shown]].Handles = handles.translated(this->GetFirstPixel());
  this->Push(drawing);
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::TraceOutline(const QPointF& place, const QRectF& region)
{
  if (!this->Picture)
  {
    return;
  }
  const QPointF first = this->GetFirstPixel();
  const double level =
    this->Window[0] + (this->Window[1] - this->Window[0]) * this->Level->value() / LevelSteps;
  const double nowhere[2] = { vtkMath::Nan(), vtkMath::Nan() };
  const double at[2] = { place.x() + first.x(), place.y() + first.y() };
  const QRectF area = region.translated(first);
  const int all[4] = { 0, -1, 0, -1 };
  const int part[4] = { static_cast<int>(std::floor(area.left())),
    static_cast<int>(std::ceil(area.right())), static_cast<int>(std::floor(area.top())),
    static_cast<int>(std::ceil(area.bottom())) };
  const bool isPlace = region.isEmpty();
  vtkNew<vtkPoints> line;
  if (!vtkLacunaOutlineTools::Trace(
        this->Picture, level, isPlace ? at : nowhere, isPlace ? all : part, MedianSize, line))
  {
    this->Canvas->SetCaption(tr("There is no contour at this level: move Level"));
    return;
  }
  vtkNew<vtkPoints> few;
  vtkLacunaOutlineTools::Simplify(line, TraceTolerance, few);
  Drawing drawing = this->Now;
  const int structure = this->GetStructure();
  drawing.Outlines.push_back(
    { structure, this->NextNumber(structure), this->Slice, this->Snapped(ToPlaces(few)) });
  this->Push(drawing);
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::CopyOutline()
{
  const int structure = this->GetStructure();
  const Outline* nearest = nullptr;
  for (const Outline& outline : this->Now.Outlines)
  {
    if (outline.Structure == structure && outline.Slice != this->Slice &&
      (!nearest || std::abs(outline.Slice - this->Slice) <= std::abs(nearest->Slice - this->Slice)))
    {
      nearest = &outline;
    }
  }
  if (!nearest)
  {
    this->Canvas->SetCaption(tr("This structure has no outline in another slice"));
    return;
  }
  Drawing drawing = this->Now;
  drawing.Outlines.push_back(
    { structure, this->NextNumber(structure), this->Slice, this->Snapped(nearest->Handles) });
  this->Push(drawing);
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::DeleteOutline()
{
  Drawing drawing = this->Now;
  const int structure = this->GetStructure();
  const auto isIt = [&](const Outline& outline)
  { return outline.Structure == structure && outline.Slice == this->Slice; };
  drawing.Outlines.erase(
    std::remove_if(drawing.Outlines.begin(), drawing.Outlines.end(), isIt), drawing.Outlines.end());
  if (drawing.Outlines.size() == this->Now.Outlines.size())
  {
    this->Canvas->SetCaption(tr("This structure has no outline in this slice"));
    return;
  }
  this->Push(drawing);
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::AddStructure()
{
  Drawing drawing = this->Now;
  const int n = drawing.Names.size();
  drawing.Names.push_back(tr("Structure %1").arg(n + 1));
  drawing.Colors.push_back(this->GetOwnColor(n));
  this->Push(drawing);
  this->Structures->setCurrentIndex(n);
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Rename()
{
  const int n = this->GetStructure() - 1;
  bool isOk = false;
  const QString name = QInputDialog::getText(
    this, tr("Rename"), tr("Name of the structure"), QLineEdit::Normal, this->Now.Names[n], &isOk);
  if (isOk && !name.trimmed().isEmpty())
  {
    Drawing drawing = this->Now;
    drawing.Names[n] = name.trimmed();
    this->Push(drawing);
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::ChooseColor()
{
  const int n = this->GetStructure() - 1;
  const QColor color = QColorDialog::getColor(this->Now.Colors[n], this, tr("Colour"));
  if (color.isValid())
  {
    Drawing drawing = this->Now;
    drawing.Colors[n] = color;
    this->Push(drawing);
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Undo()
{
  if (!this->Before.isEmpty())
  {
    this->After.push_back(this->Now);
    const Drawing drawing = this->Before.takeLast();
    this->Write(drawing);
  }
}

void pqLacunaOutlinePanel::Redo()
{
  if (!this->After.isEmpty())
  {
    this->Before.push_back(this->Now);
    const Drawing drawing = this->After.takeLast();
    this->Write(drawing);
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Save()
{
  const vtkSmartPointer<vtkDataObject> data = pqLacunaFetch(this->Source->getSourceProxy(), 0);
  auto* lines = vtkPolyData::SafeDownCast(data);
  if (!lines || lines->GetNumberOfLines() == 0)
  {
    QMessageBox::information(this, tr("Save outlines"), tr("There is no outline yet."));
    return;
  }
  QString name =
    QFileDialog::getSaveFileName(this, tr("Save outlines"), "outlines.csv", tr("Outlines (*.csv)"));
  if (name.isEmpty())
  {
    return;
  }
  if (!name.endsWith(".csv", Qt::CaseInsensitive))
  {
    name += ".csv";
  }
  QSaveFile file(name);
  if (!file.open(QIODevice::WriteOnly | QIODevice::Text))
  {
    QMessageBox::critical(
      this, tr("Save outlines"), tr("%1 cannot be written: %2").arg(name, file.errorString()));
    return;
  }
  QString rows;
  QTextStream text(&rows); // written as UTF-8, with whatever version of Qt
  text.setRealNumberPrecision(12);
  text << "structure,outline,slice,column,row,x,y,z,handle\n";
  vtkDataArray* pixel = lines->GetPointData()->GetArray("Pixel");
  vtkDataArray* handle = lines->GetPointData()->GetArray("Handle");
  auto* names =
    vtkStringArray::SafeDownCast(lines->GetCellData()->GetAbstractArray("StructureName"));
  vtkDataArray* numbers = lines->GetCellData()->GetArray("Outline");
  vtkDataArray* slices = lines->GetCellData()->GetArray("SliceNumber");
  vtkCellArray* cells = lines->GetLines();
  for (vtkIdType cell = 0; cell < cells->GetNumberOfCells(); ++cell)
  {
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    cells->GetCellAtId(cell, count, ids);
    QString structure = QString::fromUtf8(names->GetValue(cell).c_str());
    structure.replace('"', "\"\"");
    for (vtkIdType i = 0; i + 1 < count; ++i)
    {
      double x[3];
      lines->GetPoint(ids[i], x);
      text << '"' << structure << "\"," << numbers->GetComponent(cell, 0) << ','
           << slices->GetComponent(cell, 0) << ',' << pixel->GetComponent(ids[i], 0) << ','
           << pixel->GetComponent(ids[i], 1) << ',' << x[0] << ',' << x[1] << ',' << x[2] << ','
           << handle->GetComponent(ids[i], 0) << '\n';
    }
  }
  text.flush();
  file.write(rows.toUtf8());
  if (!file.commit())
  {
    QMessageBox::critical(
      this, tr("Save outlines"), tr("%1 cannot be written: %2").arg(name, file.errorString()));
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Load()
{
  const QString name = QFileDialog::getOpenFileName(
    this, tr("Load outlines"), QString(), tr("Outlines of Lacuna (*.csv)"));
  if (name.isEmpty())
  {
    return;
  }
  QFile file(name);
  const auto fail = [&](const QString& why)
  { QMessageBox::critical(this, tr("Load outlines"), tr("%1: %2").arg(name, why)); };
  if (!file.open(QIODevice::ReadOnly | QIODevice::Text))
  {
    fail(file.errorString());
    return;
  }
  QString rows = QString::fromUtf8(file.readAll());
  QTextStream text(&rows);
  const QStringList titles = text.readLine().split(',');
  int at[6];
  const char* const wanted[6] = { "structure", "outline", "slice", "column", "row", "handle" };
  for (int c = 0; c < 6; ++c)
  {
    at[c] = titles.indexOf(wanted[c]);
    if (at[c] < 0)
    {
      fail(tr(
        "it has no column '%1'. This panel reads what it saved; Outline Reader (File > Open) reads "
        "outlines of other programs, for the filter Outlined Structures")
             .arg(wanted[c]));
      return;
    }
  }
  Drawing drawing = this->Now;
  QVector<Outline> found;
  int line = 1;
  while (!text.atEnd())
  {
    ++line;
    QString row = text.readLine();
    // the name is the first column, in quotes
    QString structure;
    if (row.startsWith('"'))
    {
      int end = 1;
      while (end < row.size() && (row[end] != '"' || (end + 1 < row.size() && row[end + 1] == '"')))
      {
        end += row[end] == '"' ? 2 : 1;
      }
      structure = row.mid(1, end - 1).replace("\"\"", "\"");
      row = row.mid(end + 1);
    }
    else
    {
      structure = row.section(',', 0, 0);
      row = row.mid(structure.size());
    }
    const QStringList values = row.split(',');
    double number[6] = { 0, 0, 0, 0, 0, 0 };
    bool isGood = values.size() == titles.size() && at[0] == 0;
    for (int c = 1; c < 6 && isGood; ++c)
    {
      number[c] = values[at[c]].toDouble(&isGood);
      isGood = isGood && std::isfinite(number[c]);
    }
    if (!isGood)
    {
      fail(tr("line %1 has not the columns of the first line, as finite numbers").arg(line));
      return;
    }
    int n = static_cast<int>(drawing.Names.indexOf(structure));
    if (n < 0)
    {
      n = static_cast<int>(drawing.Names.size());
      drawing.Names.push_back(structure);
      drawing.Colors.push_back(GetOwnColor(n));
    }
    const int outline = static_cast<int>(number[1]);
    const int slice = static_cast<int>(number[2]);
    if (slice < this->SliceSlider->minimum() || slice > this->SliceSlider->maximum())
    {
      fail(tr("line %1 is of slice %2, which is not there").arg(line).arg(slice));
      return;
    }
    if (found.isEmpty() || found.back().Structure != n + 1 || found.back().Number != outline)
    {
      found.push_back({ n + 1, outline, slice, {} });
    }
    if (number[5] != 0)
    {
      found.back().Handles.push_back({ number[3], number[4] });
    }
  }
  for (Outline& outline : found)
  {
    if (outline.Handles.size() < 3)
    {
      fail(tr("an outline in slice %1 has fewer than three points with 'handle' 1")
             .arg(outline.Slice));
      return;
    }
    int number = 0;
    for (const Outline& other : drawing.Outlines)
    {
      number = other.Structure == outline.Structure ? std::max(number, other.Number + 1) : number;
    }
    outline.Number = number;
    drawing.Outlines.push_back(outline);
  }
  this->Push(drawing);
}
