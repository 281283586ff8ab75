// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// What a live source tells of itself, in words for a toolbar.
#ifndef pqLacunaLiveState_h
#define pqLacunaLiveState_h

#include <QString>

class vtkSMProxy;

/// A short text that is always there, a long one for who points at it.
struct pqLacunaReadout
{
  QString Text;
  QString ToolTip;
  bool Warning = false;
};

/// The information properties of a Polhemus Video Source, as they were read.
struct pqLacunaLiveState
{
  /// Asks the server, in one call, which waits for no device.
  static pqLacunaLiveState Read(vtkSMProxy* source);

  /// Whether a device works, or should.
  bool IsOpen() const { return this->Capturing || this->TrackerWorks || this->VideoWorks; }
  /// Speed in the place that the gauge leaves for a text; empty: the number is enough.
  pqLacunaReadout DescribeSpeed() const;
  pqLacunaReadout DescribeSlices() const;
  pqLacunaReadout DescribeDisk() const;
  pqLacunaReadout DescribeMemory() const;

  bool Capturing = false;
  bool TrackerWorks = false;
  bool VideoWorks = false;
  double Speed = 0;      ///< mm/s; not a number when it is not known
  double SpeedLimit = 0; ///< mm/s; 0: none
  qint64 Slices = 0;
  qint64 TooFast = 0;
  qint64 PastLimit = 0; ///< frames for which there was no memory
  qint64 OnDisk = 0;
  qint64 Waiting = 0;     ///< slices for the disk
  double DiskSpace = 0;   ///< MiB; not a number when nothing is recorded
  double MemoryUsed = 0;  ///< MiB
  double MemoryLimit = 0; ///< MiB; 0: not known yet
  QString RecordFileName; ///< that was asked for
  QString RecordedFileName;
  QString DiskMessage;
  QString Message;
};
#endif
