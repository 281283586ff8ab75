// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaFastrakRecord.h"

#include "lacunaFastrakReply.h"
#include "lacunaGeometryGate.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace lacuna
{
namespace
{
constexpr double Degree = 3.14159265358979323846 / 180;
}

Matrix4 FastrakRotation(const Vec3& angles)
{
  return Matrix4::Rotation({ 0, 0, 1 }, angles[0] * Degree) *
    Matrix4::Rotation({ 0, 1, 0 }, angles[1] * Degree) *
    Matrix4::Rotation({ 1, 0, 0 }, angles[2] * Degree);
}

Matrix4 FastrakRotation(const std::array<double, 4>& q)
{
  const Vec3 axis{ q[1], q[2], q[3] };
  const double sine = Norm(axis);
  return sine > 0 ? Matrix4::Rotation(axis, 2 * std::atan2(sine, q[0])) : Matrix4();
}

Vec3 FastrakAngles(const Matrix4& r)
{
  const double cosine = std::hypot(r(0, 0), r(1, 0));
  const double elevation = std::atan2(-r(2, 0), cosine);
  if (cosine < 1e-12)
  {
    return { std::atan2(-r(0, 1), r(1, 1)) / Degree, elevation / Degree, 0 };
  }
  return { std::atan2(r(1, 0), r(0, 0)) / Degree, elevation / Degree,
    std::atan2(r(2, 1), r(2, 2)) / Degree };
}

std::array<double, 4> FastrakQuaternion(const Matrix4& r)
{
  // four times the squares of w x y z; dividing by the largest loses no digits
  const std::array<double, 4> squares{ 1 + r(0, 0) + r(1, 1) + r(2, 2),
    1 + r(0, 0) - r(1, 1) - r(2, 2), 1 - r(0, 0) + r(1, 1) - r(2, 2),
    1 - r(0, 0) - r(1, 1) + r(2, 2) };
  const Vec3 odd{ r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1) };
  const Vec3 even{ r(2, 1) + r(1, 2), r(0, 2) + r(2, 0), r(1, 0) + r(0, 1) };
  const auto largest = std::max_element(squares.begin(), squares.end()) - squares.begin();
  std::array<double, 4> q{};
  switch (largest)
  {
    case 0:
      q = { squares[0], odd[0], odd[1], odd[2] };
      break;
    case 1:
      q = { odd[0], squares[1], even[2], even[1] };
      break;
    case 2:
      q = { odd[1], even[2], squares[2], even[0] };
      break;
    default:
      q = { odd[2], even[1], even[0], squares[3] };
  }
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double divisor = q[0] < 0 ? -length : length;
  for (double& element : q)
  {
    element /= divisor;
  }
  return q;
}

