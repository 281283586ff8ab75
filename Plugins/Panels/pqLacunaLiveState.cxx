// SPDX-License-Identifier: BSD-3-Clause
#include "pqLacunaLiveState.h"

#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"

#include <QCoreApplication>

#include <cmath>

namespace
{
constexpr double Gibibyte = 1024; // MiB
constexpr double LittleSpace = Gibibyte;
constexpr double MuchMemory = 0.85; // of the limit
// The disk is told to have them every 0.3 s: more at a time come from a disk that does not keep up.
constexpr qint64 ManyWaiting = 100;

QString Translate(const char* text)
{
  return QCoreApplication::translate("pqLacunaLiveState", text);
}

QString SizeText(double mebibytes)
{
  return mebibytes < Gibibyte ? Translate("%1 MiB").arg(mebibytes, 0, 'f', 0)
                              : Translate("%1 GiB").arg(mebibytes / Gibibyte, 0, 'f', 1);
}

QString SlicesText(qint64 slices)
{
  return slices == 1 ? Translate("1 slice") : Translate("%1 slices").arg(slices);
}

QString GetText(vtkSMProxy* source, const char* name)
{
  return QString::fromUtf8(vtkSMPropertyHelper(source, name).GetAsString());
}
}

//------------------------------------------------------------------------------
pqLacunaLiveState pqLacunaLiveState::Read(vtkSMProxy* source)
{
  source->UpdatePropertyInformation();
  const auto integer = [source](const char* name)
  { return static_cast<qint64>(vtkSMPropertyHelper(source, name).GetAsIdType()); };
  const auto number = [source](const char* name)
  { return vtkSMPropertyHelper(source, name).GetAsDouble(); };
  pqLacunaLiveState state;
  state.Capturing = vtkSMPropertyHelper(source, "Capturing").GetAsInt() != 0;
  state.TrackerWorks = vtkSMPropertyHelper(source, "TrackerWorks").GetAsInt() != 0;
  state.VideoWorks = vtkSMPropertyHelper(source, "VideoWorks").GetAsInt() != 0;
  state.Speed = number("Speed");
  state.SpeedLimit = number("SpeedLimit");
  state.Slices = integer("TakenSlices");
  state.TooFast = integer("TooFastSlices");
  state.PastLimit = integer("FramesPastLimit");
  state.OnDisk = integer("RecordedSlices");
  state.Waiting = integer("WaitingSlices");
  state.DiskSpace = number("DiskSpace");
  state.MemoryUsed = number("MemoryUsed");
  state.MemoryLimit = number("MemoryLimitNow");
  state.RecordFileName = GetText(source, "RecordFileName");
  state.RecordedFileName = GetText(source, "RecordedFileName");
  state.DiskMessage = GetText(source, "DiskMessage");
  state.Message = GetText(source, "Message");
  return state;
}

//------------------------------------------------------------------------------
pqLacunaReadout pqLacunaLiveState::DescribeSpeed() const
{
  pqLacunaReadout readout;
  if (!this->IsOpen())
  {
    readout.Text = Translate("devices not open");
  }
  else if (!this->TrackerWorks || !this->VideoWorks)
  {
    readout.Text = this->TrackerWorks ? Translate("no video") : Translate("no tracker");
    readout.Warning = true;
  }
  readout.ToolTip = Translate("Speed of the image's fastest corner");
  if (this->SpeedLimit > 0)
  {
    readout.ToolTip += "; " +
      Translate("above %1 mm/s (the mark, SpeedLimit) slices are flagged").arg(this->SpeedLimit);
  }
  if (!this->Message.isEmpty())
  {
    readout.ToolTip += "\n\n" + this->Message;
  }
  return readout;
}

//------------------------------------------------------------------------------
pqLacunaReadout pqLacunaLiveState::DescribeSlices() const
{
  pqLacunaReadout readout;
  readout.Text = SlicesText(this->Slices);
  readout.ToolTip = Translate("Slices of this sweep; %1 of them too fast").arg(this->TooFast);
  return readout;
}

//------------------------------------------------------------------------------
pqLacunaReadout pqLacunaLiveState::DescribeDisk() const
{
  pqLacunaReadout readout;
  if (!this->DiskMessage.isEmpty() || this->Waiting > ManyWaiting)
  {
    readout.Text = this->Waiting > 0 ? Translate("Disk: %1 wait").arg(this->Waiting)
                                     : Translate("Disk: %1, see here").arg(this->OnDisk);
    readout.ToolTip = this->DiskMessage.isEmpty()
      ? Translate("Slices wait in memory: the disk is slower than they come")
      : this->DiskMessage;
    readout.Warning = true;
  }
  else if (!this->RecordedFileName.isEmpty())
  {
    readout.Text = Translate("Disk: %1").arg(this->OnDisk);
    if (!std::isnan(this->DiskSpace))
    {
      readout.Text += ", " + Translate("%1 free").arg(SizeText(this->DiskSpace));
    }
    readout.ToolTip =
      Translate("%1 on the disk, in %2").arg(SlicesText(this->OnDisk), this->RecordedFileName);
    readout.Warning = this->DiskSpace < LittleSpace;
  }
  else if (!this->RecordFileName.isEmpty())
  {
    readout.Text = Translate("Disk: from Start");
    readout.ToolTip = Translate("The next sweep is recorded in %1").arg(this->RecordFileName);
  }
  else
  {
    readout.Text = Translate("Disk: not recorded");
    readout.ToolTip =
      Translate("With RecordFileName slices are on the disk within a second; now they are in "
                "memory only");
  }
  return readout;
}

//------------------------------------------------------------------------------
pqLacunaReadout pqLacunaLiveState::DescribeMemory() const
{
  pqLacunaReadout readout;
  const bool isFull = this->PastLimit > 0;
  readout.Text = isFull ? Translate("Memory: full")
    : this->MemoryLimit > 0
    ? Translate("Memory: %1 of %2").arg(SizeText(this->MemoryUsed), SizeText(this->MemoryLimit))
    : Translate("Memory: %1").arg(SizeText(this->MemoryUsed));
  readout.ToolTip = isFull
    ? Translate("The capture has ended at MemoryLimit and keeps all: save the sweep, then Clear; "
                "or set a higher MemoryLimit")
    : Translate("The sweep's pixels; at the limit (MemoryLimit, or half of what was free at "
                "Connect) the capture ends");
  readout.Warning =
    isFull || (this->MemoryLimit > 0 && this->MemoryUsed > MuchMemory * this->MemoryLimit);
  return readout;
}
