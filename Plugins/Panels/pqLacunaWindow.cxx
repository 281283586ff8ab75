// SPDX-License-Identifier: BSD-3-Clause
#include "pqLacunaWindow.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqFileDialog.h"
#include "pqLacunaGuide.h"
#include "pqLacunaSliders.h"
#include "pqPipelineSource.h"
#include "pqPointPickingHelper.h"
#include "pqPropertyWidget.h"
#include "pqProxyWidget.h"
#include "pqRepresentation.h"
#include "pqServerManagerModel.h"
#include "pqView.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkCompositeRepresentation.h"
#include "vtkGeometryRepresentation.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkPVDataSetAttributesInformation.h"
#include "vtkPVLODActor.h"
#include "vtkPVXMLElement.h"
#include "vtkPolyData.h"
#include "vtkPythonInterpreter.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkSMSourceProxy.h"
#include "vtkSmartPointer.h"
#include "vtkStaticCellLocator.h"

#include <QAction>
#include <QApplication>
#include <QComboBox>
#include <QDockWidget>
#include <QEvent>
#include <QGridLayout>
#include <QLabel>
#include <QMainWindow>
#include <QMenu>
#include <QMenuBar>
#include <QTimer>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

namespace
{
struct Entry
{
  const char* Text;
  const char* Job; ///< of lacuna.window; of filters and sources the name of the proxy
  const char* ToolTip;
};

constexpr Entry Jobs[] = {
  { "CT to &Implant", "ct_to_implant",
    "The largest hole of a skull is closed: bone, implant and the error to expect. Select the CT "
    "first." },
  { "Implant to &Files and Report", "report_implant",
    "Writes implant.stl and a report (HTML, PDF). Select a Skull Implant first." },
  { "CT to I&GES", "ct_to_iges",
    "The hole that the 3-D view looks into becomes an IGES surface. Select the CT first." },
  { "&Sweep to Surface", "sweep_to_surface",
    "Tracked slices become a volume and a surface. Select the sweep first." },
  { "Sweep to &Bone", "sweep_to_bone",
    "The surface of the bone in tracked slices: bright, with a shadow. Select the sweep first." },
  { "&Live Layout", "live_layout",
    "A tracker and a scanner, live: the scanner's picture, and slices and surface as they grow." },
};
constexpr Entry Samples[] = {
  { "Sample &CT: Skull with a Hole", "sample_ct", "A skull of mathematics, with a hole." },
  { "Sample Sweep: &Ultrasound", "sample_sweep",
    "Tracked slices of an organ with a cyst and lesions, of mathematics." },
};

/// What filters are for; one without a name begins a part of the menu.
constexpr Entry Filters[] = {
  { "Ultrasound", nullptr, nullptr },
  { "Frames with poses", "LacunaAssembleTrackedSlices", nullptr },
  { "What the probe sees", "LacunaScanRegion", nullptr },
  { "Where pixels lie", "LacunaProbeCalibration", nullptr },
  { "How late frames are", "LacunaTemporalCalibration", nullptr },
  { "Is the tracker right?", "LacunaTrackerSelfTest", nullptr },
  { "Slices at one moment of the heart or breath", "LacunaGateSlices", nullptr },
  { "Bone in slices", "LacunaBoneEcho", nullptr },
  { "Less speckle", "LacunaSpeckleFilter", nullptr },
  { "Contrast to speckle", "LacunaContrastToSpeckle", nullptr },
  { "Slices as pictures in space", "LacunaSlicePlanes", nullptr },
  { "Draw around an organ", "LacunaSliceOutliner", nullptr },
  { "An organ's volume in ml", "LacunaOutlinedStructures", nullptr },
  { "Volume of a sweep", "LacunaSweptVolume", nullptr },
  { "Surface while you scan", "LacunaSliceRayCaster", nullptr },
  { "Skull and implant", nullptr, nullptr },
  { "Skull alone", "LacunaSkullBone", nullptr },
  { "Implant for any hole", "LacunaSkullImplant", nullptr },
  { "Cut, guide and implant planned", "LacunaSkullResection", nullptr },
  { "The other side", "LacunaMirror", nullptr },
  { "Depth map of a skull", "LacunaBSplineIsoRayCaster", nullptr },
  { "Shaded picture of a depth map", "LacunaDepthMapShader", nullptr },
  { "Surface of a depth map", "LacunaDepthMapSurface", nullptr },
  { "Fill a hole of a depth map", "LacunaRBFHoleFiller", nullptr },
  { "Making it", nullptr, nullptr },
  { "Plate of a filled hole", "LacunaImplantPlate", nullptr },
  { "Model of the defect", "LacunaDefectModel", nullptr },
  { "Mould to press a sheet", "LacunaPressOrientation", nullptr },
  { "Milling path", "LacunaMillingToolPath", nullptr },
  { "Surfaces and shapes", nullptr, nullptr },
  { "Surface through points", "LacunaRBFSurface", nullptr },
  { "How enclosed a place is", "LacunaOccludedAngle", nullptr },
  { "Surface of an incomplete shape", "LacunaOcclusionSurface", nullptr },
  { "Values between points", "LacunaRBFInterpolator", nullptr },
  { "Warp by landmarks", "LacunaRBFImageWarp", nullptr },
};

void SaveSolid(QMainWindow* window)
{
  pqFileDialog dialog(nullptr, window, QObject::tr("Save Solid"), QString(),
    QObject::tr("STL (*.stl);;PLY (*.ply);;3MF (*.3mf);;STEP (*.step *.stp)"), false);
  dialog.setObjectName("LacunaSaveSolid");
  dialog.setFileMode(pqFileDialog::AnyFile);
  if (dialog.exec() == QDialog::Accepted && !dialog.getSelectedFiles().isEmpty())
  {
    const QByteArray path = dialog.getSelectedFiles().first().toUtf8().toHex();
    pqLacunaWindow::Run("run('save_solid', bytes.fromhex('" + QString(path) + "').decode())");
  }
}

/// ParaView's action that makes a filter, by the name of its proxy; null when there is none.
QAction* FindAction(const QWidget* window, const char* filter)
{
  const QStringList data{ "filters", filter };
  for (QAction* action : window->findChildren<QAction*>())
  {
    if (action->data().toStringList() == data)
    {
      return action;
    }
  }
  return nullptr;
}

/// A submenu for each part, in which filters have the name of what they are for beside their own. What is there stays.
void AddFilters(QMenu* menu, QMainWindow* window)
{
  QMenu* part = nullptr;
  for (const Entry& entry : Filters)
  {
    if (!entry.Job)
    {
      part = menu->findChild<QMenu*>(entry.Text);
      if (!part)
      {
        part = menu->addMenu(QObject::tr(entry.Text));
        part->setObjectName(entry.Text);
      }
      continue;
    }
    QAction* original = FindAction(window, entry.Job);
    if (!original || part->findChild<QAction*>(entry.Job))
    {
      continue; // its module is not built, or it is there
    }
    const QString text = QString("%1: %2").arg(QObject::tr(entry.Text), original->text());
    original->setToolTip(text); // in toolbars
    QAction* action = part->addAction(original->icon(), text);
    action->setObjectName(entry.Job);
    QObject::connect(action, &QAction::triggered, original, &QAction::trigger);
    // ParaView's menu knows what fits the selection
    const auto follow = [action, original] { action->setEnabled(original->isEnabled()); };
    QObject::connect(original, &QAction::changed, action, follow);
    follow();
  }
}

bool HasHounsfieldUnits(vtkSMSourceProxy* source)
{
  const auto* points = source->GetDataInformation(0)->GetPointDataInformation();
  return points->GetArrayInformation("HounsfieldUnits") != nullptr;
}

/// Whether it is Lacuna's, or made of what is.
bool IsOurs(vtkSMProxy* proxy)
{
  if (!proxy || !proxy->GetXMLName())
  {
    return false;
  }
  if (std::strncmp(proxy->GetXMLName(), "Lacuna", 6) == 0)
  {
    return true;
  }
  return proxy->GetProperty("Input") &&
    IsOurs(vtkSMPropertyHelper(proxy, "Input", true).GetAsProxy());
}

/// The label that a panel shows to the left of an editor; null when there is none.
QLabel* FindLabel(const QGridLayout* layout, QWidget* editor)
{
  const int index = layout->indexOf(editor);
  int row = 0, column = 0, rows = 0, columns = 0;
  if (index >= 0)
  {
    layout->getItemPosition(index, &row, &column, &rows, &columns);
  }
  QLayoutItem* item = column > 0 ? layout->itemAtPosition(row, 0) : nullptr;
  return item ? qobject_cast<QLabel*>(item->widget()) : nullptr;
}

/// Adds units and what 0 means to labels that have none yet, and what "None" means to lists.
void AddUnits(const QWidget* panel)
{
  constexpr const char* done = "LacunaUnit";
  const auto* layout = qobject_cast<QGridLayout*>(panel->layout());
  if (!layout)
  {
    return;
  }
  for (pqPropertyWidget* editor : panel->findChildren<pqPropertyWidget*>())
  {
    vtkPVXMLElement* hints = editor->property() ? editor->property()->GetHints() : nullptr;
    vtkPVXMLElement* hint = hints ? hints->FindNestedElementByName("LacunaLabel") : nullptr;
    if (const char* none = hint ? hint->GetAttribute("none") : nullptr)
    {
      auto* list = editor->findChild<QComboBox*>();
      const int index = list ? list->findText("None") : -1;
      if (index >= 0)
      {
        list->setItemText(index, QObject::tr(none));
      }
    }
    QLabel* label = hint ? FindLabel(layout, editor) : nullptr;
    if (label && !label->property(done).toBool())
    {
      label->setProperty(done, true);
      label->setObjectName(
        QString("LacunaLabel_") + editor->proxy()->GetPropertyName(editor->property()));
      const QString unit = hint->GetAttributeOrEmpty("unit"),
                    zero = hint->GetAttributeOrEmpty("zero");
      QString text = label->text().remove("<p>").remove("</p>");
      text += unit.isEmpty() ? QString() : QString(" (%1)").arg(unit);
      text += zero.isEmpty() ? QString() : QString("<br><small>0: %1</small>").arg(zero);
      label->setText(text);
    }
  }
}
}

