// SPDX-License-Identifier: BSD-3-Clause
// What the base does for every algorithm. What it does for several ranks: Testing/ParaView/RanksErrors.py.
#include "lacunaCheck.h"
#include "lacunaCoordinates.h"
#include "lacunaProvenance.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkImageAlgorithm.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkRTAnalyticSource.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <atomic>
#include <chrono>
#include <limits>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

namespace
{
using SDDP = vtkStreamingDemandDrivenPipeline;

// Passes an image on as a whole, whatever part of it is asked for.
class TestFilter : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static TestFilter* New();
  vtkTypeMacro(TestFilter, vtkImageAlgorithm);
  std::function<void(lacuna::AlgorithmExecution&)> Body = [](lacuna::AlgorithmExecution&) {};
  std::string AnnouncedError;
  int Made = 0;

  void Set(lacuna::Share sharing, bool takesEmpty)
  {
    this->Sharing = sharing;
    this->TakesEmpty = takesEmpty;
    this->Modified();
  }

protected:
  void Announce(const lacuna::Ports&) override
  {
    if (!this->AnnouncedError.empty())
    {
      throw std::runtime_error(this->AnnouncedError);
    }
  }
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override
  {
    ++this->Made;
    ports.GetOutput<vtkImageData>()->ShallowCopy(ports.GetInput<vtkImageData>());
    this->Body(execution);
  }
  std::string Parameters(int port) const override { return "Port=" + std::to_string(port); }
};
vtkStandardNewMacro(TestFilter);

struct Chain
{
  vtkNew<vtkRTAnalyticSource> Source;
  vtkNew<TestFilter> First;
  vtkNew<TestFilter> Second;
  vtkSmartPointer<lacunaCheck::Messages> OfFirst;
  vtkSmartPointer<lacunaCheck::Messages> OfSecond;

  Chain()
  {
    this->Source->SetWholeExtent(0, 9, 0, 8, 0, 7);
    this->First->SetInputConnection(this->Source->GetOutputPort());
    this->Second->SetInputConnection(this->First->GetOutputPort());
    this->OfFirst = lacunaCheck::Watch(this->First);
    this->OfSecond = lacunaCheck::Watch(this->Second);
  }

  // Points of what comes out.
  vtkIdType Update()
  {
    this->OfFirst->Errors.clear();
    this->OfSecond->Errors.clear();
    this->Second->Update();
    return this->Second->GetOutput()->GetNumberOfPoints();
  }
};

const auto Throw = [](lacuna::AlgorithmExecution&)
{ throw std::runtime_error("slice 7 has no pose"); };

// Reported by the filter that has it and by those behind it; and gone when it is mended.
void TestErrors()
{
  Chain chain;
  LACUNA_CHECK(chain.Update() == 720);
  LACUNA_CHECK_NEAR(chain.Second->GetProgress(), 1, 0);
  for (int time = 0; time < 2; ++time)
  {
    chain.First->Body = Throw;
    chain.First->Modified();
    LACUNA_CHECK(chain.Update() == 0);
    LACUNA_CHECK(chain.OfFirst->HasError("slice 7 has no pose"));
    LACUNA_CHECK(chain.OfSecond->HasError("slice 7 has no pose"));
    LACUNA_CHECK(chain.Second->GetOutput()->GetFieldData()->HasArray("LacunaError"));
    const int before = chain.First->Made;
    LACUNA_CHECK(chain.Update() == 0); // nothing changed: it is tried again, and reported again
    LACUNA_CHECK(chain.First->Made == before + 1);
    LACUNA_CHECK(chain.OfSecond->HasError("slice 7 has no pose"));
    chain.First->Body = [](lacuna::AlgorithmExecution&) {};
    chain.First->Modified();
    LACUNA_CHECK(chain.Update() == 720);
    LACUNA_CHECK(chain.OfFirst->Errors.empty() && chain.OfSecond->Errors.empty());
    LACUNA_CHECK(!chain.Second->GetOutput()->GetFieldData()->HasArray("LacunaError"));
  }
}

// An error of Announce is reported with the data; ParaView asks for information more than once before.
void TestAnnounced()
{
  Chain chain;
  chain.First->AnnouncedError = "no grid";
  chain.Second->UpdateInformation();
  LACUNA_CHECK(chain.OfFirst->Errors.empty());
  LACUNA_CHECK(chain.Update() == 0);
  LACUNA_CHECK(chain.OfFirst->HasError("no grid") && chain.OfSecond->HasError("no grid"));
  LACUNA_CHECK(chain.First->Made == 0);
  chain.First->AnnouncedError.clear();
  chain.First->Modified();
  LACUNA_CHECK(chain.Update() == 720);
}

// More than one thread works where there is more than one core, also in a ParaView whose default back end is sequential.
void TestThreads()
{
  Chain chain;
  std::atomic<int> covered(0);
  std::set<std::thread::id> workers;
  std::mutex mutex;
  chain.First->Body = [&](lacuna::AlgorithmExecution& execution)
  {
    execution.For(1000, 7,
      [&](std::int64_t begin, std::int64_t end)
      {
        covered += static_cast<int>(end - begin);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const std::lock_guard<std::mutex> lock(mutex);
        workers.insert(std::this_thread::get_id());
      });
  };
  chain.Update();
  LACUNA_CHECK(covered == 1000);
  LACUNA_CHECK(std::thread::hardware_concurrency() < 2 || workers.size() > 1);
}

