// SPDX-License-Identifier: BSD-3-Clause
#include "pqLacunaGuide.h"

#include "pqPropertiesPanel.h"
#include "vtkSMProxy.h"
#include "vtkSMProxyManager.h"
#include "vtkSMSessionProxyManager.h"

#include <QDialogButtonBox>
#include <QDir>
#include <QFileInfo>
#include <QImage>
#include <QPushButton>
#include <QTextBrowser>
#include <QUrl>
#include <QVBoxLayout>

#include <algorithm>

#include <dlfcn.h>

namespace
{
constexpr int Margin = 40; // of a page, with its scroll bar

/// Where the pages are, by where this library is.
QDir GetFolder()
{
  Dl_info library{};
  static const int here = 0;
  dladdr(&here, &library);
  return { QFileInfo(QString::fromLocal8Bit(library.dli_fname)).absolutePath() + "/" LACUNA_GUIDE };
}

/// Pictures no wider than the window.
class Pages : public QTextBrowser
{
public:
  using QTextBrowser::QTextBrowser;

  QVariant loadResource(int type, const QUrl& name) override
  {
    QVariant resource = QTextBrowser::loadResource(type, name);
    if (type == QTextDocument::ImageResource)
    {
      QImage image;
      image.loadFromData(resource.toByteArray());
      const int width = std::max(200, this->viewport()->width() - Margin);
      if (image.width() > width)
      {
        return image.scaledToWidth(width, Qt::SmoothTransformation);
      }
    }
    return resource;
  }
};
}

//------------------------------------------------------------------------------
pqLacunaGuide::pqLacunaGuide(QWidget* window)
  : Superclass(window)
  , Browser(new Pages(this))
{
  this->setObjectName("LacunaGuide");
  this->setWindowTitle(tr("Lacuna Guide"));
  this->resize(900, 800);
  this->Browser->setObjectName("Pages");
  this->Browser->setOpenExternalLinks(true);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close, this);
  auto* back = buttons->addButton(tr("Back"), QDialogButtonBox::ActionRole);
  auto* contents = buttons->addButton(tr("Contents"), QDialogButtonBox::ActionRole);
  back->setEnabled(false);
  QObject::connect(this->Browser, &QTextBrowser::backwardAvailable, back, &QWidget::setEnabled);
  QObject::connect(back, &QPushButton::clicked, this->Browser, &QTextBrowser::backward);
  QObject::connect(contents, &QPushButton::clicked, this, [this] { this->Open(QString()); });
  QObject::connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::close);
  auto* layout = new QVBoxLayout(this);
  layout->addWidget(this->Browser);
  layout->addWidget(buttons);
  if (auto* panel = window->findChild<pqPropertiesPanel*>())
  {
    // ParaView would open its own help beside it, which does not know the filter
    QObject::disconnect(panel, SIGNAL(helpRequested(QString, QString)), window, nullptr);
    QObject::connect(
      panel, SIGNAL(helpRequested(QString, QString)), this, SLOT(Help(QString, QString)));
  }
}

//------------------------------------------------------------------------------
pqLacunaGuide::~pqLacunaGuide() = default;

//------------------------------------------------------------------------------
void pqLacunaGuide::Open(const QString& label)
{
  const QDir folder = GetFolder();
  const QString page = label.toLower().replace(' ', '-') + ".md";
  const QString name = folder.exists(page) ? page : "README.md";
  this->show();
  this->raise();
  this->Browser->setSource(QUrl::fromLocalFile(folder.filePath(name)));
}

//------------------------------------------------------------------------------
void pqLacunaGuide::Help(const QString& group, const QString& name)
{
  vtkSMProxy* proxy =
    vtkSMProxyManager::GetProxyManager()->GetActiveSessionProxyManager()->GetPrototypeProxy(
      group.toUtf8().constData(), name.toUtf8().constData());
  if (proxy && name.startsWith("Lacuna"))
  {
    this->Open(proxy->GetXMLLabel());
    return;
  }
  QMetaObject::invokeMethod(
    this->parent(), "showHelpForProxy", Q_ARG(QString, group), Q_ARG(QString, name));
}
