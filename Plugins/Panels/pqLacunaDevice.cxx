// SPDX-License-Identifier: BSD-3-Clause
#include "pqLacunaDevice.h"

#include "vtkPVSession.h"
#include "vtkPVXMLElement.h"
#include "vtkSMProperty.h"
#include "vtkSMProxy.h"
#include "vtkSMSession.h"

#include <QComboBox>
#include <QDir>
#include <QFile>
#include <QHBoxLayout>
#include <QLineEdit>
#include <QMap>
#include <QSignalBlocker>
#include <QVector>

#include <functional>
#include <utility>

namespace
{
/// Files of /dev by name, each with what it is.
using Devices = QVector<QPair<QString, QString>>;

Devices FindTrackers()
{
  Devices found;
  const QDir named("/dev/serial/by-id");
  QMap<QString, QString> names; // of ports
  for (const QFileInfo& link : named.entryInfoList(QDir::System | QDir::Files))
  {
    names[link.symLinkTarget()] = link.fileName();
  }
  for (const QString& port :
    QDir("/dev").entryList({ "ttyUSB*", "ttyACM*" }, QDir::System | QDir::Files))
  {
    found.push_back({ "/dev/" + port, names.value("/dev/" + port, QObject::tr("serial port")) });
  }
  found.push_back({ "igtl://localhost:18944", QObject::tr("OpenIGTLink server: PLUS, 3D Slicer") });
  return found;
}

Devices FindVideos()
{
  Devices found;
  for (const QString& video : QDir("/dev").entryList({ "video*" }, QDir::System))
  {
    QFile name("/sys/class/video4linux/" + video + "/name");
    const bool isOpen = name.open(QIODevice::ReadOnly);
    found.push_back({ "/dev/" + video,
      isOpen ? QString::fromUtf8(name.readAll()).trimmed() : QObject::tr("frame grabber") });
  }
  found.push_back({ "igtl://localhost:18944", QObject::tr("OpenIGTLink server") });
  found.push_back({ "lavfi:testsrc2=size=768x576:rate=25", QObject::tr("test picture") });
  return found;
}

/// Looks what there is when it is opened: devices are plugged in late.
class DeviceList : public QComboBox
{
public:
  DeviceList(QWidget* parent, std::function<void()> fill)
    : QComboBox(parent)
    , Fill(std::move(fill))
  {
  }
  void showPopup() override
  {
    this->Fill();
    QComboBox::showPopup();
  }

private:
  std::function<void()> Fill;
};
}

//------------------------------------------------------------------------------
pqLacunaDevice::pqLacunaDevice(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent)
  : Superclass(proxy, parent)
{
  vtkPVXMLElement* hints = property->GetHints();
  vtkPVXMLElement* hint = hints ? hints->FindNestedElementByName("LacunaDevice") : nullptr;
  const bool isTracker = hint && QString(hint->GetAttributeOrEmpty("kind")) == "tracker";
  this->List = new DeviceList(this, [this, isTracker] { this->Fill(isTracker); });
  this->List->setObjectName("Devices");
  this->List->setEditable(true);
  this->List->setInsertPolicy(QComboBox::NoInsert);
  this->List->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  this->List->lineEdit()->setPlaceholderText(
    isTracker ? tr("choose a port, or type an address") : tr("choose a video, or type an address"));
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(this->List);
  // an entry has more to read than its address
  QObject::connect(this->List, QOverload<int>::of(&QComboBox::activated), this,
    [this](int index) { this->List->setEditText(this->List->itemData(index).toString()); });
  QObject::connect(this->List, &QComboBox::editTextChanged, this, &pqLacunaDevice::AddressChanged);
  this->addPropertyLink(this, "address", SIGNAL(AddressChanged()), property);
}

//------------------------------------------------------------------------------
pqLacunaDevice::~pqLacunaDevice() = default;

//------------------------------------------------------------------------------
QString pqLacunaDevice::GetAddress() const
{
  return this->List->currentText();
}

//------------------------------------------------------------------------------
void pqLacunaDevice::SetAddress(const QString& address)
{
  if (address != this->GetAddress())
  {
    this->List->setEditText(address);
  }
}

//------------------------------------------------------------------------------
void pqLacunaDevice::Fill(bool isTracker)
{
  const QString address = this->GetAddress();
  const QSignalBlocker quiet(this->List);
  this->List->clear();
  const bool isHere = this->proxy()->GetSession()->GetProcessRoles() & vtkPVSession::DATA_SERVER;
  if (isHere)
  {
    for (const auto& [device, what] : isTracker ? FindTrackers() : FindVideos())
    {
      this->List->addItem(QString("%1 (%2)").arg(device, what), device);
    }
  }
  this->List->setEditText(address);
}