void TestStop()
{
  Chain chain;
  chain.First->Body = [&](lacuna::AlgorithmExecution& execution)
  {
    chain.First->SetAbortExecute(1);
    execution.Report(0.5);
  };
  LACUNA_CHECK(chain.Update() == 0 || chain.OfSecond->Errors.empty());
  LACUNA_CHECK(chain.OfFirst->Errors.empty());
  LACUNA_CHECK(chain.First->GetOutput()->GetNumberOfPoints() == 0);
  chain.First->Body = [](lacuna::AlgorithmExecution&) {};
  chain.First->SetAbortExecute(0);
  chain.First->Modified();
  LACUNA_CHECK(chain.Update() == 720);
}

// Parts of what is made as a whole, and what a filter by parts asks for.
void TestParts()
{
  Chain chain;
  const int part[6] = { 2, 5, 0, 8, 3, 3 };
  chain.Second->UpdateInformation();
  chain.Second->UpdateExtent(part);
  LACUNA_CHECK(chain.Second->GetOutput()->GetNumberOfPoints() == 36);
  LACUNA_CHECK(chain.First->GetOutput()->GetNumberOfPoints() == 720);
  chain.Second->Set(lacuna::Share::Parts, false);
  chain.First->Set(lacuna::Share::Parts, false);
  chain.Source->Modified();
  chain.Second->UpdateInformation();
  chain.Second->UpdateExtent(part);
  LACUNA_CHECK(chain.Source->GetOutput()->GetNumberOfPoints() == 36);
  // nothing is asked for
  const int nothing[6] = { 0, -1, 0, -1, 0, -1 };
  chain.Second->Set(lacuna::Share::EachRank, false);
  chain.Second->UpdateInformation();
  const int before = chain.Second->Made;
  chain.Second->UpdateExtent(nothing);
  LACUNA_CHECK(chain.Second->Made == before);
}

void TestRefusal()
{
  Chain chain;
  chain.Source->SetWholeExtent(0, 19999, 0, 19999, 0, 19999);
  LACUNA_CHECK(chain.Update() == 0);
  LACUNA_CHECK(chain.OfSecond->HasError("20000 x 20000 x 20000 points"));
  LACUNA_CHECK(chain.OfSecond->HasError("32000000000000 bytes"));
  LACUNA_CHECK(chain.Source->GetOutput()->GetNumberOfPoints() == 1);
  chain.Source->SetWholeExtent(0, 9, 0, 8, 0, 7);
  LACUNA_CHECK(chain.Update() == 720);
}

void TestInputs()
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(2, 2, 2);
  image->AllocateScalars(VTK_FLOAT, 1);
  vtkNew<TestFilter> filter;
  const auto messages = lacunaCheck::Watch(filter);
  filter->SetInputData(image);
  image->SetSpacing(std::numeric_limits<double>::quiet_NaN(), 1, 1);
  filter->Update();
  LACUNA_CHECK(messages->HasError("input 0 is not sound: its spacing"));
  LACUNA_CHECK(filter->Made == 0);
  vtkNew<vtkImageData> empty;
  filter->SetInputData(empty);
  messages->Errors.clear();
  filter->Update();
  LACUNA_CHECK(filter->Made == 0 && messages->Errors.empty()); // empty in, empty out
  filter->Set(lacuna::Share::EachRank, true);
  filter->Update();
  LACUNA_CHECK(filter->Made == 1);

  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, image);
  image->SetSpacing(1, 1, 1);
  filter->SetInputDataObject(blocks);
  filter->Update();
  LACUNA_CHECK(messages->HasError("input 0 has blocks"));
  messages->Errors.clear();
  filter->SetInputData(image);
  filter->Update();
  LACUNA_CHECK(messages->Errors.empty() && filter->Made == 2);
}

void TestProvenance()
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(2, 2, 2);
  image->AllocateScalars(VTK_FLOAT, 1);
  lacuna::Coordinates::Mark(image, lacuna::Coordinates::Patient);
  vtkNew<TestFilter> filter;
  filter->SetInputData(image);
  filter->Update();
  const auto steps = lacuna::Provenance::Get(filter->GetOutput());
  LACUNA_CHECK(steps.size() == 1);
  LACUNA_CHECK_CONTAINS(steps.front(), "TestFilter input:");
  LACUNA_CHECK_CONTAINS(steps.front(), "Port=0");
  LACUNA_CHECK(lacuna::Coordinates::Get(filter->GetOutput()) == lacuna::Coordinates::Patient);
}
}

int TestAlgorithm(int, char*[])
{
  TestErrors();
  TestAnnounced();
  TestThreads();
  TestStop();
  TestParts();
  TestRefusal();
  TestInputs();
  TestProvenance();
  return lacunaCheck::Result();
}
