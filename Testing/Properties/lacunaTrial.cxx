// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTrial.h"

#include "lacunaAllocations.h"
#include "lacunaCheck.h"
#include "lacunaSpoiledData.h"
#include "vtkAlgorithmOutput.h"
#include "vtkObjectFactory.h"
#include "vtkOutputWindow.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkTable.h"
#include "vtkTrivialProducer.h"
#include "vtkWriter.h"

#include <vtksys/SystemTools.hxx>

#include <exception>
#include <fstream>
#include <iterator>
#include <mutex>
#include <regex>

#include <unistd.h>

namespace lacunaProperties
{
namespace
{
// Keeps what no observer takes.
class Window : public vtkOutputWindow
{
public:
  static Window* New();
  vtkTypeMacro(Window, vtkOutputWindow);
  void DisplayText(const char* text) override
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->Text += text;
  }
  std::string Take()
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    return std::exchange(this->Text, {});
  }

private:
  std::mutex Mutex;
  std::string Text;
};
vtkStandardNewMacro(Window);

Window* GetWindow()
{
  static const vtkSmartPointer<Window> window = []
  {
    auto made = vtkSmartPointer<Window>::New();
    vtkOutputWindow::SetInstance(made);
    return made;
  }();
  return window;
}

std::string& OutputFolder()
{
  static std::string folder = ".";
  return folder;
}

// Its content as the only output.
Fingerprint FingerprintOfFile(const std::string& name)
{
  std::ifstream file(name, std::ios::binary);
  const std::string content{ std::istreambuf_iterator<char>(file), {} };
  // IGES and STEP have the time to the second, G-code to the minute
  static const std::regex time(
    "[0-9]{8}\\.[0-9]{6}|[0-9]{4}-[0-9]{2}-[0-9]{2}[ T][0-9]{2}:[0-9]{2}(:[0-9]{2})?");
  return { { "file", std::hash<std::string>{}(std::regex_replace(content, time, "")) } };
}
}

//------------------------------------------------------------------------------
void SetOutputFolder(const std::string& folder)
{
  vtksys::SystemTools::MakeDirectory(folder);
  OutputFolder() = folder;
}

//------------------------------------------------------------------------------
const std::string& GetOutputFolder()
{
  return OutputFolder();
}

//------------------------------------------------------------------------------
Trial::Trial(const Subject& subject, std::uint64_t seed, Kind kind, int stretch)
  : What(subject)
{
  GetWindow();
  Dice dice(seed);
  // twice the same, since data share nothing then
  const std::uint64_t inputSeed = dice.Seed();
  Dice first(inputSeed, stretch);
  Dice second(inputSeed, stretch);
  this->Sound = subject.MakeInputs(first);
  this->Given = subject.MakeInputs(second);
  if (kind == Plain)
  {
    return;
  }
  if (kind == Hostile)
  {
    this->SpoilInputs(dice);
  }
  const double hostility = kind == Hostile ? dice.Pick({ 0.0, 0.0, 0.1, 0.4 }) : 0;
  const double share = dice.Pick({ 0.0, 0.2, 0.5, 0.9 });
  const vtkSmartPointer<vtkAlgorithm> probe = subject.New();
  for (const Property& property : subject.Properties)
  {
    const Choice choice{ &property, dice.Seed(), dice.Chance(hostility) };
    if (dice.Chance(share))
    {
      this->Choices.push_back(choice);
      this->HasHostile = this->HasHostile || choice.IsHostile;
      Dice values(choice.Seed);
      this->Story += "  " + property.Name + (choice.IsHostile ? " = (!) " : " = ") +
        property.Set(probe, values, choice.IsHostile) + "\n";
    }
  }
}

