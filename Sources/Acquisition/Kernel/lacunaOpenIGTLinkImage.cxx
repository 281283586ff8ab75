// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaLuminance.h"
#include "lacunaOpenIGTLinkMessage.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <igtl_image.h>

namespace lacuna
{
namespace
{
[[noreturn]] void Complain(const OpenIGTLinkMessage& message, const std::string& what)
{
  throw OpenIGTLinkError("The IMAGE message of '" + message.Header.Device + "' " + what);
}

std::size_t GetLevelSize(const OpenIGTLinkMessage& message, int type)
{
  switch (type)
  {
    case IGTL_IMAGE_STYPE_TYPE_INT8:
    case IGTL_IMAGE_STYPE_TYPE_UINT8:
      return 1;
    case IGTL_IMAGE_STYPE_TYPE_INT16:
    case IGTL_IMAGE_STYPE_TYPE_UINT16:
      return 2;
    default:
      Complain(message,
        "has levels of type " + std::to_string(type) +
          ", whose range is not known: have the sender give integers of 8 or 16 bits");
  }
}

// The levels as 0..255.
template <class T>
void ReadLevels(std::string_view pixels, bool littleEndian, std::vector<std::uint8_t>& levels)
{
  constexpr int most = std::numeric_limits<T>::max();
  const std::size_t first = littleEndian ? sizeof(T) - 1 : 0; // the most significant byte
  for (std::size_t i = 0; i < levels.size(); ++i)
  {
    const char* bytes = pixels.data() + i * sizeof(T);
    unsigned int bits = static_cast<unsigned char>(bytes[first]);
    if constexpr (sizeof(T) == 2)
    {
      bits = bits << 8 | static_cast<unsigned char>(bytes[1 - first]);
    }
    const int level = std::max<int>(static_cast<T>(bits), 0);
    levels[i] = static_cast<std::uint8_t>((255 * level + most / 2) / most);
  }
}

// The position of the first pixel, the spacing and the axes of unit length.
void SetPlane(const igtl_image_header& header, OpenIGTLinkImage& image)
{
  std::array<float, 12> n{};
  std::memcpy(n.data(),
    reinterpret_cast<const char*>(&header) + offsetof(igtl_image_header, matrix), sizeof(n));
  const Vec3 column{ n[0], n[1], n[2] };
  const Vec3 row{ n[3], n[4], n[5] };
  const Vec3 normal{ n[6], n[7], n[8] };
  const Vec3 centre{ n[9], n[10], n[11] };
  const Vec2 spacing{ Norm(column), Norm(row) };
  if (spacing[0] != 1 || spacing[1] != 1)
  {
    image.PixelSpacing = spacing;
  }
  image.Plane.Pose = Matrix4::FromColumns(Normalized(column), Normalized(row), Normalized(normal),
    centre - 0.5 * (image.Columns - 1) * column - 0.5 * (image.Rows - 1) * row);
  CheckOpenIGTLinkPose(image.Plane);
}
}

OpenIGTLinkImage ReadOpenIGTLinkImage(const OpenIGTLinkMessage& message)
{
  const std::string_view content = message.GetContent();
  if (content.size() < sizeof(igtl_image_header))
  {
    Complain(message, "is damaged: its header is cut off");
  }
  igtl_image_header header = {};
  std::memcpy(&header, content.data(), sizeof(header));
  igtl_image_convert_byte_order(&header);
  const std::size_t size = GetLevelSize(message, header.scalar_type);
  const int channels = header.num_components;
  if (channels != 1 && channels != 3 && channels != 4)
  {
    Complain(message,
      "has " + std::to_string(channels) + " numbers a pixel: 1 (grey), 3 or 4 (colour) are known");
  }
  if (header.endian != IGTL_IMAGE_ENDIAN_BIG && header.endian != IGTL_IMAGE_ENDIAN_LITTLE)
  {
    Complain(message, "does not say the order of its bytes");
  }
  const std::size_t columns = header.size[0];
  const std::size_t rows = header.size[1];
  if (columns == 0 || rows == 0 || header.size[2] != 1)
  {
    Complain(message,
      "has " + std::to_string(columns) + " x " + std::to_string(rows) + " x " +
        std::to_string(header.size[2]) + " pixels: one slice is needed");
  }
  for (int i = 0; i < 3; ++i)
  {
    if (header.subvol_offset[i] != 0 || header.subvol_size[i] != header.size[i])
    {
      Complain(message, "has a part of an image only: have the sender give whole images");
    }
  }
  const std::size_t levels = columns * rows * static_cast<std::size_t>(channels);
  if (content.size() != sizeof(header) + levels * size)
  {
    Complain(message,
      "is damaged: it has " + std::to_string(content.size() - sizeof(header)) +
        " bytes of pixels instead of " + std::to_string(levels * size));
  }
  OpenIGTLinkImage image;
  image.Columns = static_cast<int>(columns);
  image.Rows = static_cast<int>(rows);
  image.Grey.resize(levels);
  const std::string_view pixels = content.substr(sizeof(header));
  const bool little = header.endian == IGTL_IMAGE_ENDIAN_LITTLE;
  switch (header.scalar_type)
  {
    case IGTL_IMAGE_STYPE_TYPE_INT8:
      ReadLevels<std::int8_t>(pixels, little, image.Grey);
      break;
    case IGTL_IMAGE_STYPE_TYPE_UINT8:
      std::copy(pixels.begin(), pixels.end(), image.Grey.begin());
      break;
    case IGTL_IMAGE_STYPE_TYPE_INT16:
      ReadLevels<std::int16_t>(pixels, little, image.Grey);
      break;
    default:
      ReadLevels<std::uint16_t>(pixels, little, image.Grey);
  }
  if (channels > 1)
  {
    MakeLuminance(
      image.Grey.data(), static_cast<std::int64_t>(columns * rows), channels, image.Grey.data());
    image.Grey.resize(columns * rows);
  }
  image.Plane.Name = message.GetDevice();
  SetOpenIGTLinkStatuses(message, image);
  SetPlane(header, image);
  return image;
}
}
