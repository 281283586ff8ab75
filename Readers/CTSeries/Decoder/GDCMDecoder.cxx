// SPDX-License-Identifier: BSD-3-Clause
// The library that lacunaGDCMDecoder.cxx loads.
#include "lacunaGDCMDecoder.h"

#include <gdcmFragment.h>
#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTransferSyntax.h>

#include <exception>

namespace lacuna
{
namespace
{
constexpr std::size_t LongestFragment = 0xFFFFFFFE;

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

std::string Decode(const CTFrame& frame, CTPixels& pixels)
{
  const gdcm::TransferSyntax syntax =
    gdcm::TransferSyntax::GetTSType(frame.Header->TransferSyntax.c_str());
  if (syntax == gdcm::TransferSyntax::TS_END)
  {
    return "are in a form that is not known";
  }
  pixels.Stream.resize(pixels.Stream.size() + pixels.Stream.size() % 2); // fragments are even
  if (pixels.Stream.size() > LongestFragment)
  {
    return "are too long";
  }
  const gdcm::Image image = MakeImage(frame, pixels.Stream, syntax);
  bool decoded = false;
  try
  {
    decoded = image.GetBufferLength() == pixels.Bytes.size() &&
      image.GetBuffer(reinterpret_cast<char*>(pixels.Bytes.data()));
  }
  catch (const std::exception&) // of GDCM, which says nothing of use
  {
    decoded = false;
  }
  if (!decoded)
  {
    return "cannot be decoded";
  }
  const gdcm::PixelFormat& found = image.GetPixelFormat();
  pixels.Format.BitsAllocated = found.GetBitsAllocated();
  pixels.Format.BitsStored = found.GetBitsStored();
  pixels.Format.HighBit = found.GetHighBit();
  pixels.Format.Signed = found.GetPixelRepresentation() == 1;
  return {};
}
}
}

//------------------------------------------------------------------------------
extern "C" void LacunaDecodeWithGDCM(
  const lacuna::CTFrame* frame, lacuna::CTPixels* pixels, std::string* wrong)
{
  *wrong = lacuna::Decode(*frame, *pixels);
}
