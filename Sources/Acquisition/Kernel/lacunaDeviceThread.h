// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Keeps a device going on a thread of its own, through its failures.
#ifndef lacunaDeviceThread_h
#define lacunaDeviceThread_h

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

namespace lacuna
{
/// Thrown by a session when there is nothing more to come, and trying again would not help.
class DeviceEnded : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Runs a session, which opens a device and uses it. When one fails the reason is kept, and after a
/// while another one begins: a device that was unplugged works again when it is plugged in.
class DeviceThread
{
public:
  struct Health
  {
    bool Working = false; ///< the session said so, and has not failed since
    std::string Trouble;  ///< why it does not work, and what to do; empty before the first failure
    int Failures = 0;
  };
  /// What a session may ask and say.
  class Control
  {
  public:
    virtual ~Control() = default;
    virtual bool IsStopped() const = 0;
    /// The device works: what was wrong is over.
    virtual void SetWorking() = 0;
  };
  /// Returns when stopped; throws when the device fails: DeviceEnded and std::invalid_argument are
  /// final. It is called from the thread, and must own what it uses.
  using Session = std::function<void(Control&)>;

  /// Where the system gives no thread the health says so.
  DeviceThread(Session session, double retryTime);
  /// Tells the session to stop and waits for it, but no longer than 0.8 s since it was told first:
  /// one that a call of the system holds (the look-up of a host's name) ends by itself later.
  ~DeviceThread();
  DeviceThread(const DeviceThread&) = delete;
  DeviceThread& operator=(const DeviceThread&) = delete;

  /// Tells the session to stop, without waiting.
  void Stop();
  Health GetHealth() const;

private:
  struct State;
  std::shared_ptr<State> Shared;
  std::thread Thread;
};
}
#endif
