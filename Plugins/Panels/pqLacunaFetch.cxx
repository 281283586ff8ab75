// SPDX-License-Identifier: BSD-3-Clause
#include "pqLacunaFetch.h"

#include "vtkAlgorithm.h"
#include "vtkPVDataInformation.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMSession.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSMSourceProxy.h"

//------------------------------------------------------------------------------
vtkSmartPointer<vtkDataObject> pqLacunaFetch(vtkSMSourceProxy* source, int port)
{
  source->UpdatePipeline();
  if (!source->GetSession()->IsA("vtkSMSessionClient"))
  {
    auto* algorithm = vtkAlgorithm::SafeDownCast(source->GetClientSideObject());
    return algorithm ? algorithm->GetOutputDataObject(port) : nullptr;
  }
  // as servermanager.Fetch in Python
  vtkSMSessionProxyManager* manager = source->GetSessionProxyManager();
  const auto make = [manager](const char* name)
  {
    return vtkSmartPointer<vtkSMSourceProxy>::Take(
      vtkSMSourceProxy::SafeDownCast(manager->NewProxy("filters", name)));
  };
  const vtkSmartPointer<vtkSMSourceProxy> first = make("ReductionFilter");
  vtkSMPropertyHelper(first, "Input").Set(source, static_cast<unsigned int>(port));
  vtkSMPropertyHelper(first, "PassThrough").Set(0);
  first->UpdateVTKObjects();
  first->UpdatePipeline();
  vtkPVDataInformation* information = first->GetDataInformation(0);
  const vtkSmartPointer<vtkSMSourceProxy> mover = make("ClientServerMoveData");
  vtkSMPropertyHelper(mover, "Input").Set(first, 0);
  vtkSMPropertyHelper(mover, "OutputDataType").Set(information->GetDataSetType());
  vtkSMPropertyHelper(mover, "WholeExtent").Set(information->GetExtent(), 6);
  mover->UpdateVTKObjects();
  mover->UpdatePipeline();
  auto* algorithm = vtkAlgorithm::SafeDownCast(mover->GetClientSideObject());
  return algorithm ? algorithm->GetOutputDataObject(0) : nullptr;
}
