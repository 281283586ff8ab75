// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGDCMDecoder.h"

#include <gdcmFragment.h>
#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTransferSyntax.h>

#include <exception>
#include <new>

namespace lacuna
{
namespace
{
gdcm::Image MakeImage(
  const DecoderRequest& request, const unsigned char* stream, gdcm::TransferSyntax syntax)
{
  const DecoderFormat& format = request.Format;
  gdcm::Image image;
  image.SetNumberOfDimensions(2);
  image.SetDimension(0, request.Columns);
  image.SetDimension(1, request.Rows);
  image.SetPixelFormat(gdcm::PixelFormat(1, static_cast<unsigned short>(format.BitsAllocated),
    static_cast<unsigned short>(format.BitsStored), static_cast<unsigned short>(format.HighBit),
    static_cast<unsigned short>(format.Signed)));
  image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  image.SetTransferSyntax(syntax);
  gdcm::Fragment fragment;
  fragment.SetByteValue(
    reinterpret_cast<const char*>(stream), static_cast<std::uint32_t>(request.StreamBytes));
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
DecoderReply DecodeWithGDCM(
  const DecoderRequest& request, const unsigned char* stream, unsigned char* pixels)
{
  DecoderReply reply;
  reply.Status = DecoderStatus::Damaged;
  const gdcm::TransferSyntax syntax = gdcm::TransferSyntax::GetTSType(request.TransferSyntax);
  if (syntax == gdcm::TransferSyntax::TS_END)
  {
    reply.Status = DecoderStatus::UnknownSyntax;
    return reply;
  }
  try
  {
    const gdcm::Image image = MakeImage(request, stream, syntax);
    if (image.GetBufferLength() != request.PixelBytes ||
      !image.GetBuffer(reinterpret_cast<char*>(pixels)))
    {
      return reply;
    }
    const gdcm::PixelFormat& found = image.GetPixelFormat();
    reply.Format = { found.GetBitsAllocated(), found.GetBitsStored(), found.GetHighBit(),
      found.GetPixelRepresentation() };
    reply.Status = DecoderStatus::Decoded;
  }
  catch (const std::bad_alloc&)
  {
    reply.Status = DecoderStatus::OutOfMemory;
  }
  catch (const std::exception&) // of GDCM, which says nothing of use
  {
  }
  return reply;
}
}
