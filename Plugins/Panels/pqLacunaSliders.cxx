// SPDX-License-Identifier: BSD-3-Clause
#include "pqLacunaSliders.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqLacunaWindow.h"
#include "pqPipelineSource.h"
#include "pqPropertiesPanel.h"
#include "pqServerManagerModel.h"
#include "pqView.h"
#include "vtkPVDataInformation.h"
#include "vtkPythonInterpreter.h"
#include "vtkSMArrayRangeDomain.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMTrace.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace
{
constexpr int Steps = 400;

struct Entry
{
  const char* Proxy;
  const char* Property;
  const char* Text;
  double Low, High; ///< where the data give no range
};

/// Numbers whose effect is computed in a moment.
constexpr Entry Entries[] = {
  { "Contour", "ContourValues", "Level", 0, 255 },
  { "LacunaSkullBone", "Level", "Level (HU)", 0, 2000 },
  { "LacunaBSplineIsoRayCaster", "IsoValues", "Level", 0, 2000 },
  { "LacunaSliceRayCaster", "IsoValue", "Level", 0, 255 },
  { "LacunaRBFHoleFiller", "SupportMargin", "Margin (mm)", 2, 50 },
  { "LacunaImplantPlate", "Thickness", "Thickness (mm)", 0.5, 10 },
  { "LacunaImplantPlate", "EdgeClearance", "Clearance (mm)", 0, 3 },
  { "LacunaDefectModel", "Margin", "Margin (mm)", 1, 50 },
};
}

//------------------------------------------------------------------------------
pqLacunaSliders::pqLacunaSliders(QWidget* window)
  : Superclass(window)
  , Rows(new QVBoxLayout(this))
{
  this->setObjectName("LacunaSliders");
  this->Rows->setContentsMargins(4, 2, 4, 2);
  this->hide();
  auto* panel = window->findChild<pqPropertiesPanel*>();
  auto* layout = panel ? qobject_cast<QBoxLayout*>(panel->layout()) : nullptr;
  if (!layout)
  {
    return;
  }
  layout->insertWidget(0, this);
  auto& active = pqActiveObjects::instance();
  QObject::connect(&active, &pqActiveObjects::sourceChanged, this, &pqLacunaSliders::Show);
  QObject::connect(pqApplicationCore::instance()->getServerManagerModel(),
    &pqServerManagerModel::modifiedStateChanged, this,
    [this] { this->Show(pqActiveObjects::instance().activeSource()); });
}

//------------------------------------------------------------------------------
pqLacunaSliders::~pqLacunaSliders() = default;

//------------------------------------------------------------------------------
void pqLacunaSliders::Show(pqPipelineSource* source)
{
  const bool isApplied = source && source->modifiedState() != pqProxy::UNINITIALIZED;
  if (source == this->Source && (isApplied || !source))
  {
    return;
  }
  this->Source = isApplied ? source : nullptr;
  for (QWidget* row : this->findChildren<QWidget*>(QString(), Qt::FindDirectChildrenOnly))
  {
    row->hide();
    row->deleteLater();
  }
  this->hide();
  if (!this->Source)
  {
    return;
  }
  QObject::connect(source, &QObject::destroyed, this,
    [this, source]
    {
      if (this->Source == source)
      {
        this->Show(nullptr);
      }
    });
  vtkSMSourceProxy* proxy = source->getSourceProxy();
  const char* name = proxy->GetXMLName();
  for (const Entry& entry : Entries)
  {
    if (std::strcmp(name, entry.Proxy) == 0)
    {
      this->Add(proxy, entry.Property, tr(entry.Text), entry.Low, entry.High);
    }
  }
  const bool isCut = std::strcmp(name, "Clip") == 0;
  if (isCut || std::strcmp(name, "Cut") == 0)
  {
    vtkSMProxy* plane =
      vtkSMPropertyHelper(proxy, isCut ? "ClipFunction" : "CutFunction").GetAsProxy();
    auto* input = vtkSMSourceProxy::SafeDownCast(vtkSMPropertyHelper(proxy, "Input").GetAsProxy());
    if (plane && input && plane->GetProperty("Offset"))
    {
      double bounds[6];
      input->GetDataInformation(0)->GetBounds(bounds);
      const double half = 0.5 *
        std::sqrt(std::pow(bounds[1] - bounds[0], 2) + std::pow(bounds[3] - bounds[2], 2) +
          std::pow(bounds[5] - bounds[4], 2));
      this->Add(plane, "Offset", tr("Cut (mm)"), -half, half);
    }
  }
}

