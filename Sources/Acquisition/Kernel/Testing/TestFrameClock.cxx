// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFrameClock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <random>
#include <vector>

using namespace lacuna;

namespace
{
constexpr double Period = 0.04; // s
constexpr double Way = 0.0123;  // s from the end of a frame to its arrival
constexpr double Start = 1234.5;

// Frames whose way takes up to a millisecond longer, at the rate that their stream says or another.
struct Stream
{
  double Rate = 1; ///< by what the stream says
  double Jitter = 0.001;
  std::mt19937 Random{ 5 };

  double GetTime(int frame) const { return 77 + frame * Period; }
  double GetEnd(int frame) const { return Start + frame * Period / this->Rate; }
  double GetArrival(int frame)
  {
    return this->GetEnd(frame) + Way +
      std::uniform_real_distribution<double>(0, this->Jitter)(this->Random);
  }
};

// As it is known when the frame comes.
double Find(FrameClock& clock, double arrival, double streamTime)
{
  return clock.FindArrival(arrival, streamTime).Arrival;
}

// What is known of each frame in the end, in order; nothing: never.
std::vector<std::optional<double>> FindAll(
  const std::vector<double>& arrivals, const std::function<double(int)>& getTime, int& wrongAtOnce)
{
  FrameClock clock;
  std::vector<std::optional<double>> found;
  std::vector<double> early;
  wrongAtOnce = 0;
  for (std::size_t i = 0; i < arrivals.size(); ++i)
  {
    const FrameClock::Answer answer = clock.FindArrival(arrivals[i], getTime(static_cast<int>(i)));
    for (const std::optional<double>& arrival : clock.TakeArrivals())
    {
      wrongAtOnce += arrival != early[found.size()] ? 1 : 0;
      found.push_back(arrival);
    }
    early.push_back(answer.Arrival);
    if (answer.Known)
    {
      EXPECT_EQ(found.size(), i) << "an earlier frame is forgotten";
      found.emplace_back(answer.Arrival);
    }
  }
  return found;
}
}

TEST(FrameClock, FramesThatWereHeldUpBeforeItSettledGetTheirTimesOnceItHas)
{
  for (int first = 0; first < 12; ++first)
  {
    Stream stream;
    std::vector<double> arrivals;
    double free = 0;
    for (int frame = 0; frame < 300; ++frame)
    {
      const double punctual = stream.GetArrival(frame);
      if (frame >= first && (frame - first) % 9 == 0)
      {
        free = punctual + 0.02 + 0.01 * (frame % 11); // 20 to 120 ms
      }
      arrivals.push_back(std::max(punctual, free));
    }
    int wrongAtOnce = 0;
    const auto found = FindAll(
      arrivals, [&](int frame) { return stream.GetTime(frame); }, wrongAtOnce);
    EXPECT_TRUE(wrongAtOnce > 2 || first >= 10) << first; // which had settled by then
    ASSERT_EQ(found.size(), 300u) << first;
    double before = 0;
    for (int frame = 0; frame < 300; ++frame)
    {
      ASSERT_TRUE(found[frame]) << first << " " << frame;
      ASSERT_NEAR(*found[frame], stream.GetEnd(frame) + Way, 0.0095) << first << " " << frame;
      ASSERT_LE(*found[frame], arrivals[frame]);
      ASSERT_GE(*found[frame], before) << first << " " << frame;
      before = *found[frame];
    }
  }
}

TEST(FrameClock, ItSettlesAsSoonAsTenFramesAgree)
{
  Stream stream;
  FrameClock clock;
  for (int frame = 0; frame < 40; ++frame)
  {
    const double arrival = stream.GetArrival(frame);
    const FrameClock::Answer answer = clock.FindArrival(arrival, stream.GetTime(frame));
    EXPECT_EQ(answer.Known, frame >= 9) << frame;
    EXPECT_EQ(answer.Arrival, arrival);
    const auto arrivals = clock.TakeArrivals();
    EXPECT_EQ(arrivals.size(), frame == 9 ? 9u : 0u) << frame;
  }
}

