// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class pqLacunaGuide
 * @brief a window with the pages of Lacuna's user guide, which lie beside the plugin
 *
 * The button ? of the Properties panel opens the page of the filter that is shown.
 */
#ifndef pqLacunaGuide_h
#define pqLacunaGuide_h

#include <QDialog>

class QTextBrowser;

class pqLacunaGuide : public QDialog
{
  Q_OBJECT
  typedef QDialog Superclass;

public:
  /// A child of ParaView's main window.
  pqLacunaGuide(QWidget* window);
  ~pqLacunaGuide() override;

  /// Shows the page of a proxy by its label, such as "Skull Implant", or the table of all pages where
  /// it has none.
  void Open(const QString& label);

private Q_SLOTS:
  /// What the Properties panel's button asks for.
  void Help(const QString& group, const QString& proxy);

private:
  QTextBrowser* Browser;
};
#endif