namespace
{
constexpr const char* Filler = "LacunaRBFHoleFiller";
constexpr const char* Shown = "LacunaShown"; ///< property of a source that show_applied has shown

bool IsFiller(vtkSMProxy* proxy)
{
  return proxy && std::strcmp(proxy->GetXMLName(), Filler) == 0;
}

/// Shows what a Hole Filler would replace, as its panel says before Apply.
void ShowMarks(const pqPropertyWidget* editor)
{
  const auto* source =
    pqApplicationCore::instance()->getServerManagerModel()->findItem<pqPipelineSource*>(
      editor->proxy());
  if (!source || source->modifiedState() != pqProxy::UNINITIALIZED)
  {
    return;
  }
  vtkTypeUInt32 region = 0;
  auto* chosen = editor->findChild<pqProxyWidget*>("ChosenProxyWidget");
  if (chosen && chosen->proxy() && std::strcmp(chosen->proxy()->GetXMLName(), "None") != 0)
  {
    chosen->apply(); // to the region, which the filler does not have yet
    region = chosen->proxy()->GetGlobalID();
  }
  pqLacunaWindow::Run(
    QString("show_marks(%1, %2)").arg(editor->proxy()->GetGlobalID()).arg(region));
}

/// Shows it again when what marks the defect was changed and rests.
void FollowMarks(const QWidget* panel)
{
  constexpr const char* done = "LacunaMarks";
  for (auto* region : panel->findChildren<pqPropertyWidget*>("DefectRegion"))
  {
    if (!IsFiller(region->proxy()))
    {
      continue;
    }
    auto* rest = region->findChild<QTimer*>(done);
    if (!rest)
    {
      rest = new QTimer(region);
      rest->setObjectName(done);
      rest->setSingleShot(true);
      rest->setInterval(200); // ms
      QObject::connect(rest, &QTimer::timeout, region, [region] { ShowMarks(region); });
      rest->start();
    }
    for (const char* name :
      { "DefectRegion", "DefectArray", "SupportArray", "Surface", "Selection" })
    {
      for (auto* editor : panel->findChildren<pqPropertyWidget*>(name))
      {
        if (editor->proxy() == region->proxy() && !editor->property(done).toBool())
        {
          editor->setProperty(done, true);
          QObject::connect(
            editor, &pqPropertyWidget::changeAvailable, rest, qOverload<>(&QTimer::start));
        }
      }
    }
  }
}

/// How far along a line from begin (0) to end (1) it first meets a triangle of what is shown; more than 1: nowhere.
double Meet(vtkDataObject* shown, const double (&begin)[3], const double (&end)[3])
{
  double first = 2;
  if (auto* parts = vtkCompositeDataSet::SafeDownCast(shown))
  {
    const auto part = vtk::TakeSmartPointer(parts->NewIterator());
    for (part->InitTraversal(); !part->IsDoneWithTraversal(); part->GoToNextItem())
    {
      first = std::min(first, Meet(part->GetCurrentDataObject(), begin, end));
    }
    return first;
  }
  auto* surface = vtkPolyData::SafeDownCast(shown);
  if (surface && surface->GetNumberOfCells() > 0)
  {
    vtkNew<vtkStaticCellLocator> locator;
    locator->SetDataSet(surface);
    locator->BuildLocator();
    double part = 0, place[3], inside[3];
    int subcell = 0;
    vtkIdType cell = -1;
    if (locator->IntersectWithLine(begin, end, 1e-6, part, place, inside, subcell, cell))
    {
      first = part;
    }
  }
  return first;
}

/// What is under the mouse on slices and depth maps that are shown where they lie.
struct Hit
{
  bool IsOurs = false;  // nothing else is in front
  bool IsKnown = false; // its data are in this process
  std::array<double, 3> Place{};
};

/// ParaView's P looks in the data behind what is shown, pixels in a plane of their own, and finds a point elsewhere.
Hit PickInSpace(const pqView* view)
{
  Hit hit;
  auto* proxy = view ? vtkSMRenderViewProxy::SafeDownCast(view->getViewProxy()) : nullptr;
  vtkRenderer* renderer = proxy ? proxy->GetRenderer() : nullptr;
  if (!renderer || !proxy->GetInteractor())
  {
    return hit;
  }
  const int* mouse = proxy->GetInteractor()->GetEventPosition();
  double ends[2][3];
  for (int side = 0; side < 2; ++side)
  {
    renderer->SetDisplayPoint(mouse[0], mouse[1], side);
    renderer->DisplayToWorld();
    double world[4];
    renderer->GetWorldPoint(world);
    for (int axis = 0; axis < 3; ++axis)
    {
      ends[side][axis] = world[axis] / world[3];
    }
  }
  double first = 2;
  for (pqRepresentation* each : view->getRepresentations())
  {
    auto* shown = each->isVisible()
      ? vtkCompositeRepresentation::SafeDownCast(each->getProxy()->GetClientSideObject())
      : nullptr;
    const char* kind = shown ? shown->GetActiveRepresentationKey() : nullptr;
    auto* active =
      shown ? vtkGeometryRepresentation::SafeDownCast(shown->GetActiveRepresentation()) : nullptr;
    if (!kind || !active)
    {
      continue;
    }
    const bool isOurs =
      std::strcmp(kind, "Relief in Space") == 0 || std::strcmp(kind, "Slices in Space") == 0;
    // the display may move what it shows
    vtkNew<vtkMatrix4x4> back;
    vtkMatrix4x4::Invert(active->GetActor()->GetMatrix(), back);
    double local[2][4];
    for (int side = 0; side < 2; ++side)
    {
      const double end[4] = { ends[side][0], ends[side][1], ends[side][2], 1 };
      back->MultiplyPoint(end, local[side]);
    }
    vtkDataObject* data = shown->GetRenderedDataObject(0);
    const double part = Meet(
      data, { local[0][0], local[0][1], local[0][2] }, { local[1][0], local[1][1], local[1][2] });
    hit.IsOurs = part < first ? isOurs : hit.IsOurs || (isOurs && !data && first > 1);
    first = std::min(first, part);
  }
  hit.IsKnown = first <= 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    hit.Place[axis] = ends[0][axis] + first * (ends[1][axis] - ends[0][axis]);
  }
  return hit;
}

