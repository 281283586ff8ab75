// SPDX-License-Identifier: BSD-3-Clause
#include "vtkLacunaPolhemusVideoSource.h"

#include "lacunaLiveSweep.h"
#include "lacunaPrintableText.h"
#include "lacunaTrackedSlices.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <stdexcept>
#include <utility>

namespace
{
using SDDP = vtkStreamingDemandDrivenPipeline;

// What a message is about, without its numbers.
std::string GetSubject(std::string message)
{
  message.erase(std::remove_if(message.begin(), message.end(),
                  [](unsigned char c) { return std::isdigit(c) != 0; }),
    message.end());
  return message;
}

void AnnounceStack(vtkInformation* info, const std::array<int, 4>& window, int slices)
{
  const int extent[6] = { 0, window[2] - 1, 0, window[3] - 1, 0, slices - 1 };
  const int nothing[6] = { 0, -1, 0, -1, 0, -1 };
  const double origin[3] = { static_cast<double>(window[0]), static_cast<double>(window[1]), 0 };
  const double spacing[3] = { 1, 1, 1 };
  info->Set(SDDP::WHOLE_EXTENT(), slices > 0 ? extent : nothing, 6);
  info->Set(vtkDataObject::ORIGIN(), origin, 3);
  info->Set(vtkDataObject::SPACING(), spacing, 3);
  vtkDataObject::SetPointDataActiveScalarInfo(info, VTK_UNSIGNED_CHAR, 1);
}
}

vtkStandardNewMacro(vtkLacunaPolhemusVideoSource);

//------------------------------------------------------------------------------
vtkLacunaPolhemusVideoSource::vtkLacunaPolhemusVideoSource()
  : Now(std::make_unique<lacuna::LiveSweep>())
{
  this->Sharing = lacuna::Share::FirstRank;
  this->SetNumberOfInputPorts(0);
  this->SetNumberOfOutputPorts(2);
  this->Now->Newest = lacuna::GrowingStack::MakeBlank();
}

//------------------------------------------------------------------------------
vtkLacunaPolhemusVideoSource::~vtkLacunaPolhemusVideoSource()
{
  this->SetCalibrationFileName(nullptr);
  this->SetRecordFileName(nullptr);
}

//------------------------------------------------------------------------------
int vtkLacunaPolhemusVideoSource::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkImageData");
  return 1;
}

//------------------------------------------------------------------------------
void vtkLacunaPolhemusVideoSource::Start()
{
  if (!this->Now->Acquisition)
  {
    this->Connect();
  }
  else
  {
    this->Configure();
  }
  if (!this->Now->Acquisition || !this->Now->Trouble.empty())
  {
    return; // it was said why
  }
  if (this->Now->StackIsOfOthers)
  {
    vtkErrorMacro(<< lacuna::ToPrintable(this->DescribeKept()));
    return;
  }
  this->Now->MayDiscard = false;
  this->Now->Acquisition->Start();
}

//------------------------------------------------------------------------------
void vtkLacunaPolhemusVideoSource::Stop()
{
  if (this->Now->Acquisition)
  {
    this->Now->Acquisition->Stop();
    this->GetNeedsUpdate();
  }
}

//------------------------------------------------------------------------------
void vtkLacunaPolhemusVideoSource::Clear()
{
  lacuna::LiveSweep& now = *this->Now;
  this->Stop(); // the last slices, of which it is to be said whether they are on the disk
  try
  {
    if (now.GetUnwritten() > 0 && !now.MayDiscard)
    {
      throw std::runtime_error(now.Past.File.Trouble);
    }
    if (!now.Taken.empty() && !now.MayDiscard)
    {
      throw std::runtime_error(now.MemoryTrouble);
    }
    if (now.Acquisition)
    {
      now.Acquisition->BeginSweep(now.MayDiscard);
    }
    now.MayDiscard = false;
    now.Stack.reset();
    now.Taken.clear();
    now.MemoryTrouble.clear();
    now.FreeBytes = now.FindFreeBytes();
    now.StackIsOfOthers = false;
    now.Subjects.clear();
    now.Tried.clear(); // the button may start again
  }
  catch (const std::exception& e)
  {
    now.MayDiscard = true;
    vtkErrorMacro(<< lacuna::ToPrintable(e.what()) << ". Clear again to drop these slices");
  }
  this->Modified();
}

//------------------------------------------------------------------------------
// Slices and the newest frame; returns whether there are new ones. Throws std::bad_alloc: the slices
// for which there is no memory are kept for the next time.
bool vtkLacunaPolhemusVideoSource::TakeOver()
{
  lacuna::LiveSweep& now = *this->Now;
  if (!now.StackIsOfOthers)
  {
    for (lacuna::AcquiredSlice& slice : now.Acquisition->TakeSlices())
    {
      now.Taken.push_back(std::move(slice));
    }
  }
  const bool grows = !now.Taken.empty();
  if (grows && !now.Stack)
  {
    // The frame of the last slice may have been calibrated in another way than slices are now.
    lacuna::SweepFrame frame = now.Calibration;
    frame.Window = now.Acquisition->GetSweep()->Window;
    const auto size = static_cast<std::int64_t>(now.Taken.front().Pixels->size());
    const std::int64_t most = std::max<std::int64_t>(now.LimitBytes / size, 1);
    try
    {
      now.Stack = std::make_unique<lacuna::GrowingStack>(frame, most * size);
    }
    catch (const std::bad_alloc&) // a system that gives no memory in advance
    {
      now.Stack = std::make_unique<lacuna::GrowingStack>(frame, 0);
    }
  }
  for (; !now.Taken.empty(); now.Taken.pop_front())
  {
    now.Stack->Append(now.Taken.front());
    now.MayDiscard = false;
  }
  const auto live = now.Acquisition->GetLive();
  if (!live || live->Slice.FrameNumber == now.NewestNumber)
  {
    return grows;
  }
  now.NewestNumber = live->Slice.FrameNumber;
  now.Newest = std::make_unique<lacuna::GrowingStack>(live->Sweep, 0);
  now.Newest->Append(live->Slice);
  return this->LiveDisplay || grows;
}

