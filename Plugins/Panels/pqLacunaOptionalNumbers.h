// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class pqLacunaOptionalNumbers
 * @brief editor of numbers that may be left empty: a field is empty where its default stands for "none"
 *
 * For properties whose default is no number to type, such as 1e299, or 1 -1 of a box; the hint
 * LacunaLabel's attribute empty says in the field what happens then. Of a minimum and a maximum with
 * default 1 -1, where one is given the other one is without limit.
 */
#ifndef pqLacunaOptionalNumbers_h
#define pqLacunaOptionalNumbers_h

#include "pqPropertyWidget.h"

#include <QList>
#include <QVariant>
#include <QVector>

class QLineEdit;

class pqLacunaOptionalNumbers : public pqPropertyWidget
{
  Q_OBJECT
  Q_PROPERTY(QList<QVariant> values READ GetValues WRITE SetValues NOTIFY ValuesChanged)
  typedef pqPropertyWidget Superclass;

public:
  pqLacunaOptionalNumbers(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent = nullptr);
  ~pqLacunaOptionalNumbers() override;

  QList<QVariant> GetValues() const;
  void SetValues(const QList<QVariant>& values);

Q_SIGNALS:
  void ValuesChanged();

private:
  bool IsBox() const;

  QVector<QLineEdit*> Fields;
  QVector<double> Defaults;
};
#endif