/// Makes P use PickInSpace.
void MendPicking(const QWidget* panel)
{
  constexpr const char* done = "LacunaPicking";
  for (auto* helper : panel->findChildren<pqPointPickingHelper*>())
  {
    if (helper->property(done).toBool())
    {
      continue;
    }
    helper->setProperty(done, true);
    // a line takes each pick for its next end, and a normal is no place
    const bool isPlace = helper->getPickOption() == pqPointPickingHelper::Coordinates &&
      !(helper->parent() && helper->parent()->inherits("pqLinePropertyWidget"));
    const auto busy = std::make_shared<bool>(false);
    QObject::connect(helper, &pqPointPickingHelper::pick, helper,
      [helper, busy, isPlace]
      {
        const Hit hit = *busy ? Hit() : PickInSpace(pqActiveObjects::instance().activeView());
        if (hit.IsOurs && hit.IsKnown && isPlace)
        {
          *busy = true;
          Q_EMIT helper->pick(hit.Place[0], hit.Place[1], hit.Place[2]);
          *busy = false;
        }
        else if (hit.IsOurs)
        {
          qWarning("Lacuna: what was picked is a place of the flat image, not of the picture in "
                   "space. Pick on the "
                   "surface that Depth Map Surface or Slice Planes makes of it");
        }
      });
  }
}
}

