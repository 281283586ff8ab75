// SPDX-License-Identifier: BSD-3-Clause
// Whether ranks meet depends on nothing that may differ between them: none waits for ever.
#include "lacunaCheck.h"
#include "lacunaExecution.h"
#include "lacunaRanks.h"
#include "vtkImageThreshold.h"
#include "vtkInformation.h"
#include "vtkLacunaMeeting.h"
#include "vtkNew.h"
#include "vtkRTAnalyticSource.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTrivialProducer.h"

#include <functional>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{
using SDDP = vtkStreamingDemandDrivenPipeline;

// One of two ranks. How the other one is, is given; how often they meet, counted.
class Half : public lacuna::Ranks
{
public:
  bool OtherIsFine = true;
  bool OtherHasData = true;
  std::uint64_t OtherIsLonger = 0; // points along the first axis
  mutable int Met = 0;

  int GetNumber() const override { return 2; }
  using lacuna::Ranks::Sum;
  // of whether there are data, or of sizes
  void Sum(std::uint64_t* values, std::int64_t count) const override
  {
    if (count == 1)
    {
      values[0] += this->OtherHasData ? 1 : 0;
      return;
    }
    for (std::int64_t i = 0; i < count; ++i)
    {
      values[i] += values[i] + (i == 0 ? this->OtherIsLonger : 0);
    }
  }

protected:
  bool AllFine(bool fine) const override
  {
    ++this->Met;
    return fine && this->OtherIsFine;
  }
};

