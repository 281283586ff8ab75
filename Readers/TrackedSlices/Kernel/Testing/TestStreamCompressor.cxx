// SPDX-License-Identifier: BSD-3-Clause
// Against zlib's own decoder.
#include "lacunaStreamCompressor.h"

#include <gtest/gtest.h>

#include <zlib.h>

#include <random>

using namespace lacuna;

namespace
{
std::string Inflate(const std::string& packed, std::size_t size, int& result)
{
  std::string bytes(size + 1, '?');
  z_stream zlib{};
  inflateInit2(&zlib, MAX_WBITS + 32); // zlib or gzip, with their check sums
  zlib.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  zlib.avail_in = static_cast<uInt>(packed.size());
  zlib.next_out = reinterpret_cast<Bytef*>(bytes.data());
  zlib.avail_out = static_cast<uInt>(bytes.size());
  result = inflate(&zlib, Z_SYNC_FLUSH);
  bytes.resize(zlib.total_out);
  inflateEnd(&zlib);
  return bytes;
}

/// Compressible, and never the same for long.
std::string MakeBytes(std::size_t size)
{
  std::mt19937 random(static_cast<unsigned>(size));
  std::string bytes;
  while (bytes.size() < size)
  {
    bytes.append(1 + random() % 20, static_cast<char>(random() % 50));
  }
  bytes.resize(size);
  return bytes;
}
}

TEST(StreamCompressor, OneOrdinaryStream)
{
  ThreadExecution execution(3);
  for (const auto wrapping : { StreamCompressor::Wrapping::Zlib, StreamCompressor::Wrapping::Gzip })
  {
    for (const int level : { 1, 9 })
    {
      StreamCompressor compressor(wrapping, level);
      std::string packed = compressor.GetBeginning();
      std::string all;
      for (const std::size_t size : { 5, 0, 1, 40000, 3, 1200000, 524288, 77 })
      {
        const std::string bytes = MakeBytes(size);
        packed += compressor.Compress(
          reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), execution);
        all += bytes;
        if (all.size() < 100000)
        {
          int result = 0;
          EXPECT_EQ(Inflate(packed, all.size(), result), all); // to the last byte, at any time
          EXPECT_EQ(result, Z_OK);
        }
      }
      packed += compressor.GetEnd();
      int result = 0;
      EXPECT_TRUE(Inflate(packed, all.size(), result) == all);
      EXPECT_EQ(result, Z_STREAM_END); // the check sum is right
      uLongf inOneGo = compressBound(static_cast<uLong>(all.size()));
      std::string reference(inOneGo, '\0');
      compress2(reinterpret_cast<Bytef*>(reference.data()), &inOneGo,
        reinterpret_cast<const Bytef*>(all.data()), static_cast<uLong>(all.size()), level);
      EXPECT_LT(static_cast<double>(packed.size()), 1.01 * static_cast<double>(inOneGo));
    }
  }
}

TEST(StreamCompressor, NothingIsAStreamToo)
{
  for (const auto wrapping : { StreamCompressor::Wrapping::Zlib, StreamCompressor::Wrapping::Gzip })
  {
    const StreamCompressor compressor(wrapping, 6);
    int result = 0;
    EXPECT_EQ(Inflate(compressor.GetBeginning() + compressor.GetEnd(), 10, result), "");
    EXPECT_EQ(result, Z_STREAM_END);
  }
}

TEST(StreamCompressor, ACopyIsAPointToReturnTo)
{
  ThreadExecution execution(1);
  StreamCompressor compressor(StreamCompressor::Wrapping::Zlib, 6);
  const std::string first = MakeBytes(50000);
  const std::string second = MakeBytes(60000);
  const auto compress = [&](StreamCompressor& with, const std::string& bytes)
  {
    return with.Compress(
      reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), execution);
  };
  std::string packed = compressor.GetBeginning() + compress(compressor, first);
  StreamCompressor lost = compressor;
  compress(lost, MakeBytes(12345)); // as if this had never been
  packed += compress(compressor, second);
  packed += compressor.GetEnd();
  int result = 0;
  EXPECT_TRUE(Inflate(packed, 110000, result) == first + second);
  EXPECT_EQ(result, Z_STREAM_END);
}