namespace
{
constexpr const char* ComesUp =
  "LacunaComesUp"; ///< property of Output Messages that ParaView has shown

QDockWidget* FindMessages()
{
  const QWidget* window = pqCoreUtilities::mainWidget();
  return window ? window->findChild<QDockWidget*>("outputWidgetDock") : nullptr;
}

/// Puts Output Messages below the view when it has just come up: ParaView has it float over what the message is about.
void DockMessages()
{
  QDockWidget* messages = FindMessages();
  auto* window = qobject_cast<QMainWindow*>(pqCoreUtilities::mainWidget());
  if (!window || !messages || !messages->property(ComesUp).toBool())
  {
    return;
  }
  messages->setProperty(ComesUp, false);
  if (messages->isVisible() && messages->isFloating())
  {
    messages->setFloating(false);
    window->addDockWidget(Qt::BottomDockWidgetArea, messages);
    window->resizeDocks({ messages }, { window->height() / 6 }, Qt::Vertical);
  }
}
}

//------------------------------------------------------------------------------
pqLacunaWindow::pqLacunaWindow(QObject* parent)
  : Superclass(parent)
{
}

//------------------------------------------------------------------------------
pqLacunaWindow::~pqLacunaWindow() = default;

//------------------------------------------------------------------------------
void pqLacunaWindow::Run(const QString& call)
{
  vtkPythonInterpreter::Initialize();
  vtkPythonInterpreter::RunSimpleString(QString(
    "try:\n"
    "  import lacuna.window\n"
    "except ImportError as lacuna_error:\n"
    "  import paraview\n"
    "  paraview.print_error(f\"Lacuna's Python package is not found ({lacuna_error}): start "
    "ParaView after '. lacuna-env.sh'\")\n"
    "else:\n"
    "  lacuna.window.%1\n")
                                          .arg(call)
                                          .toUtf8()
                                          .constData());
  DockMessages();
}

