// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class pqLacunaWindow
 * @brief the menu "Lacuna" of ParaView's window, and how new data are shown there
 *
 * The menu has the main jobs in one click each, sample data and the guide. When data that concern Lacuna
 * are applied for the first time, they are shown as who works with them expects: a CT as bone, upright;
 * a sweep as slices in space. Both are done by the Python module lacuna.window, so that scripts have them,
 * too; where the Python package is not found, ParaView shows what it always does, and the menu says why.
 *
 * Labels of Lacuna's properties get their unit and what 0 means, as the hint LacunaLabel of the property
 * says: in panels only, since in Python a property is called by its label.
 */
#ifndef pqLacunaWindow_h
#define pqLacunaWindow_h

#include <QObject>
#include <QSet>
#include <QString>

class pqServerManagerModelItem;

class pqLacunaWindow : public QObject
{
  Q_OBJECT
  typedef QObject Superclass;

public:
  pqLacunaWindow(QObject* parent = nullptr);
  ~pqLacunaWindow() override;

  /// When the plugin is loaded.
  void startup();
  void shutdown();

  /// Calls a function of the Python module lacuna.window, or says why there is none.
  static void Run(const QString& call);

  /// Sees panels of properties when they are laid out.
  bool eventFilter(QObject* object, QEvent* event) override;

private:
  void AddMenu();
  void FollowState(pqServerManagerModelItem* item);

  QSet<pqServerManagerModelItem*> NewSources; ///< made in the window and not applied yet
};
#endif
