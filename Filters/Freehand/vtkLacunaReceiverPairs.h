// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The poses of two receivers, from slices or from a table. Not a part of the module's interface.
#ifndef vtkLacunaReceiverPairs_h
#define vtkLacunaReceiverPairs_h

#include "lacunaPoseTable.h"
#include "lacunaTrackerSelfTest.h"

#include <string>
#include <vector>

class vtkDataObject;
class vtkImageData;
class vtkTable;

/// Where the two receivers are looked for; the names are those of the filter's properties.
struct vtkLacunaReceiverRequest
{
  std::string FirstReceiver, SecondReceiver;
  lacuna::PoseFormat Format;
  lacuna::LengthUnit Unit;
  int Stations[2];
};

struct vtkLacunaReceiverPairs
{
  /// data: vtkImageData or vtkTable. Throws std::runtime_error with a text for the user when the
  /// poses are not there.
  vtkLacunaReceiverPairs(vtkDataObject* data, const vtkLacunaReceiverRequest& request);

  std::vector<lacuna::ReceiverPair> Pairs; ///< mm
  std::vector<std::string> Warnings;

private:
  void ReadSlices(vtkImageData* slices, const vtkLacunaReceiverRequest& request);
  void ReadTable(vtkTable* table, const vtkLacunaReceiverRequest& request);
};
#endif
