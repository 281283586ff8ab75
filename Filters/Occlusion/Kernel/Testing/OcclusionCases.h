// SPDX-License-Identifier: BSD-3-Clause
#ifndef OcclusionCases_h
#define OcclusionCases_h

#include "lacunaOccludedAngle.h"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace lacuna
{
constexpr double Pi = 3.14159265358979323846;

/// Calls set(i, j, k) -> value for each voxel.
template <class Set>
void FillField(AttenuationField& field, Set&& set)
{
  const auto& n = field.GetDimensions();
  for (std::int64_t k = 0; k < n[2]; ++k)
  {
    for (std::int64_t j = 0; j < n[1]; ++j)
    {
      for (std::int64_t i = 0; i < n[0]; ++i)
      {
        field.Row(j, k)[i] = static_cast<float>(set(i, j, k));
      }
    }
  }
}

inline std::vector<float> GetAngle(
  AttenuationField& field, const OccludedAngleOptions& options, int threads = 1)
{
  std::vector<float> angle(field.GetNumberOfVoxels());
  ThreadExecution execution(threads);
  ComputeOccludedAngle(field, options, angle.data(), execution);
  return angle;
}

/// Ranks as threads of this process.
class ThreadRanks
{
public:
  /// Calls body with the Ranks of each of number threads.
  static void Run(int number, const std::function<void(const Ranks&)>& body)
  {
    Meeting meeting(number);
    std::vector<std::thread> threads;
    for (int rank = 0; rank < number; ++rank)
    {
      threads.emplace_back([&, rank] { body(Member(meeting, rank)); });
    }
    for (std::thread& thread : threads)
    {
      thread.join();
    }
  }

private:
  /// Where the threads meet: what the last one finds summed up is everybody's.
  class Meeting
  {
  public:
    explicit Meeting(int number)
      : Number(number)
    {
    }

    template <class Value>
    void Sum(Value* values, std::int64_t count)
    {
      std::unique_lock<std::mutex> lock(this->Mutex);
      this->Changed.wait(lock, [this] { return !this->Leaving; });
      this->Values.resize(count);
      for (std::int64_t i = 0; i < count; ++i)
      {
        this->Values[i] += values[i];
      }
      this->Leaving = ++this->Present == this->Number;
      this->Changed.notify_all();
      this->Changed.wait(lock, [this] { return this->Leaving; });
      std::transform(this->Values.begin(), this->Values.end(), values,
        [](std::uint64_t sum) { return static_cast<Value>(sum); });
      if (--this->Present == 0)
      {
        this->Values.clear();
        this->Leaving = false;
        this->Changed.notify_all();
      }
    }

    const int Number;

  private:
    std::mutex Mutex;
    std::condition_variable Changed;
    std::vector<std::uint64_t> Values;
    int Present = 0;
    bool Leaving = false;
  };

  class Member : public Ranks
  {
  public:
    Member(Meeting& meeting, int rank)
      : Place(meeting)
      , Rank(rank)
    {
    }
    int GetRank() const override { return this->Rank; }
    int GetNumber() const override { return this->Place.Number; }
    void Sum(std::uint32_t* values, std::int64_t count) const override
    {
      this->Place.Sum(values, count);
    }
    void Sum(std::uint64_t* values, std::int64_t count) const override
    {
      this->Place.Sum(values, count);
    }

  protected:
    bool AllFine(bool fine) const override
    {
      std::uint32_t failures = fine ? 0 : 1;
      this->Place.Sum(&failures, 1);
      return failures == 0;
    }

  private:
    Meeting& Place;
    int Rank;
  };
};

/// Repeatable numbers 0 <= x < 1.
class Numbers
{
public:
  explicit Numbers(std::uint64_t seed)
    : State(seed)
  {
  }
  double operator()()
  {
    this->State = this->State * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(this->State >> 11) * 0x1p-53;
  }

private:
  std::uint64_t State;
};
}
#endif
