// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaEmulatedProbe.h"

#include "lacunaCalibrationFile.h"
#include "lacunaFastrakRecord.h"

#include <utility>

namespace lacuna
{
namespace
{
// The face's x, y and z lie along the receiver's x, z and -y, but for some degrees.
Matrix4 FaceToReceiver()
{
  return Matrix4::Translation({ 18, -12, 74 }) * FastrakRotation(Vec3{ 5, -8, 3 }) *
    Matrix4::FromColumns({ 1, 0, 0 }, { 0, 0, 1 }, { 0, -1, 0 }, { 0, 0, 0 });
}
}

EmulatedProbe::EmulatedProbe(FastrakEmulator::PoseScript motion, int station,
  const Matrix4& imageToFace, double depth, double aim)
  : Motion(std::move(motion))
  , Station(station)
  , ImageToReceiver(FaceToReceiver() * imageToFace)
  , TransmitterToScene(
      (this->Motion(aim, station) * FaceToReceiver() * Matrix4::Translation({ 0, 0.5 * depth, 0 }))
        .Inverse())
{
}

Matrix4 EmulatedProbe::ImageToScene(double time) const
{
  return this->TransmitterToScene * this->Motion(time, this->Station) * this->ImageToReceiver;
}

std::string EmulatedProbe::FormatCalibration() const
{
  return lacuna::FormatCalibration({ { "Image", "Probe", this->ImageToReceiver },
                                     { "Tracker", "Reference", this->TransmitterToScene } },
    "The truth of lacuna-fastrak-emulator. Image: column, row, 0; mm. Reference: the scene.");
}
}