//------------------------------------------------------------------------------
namespace
{
constexpr std::size_t HeaderLength = 3;
constexpr std::size_t MaximumItems = 32;
constexpr std::size_t MaximumLength = 254;
constexpr double MaximumDistance = 4000; // mm, twice what the widest position envelope allows

using Values = std::array<double, 4>;

bool IsExtended(FastrakItem item)
{
  return static_cast<int>(item) >= 50;
}

FastrakItem Plain(FastrakItem item)
{
  return IsExtended(item) ? static_cast<FastrakItem>(static_cast<int>(item) - 50) : item;
}

int CountNumbers(FastrakItem item)
{
  switch (Plain(item))
  {
    case FastrakItem::Space:
    case FastrakItem::CarriageReturn:
    case FastrakItem::Button:
      return 0;
    case FastrakItem::Quaternion:
      return 4;
    default:
      return 3;
  }
}

std::size_t GetItemLength(FastrakItem item, bool binary)
{
  switch (Plain(item))
  {
    case FastrakItem::Space:
      return 1;
    case FastrakItem::CarriageReturn:
    case FastrakItem::Button:
      return 2;
    default:
      return CountNumbers(item) * (binary ? 4 : IsExtended(item) ? 13 : 7);
  }
}

// Digits after the point in ASCII that is not extended.
int CountDecimals(FastrakItem item)
{
  switch (item)
  {
    case FastrakItem::Position:
    case FastrakItem::RelativePosition:
    case FastrakItem::Angles:
      return 2;
    default:
      return 4;
  }
}

bool IsDigit(char c)
{
  return c >= '0' && c <= '9';
}

// Reads "blanks, sign, blanks, digits, point, decimals" and, where there is one, an exponent; the
// whole of text or nothing.
std::optional<double> ReadNumber(std::string_view text, int decimals, bool exponent)
{
  std::string number;
  std::size_t at = 0;
  const auto skipBlanks = [&]()
  {
    while (at < text.size() && text[at] == ' ')
    {
      ++at;
    }
  };
  const auto takeDigits = [&]()
  {
    const std::size_t first = at;
    while (at < text.size() && IsDigit(text[at]))
    {
      number += text[at++];
    }
    return at - first;
  };
  const auto takeSign = [&]()
  {
    if (at < text.size() && (text[at] == '-' || text[at] == '+'))
    {
      number += text[at] == '-' ? "-" : "";
      ++at;
    }
  };
  skipBlanks();
  takeSign();
  skipBlanks();
  if (takeDigits() == 0 || at == text.size() || text[at] != '.')
  {
    return std::nullopt;
  }
  number += text[at++];
  if (takeDigits() != static_cast<std::size_t>(decimals))
  {
    return std::nullopt;
  }
  if (exponent)
  {
    if (at == text.size() || text[at] != 'E')
    {
      return std::nullopt;
    }
    number += text[at++];
    takeSign();
    if (takeDigits() == 0)
    {
      return std::nullopt;
    }
    skipBlanks();
  }
  double value = 0;
  const auto result = std::from_chars(number.data(), number.data() + number.size(), value);
  if (at != text.size() || result.ec != std::errc() || result.ptr != number.data() + number.size())
  {
    return std::nullopt;
  }
  return value;
}

std::optional<double> DecodeNumber(const char* bytes, FastrakItem item, bool binary)
{
  if (!binary)
  {
    return IsExtended(item) ? ReadNumber({ bytes, 13 }, 5, true)
                            : ReadNumber({ bytes, 7 }, CountDecimals(item), false);
  }
  std::uint32_t bits = 0;
  for (int i = 3; i >= 0; --i)
  {
    bits = bits << 8 | static_cast<unsigned char>(bytes[i]);
  }
  float value = 0;
  std::memcpy(&value, &bits, sizeof(value));
  return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

std::string EncodeNumber(double value, FastrakItem item, bool binary)
{
  if (binary)
  {
    const float number = static_cast<float>(value);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &number, sizeof(bits));
    std::string bytes;
    for (int i = 0; i < 4; ++i)
    {
      bytes += static_cast<char>(bits >> 8 * i & 0xff);
    }
    return bytes;
  }
  // printf would write a decimal comma in some locales
  std::array<char, 32> text{};
  const auto result = IsExtended(item)
    ? std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 5)
    : std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed,
        CountDecimals(item));
  std::string written(text.data(), result.ptr);
  std::replace(written.begin(), written.end(), 'e', 'E');
  const std::size_t width = IsExtended(item) ? 12 : 7;
  if (written.size() > width || !std::isfinite(value))
  {
    throw std::invalid_argument("The number " + written + " does not fit into a FASTRAK's record");
  }
  written.insert(0, width - written.size(), ' ');
  return written + (IsExtended(item) ? " " : "");
}

template <class T>
bool Keep(std::optional<T>& kept, const T& value)
{
  if (kept && !(*kept == value))
  {
    return false;
  }
  kept = value;
  return true;
}

// What the gate flags is a damaged record.
bool IsUsable(const GeometryFinding& finding)
{
  return GetAction(GeometryOrigin::Live, finding.Fault) < GeometryAction::Flag;
}

bool IsPossible(FastrakItem item, const Values& v)
{
  switch (item)
  {
    case FastrakItem::Angles:
      return std::abs(v[0]) <= 180.01 && std::abs(v[1]) <= 90.01 && std::abs(v[2]) <= 180.01;
    case FastrakItem::Position:
    case FastrakItem::RelativePosition:
      return std::abs(v[0]) <= MaximumDistance && std::abs(v[1]) <= MaximumDistance &&
        std::abs(v[2]) <= MaximumDistance;
    default:
      // an axis has three
      return IsUsable(
        CheckQuaternion(std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3])));
  }
}

