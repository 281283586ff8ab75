// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOpenIGTLinkConnection.h"

#include "lacunaExecution.h"
#include "lacunaTcpChannel.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

namespace lacuna
{
namespace
{
constexpr std::chrono::duration<double> Interval(0.05); // between looks at whether to stop
constexpr double Patience = 5;                          // s for the rest of a message
constexpr std::uint64_t LargestWanted = std::uint64_t{ 128 } << 20;
constexpr std::size_t Piece = std::size_t{ 1 } << 20;
constexpr std::size_t MostDevices = 64;
constexpr double ConnectTime = 5;  // s
constexpr double AnswerTime = 0.3; // s for a server to change to version 2: PLUS looks every 0.1 s
constexpr double RefusalTime = 1;  // s in which a server that cannot read version 2 hangs up
constexpr int ManyRefusals = 2;

void CheckStopped(const std::function<bool()>& stopped)
{
  if (stopped && stopped())
  {
    throw Aborted();
  }
}

std::string GetKey(const OpenIGTLinkHeader& header)
{
  return header.Type + " '" + header.Device + "'";
}

bool IsMeasurement(const OpenIGTLinkHeader& header)
{
  const std::array<const char*, 6> types{ "TRANSFORM", "POSITION", "QTRANS", "TDATA", "QTDATA",
    "IMAGE" };
  return std::find(types.begin(), types.end(), header.Type) != types.end();
}

// Whether its stamp is the instant of a measurement.
bool IsMeasured(const OpenIGTLinkHeader& header)
{
  return header.Stamp && IsMeasurement(header);
}

// Connections of one server that share a clock; locked while one is made.
struct Shared
{
  std::mutex Mutex;
  std::weak_ptr<OpenIGTLinkConnection> Connection;
  OpenIGTLinkConnection::Refusals Refusals = std::make_shared<std::atomic<int>>(0);
};

std::shared_ptr<Shared> FindShared(const std::string& server, const Clock& clock)
{
  static std::mutex mutex;
  static std::map<std::pair<std::string, const Clock*>, std::shared_ptr<Shared>> all;
  const std::lock_guard<std::mutex> lock(mutex);
  std::shared_ptr<Shared>& shared = all[{ server, &clock }];
  if (!shared)
  {
    shared = std::make_shared<Shared>();
  }
  return shared;
}
}

std::shared_ptr<OpenIGTLinkConnection> OpenIGTLinkConnection::Open(
  const OpenIGTLinkAddress& address, const Clock& clock, const std::function<bool()>& stopped)
{
  const std::shared_ptr<Shared> shared = FindShared(address.GetServer(), clock);
  std::unique_lock<std::mutex> lock(shared->Mutex, std::defer_lock);
  while (!lock.try_lock())
  {
    CheckStopped(stopped);
    std::this_thread::sleep_for(Interval);
  }
  std::shared_ptr<OpenIGTLinkConnection> connection = shared->Connection.lock();
  if (!connection || connection->IsBroken())
  {
    connection = std::make_shared<OpenIGTLinkConnection>(
      std::make_unique<TcpChannel>(
        address.Host, address.Port, address.GetServer(), ConnectTime, stopped),
      clock, shared->Refusals);
    shared->Connection = connection;
  }
  return connection;
}

OpenIGTLinkInbox::OpenIGTLinkInbox(Filter filter)
  : Matches(std::move(filter))
{
}

std::shared_ptr<const OpenIGTLinkArrival> OpenIGTLinkInbox::Wait(
  double seconds, const std::function<bool()>& stopped)
{
  std::unique_lock<std::mutex> lock(this->Mutex);
  for (double waited = 0; this->Messages.empty() && !this->Reason && waited < seconds;
       waited += Interval.count())
  {
    lock.unlock();
    CheckStopped(stopped);
    lock.lock();
    this->Changed.wait_for(
      lock, Interval, [this] { return !this->Messages.empty() || this->Reason; });
  }
  if (!this->Messages.empty())
  {
    std::shared_ptr<const OpenIGTLinkArrival> first = std::move(this->Messages.front());
    this->Messages.pop_front();
    this->Bytes -= first->Message.Body.size();
    return first;
  }
  if (this->Reason)
  {
    throw ChannelError(this->Reason->Kind, this->Reason->What);
  }
  return nullptr;
}

OpenIGTLinkCounts OpenIGTLinkInbox::GetCounts() const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->Counts;
}

std::string OpenIGTLinkInbox::GetFault() const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return this->Fault;
}

void OpenIGTLinkInbox::Put(std::shared_ptr<const OpenIGTLinkArrival> arrival)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  ++this->Counts.Messages;
  this->Bytes += arrival->Message.Body.size();
  this->Messages.push_back(std::move(arrival));
  while (this->Bytes > MaximumBytes && this->Messages.size() > 1)
  {
    this->Bytes -= this->Messages.front()->Message.Body.size();
    this->Messages.pop_front();
    ++this->Counts.Dropped;
  }
  this->Changed.notify_all();
}