std::string ErrorOf(const std::function<void()>& work)
{
  try
  {
    work();
  }
  catch (const std::bad_alloc&)
  {
    return "bad_alloc";
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  return {};
}

const std::vector<double> Before{ 1, 0, 0 };
const std::vector<double> After{ 2, 0, 0 };

void TestTimes()
{
  vtkNew<vtkTrivialProducer> filter; // without inputs
  Half ranks;
  vtkLacunaMeeting meeting;
  int calls = 0;
  const auto body = [&] { ++calls; };
  LACUNA_CHECK(meeting.Hold(filter, Before, true, ranks, body));
  LACUNA_CHECK(!meeting.Hold(filter, Before, true, ranks, body));
  LACUNA_CHECK(calls == 1 && ranks.Met == 1);
  LACUNA_CHECK(meeting.Hold(filter, After, true, ranks, body));
  LACUNA_CHECK(calls == 2 && ranks.Met == 2);
  meeting.Forget();
  LACUNA_CHECK(meeting.Hold(filter, After, true, ranks, body));
  LACUNA_CHECK(calls == 3 && ranks.Met == 3);
}

// VTK asks again for what an error has left empty, on those ranks only that have been asked for a part.
void TestErrors()
{
  vtkNew<vtkTrivialProducer> filter; // without inputs
  const std::vector<std::function<void()>> bodies{ [] { throw std::runtime_error("wrong"); },
    [] { throw std::bad_alloc(); }, [] { throw lacuna::Aborted(); } };
  const std::vector<std::string> texts{ "wrong", "out of memory", "it was stopped" };
  for (std::size_t i = 0; i < bodies.size(); ++i)
  {
    Half ranks;
    vtkLacunaMeeting meeting;
    LACUNA_CHECK(!ErrorOf([&] { meeting.Hold(filter, Before, true, ranks, bodies[i]); }).empty());
    LACUNA_CHECK(ranks.Met == 1);
    const std::string again =
      ErrorOf([&] { meeting.Hold(filter, Before, true, ranks, [] { LACUNA_CHECK(false); }); });
    LACUNA_CHECK_CONTAINS(again, texts[i]);
    LACUNA_CHECK_CONTAINS(again, "change a property");
    LACUNA_CHECK(ranks.Met == 1);
    LACUNA_CHECK(meeting.Hold(filter, After, true, ranks, [] {}));
    LACUNA_CHECK(ranks.Met == 2);

    // one rank alone waits for nobody, and what was wrong may be right now
    const lacuna::Ranks alone;
    vtkLacunaMeeting own;
    LACUNA_CHECK(!ErrorOf([&] { own.Hold(filter, Before, true, alone, bodies[i]); }).empty());
    LACUNA_CHECK(own.Hold(filter, Before, true, alone, [] {}));
  }
}

void TestOtherRank()
{
  vtkNew<vtkTrivialProducer> filter; // without inputs
  Half ranks;
  vtkLacunaMeeting meeting;
  const auto never = [] { LACUNA_CHECK(false); };
  ranks.OtherIsFine = false;
  LACUNA_CHECK_CONTAINS(
    ErrorOf([&] { meeting.Hold(filter, Before, true, ranks, never); }), "another rank has stopped");
  ranks.OtherIsFine = true;
  ranks.OtherHasData = false;
  LACUNA_CHECK_CONTAINS(
    ErrorOf([&] { meeting.Hold(filter, After, true, ranks, never); }), "another rank has no input");
  ranks.OtherHasData = true;
  LACUNA_CHECK_CONTAINS(
    ErrorOf([&] { meeting.Hold(filter, Before, false, ranks, never); }), "this rank has no input");
  ranks.OtherHasData = false;
  LACUNA_CHECK(meeting.Hold(filter, After, false, ranks, [] {})); // empty in, empty out
}

// Each has the whole of an input: parts of one that differs cannot be put together.
void TestSizes()
{
  vtkNew<vtkRTAnalyticSource> source;
  source->SetWholeExtent(0, 9, 0, 8, 0, 7);
  vtkNew<vtkImageThreshold> filter;
  filter->SetInputConnection(source->GetOutputPort());
  filter->Update();
  Half ranks;
  vtkLacunaMeeting meeting;
  LACUNA_CHECK(meeting.Hold(filter, Before, true, ranks, [] {}));
  ranks.OtherIsLonger = 1;
  LACUNA_CHECK_CONTAINS(
    ErrorOf([&] { meeting.Hold(filter, After, true, ranks, [] { LACUNA_CHECK(false); }); }),
    "not the same");
}

// An input that does not fit: nobody loads it, and all ranks hear of it when they meet.
void TestRefusal()
{
  vtkNew<vtkRTAnalyticSource> source;
  source->SetWholeExtent(0, 19999, 0, 19999, 0, 19999);
  vtkNew<vtkImageThreshold> filter;
  filter->SetInputConnection(source->GetOutputPort());
  filter->UpdateInformation();
  vtkInformation* info = filter->GetInputInformation();
  Half ranks;
  vtkLacunaMeeting meeting;
  meeting.AskForWhole(filter, filter->GetExecutive()->GetInputInformation());
  const int* asked = info->Get(SDDP::UPDATE_EXTENT());
  LACUNA_CHECK(asked[0] > asked[1]);
  const std::string error =
    ErrorOf([&] { meeting.Hold(filter, Before, false, ranks, [] { LACUNA_CHECK(false); }); });
  LACUNA_CHECK_CONTAINS(error, "32000000000000 bytes");
  LACUNA_CHECK(ranks.Met == 1);

  source->SetWholeExtent(0, 9, 0, 9, 0, 9);
  filter->UpdateInformation();
  meeting.AskForWhole(filter, filter->GetExecutive()->GetInputInformation());
  asked = info->Get(SDDP::UPDATE_EXTENT());
  LACUNA_CHECK(asked[0] == 0 && asked[1] == 9);
  LACUNA_CHECK(meeting.Hold(filter, After, true, ranks, [] {}));

  // asked alone for another part later: the others do not wait
  source->SetWholeExtent(0, 19999, 0, 19999, 0, 19999);
  filter->UpdateInformation();
  meeting.AskForWhole(filter, filter->GetExecutive()->GetInputInformation());
  const int met = ranks.Met;
  LACUNA_CHECK_CONTAINS(
    ErrorOf([&] { meeting.Hold(filter, After, false, ranks, [] {}); }), "bytes");
  LACUNA_CHECK(ranks.Met == met);
}
}

int TestMeeting(int, char*[])
{
  TestTimes();
  TestErrors();
  TestOtherRank();
  TestSizes();
  TestRefusal();
  return lacunaCheck::Result();
}
