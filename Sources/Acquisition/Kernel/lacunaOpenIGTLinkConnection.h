// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A connection to an OpenIGTLink server, shared by those who want its messages.
#ifndef lacunaOpenIGTLinkConnection_h
#define lacunaOpenIGTLinkConnection_h

#include "lacunaByteChannel.h"
#include "lacunaClock.h"
#include "lacunaOpenIGTLinkAddress.h"
#include "lacunaOpenIGTLinkClock.h"
#include "lacunaOpenIGTLinkMessage.h"
#include "lacunaTrackedPose.h"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace lacuna
{
/// A message that came. Times are s of the acquisition's clock.
struct OpenIGTLinkArrival
{
  OpenIGTLinkMessage Message;
  double Arrival = 0; ///< when its last byte was there
  double Time = 0;    ///< the instant of its stamp (see OpenIGTLinkClock); without one, the arrival
  ClockEpoch Epoch;   ///< of Time
};

struct OpenIGTLinkCounts
{
  std::uint64_t Messages = 0; ///< wanted ones that came whole
  std::uint64_t Damaged = 0;  ///< wanted ones that were not, or are larger than 128 MiB
  std::uint64_t Dropped = 0;  ///< wanted ones that nobody took in time
};

/// What is known of the clock of a device that stamps its messages: see OpenIGTLinkClock.
struct OpenIGTLinkClockState
{
  std::optional<double> Offset; ///< s, our time minus its own
  double Jitter = 0;            ///< s
  int Steps = 0;                ///< how often the device's clock was set
  std::string Other;            ///< an image device that somebody wants and whose clock is another
  double OtherStep = 0;         ///< s that its stamps are apart from the device's
};

/// Why a connection ended. Each thread makes an exception of it for itself: one exception that several
/// threads rethrow is counted inside the C++ library, where ThreadSanitizer does not see it.
struct OpenIGTLinkBreak
{
  ChannelError::Kind Kind = ChannelError::Kind::Other;
  std::string What;
};

/// Waits for messages that match on behalf of one device. Used by one thread, filled by another.
class OpenIGTLinkInbox
{
public:
  using Filter = std::function<bool(const OpenIGTLinkHeader&)>;
  /// The filter is asked on the other thread.
  explicit OpenIGTLinkInbox(Filter filter);

  /// The next message; null when none comes in so many seconds. Throws Aborted when stopped,
  /// which is asked every 50 ms, and ChannelError when the connection broke.
  std::shared_ptr<const OpenIGTLinkArrival> Wait(
    double seconds, const std::function<bool()>& stopped);
  OpenIGTLinkCounts GetCounts() const;
  /// What is wrong with the last message that was not whole; empty: none was.
  std::string GetFault() const;

  bool Wants(const OpenIGTLinkHeader& header) const { return this->Matches(header); }
  void Put(std::shared_ptr<const OpenIGTLinkArrival> arrival);
  void NoteDamage(const std::string& fault);
  void Break(const OpenIGTLinkBreak& reason);

private:
  static constexpr std::size_t MaximumBytes = std::size_t{ 64 } << 20;

  Filter Matches;
  mutable std::mutex Mutex;
  std::condition_variable Changed;
  std::deque<std::shared_ptr<const OpenIGTLinkArrival>> Messages;
  std::size_t Bytes = 0;
  OpenIGTLinkCounts Counts;
  std::string Fault;
  std::optional<OpenIGTLinkBreak> Reason;
};

/// Reads messages on a thread of its own, until the line breaks or garbage comes.
///
/// It begins with a message of header version 2 (see MakeOpenIGTLinkStatusRequest), because PLUS answers
/// in the version of its client. What PLUS measures before it has read that message has no status. So
/// measurements of version 1 wait for the answer, up to 0.3 s: once a message of version 2 comes, they
/// are dropped. A server that twice ends the connection at that message is not sent it again.
class OpenIGTLinkConnection
{
public:
  /// The one to this server that is open in this program, or a new one: 3D Slicer serves only one at
  /// a time, and the stamps of one sender are best compared together. The clock must live longer; it
  /// is the computer's. Throws ChannelError, and Aborted when stopped, which is asked every 50 ms.
  /// Thread-safe.
  static std::shared_ptr<OpenIGTLinkConnection> Open(
    const OpenIGTLinkAddress& address, const Clock& clock, const std::function<bool()>& stopped);

  /// How many connections to a server in a row ended at the message of version 2.
  using Refusals = std::shared_ptr<std::atomic<int>>;
  /// The clock must live longer, and have the channel's time.
  OpenIGTLinkConnection(
    std::unique_ptr<ByteChannel> channel, const Clock& clock, Refusals refusals);
  ~OpenIGTLinkConnection();
  OpenIGTLinkConnection(const OpenIGTLinkConnection&) = delete;
  OpenIGTLinkConnection& operator=(const OpenIGTLinkConnection&) = delete;

  /// From then on the inbox gets messages, until it is detached.
  void Attach(OpenIGTLinkInbox& inbox);
  void Detach(OpenIGTLinkInbox& inbox);
  void Send(const std::string& bytes) { this->Channel->Write(bytes); }
  bool IsBroken() const { return this->Broken; }
  std::string GetName() const { return this->Channel->GetName(); }

  /// What the server sends, "TRANSFORM ProbeToTracker, IMAGE Image_Reference", for messages.
  std::string GetDevices() const;
  /// Whether any pose came, of whatever device.
  bool SendsPoses() const;
  OpenIGTLinkClockState GetClock(const OpenIGTLinkHeader& header) const;

private:
  void Run();
  void Break(const OpenIGTLinkBreak& reason);
  bool Receive(char* bytes, std::size_t size, double patience);
  bool ReadMessage();
  bool Skip(std::uint64_t size);
  bool ReadBody(std::uint64_t size, std::vector<char>& body);
  bool IsWanted(const OpenIGTLinkHeader& header) const;
  bool NoteDevice(const OpenIGTLinkHeader& header);
  void NoteStamp(const OpenIGTLinkHeader& header);
  void Deliver(const OpenIGTLinkHeader& header, std::vector<char>&& body, double arrival);
  void NoteDamage(const OpenIGTLinkHeader& header, const std::string& fault);
  void HeedAnswer(const OpenIGTLinkHeader& header);
  void EndWait();

  std::unique_ptr<ByteChannel> Channel;
  const Clock& Time;
  mutable std::mutex Mutex; ///< of what follows, up to the thread
  std::vector<OpenIGTLinkInbox*> Inboxes;
  std::map<std::string, OpenIGTLinkHeader> Devices; ///< by key, the first message of each
  OpenIGTLinkClock Clocks;
  std::optional<OpenIGTLinkBreak> Reason;
  Refusals Refused;
  bool Asked = false;    ///< for version 2
  bool Answered = false; ///< in version 2
  double Begin = 0;
  /// Of version 1, that wait for the answer; used by Reader only, as is whether there is a wait.
  std::vector<std::shared_ptr<const OpenIGTLinkArrival>> Early;
  bool Waits = false;
  std::atomic<bool> Broken{ false };
  std::atomic<bool> Stop{ false };
  std::thread Reader;
};
}
#endif