void OpenIGTLinkInbox::NoteDamage(const std::string& fault)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  ++this->Counts.Damaged;
  this->Fault = fault;
}

void OpenIGTLinkInbox::Break(const OpenIGTLinkBreak& reason)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Reason = reason;
  this->Changed.notify_all();
}

OpenIGTLinkConnection::OpenIGTLinkConnection(
  std::unique_ptr<ByteChannel> channel, const Clock& clock, Refusals refusals)
  : Channel(std::move(channel))
  , Time(clock)
  , Refused(std::move(refusals))
  , Asked(*this->Refused < ManyRefusals)
  , Begin(clock.Now())
  , Waits(this->Asked)
{
  if (this->Asked)
  {
    this->Channel->Write(MakeOpenIGTLinkStatusRequest());
  }
  this->Reader = std::thread([this] { this->Run(); });
}

OpenIGTLinkConnection::~OpenIGTLinkConnection()
{
  this->Stop = true;
  this->Reader.join();
}

void OpenIGTLinkConnection::Attach(OpenIGTLinkInbox& inbox)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Inboxes.push_back(&inbox);
  if (this->Reason)
  {
    inbox.Break(*this->Reason);
  }
}

void OpenIGTLinkConnection::Detach(OpenIGTLinkInbox& inbox)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Inboxes.erase(
    std::remove(this->Inboxes.begin(), this->Inboxes.end(), &inbox), this->Inboxes.end());
}

std::string OpenIGTLinkConnection::GetDevices() const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  std::string text;
  for (const auto& device : this->Devices)
  {
    text += (text.empty() ? "" : ", ") + device.first;
  }
  return text;
}

bool OpenIGTLinkConnection::SendsPoses() const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  return std::any_of(this->Devices.begin(), this->Devices.end(),
    [](const auto& device)
    { return IsMeasurement(device.second) && device.second.Type != "IMAGE"; });
}

OpenIGTLinkClockState OpenIGTLinkConnection::GetClock(const OpenIGTLinkHeader& header) const
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  const std::string own = GetKey(header);
  OpenIGTLinkClockState state;
  state.Offset = this->Clocks.GetOffset(own);
  state.Jitter = this->Clocks.GetJitter(own);
  state.Steps = this->Clocks.GetNumberOfSteps(own);
  for (const auto& [key, other] : this->Devices)
  {
    const double step = this->Clocks.GetStep(own, key);
    if (other.Type == "IMAGE" && step > state.OtherStep && this->IsWanted(other))
    {
      state.Other = other.Device;
      state.OtherStep = step;
    }
  }
  return state;
}

void OpenIGTLinkConnection::Run()
{
  try
  {
    while (this->ReadMessage())
    {
    }
  }
  catch (const ChannelError& e)
  {
    this->Break({ e.GetKind(), e.what() });
  }
  catch (const std::exception& e)
  {
    this->Break({ ChannelError::Kind::Other, e.what() });
  }
}

void OpenIGTLinkConnection::Break(const OpenIGTLinkBreak& reason)
{
  this->EndWait();
  const bool refused =
    this->Asked && !this->Answered && this->Time.Now() - this->Begin < RefusalTime;
  *this->Refused = refused ? *this->Refused + 1 : 0;
  const std::lock_guard<std::mutex> lock(this->Mutex);
  this->Reason = reason;
  this->Broken = true;
  for (OpenIGTLinkInbox* inbox : this->Inboxes)
  {
    inbox->Break(reason);
  }
}

// False when told to stop. Once the first byte is there, patience is the longest silence, s; 0: any.
bool OpenIGTLinkConnection::Receive(char* bytes, std::size_t size, double patience)
{
  std::size_t count = 0;
  double last = this->Time.Now();
  while (count < size)
  {
    if (this->Stop)
    {
      return false;
    }
    if (this->Waits && this->Time.Now() - this->Begin > AnswerTime)
    {
      this->EndWait();
    }
    const std::size_t more = this->Channel->Read(bytes + count, size - count, Interval.count());
    const double now = this->Time.Now();
    if (more > 0)
    {
      patience = Patience;
      last = now;
    }
    else if (patience > 0 && now - last > patience)
    {
      throw ChannelError(ChannelError::Kind::Other,
        "The server " + this->GetName() +
          " stopped in the middle of a message, or sends what is "
          "not OpenIGTLink: restart it, or check the port");
    }
    count += more;
  }
  return true;
}

// With the lock.
bool OpenIGTLinkConnection::IsWanted(const OpenIGTLinkHeader& header) const
{
  return std::any_of(this->Inboxes.begin(), this->Inboxes.end(),
    [&](const OpenIGTLinkInbox* inbox) { return inbox->Wants(header); });
}

// Whether somebody wants its messages.
bool OpenIGTLinkConnection::NoteDevice(const OpenIGTLinkHeader& header)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (this->Devices.size() < MostDevices)
  {
    this->Devices.emplace(GetKey(header), header);
  }
  return this->IsWanted(header);
}

