// SPDX-License-Identifier: BSD-3-Clause
#include "pqLacunaOutlinePanel.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqLacunaFetch.h"
#include "pqObjectBuilder.h"
#include "pqOutputPort.h"
#include "pqPipelineSource.h"
#include "pqServerManagerModel.h"
#include "pqView.h"
#include "vtkBoundingBox.h"
#include "vtkCamera.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkLacunaOutlineTools.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSMPVRepresentationProxy.h"
#include "vtkSMParaViewPipelineControllerWithRendering.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMTrace.h"
#include "vtkSMViewProxy.h"
#include "vtkStringArray.h"
#include "vtkStructuredGrid.h"
#include "vtkTable.h"

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QSlider>
#include <QSpinBox>
#include <QTableWidget>
#include <QToolButton>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

namespace
{

bool IsOf(const pqPipelineSource* source, const char* name)
{
  return source && std::strcmp(source->getProxy()->GetXMLName(), name) == 0;
}

// The side of the patient to which a direction leads, LPS.
QString GetLetter(const double direction[3])
{
  int axis = 0;
  for (int c = 1; c < 3; ++c)
  {
    axis = std::abs(direction[c]) > std::abs(direction[axis]) ? c : axis;
  }
  const char* const letters[3] = { "LR", "PA", "SI" };
  return QString(letters[axis][direction[axis] > 0 ? 0 : 1]);
}
}

//------------------------------------------------------------------------------
pqLacunaOutlinePanel::pqLacunaOutlinePanel(QWidget* parent)
  : Superclass(tr("Slice Outliner"), parent)
{
  this->Build();
  this->SliceTimer.setSingleShot(true);
  QObject::connect(&this->SliceTimer, &QTimer::timeout, this,
    [this] { this->ShowSlice(this->SliceNumber->value()); });
  auto* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(&pqActiveObjects::instance(), &pqActiveObjects::sourceChanged, this,
    &pqLacunaOutlinePanel::FindSource);
  QObject::connect(model, &pqServerManagerModel::preSourceRemoved, this,
    [this](pqPipelineSource* source)
    {
      this->Histories.remove(source);
      if (source == this->Surfaces)
      {
        this->Follow(nullptr);
      }
      if (source == this->Source)
      {
        this->Source = nullptr;
        this->Follow(nullptr);
        this->Tell(tr("Select a Slice Outliner, or add one: Filters > Lacuna > Slice Outliner"));
      }
    });
  this->Tell(tr("Select a Slice Outliner, or add one: Filters > Lacuna > Slice Outliner"));
  // ParaView shows what a plugin brings; this one waits until there is something to draw in
  this->hide();
  QTimer::singleShot(0, this,
    [this]
    {
      if (!this->Source)
      {
        this->hide();
      }
      this->FindSource();
    });
}

pqLacunaOutlinePanel::~pqLacunaOutlinePanel() = default;