//------------------------------------------------------------------------------
void Trial::SpoilInputs(Dice& dice)
{
  if (this->Given.empty())
  {
    return;
  }
  for (int n = dice.Pick({ 0, 0, 1, 1, 2, 3 }); n > 0; --n)
  {
    const int port = dice.Whole(0, static_cast<int>(this->Given.size()) - 1);
    vtkSmartPointer<vtkDataObject>& data = this->Given[port];
    std::string what;
    if (dice.Chance(0.02))
    {
      data = nullptr;
      what = "not connected";
    }
    else if (dice.Chance(0.03))
    {
      data = dice.Chance(0.5) ? vtkSmartPointer<vtkDataObject>(vtkSmartPointer<vtkTable>::New())
                              : vtkSmartPointer<vtkDataObject>(vtkSmartPointer<vtkPolyData>::New());
      what = "a " + std::string(data->GetClassName());
    }
    else if (data)
    {
      what = Spoil(data, dice);
    }
    if (!what.empty())
    {
      this->Spoiled = true;
      this->Story += "  input " + std::to_string(port) + ": " + what + "\n";
    }
  }
  GetWindow()->Take();
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkAlgorithm> Trial::Make(bool sound) const
{
  const vtkSmartPointer<vtkAlgorithm> algorithm = this->What.New();
  if (this->What.Prepare)
  {
    this->What.Prepare(algorithm);
  }
  for (const Choice& choice : this->Choices)
  {
    Dice dice(choice.Seed);
    choice.What->Set(algorithm, dice, choice.IsHostile);
  }
  this->Connect(algorithm, sound);
  return algorithm;
}

//------------------------------------------------------------------------------
void Trial::Connect(vtkAlgorithm* algorithm, bool sound) const
{
  const Inputs& inputs = sound ? this->Sound : this->Given;
  for (std::size_t port = 0; port < inputs.size(); ++port)
  {
    algorithm->RemoveAllInputConnections(static_cast<int>(port));
    if (inputs[port])
    {
      vtkNew<vtkTrivialProducer> producer;
      producer->SetOutput(inputs[port]);
      algorithm->SetInputConnection(static_cast<int>(port), producer->GetOutputPort());
    }
  }
}

//------------------------------------------------------------------------------
std::string CompareRuns(const Run& first, const Run& second)
{
  if (first.Errors.empty() != second.Errors.empty())
  {
    // what is kept of the first one may take the memory of the second, and so may other programs
    for (const char* owner : { "this process may have", "this machine has" })
    {
      if ((first.Errors + second.Errors).find(owner) != std::string::npos)
      {
        return {};
      }
    }
    return "an error once, none then: " + first.Errors + second.Errors;
  }
  if (first.IsEmpty && second.IsEmpty)
  {
    return {};
  }
  if (first.Outputs.size() != second.Outputs.size())
  {
    return "a file once, none then";
  }
  for (std::size_t port = 0; port < first.Outputs.size(); ++port)
  {
    const std::string difference = Compare(first.Outputs[port], second.Outputs[port]);
    if (!difference.empty())
    {
      return "output " + std::to_string(port) + " differs in " + difference;
    }
  }
  return {};
}

//------------------------------------------------------------------------------
Run Trial::Execute(vtkAlgorithm* algorithm, int threads) const
{
  Run run;
  const auto messages = lacunaCheck::Watch(algorithm);
  std::string file;
  if (this->What.SetFile)
  {
    static const pid_t process = getpid(); // the same in all forks, as files have their names
    file = this->What.SetFile(
      algorithm, OutputFolder() + "/" + this->What.Name + std::to_string(process));
    vtksys::SystemTools::RemoveFile(file);
  }
  GetWindow()->Take();
  const auto update = [&]
  {
    if (this->What.SetFile)
    {
      const int written = vtkWriter::SafeDownCast(algorithm)->Write();
      const bool isThere = vtksys::SystemTools::FileExists(file);
      if ((written == 1) != isThere)
      {
        run.Stray += written == 1 ? "written, but no file. " : "not written, but a file. ";
      }
    }
    else
    {
      algorithm->Update();
    }
  };
  CountAllocations();
  try
  {
    if (threads > 0)
    {
      vtkSMPTools::LocalScope(
        vtkSMPTools::Config{ threads, std::string("STDThread"), false }, update);
    }
    else
    {
      update();
    }
  }
  catch (const std::exception& e)
  {
    run.Stray += std::string("an exception escaped: ") + e.what();
  }
  run.Allocations = CountAllocations();
  GrantAllocations(-1); // what follows is the test's
  run.Stray += GetWindow()->Take();
  run.Errors = messages->Errors;
  run.Warnings = messages->Warnings;
  algorithm->RemoveObserver(messages);
  algorithm->GetExecutive()->RemoveObserver(messages);
  if (!file.empty() && vtksys::SystemTools::FileExists(file))
  {
    run.IsEmpty = false;
    run.Outputs.push_back(FingerprintOfFile(file));
    vtksys::SystemTools::RemoveFile(file);
  }
  const int ports = this->What.SetFile ? 0 : algorithm->GetNumberOfOutputPorts();
  for (int port = 0; port < ports; ++port)
  {
    vtkDataObject* data = algorithm->GetOutputDataObject(port);
    run.IsEmpty = run.IsEmpty && IsEmpty(data);
    run.Outputs.push_back(TakeFingerprint(data));
  }
  return run;
}
}
