// SPDX-License-Identifier: BSD-3-Clause
#include "pqLacunaOptionalNumbers.h"

#include "vtkPVXMLElement.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"
#include "vtkSMSessionProxyManager.h"

#include <QDoubleValidator>
#include <QGridLayout>
#include <QLineEdit>

namespace
{
constexpr double Unlimited = 1e299;
}

//------------------------------------------------------------------------------
pqLacunaOptionalNumbers::pqLacunaOptionalNumbers(
  vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent)
  : Superclass(proxy, parent)
{
  // the defaults of such proxies
  vtkSMProxy* prototype =
    proxy->GetSessionProxyManager()->GetPrototypeProxy(proxy->GetXMLGroup(), proxy->GetXMLName());
  const vtkSMPropertyHelper numbers(prototype, proxy->GetPropertyName(property));
  vtkPVXMLElement* hints = property->GetHints();
  vtkPVXMLElement* label = hints ? hints->FindNestedElementByName("LacunaLabel") : nullptr;
  const unsigned int count = numbers.GetNumberOfElements();
  auto* layout = new QGridLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  for (unsigned int n = 0; n < count; ++n)
  {
    auto* field = new QLineEdit(this);
    field->setObjectName(QString("DoubleLineEdit%1").arg(n));
    field->setPlaceholderText(label ? label->GetAttributeOrEmpty("empty") : "");
    auto* validator = new QDoubleValidator(field);
    validator->setLocale(QLocale::c());
    field->setValidator(validator);
    QObject::connect(field, &QLineEdit::textEdited, this, &pqLacunaOptionalNumbers::ValuesChanged);
    this->Fields.push_back(field);
    this->Defaults.push_back(numbers.GetAsDouble(n));
    const int columns = count == 6 ? 2 : 3;
    layout->addWidget(field, static_cast<int>(n) / columns, static_cast<int>(n) % columns);
  }
  this->addPropertyLink(this, "values", SIGNAL(ValuesChanged()), property);
}

//------------------------------------------------------------------------------
pqLacunaOptionalNumbers::~pqLacunaOptionalNumbers() = default;

//------------------------------------------------------------------------------
bool pqLacunaOptionalNumbers::IsBox() const
{
  return this->Defaults.size() % 2 == 0 && this->Defaults[0] > this->Defaults[1];
}

//------------------------------------------------------------------------------
QList<QVariant> pqLacunaOptionalNumbers::GetValues() const
{
  QList<QVariant> values;
  for (int n = 0; n < this->Fields.size(); ++n)
  {
    bool isNumber = false;
    const double number = QLocale::c().toDouble(this->Fields[n]->text(), &isNumber);
    double value = isNumber ? number : this->Defaults[n];
    if (!isNumber && this->IsBox() && !this->Fields[n ^ 1]->text().isEmpty())
    {
      value = n % 2 == 0 ? -Unlimited : Unlimited;
    }
    values.push_back(value);
  }
  return values;
}

//------------------------------------------------------------------------------
void pqLacunaOptionalNumbers::SetValues(const QList<QVariant>& values)
{
  for (int n = 0; n < this->Fields.size() && n < values.size(); ++n)
  {
    const double value = values[n].toDouble();
    const int other = n ^ 1;
    const bool isEmpty = this->IsBox() ? (value == this->Defaults[n] && other < values.size() &&
                                           values[other].toDouble() == this->Defaults[other]) ||
        value == (n % 2 == 0 ? -Unlimited : Unlimited)
                                       : value == this->Defaults[n];
    const QString text = isEmpty ? QString() : QString::number(value, 'g', 12);
    bool isShown = false;
    const double shown = QLocale::c().toDouble(this->Fields[n]->text(), &isShown);
    if (isEmpty ? !this->Fields[n]->text().isEmpty() : !isShown || shown != value)
    {
      this->Fields[n]->setText(text); // not what is being typed
    }
  }
}
