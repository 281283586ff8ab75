// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How kernels run their loops: in parallel, with progress, stoppable.
#ifndef lacunaExecution_h
#define lacunaExecution_h

#include <cstdint>
#include <functional>
#include <stdexcept>

namespace lacuna
{
/// Thrown out of a kernel when the user stopped it.
class Aborted : public std::runtime_error
{
public:
  Aborted();
};

/// Runs a kernel's loops. A kernel takes an Execution& and neither knows about threads nor about
/// who watches its progress; it must not let its results depend on how a range is divided.
class Execution
{
public:
  /// Work on the indices begin <= i < end.
  using Body = std::function<void(std::int64_t begin, std::int64_t end)>;

  virtual ~Execution() = default;

  /// Calls body over disjoint ranges of at most grain indices that cover 0 <= i < count, in
  /// parallel and in any order, and returns when all are done. The calling thread reports progress
  /// meanwhile, between ranges if it works too. Throws Aborted when the user stopped, or the first
  /// exception of body. The set-up costs some 50 microseconds: for loops of a millisecond or more.
  void For(std::int64_t count, std::int64_t grain, const Body& body);

  /// Threads that work on a loop at most.
  virtual int GetNumberOfThreads() const = 0;

  /// The next loops and reports cover this part of the whole progress, 0 <= first <= last <= 1; of
  /// the caller's stage while a NestedStages lives.
  void SetStage(double first, double last);

  /// Gives a function that is itself a stage of its caller stages of its own: while it lives,
  /// SetStage divides the stage there was before; then that one is back.
  class NestedStages
  {
  public:
    explicit NestedStages(Execution& execution);
    ~NestedStages();
    NestedStages(const NestedStages&) = delete;
    NestedStages& operator=(const NestedStages&) = delete;

  private:
    Execution& Outer;
    double WholeFirst;
    double WholeLast;
    double StageFirst;
    double StageLast;
  };

  /// Says how far a serial part of the current stage is, 0..1. Throws Aborted when stopped.
  void Report(double fraction);

protected:
  /// Runs body over ranges that cover 0 <= i < count, in parallel; returns when all are done.
  virtual void Launch(std::int64_t count, std::int64_t grain, const Body& body) = 0;
  /// Whether the thread that calls Launch takes ranges itself, one after the other, and can so
  /// report between them. Then For needs no thread besides, which would wait for a core.
  virtual bool LaunchWorks() const { return false; }
  /// Called on the thread that called For or Report; returns false to stop.
  virtual bool OnProgress(double fraction) = 0;

private:
  double WholeFirst = 0; ///< what SetStage divides
  double WholeLast = 1;
  double StageFirst = 0;
  double StageLast = 1;
};

/// Plain std::thread execution, for tests, benchmarks and programs without VTK.
class ThreadExecution : public Execution
{
public:
  /// Threads to use; 0 means all cores. progress may be empty; it returns false to stop.
  explicit ThreadExecution(int threads = 0, std::function<bool(double)> progress = {});
  int GetNumberOfThreads() const override { return this->Threads; }

protected:
  void Launch(std::int64_t count, std::int64_t grain, const Body& body) override;
  bool LaunchWorks() const override { return true; }
  bool OnProgress(double fraction) override;

private:
  int Threads;
  std::function<bool(double)> Progress;
};
}
#endif
