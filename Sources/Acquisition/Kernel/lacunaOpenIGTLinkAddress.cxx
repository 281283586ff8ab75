// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaOpenIGTLinkAddress.h"

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <string_view>

namespace lacuna
{
namespace
{
constexpr std::string_view Scheme = "igtl://";

[[noreturn]] void Complain(const std::string& text, const std::string& what)
{
  throw std::invalid_argument("The address '" + text + "' " + what +
    ": give igtl://host:port, as igtl://localhost:18944?transform=ProbeToTracker&image=Image");
}

bool EqualLetters(std::string_view a, std::string_view b)
{
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
    [&](char left, char right) { return lower(left) == lower(right); });
}

// %20 and the like become characters; false when one is none.
bool Decode(std::string_view text, std::string& decoded)
{
  for (std::size_t i = 0; i < text.size(); ++i)
  {
    if (text[i] != '%')
    {
      decoded += text[i];
      continue;
    }
    const std::string_view digits = text.substr(i + 1, 2);
    unsigned int code = 0;
    const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
    if (digits.size() != 2 || error != std::errc() || end != digits.data() + 2 || code == 0)
    {
      return false;
    }
    decoded += static_cast<char>(code);
    i += 2;
  }
  return true;
}

void ReadServer(const std::string& text, std::string_view server, OpenIGTLinkAddress& address)
{
  std::string_view port;
  const bool brackets = !server.empty() && server.front() == '[';
  const std::size_t close = server.find(']');
  if (brackets && close == std::string_view::npos)
  {
    Complain(text, "has no ]");
  }
  const std::string_view rest = brackets ? server.substr(close + 1) : server;
  const std::size_t colon = rest.find(':');
  address.Host = brackets ? server.substr(1, close - 1) : rest.substr(0, colon);
  if (address.Host.empty() || address.Host.find_first_of(" @") != std::string::npos ||
    (brackets && !rest.empty() && colon != 0))
  {
    Complain(text, address.Host.empty() ? "names no host" : "has no right name of a host");
  }
  if (colon == std::string_view::npos)
  {
    return;
  }
  port = rest.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.Port);
  if (error != std::errc() || end != port.data() + port.size() || address.Port < 1 ||
    address.Port > 65535)
  {
    Complain(text, "has the port '" + std::string(port) + "', which is not from 1 to 65535");
  }
}

void ReadOption(const std::string& text, std::string_view option, OpenIGTLinkAddress& address)
{
  const std::size_t equals = option.find('=');
  const std::string_view name = option.substr(0, equals);
  std::string value;
  if (equals == std::string_view::npos || !Decode(option.substr(equals + 1), value) ||
    value.empty())
  {
    Complain(text, "has the option '" + std::string(option) + "', which has no right value");
  }
  if (EqualLetters(name, "transform"))
  {
    address.Transform = value;
  }
  else if (EqualLetters(name, "image"))
  {
    address.Image = value;
  }
  else if (EqualLetters(name, "start") && EqualLetters(value, "TDATA"))
  {
    address.StartTrackingData = "TDATA";
  }
  else if (EqualLetters(name, "start") && EqualLetters(value, "QTDATA"))
  {
    address.StartTrackingData = "QTDATA";
  }
  else
  {
    Complain(text,
      "has the option '" + std::string(option) +
        "', which is none of transform=NAME, image=NAME, start=TDATA and start=QTDATA");
  }
}
}

std::string OpenIGTLinkAddress::GetServer() const
{
  const bool brackets = this->Host.find(':') != std::string::npos;
  return std::string(Scheme) + (brackets ? "[" + this->Host + "]" : this->Host) + ":" +
    std::to_string(this->Port);
}

bool IsOpenIGTLinkAddress(const std::string& text)
{
  return EqualLetters(std::string_view(text).substr(0, Scheme.size()), Scheme);
}

OpenIGTLinkAddress ParseOpenIGTLinkAddress(const std::string& text)
{
  if (!IsOpenIGTLinkAddress(text))
  {
    Complain(text, "does not begin with igtl://");
  }
  OpenIGTLinkAddress address;
  const std::string_view all = std::string_view(text).substr(Scheme.size());
  const std::size_t question = all.find('?');
  std::string_view server = all.substr(0, question);
  if (!server.empty() && server.back() == '/')
  {
    server.remove_suffix(1);
  }
  ReadServer(text, server, address);
  std::string_view options =
    question == std::string_view::npos ? std::string_view() : all.substr(question + 1);
  while (!options.empty())
  {
    const std::size_t end = std::min(options.find('&'), options.size());
    ReadOption(text, options.substr(0, end), address);
    options.remove_prefix(std::min(end + 1, options.size()));
  }
  return address;
}
}