// Puts an item's numbers, in mm and degrees, into a record; false when they are not possible or
// not those the record has.
bool Store(FastrakRecord& record, FastrakItem item, const Values& v)
{
  const Vec3 vector{ v[0], v[1], v[2] };
  if (!IsPossible(item, v))
  {
    return false;
  }
  switch (item)
  {
    case FastrakItem::Position:
      return Keep(record.Position, vector);
    case FastrakItem::RelativePosition:
      return Keep(record.RelativePosition, vector);
    case FastrakItem::Angles:
      return Keep(record.Angles, vector);
    case FastrakItem::Quaternion:
      return Keep(record.Quaternion, v);
    default:
      return Keep(
        record.Axes[static_cast<int>(item) - static_cast<int>(FastrakItem::XAxis)], vector);
  }
}

Values Load(const FastrakRecord& record, FastrakItem item)
{
  if (item == FastrakItem::Quaternion)
  {
    return record.Quaternion.value_or(Values{});
  }
  const std::optional<Vec3>& v = item == FastrakItem::Position ? record.Position
    : item == FastrakItem::RelativePosition                    ? record.RelativePosition
    : item == FastrakItem::Angles
    ? record.Angles
    : record.Axes[static_cast<int>(item) - static_cast<int>(FastrakItem::XAxis)];
  return v ? Values{ (*v)[0], (*v)[1], (*v)[2] } : Values{};
}

bool IsLength(FastrakItem item)
{
  return item == FastrakItem::Position || item == FastrakItem::RelativePosition;
}

bool DecodeItem(FastrakRecord& record, FastrakItem item, const char* bytes, const FastrakFormat& f)
{
  const FastrakItem plain = Plain(item);
  switch (plain)
  {
    case FastrakItem::Space:
      return bytes[0] == ' ';
    case FastrakItem::CarriageReturn:
      return bytes[0] == '\r' && bytes[1] == '\n';
    case FastrakItem::Button:
      return bytes[0] == ' ' && (bytes[1] == '0' || bytes[1] == '1') &&
        Keep(record.Button, bytes[1] == '1');
    default:
      break;
  }
  Values values{};
  const std::size_t width = GetItemLength(item, f.Binary) / CountNumbers(item);
  for (int i = 0; i < CountNumbers(item); ++i)
  {
    const std::optional<double> number = DecodeNumber(bytes + i * width, item, f.Binary);
    if (!number)
    {
      return false;
    }
    values[i] = *number * (IsLength(plain) ? GetMillimetres(f.Unit) : 1);
  }
  return Store(record, plain, values);
}
}

FastrakLayout::FastrakLayout()
  : Items{ FastrakItem::Position, FastrakItem::Angles, FastrakItem::CarriageReturn }
{
}

FastrakLayout::FastrakLayout(std::vector<FastrakItem> items)
  : Items(std::move(items))
{
  if (this->Items.size() > MaximumItems)
  {
    throw std::invalid_argument(
      "A FASTRAK's record can have 32 items, not " + std::to_string(this->Items.size()));
  }
  for (const FastrakItem item : this->Items)
  {
    if (IsExtended(item) && CountNumbers(item) > 0 &&
      std::find(this->Items.begin(), this->Items.end(), Plain(item)) != this->Items.end())
    {
      const int number = static_cast<int>(item);
      throw std::invalid_argument("List item " + std::to_string(number) + " or " +
        std::to_string(number - 50) + ", not both: they are one value with more or fewer digits");
    }
  }
  const std::size_t length = std::max(this->GetLength(true), this->GetLength(false));
  if (length > MaximumLength)
  {
    throw std::invalid_argument("A FASTRAK's record can have 254 bytes, not " +
      std::to_string(length) + ": list fewer items");
  }
}