//------------------------------------------------------------------------------
// As the filter's own (vtkLacunaSliceOutliner).
QColor pqLacunaOutlinePanel::GetOwnColor(int n)
{
  static const QColor palette[7] = { { 230, 159, 0 }, { 86, 180, 233 }, { 0, 158, 115 },
    { 240, 228, 66 }, { 213, 94, 0 }, { 204, 121, 167 }, { 0, 114, 178 } };
  return palette[n % 7];
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Tell(const QString& message, bool isReady)
{
  this->Canvas->SetMessage(message);
  this->widget()->setEnabled(isReady || message.isEmpty());
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::FindSource()
{
  pqPipelineSource* source = pqActiveObjects::instance().activeSource();
  if (!IsOf(source, "LacunaSliceOutliner") || source == this->Source)
  {
    return;
  }
  if (this->Source)
  {
    QObject::disconnect(this->Source, nullptr, this, nullptr);
  }
  this->Source = source;
  this->Follow(nullptr);
  this->LastTrace.IsValid = false;
  this->IsReady = false;
  this->IsPlaced = false;
  this->HasWindow = false;
  this->Tell(tr("Click Apply in the panel Properties"));
  QObject::connect(source, QOverload<pqPipelineSource*>::of(&pqPipelineSource::dataUpdated), this,
    [this] { this->SourceUpdated(); });
  if (source->modifiedState() != pqProxy::UNINITIALIZED)
  {
    this->SourceUpdated();
  }
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::SourceUpdated()
{
  if (!this->Source || this->IsWriting)
  {
    return;
  }
  const bool isFirst = !this->IsReady;
  this->Read();
  this->ReadPicture();
  this->IsReady = true;
  this->ShowStructures();
  this->ShowPicture();
  this->ShowOutlines();
  if (isFirst)
  {
    this->show();
    this->raise();
    for (pqPipelineSource* consumer : this->Source->getAllConsumers())
    {
      if (IsOf(consumer, "LacunaOutlinedStructures"))
      {
        this->Follow(consumer);
      }
    }
    QTimer::singleShot(0, this, &pqLacunaOutlinePanel::Attach); // when Apply has made the displays
  }
  this->ShowTable();
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Follow(pqPipelineSource* surfaces)
{
  if (this->Surfaces)
  {
    QObject::disconnect(this->Surfaces, nullptr, this, nullptr);
  }
  this->Surfaces = surfaces;
  if (surfaces)
  {
    QObject::connect(surfaces, QOverload<pqPipelineSource*>::of(&pqPipelineSource::dataUpdated),
      this, [this] { this->ShowTable(); });
  }
  this->ShowTable();
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Read()
{
  vtkSMProxy* proxy = this->Source->getProxy();
  Drawing drawing;
  const std::vector<double> points = vtkSMPropertyHelper(proxy, "OutlinePoints").GetDoubleArray();
  for (std::size_t i = 0; i + 4 < points.size(); i += 5)
  {
    const int structure = static_cast<int>(points[i]);
    const int number = static_cast<int>(points[i + 1]);
    if (drawing.Outlines.isEmpty() || drawing.Outlines.back().Structure != structure ||
      drawing.Outlines.back().Number != number)
    {
      drawing.Outlines.push_back({ structure, number, static_cast<int>(points[i + 2]), {} });
    }
    drawing.Outlines.back().Handles.push_back({ points[i + 3], points[i + 4] });
  }
  vtkSMPropertyHelper names(proxy, "StructureNames");
  for (unsigned int i = 0; i < names.GetNumberOfElements(); ++i)
  {
    drawing.Names.push_back(QString::fromUtf8(names.GetAsString(i)));
  }
  const std::vector<double> colors = vtkSMPropertyHelper(proxy, "StructureColors").GetDoubleArray();
  for (std::size_t i = 0; i + 2 < colors.size(); i += 3)
  {
    drawing.Colors.push_back(QColor::fromRgbF(colors[i], colors[i + 1], colors[i + 2]));
  }
  int structures = std::max<int>(1, drawing.Names.size());
  for (const Outline& outline : drawing.Outlines)
  {
    structures = std::max(structures, outline.Structure);
  }
  while (drawing.Names.size() < structures)
  {
    drawing.Names.push_back(tr("Structure %1").arg(drawing.Names.size() + 1));
  }
  while (drawing.Colors.size() < structures)
  {
    drawing.Colors.push_back(this->GetOwnColor(drawing.Colors.size()));
  }
  this->Now = drawing;
  const int slice = vtkSMPropertyHelper(proxy, "Slice").GetAsInt();
  proxy->UpdatePropertyInformation();
  vtkSMPropertyHelper range(proxy, "SliceRangeInfo");
  const QSignalBlocker slider(this->SliceSlider);
  const QSignalBlocker number(this->SliceNumber);
  this->SliceSlider->setRange(range.GetAsInt(0), range.GetAsInt(1));
  this->SliceNumber->setRange(range.GetAsInt(0), range.GetAsInt(1));
  this->SliceSlider->setValue(slice);
  this->SliceNumber->setValue(slice);
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Push(const Drawing& drawing)
{
  if (this->Source)
  {
    this->Histories[this->Source].Before.push_back(this->Now);
  }
  this->Replace(drawing);
}

void pqLacunaOutlinePanel::Replace(const Drawing& drawing)
{
  this->LastTrace.IsValid = false;
  if (this->Source)
  {
    this->Histories[this->Source].After.clear();
  }
  this->Write(drawing);
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::Write(const Drawing& drawing)
{
  if (!this->Source)
  {
    return;
  }
  this->Now = drawing;
  std::vector<double> points;
  for (const Outline& outline : drawing.Outlines)
  {
    for (const QPointF& handle : outline.Handles)
    {
      for (const double value : { 1.0 * outline.Structure, 1.0 * outline.Number,
             1.0 * outline.Slice, handle.x(), handle.y() })
      {
        points.push_back(value);
      }
    }
  }
  std::vector<double> colors;
  for (const QColor& color : drawing.Colors)
  {
    for (const double value : { color.redF(), color.greenF(), color.blueF() })
    {
      colors.push_back(value);
    }
  }
  vtkSMProxy* proxy = this->Source->getProxy();
  {
    SM_SCOPED_TRACE(PropertiesModified).arg("proxy", proxy);
    vtkSMPropertyHelper(proxy, "OutlinePoints")
      .Set(points.data(), static_cast<unsigned int>(points.size()));
    vtkSMPropertyHelper(proxy, "StructureColors")
      .Set(colors.data(), static_cast<unsigned int>(colors.size()));
    vtkSMPropertyHelper names(proxy, "StructureNames");
    names.SetNumberOfElements(static_cast<unsigned int>(drawing.Names.size()));
    for (int i = 0; i < drawing.Names.size(); ++i)
    {
      names.Set(static_cast<unsigned int>(i), drawing.Names[i].toUtf8().constData());
    }
    double grid[6];
    proxy->UpdatePropertyInformation();
    vtkSMPropertyHelper(proxy, "InputGrid").Get(grid, 6);
    vtkSMPropertyHelper(proxy, "VolumeGrid").Set(grid, 6);
    proxy->UpdateVTKObjects();
  }
  this->IsWriting = true; // the answer is what was written
  this->Attach();
  pqApplicationCore::instance()->render();
  this->IsWriting = false;
  this->ShowStructures();
  this->ShowOutlines();
  this->ShowTable();
}

//------------------------------------------------------------------------------
// The filter of surfaces, from the first outline on; both are shown in their structures' colours.
void pqLacunaOutlinePanel::Attach()
{
  if (!this->Source || !this->IsReady)
  {
    return;
  }
  pqView* view = pqActiveObjects::instance().activeView();
  auto* viewProxy = view ? vtkSMViewProxy::SafeDownCast(view->getProxy()) : nullptr;
  const auto color = [viewProxy](pqPipelineSource* source, double opacity)
  {
    auto* display = viewProxy ? vtkSMPVRepresentationProxy::SafeDownCast(
                                  viewProxy->FindRepresentation(source->getSourceProxy(), 0))
                              : nullptr;
    if (display)
    {
      SM_SCOPED_TRACE(PropertiesModified).arg("proxy", display);
      vtkSMPropertyHelper array(display, "ColorArrayName");
      array.SetInputArrayToProcess(vtkDataObject::CELL, "StructureColor");
      vtkSMPropertyHelper(display, "MapScalars").Set(0); // they are colours
      vtkSMPropertyHelper(display, "LineWidth").Set(3.0);
      vtkSMPropertyHelper(display, "Opacity").Set(opacity);
      display->UpdateVTKObjects();
    }
  };
  // a picture, not a lit surface, with no bar for its grey levels
  const auto showSlice = [this, viewProxy]
  {
    auto* slice = viewProxy ? vtkSMPVRepresentationProxy::SafeDownCast(
                                viewProxy->FindRepresentation(this->Source->getSourceProxy(), 1))
                            : nullptr;
    if (slice)
    {
      slice->SetScalarBarVisibility(viewProxy, false);
      SM_SCOPED_TRACE(PropertiesModified).arg("proxy", slice);
      vtkSMPropertyHelper(slice, "Ambient").Set(1.0);
      vtkSMPropertyHelper(slice, "Diffuse").Set(0.0);
      slice->UpdateVTKObjects();
    }
  };
  if (this->Now.Outlines.isEmpty())
  {
    if (this->IsPlaced)
    {
      return;
    }
    this->IsPlaced = true;
    color(this->Source, 1);
    showSlice();
    this->LookAtSlice(view); // which may be elsewhere than what was seen in pixels
    return;
  }
  if (!this->Surfaces)
  {
    auto* builder = pqApplicationCore::instance()->getObjectBuilder();
    pqPipelineSource* made =
      builder->createFilter("filters", "LacunaOutlinedStructures", this->Source, 0);
    if (!made)
    {
      return;
    }
    this->Surfaces = made;
    this->Surfaces->rename(tr("Structures"));
    this->Surfaces->setModifiedState(pqProxy::UNMODIFIED);
    vtkSMPropertyHelper(this->Surfaces->getProxy(), "RegistrationError")
      .Set(this->RegistrationError->value());
    this->Surfaces->getProxy()->UpdateVTKObjects();
    this->Surfaces->updatePipeline();
    if (viewProxy)
    {
      vtkNew<vtkSMParaViewPipelineControllerWithRendering> controller;
      controller->Show(this->Surfaces->getSourceProxy(), 0, viewProxy);
    }
    color(this->Source, 1);
    color(this->Surfaces, 0.5);
    this->Follow(made);
    showSlice();
    pqActiveObjects::instance().setActiveSource(this->Source);
    this->LookAtSlice(view);
  }
}

//------------------------------------------------------------------------------
// From the side on which the scanner shows the slice, upright, and a little askew.
void pqLacunaOutlinePanel::LookAtSlice(pqView* view)
{
  auto* render = view ? vtkSMRenderViewProxy::SafeDownCast(view->getProxy()) : nullptr;
  const vtkSmartPointer<vtkDataObject> data = pqLacunaFetch(this->Source->getSourceProxy(), 1);
  auto* grid = vtkStructuredGrid::SafeDownCast(data);
  if (!render || !grid || grid->GetNumberOfPoints() < 4)
  {
    return;
  }
  int size[3];
  grid->GetDimensions(size);
  double corner[3];
  double right[3];
  double down[3];
  double into[3];
  grid->GetPoint(0, corner);
  grid->GetPoint(size[0] - 1, right);
  grid->GetPoint(static_cast<vtkIdType>(size[0]) * (size[1] - 1), down);
  vtkMath::Subtract(right, corner, right);
  vtkMath::Subtract(down, corner, down);
  vtkMath::Normalize(right);
  vtkMath::Normalize(down);
  vtkMath::Cross(right, down, into);
  vtkCamera* camera = render->GetActiveCamera();
  const double* focus = camera->GetFocalPoint();
  constexpr double aside = 0.6;
  constexpr double above = 0.35;
  camera->SetPosition(focus[0] - into[0] + aside * right[0] - above * down[0],
    focus[1] - into[1] + aside * right[1] - above * down[1],
    focus[2] - into[2] + aside * right[2] - above * down[2]);
  camera->SetViewUp(-down[0], -down[1], -down[2]);
  vtkBoundingBox seen(grid->GetBounds());
  const vtkSmartPointer<vtkDataObject> lines = pqLacunaFetch(this->Source->getSourceProxy(), 0);
  auto* outlines = vtkPolyData::SafeDownCast(lines);
  if (outlines && outlines->GetNumberOfPoints() > 0)
  {
    seen.AddBounds(outlines->GetBounds());
  }
  double bounds[6];
  seen.GetBounds(bounds);
  render->ResetCamera(bounds);
  view->render();
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::ReadPicture()
{
  this->Picture = nullptr;
  const vtkSmartPointer<vtkDataObject> data = pqLacunaFetch(this->Source->getSourceProxy(), 1);
  auto* grid = vtkStructuredGrid::SafeDownCast(data);
  const auto get = [grid](const char* name, int component)
  {
    vtkDataArray* array = grid ? grid->GetFieldData()->GetArray(name) : nullptr;
    return array && component < array->GetNumberOfComponents() && array->GetNumberOfTuples() == 1
      ? array->GetComponent(0, component)
      : vtkMath::Nan();
  };
  const double number = get("SliceNumber", 0);
  this->Slice = std::isfinite(number) ? static_cast<int>(number) : this->SliceNumber->value();
  vtkDataArray* levels = grid ? grid->GetPointData()->GetScalars() : nullptr;
  if (!levels || grid->GetNumberOfPoints() == 0)
  {
    this->Tell(std::isfinite(number)
        ? tr("Slice %1 has no usable pose, so it has no place in mm. Go on to another slice")
            .arg(this->Slice)
        : tr("There is no picture: see the messages (View > Output Messages)"),
      true);
    return;
  }
  this->Tell({});
  this->Picture = vtkSmartPointer<vtkImageData>::New();
  this->Picture->SetExtent(grid->GetExtent());
  this->Picture->SetOrigin(get("PixelOrigin", 0), get("PixelOrigin", 1), 0);
  this->Picture->SetSpacing(get("PixelStep", 0), get("PixelStep", 1), 1);
  this->Picture->GetPointData()->SetScalars(levels);
  this->Aspect = get("PixelSize", 0) > 0 ? get("PixelSize", 1) / get("PixelSize", 0) : 1;
  int size[3];
  grid->GetDimensions(size);
  auto* coordinates =
    vtkStringArray::SafeDownCast(grid->GetFieldData()->GetAbstractArray("Coordinates"));
  this->Letters[0].clear();
  this->Letters[1].clear();
  if (coordinates && coordinates->GetNumberOfValues() == 1 &&
    coordinates->GetValue(0) == "Patient" && size[0] > 1 && size[1] > 1)
  {
    double corner[3];
    double right[3];
    double below[3];
    grid->GetPoint(0, corner);
    grid->GetPoint(1, right);
    grid->GetPoint(size[0], below);
    vtkMath::Subtract(right, corner, right);
    vtkMath::Subtract(corner, below, below); // upwards
    this->Letters[0] = GetLetter(right);
    this->Letters[1] = GetLetter(below);
  }
  double range[2];
  levels->GetFiniteRange(range);
  if (!this->HasWindow && range[1] > range[0])
  {
    std::copy_n(range, 2, this->LevelRange);
    std::copy_n(range, 2, this->Window);
    if (levels->GetDataType() == VTK_UNSIGNED_CHAR)
    {
      this->Window[0] = this->LevelRange[0] = 0;
      this->Window[1] = this->LevelRange[1] = 255;
    }
    this->HasWindow = true;
    this->ProposeLevel();
  }
}

//------------------------------------------------------------------------------
QPolygonF pqLacunaOutlinePanel::ToCanvas(const QPolygonF& places) const
{
  QPolygonF result;
  if (this->Picture)
  {
    const double* origin = this->Picture->GetOrigin();
    const double* step = this->Picture->GetSpacing();
    const int* extent = this->Picture->GetExtent();
    for (const QPointF& place : places)
    {
      result.push_back({ (place.x() - origin[0]) / step[0] - extent[0],
        (place.y() - origin[1]) / step[1] - extent[2] });
    }
  }
  return result;
}

QPolygonF pqLacunaOutlinePanel::FromCanvas(const QPolygonF& places) const
{
  QPolygonF result;
  if (this->Picture)
  {
    const double* origin = this->Picture->GetOrigin();
    const double* step = this->Picture->GetSpacing();
    const int* extent = this->Picture->GetExtent();
    for (const QPointF& place : places)
    {
      result.push_back({ origin[0] + step[0] * (place.x() + extent[0]),
        origin[1] + step[1] * (place.y() + extent[2]) });
    }
  }
  return result;
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::ProposeLevel()
{
  const int all[4] = { 0, -1, 0, -1 };
  const double level = vtkLacunaOutlineTools::ProposeLevel(this->Picture, all);
  const double part = (level - this->LevelRange[0]) / (this->LevelRange[1] - this->LevelRange[0]);
  const QSignalBlocker blocker(this->Level);
  this->Level->setValue(static_cast<int>(std::lround(LevelSteps * std::clamp(part, 0.0, 1.0))));
  this->ShowLevel();
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::ShowPicture()
{
  if (!this->Picture)
  {
    return;
  }
  int size[3];
  this->Picture->GetDimensions(size);
  QImage image(size[0], size[1], QImage::Format_Grayscale8);
  vtkDataArray* levels = this->Picture->GetPointData()->GetScalars();
  const double width = this->Window[1] - this->Window[0];
  vtkIdType n = 0;
  for (int row = 0; row < size[1]; ++row)
  {
    uchar* line = image.scanLine(row);
    for (int column = 0; column < size[0]; ++column, ++n)
    {
      const double part = width > 0 ? (levels->GetComponent(n, 0) - this->Window[0]) / width : 0;
      line[column] = static_cast<uchar>(part > 0 ? std::min(255.0, 255 * part + 0.5) : 0);
    }
  }
  this->Canvas->SetPicture(image, this->Aspect, this->Letters);
  this->Canvas->SetCaption(tr("Slice %1 (%2 to %3)")
                             .arg(this->Slice)
                             .arg(this->SliceSlider->minimum())
                             .arg(this->SliceSlider->maximum()));
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::ShowOutlines()
{
  QVector<pqLacunaOutlineCanvas::Outline> outlines;
  this->Shown.clear();
  const bool isSmooth =
    this->Source && vtkSMPropertyHelper(this->Source->getProxy(), "Smooth").GetAsInt() != 0;
  for (int i = 0; i < this->Now.Outlines.size(); ++i)
  {
    const Outline& outline = this->Now.Outlines[i];
    if (outline.Slice != this->Slice)
    {
      continue;
    }
    vtkNew<vtkPoints> points;
    vtkNew<vtkPoints> curve;
    ToPoints(outline.Handles, points);
    vtkLacunaOutlineTools::MakeCurve(points, isSmooth, curve);
    outlines.push_back({ this->ToCanvas(outline.Handles), this->ToCanvas(ToPlaces(curve)),
      this->Now.Colors[outline.Structure - 1], outline.Structure == this->GetStructure() });
    this->Shown.push_back(i);
  }
  this->Canvas->SetOutlines(outlines);
  this->Canvas->SetColor(this->Now.Colors[this->GetStructure() - 1]);
  const History history = this->Histories.value(this->Source);
  this->UndoButton->setEnabled(!history.Before.isEmpty());
  this->RedoButton->setEnabled(!history.After.isEmpty());
}

//------------------------------------------------------------------------------
int pqLacunaOutlinePanel::GetStructure() const
{
  return std::clamp<int>(this->Structures->currentIndex() + 1, 1, this->Now.Colors.size());
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::ShowStructures()
{
  const QSignalBlocker blocker(this->Structures);
  const int current = std::max(0, this->Structures->currentIndex());
  this->Structures->clear();
  for (int i = 0; i < this->Now.Names.size(); ++i)
  {
    QPixmap swatch(14, 14);
    swatch.fill(this->Now.Colors[i]);
    this->Structures->addItem(QIcon(swatch), this->Now.Names[i]);
  }
  this->Structures->setCurrentIndex(std::min<int>(current, this->Structures->count() - 1));
  QPixmap swatch(16, 16);
  swatch.fill(this->Now.Colors[this->GetStructure() - 1]);
  this->ColorButton->setIcon(QIcon(swatch));
}

//------------------------------------------------------------------------------
void pqLacunaOutlinePanel::ShowTable()
{
  vtkSmartPointer<vtkDataObject> data;
  if (this->Surfaces)
  {
    data = pqLacunaFetch(this->Surfaces->getSourceProxy(), 1);
    const QSignalBlocker blocker(this->RegistrationError);
    this->RegistrationError->setValue(
      vtkSMPropertyHelper(this->Surfaces->getProxy(), "RegistrationError").GetAsDouble());
  }
  auto* table = vtkTable::SafeDownCast(data);
  const int rows = table ? static_cast<int>(table->GetNumberOfRows()) : 0;
  this->Table->setRowCount(rows);
  this->Summary->clear();
  for (int row = 0; row < rows; ++row)
  {
    const auto number = [table, row](const char* name)
    { return table->GetValueByName(row, name).ToDouble(); };
    const QString name = QString::fromUtf8(table->GetValueByName(row, "Name").ToString().c_str());
    const QString status =
      QString::fromUtf8(table->GetValueByName(row, "Status").ToString().c_str());
    const double volume = number("Volume (ml)");
    const double error = number("Standard error (ml)");
    // as many digits as the error has a meaning for
    const int digits =
      error > 0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(error))), 1, 3) : 2;
    const QString volumeText = status.isEmpty()
      ? tr("%1 ml \u00b1 %2").arg(volume, 0, 'f', digits).arg(error, 0, 'f', digits)
      : status;
    const QString texts[] = { name, QString::number(number("Outlines")), volumeText,
      status.isEmpty() ? QString::number(number("Area (cm2)"), 'f', 1) : QString(),
      status.isEmpty() ? QString::number(number("Largest diameter (mm)"), 'f', 1) : QString() };
    for (int column = 0; column < 5; ++column)
    {
      auto* item = new QTableWidgetItem(texts[column]);
      item->setToolTip(column == 2 && status.isEmpty()
          ? tr("\u00b1 is the standard error: of drawing, and of where the slices lie")
          : texts[column]);
      this->Table->setItem(row, column, item);
    }
    if (static_cast<int>(number("Structure")) == this->GetStructure())
    {
      this->Summary->setText(QString("%1: %2").arg(name, volumeText));
    }
  }
  this->Table->resizeColumnsToContents();
}
