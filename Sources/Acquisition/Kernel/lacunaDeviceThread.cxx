// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDeviceThread.h"

#include "lacunaExecution.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace lacuna
{
namespace
{
constexpr std::chrono::milliseconds LongestEnd{ 800 };
}

struct DeviceThread::State : public Control
{
  bool IsStopped() const override { return this->Stopped; }
  void SetWorking() override
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->Now.Working = true;
    this->Now.Trouble.clear();
  }
  // Returns whether to try again.
  bool Run(const Session& session);
  void Fail(const std::string& reason);
  void Loop(Session session, double retryTime);

  std::atomic<bool> Stopped{ false };
  mutable std::mutex Mutex;
  std::condition_variable Changed;
  Health Now;
  std::chrono::steady_clock::time_point Told;
  bool Ended = false;
};

void DeviceThread::State::Fail(const std::string& reason)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Now.Working = false;
  this->Now.Trouble = reason;
  ++this->Now.Failures;
}

bool DeviceThread::State::Run(const Session& session)
{
  try
  {
    session(*this);
  }
  catch (const Aborted&)
  {
    return !this->Stopped;
  }
  catch (const DeviceEnded& e)
  {
    this->Fail(e.what());
    return false;
  }
  catch (const std::invalid_argument& e)
  {
    this->Fail(e.what());
    return false;
  }
  catch (const std::exception& e)
  {
    this->Fail(e.what());
  }
  return !this->Stopped;
}

void DeviceThread::State::Loop(Session session, double retryTime)
{
  while (!this->Stopped && this->Run(session))
  {
    std::unique_lock<std::mutex> lock(this->Mutex);
    this->Changed.wait_for(
      lock, std::chrono::duration<double>(retryTime), [this] { return this->Stopped.load(); });
  }
  session = nullptr; // what it owns goes before the end is told
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Ended = true;
  this->Changed.notify_all();
}

DeviceThread::DeviceThread(Session session, double retryTime)
  : Shared(std::make_shared<State>())
{
  try
  {
    this->Thread =
      std::thread([state = this->Shared, session = std::move(session), retryTime]() mutable
        { state->Loop(std::move(session), retryTime); });
  }
  catch (const std::system_error& e) // a capture that goes on with another device shall not end
  {
    this->Shared->Fail("No thread can be started for the device: " + e.code().message() +
      ". Close other programs, Disconnect, and Connect");
    this->Shared->Ended = true;
  }
}

DeviceThread::~DeviceThread()
{
  this->Stop();
  std::unique_lock<std::mutex> lock(this->Shared->Mutex);
  const bool ended = this->Shared->Changed.wait_until(
    lock, this->Shared->Told + LongestEnd, [this] { return this->Shared->Ended; });
  lock.unlock();
  if (this->Thread.joinable())
  {
    ended ? this->Thread.join() : this->Thread.detach();
  }
}

void DeviceThread::Stop()
{
  const std::lock_guard<std::mutex> lock(this->Shared->Mutex);
  if (!this->Shared->Stopped)
  {
    this->Shared->Stopped = true;
    this->Shared->Told = std::chrono::steady_clock::now();
    this->Shared->Changed.notify_all();
  }
}

DeviceThread::Health DeviceThread::GetHealth() const
{
  const std::lock_guard<std::mutex> lock(this->Shared->Mutex);
  return this->Shared->Now;
}
}