// Of a message that nobody wants yet: the clock is known when somebody does.
void OpenIGTLinkConnection::NoteStamp(const OpenIGTLinkHeader& header)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  if (IsMeasured(header) && this->Devices.count(GetKey(header)) > 0)
  {
    this->Clocks.ToLocal(GetKey(header), *header.Stamp, this->Time.Now());
  }
}

void OpenIGTLinkConnection::NoteDamage(const OpenIGTLinkHeader& header, const std::string& fault)
{
  const std::lock_guard<std::mutex> lock(this->Mutex);
  for (OpenIGTLinkInbox* inbox : this->Inboxes)
  {
    if (inbox->Wants(header))
    {
      inbox->NoteDamage(fault);
    }
  }
}

// What was measured before the first message of version 2 would have no status, however wrong it is.
void OpenIGTLinkConnection::HeedAnswer(const OpenIGTLinkHeader& header)
{
  if (header.Version >= 2)
  {
    this->Answered = true;
    this->Early.clear();
    this->Waits = false;
  }
}

// The server has no version 2: what waited is all that it gives.
void OpenIGTLinkConnection::EndWait()
{
  this->Waits = false;
  const std::lock_guard<std::mutex> lock(this->Mutex);
  for (const auto& arrival : this->Early)
  {
    for (OpenIGTLinkInbox* inbox : this->Inboxes)
    {
      if (inbox->Wants(arrival->Message.Header))
      {
        inbox->Put(arrival);
      }
    }
  }
  this->Early.clear();
}

bool OpenIGTLinkConnection::Skip(std::uint64_t size)
{
  std::vector<char> scrap(static_cast<std::size_t>(std::min<std::uint64_t>(size, Piece)));
  for (; size > 0; size -= std::min<std::uint64_t>(size, Piece))
  {
    const auto piece = static_cast<std::size_t>(std::min<std::uint64_t>(size, Piece));
    if (!this->Receive(scrap.data(), piece, Patience))
    {
      return false;
    }
  }
  return true;
}

// Takes no more memory than twice what came.
bool OpenIGTLinkConnection::ReadBody(std::uint64_t size, std::vector<char>& body)
{
  while (body.size() < size)
  {
    const std::size_t begin = body.size();
    const auto piece = static_cast<std::size_t>(std::min<std::uint64_t>(size - begin, Piece));
    body.resize(begin + piece);
    if (!this->Receive(body.data() + begin, piece, Patience))
    {
      return false;
    }
  }
  return true;
}

void OpenIGTLinkConnection::Deliver(
  const OpenIGTLinkHeader& header, std::vector<char>&& body, double arrival)
{
  const auto delivery = std::make_shared<OpenIGTLinkArrival>();
  delivery->Message = MakeOpenIGTLinkMessage(header, std::move(body));
  delivery->Arrival = arrival;
  const std::lock_guard<std::mutex> lock(this->Mutex);
  delivery->Time = arrival;
  if (IsMeasured(header))
  {
    delivery->Time = this->Clocks.ToLocal(GetKey(header), *header.Stamp, arrival);
    delivery->Epoch = { this, this->Clocks.GetRevision() };
  }
  if (this->Waits && IsMeasurement(header))
  {
    this->Early.push_back(delivery);
    return;
  }
  for (OpenIGTLinkInbox* inbox : this->Inboxes)
  {
    if (inbox->Wants(header))
    {
      inbox->Put(delivery);
    }
  }
}

// False when told to stop.
bool OpenIGTLinkConnection::ReadMessage()
{
  std::array<char, OpenIGTLinkHeader::Size> bytes{};
  if (!this->Receive(bytes.data(), bytes.size(), 0))
  {
    return false;
  }
  OpenIGTLinkHeader header;
  try
  {
    header = ReadOpenIGTLinkHeader(bytes.data());
  }
  catch (const OpenIGTLinkError& e)
  {
    throw ChannelError(
      ChannelError::Kind::Other, "From the server " + this->GetName() + ": " + e.what());
  }
  this->HeedAnswer(header);
  const bool wanted = this->NoteDevice(header);
  if (wanted && header.BodySize > LargestWanted)
  {
    this->NoteDamage(header,
      "The " + header.Type + " message of '" + header.Device + "' has " +
        std::to_string(header.BodySize) + " bytes, more than 128 MiB");
  }
  // a device that is being opened beside another one may want what came when they connected
  const bool mayBeWanted = this->Waits && IsMeasurement(header) && header.BodySize <= Piece;
  if (!(wanted || mayBeWanted) || header.BodySize > LargestWanted)
  {
    this->NoteStamp(header);
    return this->Skip(header.BodySize);
  }
  std::vector<char> body;
  if (!this->ReadBody(header.BodySize, body))
  {
    return false;
  }
  try
  {
    this->Deliver(header, std::move(body), this->Time.Now());
  }
  catch (const OpenIGTLinkError& e)
  {
    this->NoteDamage(header, e.what());
  }
  return true;
}
}
