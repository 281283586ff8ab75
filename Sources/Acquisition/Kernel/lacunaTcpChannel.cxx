// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaTcpChannel.h"

#include "lacunaExecution.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace lacuna
{
namespace
{
constexpr double Interval = 0.05; // s between looks at whether to stop
constexpr int WriteTime = 500;    // ms
// A connection whose other side says nothing for Idle is asked; Probes unanswered questions end it.
constexpr int Idle = 3; // s
constexpr int Probes = 3;

struct Address
{
  sockaddr_storage Bytes = {};
  socklen_t Size = 0;
};

// The system's looking up of a name cannot be cut short: it goes on by itself when given up.
struct Lookup
{
  std::mutex Mutex;
  std::condition_variable Finished;
  bool Done = false;
  int Error = 0;
  std::vector<Address> Addresses;
};

void LookUp(const std::string& host, const std::string& port, int flags, Lookup& lookup)
{
  addrinfo hints = {};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV | flags;
  addrinfo* list = nullptr;
  const int error = getaddrinfo(host.c_str(), port.c_str(), &hints, &list);
  const std::lock_guard<std::mutex> lock(lookup.Mutex);
  for (const addrinfo* item = error == 0 ? list : nullptr; item; item = item->ai_next)
  {
    Address address;
    address.Size = std::min<socklen_t>(item->ai_addrlen, sizeof(address.Bytes));
    std::memcpy(&address.Bytes, item->ai_addr, address.Size);
    lookup.Addresses.push_back(address);
  }
  if (error == 0)
  {
    freeaddrinfo(list);
  }
  lookup.Error = error;
  lookup.Done = true;
  lookup.Finished.notify_all();
}

void CheckStopped(const std::function<bool()>& stopped)
{
  if (stopped && stopped())
  {
    throw Aborted();
  }
}

std::vector<Address> FindAddresses(const std::string& host, int port, const std::string& name,
  double seconds, const std::function<bool()>& stopped)
{
  const auto lookup = std::make_shared<Lookup>();
  const std::string service = std::to_string(port);
  LookUp(host, service, AI_NUMERICHOST, *lookup); // digits need no server
  if (lookup->Error == 0)
  {
    return lookup->Addresses;
  }
  lookup->Done = false;
  std::thread([host, service, lookup] { LookUp(host, service, 0, *lookup); }).detach();
  std::unique_lock<std::mutex> lock(lookup->Mutex);
  for (double waited = 0; !lookup->Done && waited < seconds; waited += Interval)
  {
    CheckStopped(stopped);
    lookup->Finished.wait_for(lock, std::chrono::duration<double>(Interval));
  }
  if (!lookup->Done || lookup->Error != 0 || lookup->Addresses.empty())
  {
    throw ChannelError(ChannelError::Kind::NotFound,
      "There is no host '" + host + "' for " + name + " (" +
        (lookup->Done ? gai_strerror(lookup->Error) : "the name server does not answer") +
        "): check the spelling, or give its number, as 192.168.0.10");
  }
  return lookup->Addresses;
}

// 0, or why not.
int Connect(
  int socket, const Address& address, double seconds, const std::function<bool()>& stopped)
{
  if (connect(socket, reinterpret_cast<const sockaddr*>(&address.Bytes), address.Size) == 0)
  {
    return 0;
  }
  if (errno != EINPROGRESS)
  {
    return errno;
  }
  for (double waited = 0; waited < seconds; waited += Interval)
  {
    CheckStopped(stopped);
    pollfd wait = { socket, POLLOUT, 0 };
    if (poll(&wait, 1, static_cast<int>(1000 * Interval)) > 0)
    {
      int error = 0;
      socklen_t size = sizeof(error);
      return getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
    }
  }
  return ETIMEDOUT;
}

[[noreturn]] void ThrowConnecting(const std::string& name, int error)
{
  switch (error)
  {
    case ECONNREFUSED:
      throw ChannelError(ChannelError::Kind::NotFound,
        "No server listens at " + name +
          " (connection refused): start it, and check the port in its settings");
    case ETIMEDOUT:
    case EHOSTUNREACH:
    case ENETUNREACH:
    case ENETDOWN:
    case EHOSTDOWN:
      throw ChannelError(ChannelError::Kind::NotFound,
        "The host of " + name + " does not answer (" + std::strerror(error) +
          "): check its name, the network and firewalls on the way");
    case EACCES:
    case EPERM:
      throw ChannelError(ChannelError::Kind::Permission,
        "This computer does not allow the connection to " + name + ": check its firewall");
    default:
      throw ChannelError(ChannelError::Kind::Other,
        "The connection to " + name + " cannot be made: " + std::strerror(error));
  }
}

void SetOption(int socket, int level, int option, int value)
{
  // of those that fail nothing else depends
  setsockopt(socket, level, option, &value, sizeof(value));
}
}

TcpChannel::TcpChannel(const std::string& host, int port, const std::string& name, double seconds,
  const std::function<bool()>& stopped)
  : Name(name)
{
  int error = 0;
  for (const Address& address : FindAddresses(host, port, name, seconds, stopped))
  {
    this->Socket =
      socket(address.Bytes.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, IPPROTO_TCP);
    if (this->Socket < 0)
    {
      error = errno;
      continue;
    }
    try
    {
      error = Connect(this->Socket, address, seconds, stopped);
    }
    catch (...)
    {
      close(this->Socket);
      throw;
    }
    if (error == 0)
    {
      SetOption(this->Socket, IPPROTO_TCP, TCP_NODELAY, 1);
      SetOption(this->Socket, SOL_SOCKET, SO_KEEPALIVE, 1);
      SetOption(this->Socket, IPPROTO_TCP, TCP_KEEPIDLE, Idle);
      SetOption(this->Socket, IPPROTO_TCP, TCP_KEEPINTVL, 1);
      SetOption(this->Socket, IPPROTO_TCP, TCP_KEEPCNT, Probes);
      return;
    }
    close(this->Socket);
  }
  ThrowConnecting(name, error);
}

TcpChannel::~TcpChannel()
{
  close(this->Socket);
}

void TcpChannel::ThrowLost(const std::string& reason) const
{
  throw ChannelError(ChannelError::Kind::Unplugged,
    "The connection to " + this->Name + " is gone (" + reason +
      "): start the server again, or check the network");
}

std::size_t TcpChannel::Read(char* bytes, std::size_t size, double seconds)
{
  pollfd wait = { this->Socket, POLLIN, 0 };
  const int ready = poll(&wait, 1, static_cast<int>(1000 * seconds));
  if (ready <= 0)
  {
    if (ready < 0 && errno != EINTR)
    {
      this->ThrowLost(std::strerror(errno));
    }
    return 0;
  }
  const ssize_t count = recv(this->Socket, bytes, size, 0);
  if (count > 0)
  {
    return static_cast<std::size_t>(count);
  }
  if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR))
  {
    return 0;
  }
  this->ThrowLost(count == 0 ? "the server closed it" : std::strerror(errno));
}

void TcpChannel::Write(std::string_view bytes)
{
  while (!bytes.empty())
  {
    const ssize_t count = send(this->Socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count > 0)
    {
      bytes.remove_prefix(static_cast<std::size_t>(count));
      continue;
    }
    pollfd wait = { this->Socket, POLLOUT, 0 };
    if ((errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) ||
      poll(&wait, 1, WriteTime) == 0)
    {
      this->ThrowLost(std::strerror(errno));
    }
  }
}
}