//------------------------------------------------------------------------------
bool vtkLacunaPolhemusVideoSource::GetNeedsUpdate()
{
  if (!this->Now->Acquisition)
  {
    return false;
  }
  bool changed = false;
  try
  {
    changed = this->TakeOver();
    this->Now->MemoryTrouble.clear();
  }
  catch (const std::bad_alloc&)
  {
    this->Now->Acquisition->Stop();
    const std::string trouble = "There is no memory for " +
      std::to_string(this->Now->Taken.size()) +
      " slices, which wait for it; the capture has ended. Close what needs memory, then Start, or "
      "save the others; and set a lower MemoryLimit";
    if (std::exchange(this->Now->MemoryTrouble, trouble) != trouble)
    {
      this->Now->News.push_back(trouble);
    }
  }
  this->CollectNews();
  changed = changed || !this->Now->News.empty() ||
    (this->Now->ToldCapturing && !this->Now->GetState().Capturing);
  if (changed)
  {
    this->Modified();
  }
  return changed;
}

//------------------------------------------------------------------------------
// ParaView shows no warning of GetNeedsUpdate: they wait for the update that follows.
void vtkLacunaPolhemusVideoSource::CollectNews()
{
  constexpr double longAgo = 5; // s; what comes and goes is said once
  const double time = this->Now->GetClock().Now();
  for (const std::string& message : this->Now->Acquisition->GetState().Messages)
  {
    const auto [subject, fresh] = this->Now->Subjects.try_emplace(GetSubject(message), time);
    if (fresh || time - subject->second > longAgo)
    {
      this->Now->News.push_back(message);
    }
    subject->second = time;
  }
}

//------------------------------------------------------------------------------
void vtkLacunaPolhemusVideoSource::Announce(const lacuna::Ports& ports)
{
  lacuna::LiveSweep& now = *this->Now;
  if (now.Acquisition)
  {
    this->Configure();
  }
  const auto set = [&](int port, const lacuna::GrowingStack* stack)
  {
    AnnounceStack(ports.GetOutputInformation(port),
      stack ? stack->GetWindow() : std::array<int, 4>{},
      stack ? static_cast<int>(stack->GetNumberOfSlices()) : 0);
  };
  set(0, now.Stack.get());
  set(1, now.Newest.get());
}

//------------------------------------------------------------------------------
void vtkLacunaPolhemusVideoSource::Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution&)
{
  lacuna::LiveSweep& now = *this->Now;
  now.ToldCapturing = now.GetState().Capturing;
  for (const std::string& message : std::exchange(now.News, {}))
  {
    vtkWarningMacro(<< lacuna::ToPrintable(message));
  }
  for (int port = 0; port < 2; ++port)
  {
    if (ports.GetOutputInformation(port)->Get(SDDP::UPDATE_NUMBER_OF_PIECES()) > 1)
    {
      throw std::runtime_error("Devices are driven by one process only, not by each of several: "
                               "run a server without MPI where they are plugged in");
    }
    const lacuna::GrowingStack* stack = port == 0 ? now.Stack.get() : now.Newest.get();
    auto* output = ports.GetOutput<vtkImageData>(port);
    if (port == 1 || now.ToldCapturing) // the newest frame may get a pose
    {
      lacuna::TrackedSlices::MarkAsGrowing(output);
    }
    if (stack)
    {
      stack->Fill(output);
    }
    else
    {
      // what shows it looks for the array that it is coloured by
      vtkNew<vtkUnsignedCharArray> none;
      none->SetName("Intensity");
      output->GetPointData()->SetScalars(none);
    }
  }
}

//------------------------------------------------------------------------------
std::string vtkLacunaPolhemusVideoSource::Parameters(int port) const
{
  const lacuna::LiveSweep& now = *this->Now;
  if (!(port == 0 ? now.Stack : now.Newest))
  {
    return {};
  }
  return port == 0 ? now.TakenBy : now.DescribeDevices() + " " + this->DescribeRules();
}

//------------------------------------------------------------------------------
void vtkLacunaPolhemusVideoSource::Describe(lacuna::Properties& properties) const
{
  this->vtkLacunaLiveDevices::Describe(properties);
  this->ListRules(properties);
  properties.Add("LiveDisplay", this->LiveDisplay);
}

//------------------------------------------------------------------------------
void vtkLacunaPolhemusVideoSource::PrintSelf(ostream& os, vtkIndent indent)
{
  this->vtkLacunaAlgorithm::PrintSelf(os, indent);
  os << indent << "SliceCount: " << this->GetSliceCount() << "\n";
}