//------------------------------------------------------------------------------
void pqLacunaSliders::Add(
  vtkSMProxy* proxy, const char* name, const QString& text, double low, double high)
{
  vtkSMProperty* property = proxy->GetProperty(name);
  if (!property || vtkSMPropertyHelper(property).GetNumberOfElements() == 0)
  {
    return;
  }
  if (auto* range =
        vtkSMArrayRangeDomain::SafeDownCast(property->FindDomain("vtkSMArrayRangeDomain")))
  {
    if (range->GetMinimumExists(0) && range->GetMaximumExists(0) &&
      range->GetMinimum(0) < range->GetMaximum(0))
    {
      low = range->GetMinimum(0);
      high = range->GetMaximum(0);
    }
  }
  auto* line = new QWidget(this);
  auto* layout = new QHBoxLayout(line);
  layout->setContentsMargins(0, 0, 0, 0);
  auto* slider = new QSlider(Qt::Horizontal, line);
  slider->setObjectName(QString("LacunaSlider_") + name);
  slider->setRange(0, Steps);
  slider->setToolTip(tr("Drag: the view follows at once, without Apply."));
  auto* value = new QLabel(line);
  value->setMinimumWidth(value->fontMetrics().horizontalAdvance("-0000.0"));
  value->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  layout->addWidget(new QLabel(text, line));
  layout->addWidget(slider, 1);
  layout->addWidget(value);
  this->Rows->addWidget(line);
  const Row row{ proxy, property, low, high, slider, value };
  this->Follow(row);
  QObject::connect(
    slider, &QSlider::valueChanged, this, [this, row](int step) { this->Drag(row, step); });
  pqActiveObjects& active = pqActiveObjects::instance();
  QObject::connect(
    &active, &pqActiveObjects::dataUpdated, line, [this, row] { this->Follow(row); });
  this->show();
}

//------------------------------------------------------------------------------
void pqLacunaSliders::Follow(const Row& row)
{
  const double value = vtkSMPropertyHelper(row.Property).GetAsDouble();
  row.Value->setText(QString::number(value, 'g', 4));
  if (!row.Slider->isSliderDown())
  {
    const double part = (value - row.Low) / (row.High - row.Low);
    const QSignalBlocker quiet(row.Slider);
    row.Slider->setValue(static_cast<int>(std::lround(Steps * std::clamp(part, 0.0, 1.0))));
  }
}

//------------------------------------------------------------------------------
void pqLacunaSliders::Drag(const Row& row, int step)
{
  const double value = row.Low + (row.High - row.Low) * step / Steps;
  {
    SM_SCOPED_TRACE(PropertiesModified).arg("proxy", row.Proxy);
    vtkSMPropertyHelper(row.Property).Set(value);
    row.Proxy->UpdateVTKObjects();
  }
  if (vtkPythonInterpreter::IsInitialized()) // else nothing is marked
  {
    pqLacunaWindow::Run("hide_places(" + QString::number(row.Proxy->GetGlobalID()) + ")");
  }
  row.Value->setText(QString::number(value, 'g', 4));
  if (pqView* view = pqActiveObjects::instance().activeView())
  {
    view->render(); // once, when the events that wait have been seen
  }
}