//------------------------------------------------------------------------------
void pqLacunaWindow::startup()
{
  auto* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(
    model, &pqServerManagerModel::modifiedStateChanged, this, &pqLacunaWindow::FollowState);
  QObject::connect(model, &pqServerManagerModel::preItemRemoved, this,
    [this](pqServerManagerModelItem* item)
    {
      const auto* source = qobject_cast<pqPipelineSource*>(item);
      if (source && IsOurs(source->getProxy()) && vtkPythonInterpreter::IsInitialized())
      {
        Run("hide_places(" + QString::number(source->getProxy()->GetGlobalID()) + ")");
      }
      if (this->NewSources.remove(item) && source && IsFiller(source->getProxy()))
      {
        Run("hide_marks()");
      }
    });
  QTimer::singleShot(0, this, &pqLacunaWindow::AddMenu); // when the window has its own
  qApp->installEventFilter(this);
}

//------------------------------------------------------------------------------
void pqLacunaWindow::shutdown()
{
  qApp->removeEventFilter(this);
}

//------------------------------------------------------------------------------
bool pqLacunaWindow::eventFilter(QObject* object, QEvent* event)
{
  if (event->type() == QEvent::LayoutRequest)
  {
    if (const auto* panel = qobject_cast<pqProxyWidget*>(object))
    {
      AddUnits(panel);
      FollowMarks(panel);
      MendPicking(panel);
    }
  }
  else if (event->type() == QEvent::Show)
  {
    auto* dock = qobject_cast<QDockWidget*>(object);
    if (dock && dock->isFloating() && dock == FindMessages())
    {
      dock->setProperty(ComesUp, true);
    }
  }
  return false;
}

