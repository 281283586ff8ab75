// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTests.h"
#include "lacunaTrial.h"
#include "lacunaVersionCompat.h"
#include "vtkCommand.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPassInputTypeAlgorithm.h"

namespace lacunaProperties
{
namespace
{
// Counts reports, and stops at one of them.
class Stopper : public vtkCommand
{
public:
  static Stopper* New() { return new Stopper; }
  vtkTypeMacro(Stopper, vtkCommand);
  void Execute(vtkObject* caller, unsigned long, void*) override
  {
    if (++this->Count == this->StopAt)
    {
      auto* algorithm = vtkAlgorithm::SafeDownCast(caller);
      algorithm->AbortExecuteOn();
      this->WasReady = algorithm->GetProgress() >= 1;
    }
  }
  bool HasStopped() const { return this->StopAt > 0 && this->Count >= this->StopAt; }
  int Count = 0;
  int StopAt = 0;
  bool WasReady = false;
};

// An algorithm upstream that is stopped.
class Stopped : public vtkPassInputTypeAlgorithm
{
public:
  static Stopped* New();
  vtkTypeMacro(Stopped, vtkPassInputTypeAlgorithm);

protected:
  int FillInputPortInformation(int, vtkInformation* info) override
  {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObject");
    return 1;
  }
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override
  {
    this->AbortExecuteOn();
    lacuna::CheckAbort(this);
    return 1;
  }
};
vtkStandardNewMacro(Stopped);

// Of inputs of which one comes from such a one.
std::string TestStoppedInput(const Trial& trial, Dice& dice)
{
  const vtkSmartPointer<vtkAlgorithm> algorithm = trial.Make();
  std::vector<int> ports;
  for (int port = 0; port < algorithm->GetNumberOfInputPorts(); ++port)
  {
    if (algorithm->GetNumberOfInputConnections(port) > 0)
    {
      ports.push_back(port);
    }
  }
  if (ports.empty() || !lacuna::TellsOfAbort)
  {
    return {};
  }
  const int port = dice.Pick(ports);
  vtkNew<Stopped> stopped;
  stopped->SetInputConnection(algorithm->GetInputConnection(port, 0));
  algorithm->SetInputConnection(port, stopped->GetOutputPort());
  const Run run = trial.Execute(algorithm, 0);
  // that there is no file is an error, whatever the reason
  if (!trial.What.SetFile && (!run.Errors.empty() || !run.Stray.empty()))
  {
    return "messages when input " + std::to_string(port) + " was stopped: " + run.Errors +
      run.Stray;
  }
  return run.IsEmpty ? "" : "an output though input " + std::to_string(port) + " was stopped";
}
}

//------------------------------------------------------------------------------
std::string TestAbort(const Subject& subject, std::uint64_t seed, bool areAtWork, Account& account)
{
  const int stretch = areAtWork ? 4 : 1; // until loops take longer than the time between reports
  const Trial trial(subject, seed, Trial::Varied, stretch);
  Dice dice(seed + 1);
  vtkNew<Stopper> counter;
  const vtkSmartPointer<vtkAlgorithm> fresh = trial.Make();
  fresh->AddObserver(vtkCommand::ProgressEvent, counter);
  const Run whole = trial.Execute(fresh, areAtWork ? 0 : 1);
  std::string& story = account.Story;
  story = trial.GetStory() + "  " + std::to_string(counter->Count) + " reports of progress\n" +
    whole.Errors;
  if (!whole.Errors.empty() || counter->Count == 0)
  {
    return {}; // not a run that could be stopped
  }
  vtkNew<Stopper> stopper;
  stopper->StopAt = dice.Whole(1, counter->Count);
  story += "  stopped at report " + std::to_string(stopper->StopAt) + "\n";
  const vtkSmartPointer<vtkAlgorithm> algorithm = trial.Make();
  algorithm->AddObserver(vtkCommand::ProgressEvent, stopper);
  const Run stopped =
    trial.Execute(algorithm, areAtWork ? dice.Pick({ 0, 2, 5 }) : dice.Pick({ 0, 1, 5 }));
  if (!stopped.Errors.empty() || !stopped.Stray.empty())
  {
    return "messages when stopped: " + stopped.Errors + stopped.Stray;
  }
  if (!stopper->HasStopped() && !areAtWork)
  {
    return "fewer reports the second time";
  }
  if (!stopper->HasStopped() && stopped.IsEmpty && !whole.IsEmpty)
  {
    return "not stopped, and no output";
  }
  account.Succeeded = stopper->HasStopped() && stopped.IsEmpty && !whole.IsEmpty;
  if (!stopped.IsEmpty && stopper->HasStopped() && !stopper->WasReady)
  {
    return "stopped, and went on";
  }
  bool isWhole = stopped.Outputs.size() == whole.Outputs.size();
  for (std::size_t port = 0; isWhole && port < whole.Outputs.size(); ++port)
  {
    isWhole = Compare(whole.Outputs[port], stopped.Outputs[port]).empty();
  }
  if (!stopped.IsEmpty && !isWhole)
  {
    return "stopped, and half an output";
  }
  const std::string fault = TestStoppedInput(trial, dice);
  if (!fault.empty())
  {
    return fault;
  }
  stopper->StopAt = 0;
  algorithm->AbortExecuteOff();
  algorithm->Modified();
  const Run again = trial.Execute(algorithm, 0);
  if (again.Outputs.size() != whole.Outputs.size())
  {
    return "nothing after it was stopped: " + again.Errors;
  }
  for (std::size_t port = 0; port < whole.Outputs.size(); ++port)
  {
    const std::string difference = Compare(whole.Outputs[port], again.Outputs[port]);
    if (!difference.empty())
    {
      return "after it was stopped output " + std::to_string(port) + " differs in " + difference +
        again.Errors;
    }
  }
  return {};
}
}