FastrakLayout FastrakLayout::FromNumbers(const std::vector<int>& numbers)
{
  constexpr std::array<int, 10> known{ 0, 1, 2, 3, 4, 5, 6, 7, 11, 16 };
  std::vector<FastrakItem> items;
  for (const int number : numbers)
  {
    if (std::find(known.begin(), known.end(), number) == known.end() &&
      std::find(known.begin(), known.end(), number - 50) == known.end())
    {
      throw std::invalid_argument("A FASTRAK has no item " + std::to_string(number) +
        " to list: there are 0 to 7, 11, 16 and with more digits 50 to 57, 61, 66");
    }
    items.push_back(static_cast<FastrakItem>(number));
  }
  return FastrakLayout(std::move(items));
}

std::size_t FastrakLayout::GetLength(bool binary) const
{
  std::size_t length = HeaderLength;
  for (const FastrakItem item : this->Items)
  {
    length += GetItemLength(item, binary);
  }
  return length;
}

bool FastrakLayout::HasPose() const
{
  const auto has = [this](FastrakItem wanted)
  {
    return std::any_of(this->Items.begin(), this->Items.end(),
      [wanted](FastrakItem item) { return Plain(item) == wanted; });
  };
  return has(FastrakItem::Position) &&
    (has(FastrakItem::Angles) || has(FastrakItem::Quaternion) ||
      (has(FastrakItem::XAxis) && has(FastrakItem::YAxis) && has(FastrakItem::ZAxis)));
}

std::optional<Matrix4> FastrakRecord::GetPose() const
{
  if (!this->Position)
  {
    return std::nullopt;
  }
  if (this->Angles)
  {
    return Matrix4::Translation(*this->Position) * FastrakRotation(*this->Angles);
  }
  if (this->Quaternion)
  {
    return Matrix4::Translation(*this->Position) * FastrakRotation(*this->Quaternion);
  }
  if (!this->Axes[0] || !this->Axes[1] || !this->Axes[2])
  {
    return std::nullopt;
  }
  if (!IsUsable(CheckPose(
        Matrix4::FromColumns(*this->Axes[0], *this->Axes[1], *this->Axes[2], *this->Position))))
  {
    return std::nullopt;
  }
  const Vec3 z = Normalized(Cross(*this->Axes[0], *this->Axes[1]));
  const Vec3 y = Normalized(Cross(z, *this->Axes[0]));
  return Matrix4::FromColumns(Cross(y, z), y, z, *this->Position);
}

std::optional<FastrakRecord> DecodeFastrakRecord(
  std::string_view bytes, const FastrakLayout& layout, const FastrakFormat& format)
{
  if (bytes.size() != layout.GetLength(format.Binary) || bytes[0] != '0' || bytes[1] < '1' ||
    bytes[1] > '0' + FastrakStations || !IsFastrakErrorCode(bytes[2]))
  {
    return std::nullopt;
  }
  FastrakRecord record;
  record.Station = bytes[1] - '0';
  record.Error = bytes[2];
  std::size_t at = HeaderLength;
  for (const FastrakItem item : layout.GetItems())
  {
    if (!DecodeItem(record, item, bytes.data() + at, format))
    {
      return std::nullopt;
    }
    at += GetItemLength(item, format.Binary);
  }
  return record;
}

std::string EncodeFastrakRecord(
  const FastrakRecord& record, const FastrakLayout& layout, const FastrakFormat& format)
{
  std::string bytes{ '0', static_cast<char>('0' + record.Station), record.Error };
  for (const FastrakItem item : layout.GetItems())
  {
    const FastrakItem plain = Plain(item);
    if (plain == FastrakItem::Space)
    {
      bytes += ' ';
    }
    else if (plain == FastrakItem::CarriageReturn)
    {
      bytes += "\r\n";
    }
    else if (plain == FastrakItem::Button)
    {
      bytes += record.Button.value_or(false) ? " 1" : " 0";
    }
    else
    {
      const Values values = Load(record, plain);
      const double unit = IsLength(plain) ? GetMillimetres(format.Unit) : 1;
      for (int i = 0; i < CountNumbers(item); ++i)
      {
        bytes += EncodeNumber(values[i] / unit, item, format.Binary);
      }
    }
  }
  return bytes;
}
}
