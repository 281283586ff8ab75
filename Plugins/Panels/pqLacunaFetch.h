// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The data of a source on the client, wherever the server is.
#ifndef pqLacunaFetch_h
#define pqLacunaFetch_h

#include "vtkDataObject.h" // for the smart pointer
#include "vtkSmartPointer.h"

class vtkSMSourceProxy;

/// Updates the source. Of several ranks it gives what the first one has. Null when there is nothing.
vtkSmartPointer<vtkDataObject> pqLacunaFetch(vtkSMSourceProxy* source, int port);
#endif
