// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class pqLacunaSpeedGauge
 * @brief a bar as long as the probe is fast, which turns red above the limit
 *
 * The limit is a mark in the middle. A warning stays for a second, so that it is seen, and is told in
 * words too.
 */
#ifndef pqLacunaSpeedGauge_h
#define pqLacunaSpeedGauge_h

#include <QElapsedTimer>
#include <QString>
#include <QWidget>

struct pqLacunaLiveState;

class pqLacunaSpeedGauge : public QWidget
{
  Q_OBJECT
  Q_PROPERTY(QString text READ GetText)
  Q_PROPERTY(bool warning READ HasWarning)
  typedef QWidget Superclass;

public:
  pqLacunaSpeedGauge(QWidget* parent = nullptr);

  void SetState(const pqLacunaLiveState& state);
  const QString& GetText() const { return this->Text; }
  bool HasWarning() const { return this->Warning; }
  QSize sizeHint() const override;

protected:
  void paintEvent(QPaintEvent* event) override;

private:
  QString Text;
  bool Warning = false;
  double Length = 0; ///< of the bar, 0 to 1
  bool HasLimit = false;
  qint64 TooFast = 0;   ///< slices, when last looked
  QElapsedTimer Warned; ///< since it was too fast
};
#endif
