// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class pqLacunaLiveToolbar
 * @brief starts and stops a live acquisition, and tells how it goes
 *
 * It follows the Polhemus Video Source that was selected last, or the only one, and asks it for its
 * information properties five times a second while there is one: those are what the source has at
 * hand, so no device is waited for. While the server is busy with something else it is not asked.
 *
 * The action is also in the menu Tools, where Customize Shortcuts finds it: a key, or a foot switch
 * that sends one, starts and stops. It is F9 unless it was changed.
 */
#ifndef pqLacunaLiveToolbar_h
#define pqLacunaLiveToolbar_h

#include <QPointer>
#include <QTimer>
#include <QToolBar>

#include <vector>

class pqLacunaSpeedGauge;
class pqPipelineSource;
class QLabel;
struct pqLacunaLiveState;
struct pqLacunaReadout;

class pqLacunaLiveToolbar : public QToolBar
{
  Q_OBJECT
  typedef QToolBar Superclass;

public:
  pqLacunaLiveToolbar(QWidget* parent = nullptr);
  ~pqLacunaLiveToolbar() override;

private:
  void AddReadouts();
  void SettleIn();
  void FindSource();
  void Poll();
  void Toggle();
  void ShowNoSource();
  void ShowState(const pqLacunaLiveState& state);

  QPointer<pqPipelineSource> Source;
  QPointer<pqPipelineSource> Seen; ///< whose slices the cameras were turned to
  QTimer Timer;
  QAction* StartStop;
  pqLacunaSpeedGauge* Speed = nullptr;
  QLabel* Slices = nullptr;
  QLabel* Disk = nullptr;
  QLabel* Memory = nullptr;
  std::vector<QAction*> Readouts; ///< of the toolbar: shown while there is a source
  QIcon StartIcon;
  QIcon StopIcon;
};
#endif
