// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class pqLacunaDevice
 * @brief editor of a device's address, with a list of those that this computer has
 *
 * The hint LacunaDevice of the property says which: its attribute kind is "tracker" (serial ports) or
 * "video" (frame grabbers). Anything else can be typed. Devices of a remote server are not listed.
 */
#ifndef pqLacunaDevice_h
#define pqLacunaDevice_h

#include "pqPropertyWidget.h"

class QComboBox;

class pqLacunaDevice : public pqPropertyWidget
{
  Q_OBJECT
  Q_PROPERTY(QString address READ GetAddress WRITE SetAddress NOTIFY AddressChanged)
  typedef pqPropertyWidget Superclass;

public:
  pqLacunaDevice(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent = nullptr);
  ~pqLacunaDevice() override;

  QString GetAddress() const;
  void SetAddress(const QString& address);

Q_SIGNALS:
  void AddressChanged();

private:
  void Fill(bool isTracker);

  QComboBox* List;
};
#endif
