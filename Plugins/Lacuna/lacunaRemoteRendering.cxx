// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// While the plugin is loaded, a server that can render does so by itself. Otherwise ParaView sends small
/// data to the client for it, images without their direction: depth maps and patients scanned feet first
/// would be shown mirrored and elsewhere. A threshold that the user has set is of higher priority and wins.
#include "vtkSMProxy.h"
#include "vtkSMProxyManager.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSMSettings.h"

namespace
{
bool Add()
{
  auto* settings = vtkSMSettings::GetInstance();
  settings->AddCollectionFromString(
    R"json({ "settings": { "RenderViewSettings": { "RemoteRenderThreshold": 0 } } })json", 0.5);
  // a connection made before the plugin was loaded has read its settings already
  auto* manager = vtkSMProxyManager::IsInitialized()
    ? vtkSMProxyManager::GetProxyManager()->GetActiveSessionProxyManager()
    : nullptr;
  auto* views = manager ? manager->GetProxy("settings", "RenderViewSettings") : nullptr;
  auto* threshold = views ? views->GetProperty("RemoteRenderThreshold") : nullptr;
  if (threshold && settings->GetPropertySetting(threshold))
  {
    views->UpdateVTKObjects();
  }
  return true;
}

const bool Added = Add();
}
