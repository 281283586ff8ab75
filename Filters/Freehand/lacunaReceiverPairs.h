// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The poses of two receivers, from slices or from a table. Not a part of the module's interface.
#ifndef lacunaReceiverPairs_h
#define lacunaReceiverPairs_h

#include "lacunaPoseTable.h"
#include "lacunaTrackerSelfTest.h"

#include <string>
#include <vector>

class vtkDataObject;
class vtkImageData;
class vtkTable;

namespace lacuna
{
/// Where the two receivers are looked for; the names are those of the filter's properties.
struct ReceiverRequest
{
  std::string FirstReceiver, SecondReceiver;
  PoseFormat Format;
  LengthUnit Unit;
  int Stations[2];
};

struct ReceiverPairs
{
  /// data: vtkImageData or vtkTable. Throws std::runtime_error with a text for the user when the
  /// poses are not there.
  ReceiverPairs(vtkDataObject* data, const ReceiverRequest& request);

  std::vector<ReceiverPair> Pairs; ///< mm
  std::vector<std::string> Warnings;

private:
  void ReadSlices(vtkImageData* slices, const ReceiverRequest& request);
  void ReadTable(vtkTable* table, const ReceiverRequest& request);
};
}
#endif