TEST(FrameClock, OfAStreamThatIsNotInStepArrivalsStayAfterFiftyFrames)
{
  Stream stream;
  std::vector<double> arrivals;
  for (int frame = 0; frame < 100; ++frame) // in bursts of two
  {
    arrivals.push_back(stream.GetArrival(frame + 1 - frame % 2) + 0.0001 * (frame % 2));
  }
  int wrongAtOnce = 0;
  const auto found = FindAll(
    arrivals, [&](int frame) { return stream.GetTime(frame); }, wrongAtOnce);
  ASSERT_EQ(found.size(), 100u);
  for (std::size_t frame = 0; frame < 100; ++frame)
  {
    EXPECT_EQ(found[frame], arrivals[frame]) << frame;
  }
}

TEST(FrameClock, OfFramesBeforeAStreamBeganAnewNothingIsKnown)
{
  Stream stream;
  std::vector<double> arrivals;
  for (int frame = 0; frame < 60; ++frame)
  {
    arrivals.push_back(stream.GetArrival(frame));
  }
  int wrongAtOnce = 0;
  const auto found = FindAll(
    arrivals, [&](int frame) { return stream.GetTime(frame) - (frame < 5 ? 0 : 7); }, wrongAtOnce);
  ASSERT_EQ(found.size(), 60u);
  for (std::size_t frame = 0; frame < 60; ++frame)
  {
    EXPECT_EQ(found[frame].has_value(), frame >= 5) << frame;
  }
}

TEST(FrameClock, FramesThatWereHeldUpGetTheTimesThatTheyWouldHaveHad)
{
  FrameClock clock;
  Stream stream;
  double free = 0; // until then the computer stands still
  double before = 0;
  int late = 0;
  for (int frame = 0; frame < 2000; ++frame)
  {
    const double punctual = stream.GetArrival(frame);
    if (frame > 50 && frame % 37 == 0)
    {
      free = punctual + 0.01 * (frame % 23); // up to five frames
    }
    const double arrival = std::max(punctual, free);
    const double found = Find(clock, arrival, stream.GetTime(frame));
    EXPECT_LE(found, arrival);
    EXPECT_GT(found, before);
    before = found;
    if (arrival > punctual + 0.009)
    {
      ++late;
      EXPECT_NEAR(found, stream.GetEnd(frame) + Way + 0.0005, 0.0005) << frame;
    }
    else if (arrival == punctual)
    {
      EXPECT_EQ(found, arrival) << frame;
    }
    else
    {
      EXPECT_NEAR(found, punctual, 0.009) << frame;
    }
  }
  EXPECT_GT(late, 80);
}

TEST(FrameClock, StreamsOfAnotherRateThanTheySayKeepTheirArrivals)
{
  for (const double rate : { 0.5, 0.8, 0.99, 0.995, 0.998, 0.999, 0.9999, 1.001, 1.01, 1.2, 2.0 })
  {
    FrameClock clock;
    Stream stream;
    stream.Rate = rate;
    for (int frame = 0; frame < 1000; ++frame)
    {
      const double arrival = stream.GetArrival(frame);
      ASSERT_EQ(Find(clock, arrival, stream.GetTime(frame)), arrival) << rate << " " << frame;
    }
  }
}

TEST(FrameClock, StreamsThatComeInBurstsKeepTheirArrivals)
{
  FrameClock clock;
  Stream stream;
  for (int frame = 0; frame < 1000; ++frame)
  {
    const double arrival = stream.GetArrival(frame + 1 - frame % 2) + 0.0001 * (frame % 2);
    ASSERT_EQ(Find(clock, arrival, stream.GetTime(frame)), arrival) << frame;
  }
}