//------------------------------------------------------------------------------
void pqLacunaWindow::AddMenu()
{
  auto* window = qobject_cast<QMainWindow*>(pqCoreUtilities::mainWidget());
  if (!window)
  {
    return;
  }
  auto* menu = new QMenu(tr("&Lacuna"), window);
  menu->setObjectName("menuLacuna");
  menu->setToolTipsVisible(true);
  const auto add = [this, menu](const Entry& entry)
  {
    QAction* action = menu->addAction(tr(entry.Text));
    action->setObjectName(QString("Lacuna_") + entry.Job);
    action->setToolTip(tr(entry.ToolTip));
    QObject::connect(
      action, &QAction::triggered, this, [job = QString(entry.Job)] { Run("run('" + job + "')"); });
  };
  for (const Entry& entry : Jobs)
  {
    add(entry);
  }
  QAction* save = menu->addAction(tr("Save S&olid (STL, PLY, 3MF, STEP)..."));
  save->setObjectName("Lacuna_save_solid");
  save->setToolTip(
    tr("Writes what is selected for a printer, in mm, with a record; mirrored data are refused."));
  QObject::connect(save, &QAction::triggered, this, [window] { SaveSolid(window); });
  menu->addSeparator();
  for (const Entry& entry : Samples)
  {
    add(entry);
  }
  menu->addSeparator();
  AddFilters(menu, window);
  menu->addSeparator();
  auto* guide = new pqLacunaGuide(window);
  QAction* help = menu->addAction(tr("&Guide"));
  help->setObjectName("Lacuna_guide");
  help->setToolTip(
    tr("The user guide. The button ? of the Properties panel opens a filter's page."));
  QObject::connect(help, &QAction::triggered, guide, [guide] { guide->Open(QString()); });
  QObject::connect(menu, &QMenu::aboutToShow, this,
    [menu, window]
    {
      // ParaView looks what fits the selection when its own menu of filters is opened
      if (auto* filters = window->findChild<QMenu*>("menuFilters"))
      {
        Q_EMIT filters->aboutToShow();
      }
      AddFilters(menu, window); // where ParaView learns of the filters later
    });
  QAction* before = nullptr; // Help is the last
  for (QAction* action : window->menuBar()->actions())
  {
    if (action->text().remove('&') == "Help")
    {
      before = action;
    }
  }
  window->menuBar()->insertMenu(before, menu);
  new pqLacunaSliders(window); // the window's
}

//------------------------------------------------------------------------------
void pqLacunaWindow::FollowState(pqServerManagerModelItem* item)
{
  auto* source = qobject_cast<pqPipelineSource*>(item);
  if (!source)
  {
    return;
  }
  vtkSMSourceProxy* proxy = source->getSourceProxy();
  const QString identity = QString::number(proxy->GetGlobalID());
  if (source->modifiedState() == pqProxy::UNINITIALIZED)
  {
    this->NewSources.insert(item);
    if (std::strcmp(proxy->GetXMLName(), "LacunaTrackedSliceReader") == 0)
    {
      Run("offer_calibration(" + identity + ")");
    }
    if (IsFiller(proxy))
    {
      Run("place_regions(" + identity + ")");
    }
  }
  else if (source->modifiedState() == pqProxy::UNMODIFIED && this->NewSources.remove(item) &&
    (IsOurs(proxy) || HasHounsfieldUnits(proxy)))
  {
    if (IsFiller(proxy))
    {
      Run("hide_marks()");
    }
    source->setProperty(Shown, true);
    Run("show_applied(" + identity + ")");
  }
  else if (source->modifiedState() == pqProxy::UNMODIFIED && source->property(Shown).toBool())
  {
    Run("show_places(" + identity + ")");
  }
}
