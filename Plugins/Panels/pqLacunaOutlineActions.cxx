// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// pqLacunaOutlinePanel: its widgets, and what they do.
#include "pqLacunaOutlinePanel.h"

#include "pqApplicationCore.h"
#include "pqPipelineSource.h"
#include "vtkImageData.h"
#include "vtkLacunaOutlineTools.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMTrace.h"

#include <QButtonGroup>
#include <QCheckBox>
#include <QColorDialog>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QInputDialog>
#include <QLabel>
#include <QSlider>
#include <QSpinBox>
#include <QTableWidget>
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
  layout->addLayout(this->BuildStructures(box));
  auto* tools = new QButtonGroup(box);
  layout->addLayout(this->BuildToolButtons(box, tools));
  this->BuildLevel(box);
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
QLayout* pqLacunaOutlinePanel::BuildStructures(QWidget* box)
{
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
  return row;
}

//------------------------------------------------------------------------------
QLayout* pqLacunaOutlinePanel::BuildToolButtons(QWidget* box, QButtonGroup* tools)
{
  auto* row = MakeRow();
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
  return row;
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::BuildLevel(QWidget* box)
{
  this->LevelRow = new QWidget(box);
  auto* level = MakeRow();
  this->LevelRow->setLayout(level);
  this->Level = new QSlider(Qt::Horizontal, box);
  this->Level->setObjectName("TraceLevel");
  this->Level->setRange(0, LevelSteps);
  this->Level->setToolTip(tr("Grey level between the structure and what is around it"));
  level->addWidget(new QLabel(tr("Level"), box));
  level->addWidget(this->Level, 1);
  this->LevelNumber = new QLabel(box);
  this->LevelNumber->setObjectName("TraceLevelNumber");
  level->addWidget(this->LevelNumber);
  QObject::connect(this->Level, &QSlider::valueChanged, this, [this] { this->RetraceLast(); });
  this->LevelRow->hide();
}

//------------------------------------------------------------------------------
QWidget* pqLacunaOutlinePanel::BuildResults()
{
  auto* box = new QWidget(this);
  auto* layout = new QVBoxLayout(box);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addLayout(this->BuildSlices(box));
  layout->addLayout(this->BuildEditing());
  this->BuildTable(box);
  layout->addWidget(this->Summary);
  layout->addWidget(this->Table);
  layout->addLayout(this->BuildFiles(box));
  return box;
}

//------------------------------------------------------------------------------
QLayout* pqLacunaOutlinePanel::BuildSlices(QWidget* box)
{
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
  QObject::connect(
    this->SliceSlider, &QSlider::valueChanged, this->SliceNumber, &QSpinBox::setValue);
  QObject::connect(this->SliceNumber, QOverload<int>::of(&QSpinBox::valueChanged), this,
    [this](int slice)
    {
      const QSignalBlocker slider(this->SliceSlider);
      if (this->Canvas->HasPending())
      {
        const QSignalBlocker number(this->SliceNumber);
        this->SliceNumber->setValue(this->Slice);
        this->SliceSlider->setValue(this->Slice);
        this->Canvas->SetCaption(tr("Close the outline first (Enter), or forget it (Esc)"));
        return;
      }
      this->SliceSlider->setValue(slice);
      this->SliceTimer.start(0); // of many steps at once the last
    });
  return row;
}

//------------------------------------------------------------------------------
QLayout* pqLacunaOutlinePanel::BuildEditing()
{
  auto* row = MakeRow();
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
  QObject::connect(copy, &QToolButton::clicked, this, &pqLacunaOutlinePanel::CopyOutline);
  QObject::connect(remove, &QToolButton::clicked, this, &pqLacunaOutlinePanel::DeleteOutline);
  QObject::connect(this->UndoButton, &QToolButton::clicked, this, &pqLacunaOutlinePanel::Undo);
  QObject::connect(this->RedoButton, &QToolButton::clicked, this, &pqLacunaOutlinePanel::Redo);
  QObject::connect(this->Canvas, &pqLacunaOutlineCanvas::undoWanted, this,
    [this](bool isRedo) { isRedo ? this->Redo() : this->Undo(); });
  return row;
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::BuildTable(QWidget* box)
{
  this->Summary = new QLabel(box);
  this->Summary->setObjectName("VolumeSummary");
  QFont font = this->Summary->font();
  font.setPointSizeF(1.5 * font.pointSizeF());
  font.setBold(true);
  this->Summary->setFont(font);

  this->Table = new QTableWidget(0, 5, box);
  this->Table->setObjectName("StructureTable");
  this->Table->setHorizontalHeaderLabels(
    { tr("Structure"), tr("Outlines"), tr("Volume"), tr("Area (cm\u00b2)"), tr("Diameter (mm)") });
  this->Table->horizontalHeader()->setStretchLastSection(true);
  this->Table->verticalHeader()->hide();
  this->Table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  this->Table->setMaximumHeight(120);
}

//------------------------------------------------------------------------------
QLayout* pqLacunaOutlinePanel::BuildFiles(QWidget* box)
{
  auto* row = MakeRow();
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
  return row;
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
  this->LastTrace.IsValid = false;
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
int pqLacunaOutlinePanel::NextNumber(const Drawing& drawing, int structure)
{
  int number = 0;
  for (const Outline& outline : drawing.Outlines)
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
  QPolygonF handles = this->FromCanvas(points);
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
    { structure, NextNumber(this->Now, structure), this->Slice, this->Snapped(handles) });
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
  drawing.Outlines[this->Shown[shown]].Handles = this->FromCanvas(handles);
  this->Push(drawing);
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::TraceOutline(const QPointF& place, const QRectF& region)
{
  if (!this->Picture)
  {
    return;
  }
  const double nowhere[2] = { vtkMath::Nan(), vtkMath::Nan() };
  const QPolygonF places =
    this->FromCanvas(QPolygonF({ place, region.topLeft(), region.bottomRight() }));
  const double at[2] = { places[0].x(), places[0].y() };
  const int all[4] = { 0, -1, 0, -1 };
  const int part[4] = { static_cast<int>(std::floor(places[1].x())),
    static_cast<int>(std::ceil(places[2].x())), static_cast<int>(std::floor(places[1].y())),
    static_cast<int>(std::ceil(places[2].y())) };
  const bool isPlace = region.isEmpty();
  vtkNew<vtkPoints> line;
  if (!vtkLacunaOutlineTools::Trace(this->Picture, this->GetLevel(), isPlace ? at : nowhere,
        isPlace ? all : part, MedianSize, line))
  {
    this->Canvas->SetCaption(tr("There is no contour at this level: move Level"));
    return;
  }
  vtkNew<vtkPoints> few;
  vtkLacunaOutlineTools::Simplify(line, TraceTolerance, few);
  // instead of the outline that is there, as of a click before
  Drawing drawing = this->Now;
  const int structure = this->GetStructure();
  const QRectF area(places[1], places[2]);
  const auto isThere = [&](const Outline& outline)
  {
    return outline.Structure == structure && outline.Slice == this->Slice &&
      (isPlace ? outline.Handles.containsPoint(places[0], Qt::OddEvenFill)
               : area.contains(outline.Handles.boundingRect().center()));
  };
  drawing.Outlines.erase(std::remove_if(drawing.Outlines.begin(), drawing.Outlines.end(), isThere),
    drawing.Outlines.end());
  drawing.Outlines.push_back(
    { structure, NextNumber(this->Now, structure), this->Slice, this->Snapped(ToPlaces(few)) });
  const bool isAgain =
    this->LastTrace.IsValid && this->LastTrace.Place == place && this->LastTrace.Region == region;
  isAgain ? this->Replace(drawing) : this->Push(drawing);
  this->LastTrace.IsValid = true;
  this->LastTrace.Place = place;
  this->LastTrace.Region = region;
}

//------------------------------------------------------------------------------
double pqLacunaOutlinePanel::GetLevel() const
{
  return this->LevelRange[0] +
    (this->LevelRange[1] - this->LevelRange[0]) * this->Level->value() / LevelSteps;
}

void pqLacunaOutlinePanel::ShowLevel()
{
  this->LevelNumber->setText(QString::number(this->GetLevel(), 'f', 0));
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::RetraceLast()
{
  this->ShowLevel();
  if (this->LastTrace.IsValid)
  {
    this->TraceOutline(this->LastTrace.Place, this->LastTrace.Region);
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::CopyOutline()
{
  const int structure = this->GetStructure();
  const Outline* nearest = nullptr;
  for (const Outline& outline : this->Now.Outlines)
  {
    if (outline.Structure == structure && outline.Slice == this->Slice)
    {
      this->Canvas->SetCaption(tr("This structure has an outline here: delete it first"));
      return;
    }
    if (outline.Structure == structure &&
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
  const int from = nearest->Slice;
  int number = NextNumber(this->Now, structure);
  for (const Outline& outline : this->Now.Outlines)
  {
    if (outline.Structure == structure && outline.Slice == from)
    {
      drawing.Outlines.push_back(
        { structure, number++, this->Slice, this->Snapped(outline.Handles) });
    }
  }
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
  QString name = tr("Structure %1").arg(n + 1);
  while (drawing.Names.contains(name))
  {
    name += "'";
  }
  drawing.Names.push_back(name);
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
  if (isOk && this->Now.Names.contains(name.trimmed()) && this->Now.Names[n] != name.trimmed())
  {
    this->Canvas->SetCaption(tr("Another structure is called %1").arg(name.trimmed()));
  }
  else if (isOk && !name.trimmed().isEmpty())
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
  if (this->Source && !this->Histories[this->Source].Before.isEmpty())
  {
    this->LastTrace.IsValid = false;
    History& history = this->Histories[this->Source];
    history.After.push_back(this->Now);
    const Drawing drawing = history.Before.takeLast();
    this->Write(drawing);
  }
}

void pqLacunaOutlinePanel::Redo()
{
  if (this->Source && !this->Histories[this->Source].After.isEmpty())
  {
    this->LastTrace.IsValid = false;
    History& history = this->Histories[this->Source];
    history.Before.push_back(this->Now);
    const Drawing drawing = history.After.takeLast();
    this->Write(drawing);
  }
}