TEST(FrameClock, AWayThatBecomesLongerIsTheUsualOneSoon)
{
  FrameClock clock;
  Stream stream;
  for (int frame = 0; frame < 200; ++frame)
  {
    const double arrival = stream.GetArrival(frame) + (frame < 100 ? 0 : 0.03);
    const double found = Find(clock, arrival, stream.GetTime(frame));
    if (frame == 100)
    {
      ASSERT_LE(found, arrival); // it may have been held up
    }
    else
    {
      ASSERT_EQ(found, arrival) << frame;
    }
  }
}

TEST(FrameClock, AStreamThatBeginsAnewIsLearntAnew)
{
  FrameClock clock;
  Stream stream;
  for (int frame = 0; frame < 400; ++frame)
  {
    const double time = stream.GetTime(frame) - (frame < 200 ? 0 : 7);
    const bool late = frame == 201 || frame == 300;
    const double arrival = stream.GetArrival(frame) + (late ? 0.03 : 0);
    const double found = Find(clock, arrival, time);
    if (frame == 300)
    {
      EXPECT_NEAR(found, stream.GetEnd(frame) + Way, 0.001);
    }
    else
    {
      ASSERT_EQ(found, arrival) << frame; // 201: nothing is known yet
    }
  }
}

TEST(FrameClock, ALongStallIsOneAtAnyRate)
{
  for (const double period : { 1 / 120.0, 1 / 60.0, 1 / 25.0, 1 / 5.0 })
  {
    FrameClock clock;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> jitter(0, 0.001);
    double free = 0;
    double before = 0;
    for (int frame = 0; frame < 3000; ++frame)
    {
      const double due = Start + frame * period;
      if (frame == 300 || frame == 1000) // the decoder needs time for what has waited
      {
        free = due + (frame == 300 ? 0.34 : 0.9);
      }
      free = std::max(due + jitter(random), free + std::min(0.6 * period, 0.01));
      const double found = Find(clock, free, 77 + frame * period);
      ASSERT_NEAR(found, due, 0.0095) << 1 / period << " " << frame;
      ASSERT_GE(found, before) << 1 / period << " " << frame;
      before = found;
    }
  }
}

TEST(FrameClock, ASenderThatCountsAndLosesFramesMisleadsForOneEach)
{
  FrameClock clock;
  Stream stream;
  int wrong = 0;
  int lost = 0;
  for (int frame = 0; frame < 1000; ++frame)
  {
    lost += frame > 100 && frame % 200 == 0 ? 1 : 0;
    const double arrival = stream.GetArrival(frame + lost);
    wrong += Find(clock, arrival, stream.GetTime(frame)) == arrival ? 0 : 1;
  }
  EXPECT_EQ(lost, 4);
  EXPECT_EQ(wrong, lost);
}

TEST(FrameClock, ATimeThatIsSetBackByLessThanASecondIsNoStall)
{
  FrameClock clock;
  Stream stream;
  for (int frame = 0; frame < 400; ++frame)
  {
    const double time = stream.GetTime(frame) - (frame < 200 ? 0 : 0.5);
    const double arrival = stream.GetArrival(frame);
    ASSERT_EQ(Find(clock, arrival, time), arrival) << frame;
  }
}

// While nothing was known yet the first of them kept its arrival.
TEST(FrameClock, NoneOfTheFramesThatWereHeldUpIsEarlierThanTheOneBefore)
{
  for (int stall = 15; stall < 40; ++stall)
  {
    FrameClock clock;
    Stream stream;
    double free = 0;
    double before = 0;
    for (int frame = 0; frame < 100; ++frame)
    {
      free = frame == stall ? stream.GetEnd(frame) + 0.2 : free;
      const double arrival = std::max(stream.GetArrival(frame), free);
      const double found = Find(clock, arrival, stream.GetTime(frame));
      ASSERT_GE(found, before) << stall << " " << frame;
      before = found;
    }
  }
}
