// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaDicomDecoder.h"

#include "lacunaCompressedImage.h"
#include "lacunaDicomHeader.h"

#include <gdcmFragment.h>
#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>
#include <gdcmTransferSyntax.h>

#include <stdexcept>
#include <vector>

namespace lacuna
{
namespace
{
constexpr const char* RunLengthSyntax = "1.2.840.10008.1.2.5";

[[noreturn]] void Fail(const CTFrame& frame, const std::string& what)
{
  throw std::runtime_error(frame.GetName() + ": its compressed pixels " + what +
    " (transfer syntax " + frame.Header->TransferSyntax + ")");
}

CTPixels Hold(std::vector<unsigned char> bytes, const CTPixelFormat& format)
{
  const auto owner = std::make_shared<std::vector<unsigned char>>(std::move(bytes));
  return { std::shared_ptr<const unsigned char>(owner, owner->data()), format };
}

gdcm::Image MakeImage(
  const CTFrame& frame, const std::vector<unsigned char>& stream, gdcm::TransferSyntax syntax)
{
  const CTFileHeader& header = *frame.Header;
  gdcm::Image image;
  image.SetNumberOfDimensions(2);
  image.SetDimension(0, static_cast<unsigned int>(header.Columns));
  image.SetDimension(1, static_cast<unsigned int>(header.Rows));
  image.SetPixelFormat(
    gdcm::PixelFormat(1, static_cast<unsigned short>(header.Format.BitsAllocated),
      static_cast<unsigned short>(header.Format.BitsStored),
      static_cast<unsigned short>(header.Format.HighBit), header.Format.Signed ? 1 : 0));
  image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  image.SetTransferSyntax(syntax);
  gdcm::Fragment fragment;
  fragment.SetByteValue(
    reinterpret_cast<const char*>(stream.data()), static_cast<std::uint32_t>(stream.size()));
  gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = gdcm::SequenceOfFragments::New();
  fragments->AddFragment(fragment);
  gdcm::DataElement pixels(gdcm::Tag(0x7FE0, 0x0010));
  pixels.SetVR(gdcm::VR::OB);
  pixels.SetValue(*fragments);
  image.SetDataElement(pixels);
  return image;
}
}

//------------------------------------------------------------------------------
CTPixels ReadDicomPixels(const CTFrame& frame)
{
  std::vector<unsigned char> stream = ReadDicomBytes(frame);
  const CTFileHeader& header = *frame.Header;
  if (!header.Compressed)
  {
    return Hold(std::move(stream), header.Format);
  }
  std::vector<unsigned char> bytes(static_cast<std::size_t>(frame.GetSize()));
  if (header.TransferSyntax == RunLengthSyntax)
  {
    if (!DecodeRunLength(stream, header.Format.BitsAllocated / 8, bytes))
    {
      Fail(frame, "cannot be decoded");
    }
    return Hold(std::move(bytes), header.Format);
  }
  const std::string wrong =
    WhyNotImage(stream, header.Columns, header.Rows, header.Format.BitsAllocated);
  if (!wrong.empty())
  {
    Fail(frame, wrong);
  }
  const gdcm::TransferSyntax syntax =
    gdcm::TransferSyntax::GetTSType(header.TransferSyntax.c_str());
  if (syntax == gdcm::TransferSyntax::TS_END)
  {
    Fail(frame, "are in a form that is not known");
  }
  // fragments have even lengths and less than 4 GiB
  if (stream.size() > 0xFFFFFFFEU)
  {
    Fail(frame, "are too long");
  }
  stream.resize(stream.size() + stream.size() % 2);
  const gdcm::Image image = MakeImage(frame, stream, syntax);
  bool decoded = false;
  try
  {
    decoded = image.GetBufferLength() == bytes.size() &&
      image.GetBuffer(reinterpret_cast<char*>(bytes.data()));
  }
  catch (const std::exception&) // of GDCM, which says nothing of use
  {
    decoded = false;
  }
  if (!decoded)
  {
    Fail(frame, "cannot be decoded");
  }
  const gdcm::PixelFormat& found = image.GetPixelFormat();
  CTPixelFormat format;
  format.BitsAllocated = found.GetBitsAllocated();
  format.BitsStored = found.GetBitsStored();
  format.HighBit = found.GetHighBit();
  format.Signed = found.GetPixelRepresentation() == 1;
  if (format.BitsAllocated != header.Format.BitsAllocated)
  {
    Fail(frame,
      "have " + std::to_string(format.BitsAllocated) + " bits, not " +
        std::to_string(header.Format.BitsAllocated) + " as Bits Allocated (0028,0100) says");
  }
  return Hold(std::move(bytes), format);
}
}
