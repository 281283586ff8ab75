// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaExecution.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

TEST(Execution, CoversEachIndexOnce)
{
  for (const int threads : { 1, 2, 5 })
  {
    for (const int count : { 0, 1, 7, 1000 })
    {
      lacuna::ThreadExecution execution(threads);
      std::vector<std::atomic<int>> hits(count);
      execution.For(count, 3,
        [&](std::int64_t begin, std::int64_t end)
        {
          EXPECT_LE(end - begin, 3);
          for (std::int64_t i = begin; i < end; ++i)
          {
            ++hits[i];
          }
        });
      for (const auto& h : hits)
      {
        EXPECT_EQ(h, 1);
      }
    }
  }
}

TEST(Execution, PassesTheBodysExceptionOn)
{
  lacuna::ThreadExecution execution(3);
  EXPECT_THROW(execution.For(100, 1,
                 [](std::int64_t begin, std::int64_t)
                 {
                   if (begin == 42)
                   {
                     throw std::out_of_range("42");
                   }
                 }),
    std::out_of_range);
}

TEST(Execution, StopsWhenTheObserverSaysSo)
{
  std::atomic<int> ran(0);
  lacuna::ThreadExecution execution(2, [](double) { return false; });
  EXPECT_THROW(execution.For(10000, 1,
                 [&](std::int64_t, std::int64_t)
                 {
                   ++ran;
                   std::this_thread::sleep_for(std::chrono::milliseconds(1));
                 }),
    lacuna::Aborted);
  EXPECT_LT(ran, 9000);
}

TEST(Execution, ReportsOnTheCallingThreadWithinTheStage)
{
  const auto caller = std::this_thread::get_id();
  std::vector<double> reports;
  lacuna::ThreadExecution execution(2,
    [&](double fraction)
    {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      reports.push_back(fraction);
      return true;
    });
  execution.SetStage(0.25, 0.5);
  execution.For(400, 1,
    [](std::int64_t, std::int64_t) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
  ASSERT_GE(reports.size(), 2u);
  for (const double r : reports)
  {
    EXPECT_GE(r, 0.25);
    EXPECT_LE(r, 0.5);
  }
  EXPECT_DOUBLE_EQ(reports.back(), 0.5);
}

TEST(Execution, StagesOfAStageStayWithinIt)
{
  std::vector<double> reports;
  lacuna::ThreadExecution execution(1,
    [&](double fraction)
    {
      reports.push_back(fraction);
      return true;
    });
  execution.SetStage(0.5, 1);
  {
    const lacuna::Execution::NestedStages stages(execution);
    execution.Report(0);
    execution.SetStage(0.5, 1);
    execution.Report(0);
    {
      const lacuna::Execution::NestedStages inner(execution);
      execution.SetStage(0, 0.5);
      execution.Report(1);
    }
    execution.Report(1);
  }
  execution.Report(0.5);
  execution.SetStage(0, 0.5);
  execution.Report(1);
  EXPECT_EQ(reports, (std::vector<double>{ 0.5, 0.75, 0.875, 1, 0.75, 0.5 }));
}
