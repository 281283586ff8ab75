// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Field data strings with which the reader tells the writer what tracked slices do not say.
#ifndef lacunaSequenceNames_h
#define lacunaSequenceNames_h

namespace lacuna::SequenceNames
{
/// Two strings: the names of the image and the reference frame that ImageToReference joins.
constexpr const char* Frames = "ImageToReferenceFrames";
/// One string: BRIGHTNESS, RF_REAL ...: what the grey levels are.
constexpr const char* ImageType = "UltrasoundImageType";
/// One string: the orientation of the slices as they are in memory, MFA or FM.
constexpr const char* Orientation = "UltrasoundImageOrientation";
/// Fields of the header that hold the steps of the Provenance begin with this.
constexpr const char* ProvenancePrefix = "LacunaProvenance";
}
#endif
