// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaCheck.h"
#include "vtkExecutive.h"
#include "vtkImageAlgorithm.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkLacunaExecution.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

namespace
{
// A filter whose body is given from outside.
class TestSource : public vtkImageAlgorithm
{
public:
  static TestSource* New();
  vtkTypeMacro(TestSource, vtkImageAlgorithm);
  std::function<void(vtkLacunaExecution&)> Body;

protected:
  TestSource() { this->SetNumberOfInputPorts(0); }
  int RequestInformation(
    vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    const int extent[6] = { 0, 3, 0, 3, 0, 3 };
    outputs->GetInformationObject(0)->Set(
      vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
    return 1;
  }
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override
  {
    vtkImageData* output = vtkImageData::GetData(outputs);
    output->SetDimensions(4, 4, 4);
    output->AllocateScalars(VTK_FLOAT, 1);
    return vtkLacunaExecution::Run(this, outputs, this->Body);
  }
};
vtkStandardNewMacro(TestSource);
}

int TestLacunaExecution(int, char*[])
{
  {
    vtkNew<TestSource> source;
    std::atomic<int> covered(0);
    source->Body = [&](vtkLacunaExecution& execution)
    {
      execution.For(1000, 7,
        [&](std::int64_t begin, std::int64_t end) { covered += static_cast<int>(end - begin); });
    };
    source->Update();
    LACUNA_CHECK(covered == 1000);
    LACUNA_CHECK(source->GetOutput()->GetPointData()->GetScalars() != nullptr);
    LACUNA_CHECK_NEAR(source->GetProgress(), 1, 0);
  }
  {
    // more than one thread works where there is more than one core, also in a ParaView whose
    // default back end is sequential
    vtkNew<TestSource> source;
    std::set<std::thread::id> workers;
    std::mutex mutex;
    source->Body = [&](vtkLacunaExecution& execution)
    {
      execution.For(200, 1,
        [&](std::int64_t, std::int64_t)
        {
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
          const std::lock_guard<std::mutex> lock(mutex);
          workers.insert(std::this_thread::get_id());
        });
    };
    source->Update();
    LACUNA_CHECK(std::thread::hardware_concurrency() < 2 || workers.size() > 1);
  }
  {
    // an error empties the output
    vtkNew<TestSource> source;
    vtkNew<lacunaCheck::Messages> messages;
    messages->Watch(source);
    vtkNew<lacunaCheck::Messages> executiveMessages;
    executiveMessages->Watch(source->GetExecutive());
    source->Body = [](vtkLacunaExecution&) { throw std::runtime_error("slice 7 has no pose"); };
    source->Update();
    LACUNA_CHECK(messages->HasError("slice 7 has no pose"));
    LACUNA_CHECK(source->GetOutput()->GetNumberOfPoints() == 0);
  }
  {
    // each who asks hears what is wrong, for which the same work is not done again at once
    vtkNew<TestSource> source;
    vtkNew<lacunaCheck::Messages> messages;
    messages->Watch(source);
    vtkNew<lacunaCheck::Messages> executiveMessages;
    executiveMessages->Watch(source->GetExecutive());
    int ran = 0;
    source->Body = [&](vtkLacunaExecution&)
    {
      ++ran;
      throw std::runtime_error("slice 7 has no pose");
    };
    const auto heard = [&]
    {
      messages->Errors.clear();
      source->Update();
      return messages->HasError("slice 7 has no pose");
    };
    LACUNA_CHECK(heard() && ran == 1);
    LACUNA_CHECK(heard() && ran == 1);
    const int part[6] = { 0, 3, 0, 3, 1, 2 };
    messages->Errors.clear();
    source->UpdateExtent(part);
    LACUNA_CHECK(messages->HasError("slice 7 has no pose") && ran == 2);
    source->Modified();
    LACUNA_CHECK(heard() && ran == 3);
    vtkObject::GlobalWarningDisplayOff();
    source->Modified();
    const bool heardWhenOff = heard() || heard();
    vtkObject::GlobalWarningDisplayOn();
    LACUNA_CHECK(!heardWhenOff);
    LACUNA_CHECK(heard());
    source->Body = [](vtkLacunaExecution&) {};
    source->Modified();
    LACUNA_CHECK(!heard());
  }
  {
    // stopped by the user: no error, nothing that looks like a result
    vtkNew<TestSource> source;
    vtkNew<lacunaCheck::Messages> messages;
    messages->Watch(source);
    std::atomic<int> ran(0);
    source->Body = [&](vtkLacunaExecution& execution)
    {
      source->SetAbortExecute(1);
      execution.For(10000, 1,
        [&](std::int64_t, std::int64_t)
        {
          ++ran;
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        });
    };
    source->Update();
    LACUNA_CHECK(ran < 10000);
    LACUNA_CHECK(messages->Errors.empty());
    LACUNA_CHECK(source->GetOutput()->GetNumberOfPoints() == 0);
  }
  return lacunaCheck::Result();
}
