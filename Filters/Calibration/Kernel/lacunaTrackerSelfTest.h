// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How far a tracker warps space in the room where it stands.
///
/// Two receivers are fixed to each other, some 0.3 m apart, and moved through the working volume.
/// Distance and relative orientation should stay the same; by how much they do not shows what an
/// imaged point at the second receiver's place would be off by. Carr (1996, ch. 2.2.2.2) found up to
/// 5 mm, repeatable: a warp of the field rather than noise.
#ifndef lacunaTrackerSelfTest_h
#define lacunaTrackerSelfTest_h

#include "lacunaMatrix4.h"
#include "lacunaProperties.h"
#include "lacunaSliceMotion.h"

#include <cstddef>
#include <string>
#include <vector>

namespace lacuna
{
/// Poses that are alike make a place: its first pose is the middle, and the others lie within a
/// distance of it and are turned by no more than an angle. A pose belongs to the nearest place. A
/// visit of a place lasts until the receiver has been twice as far from its middle, or turned twice
/// as much: then coming back is another visit.
struct ReceiverPlaces
{
  /// poses: rigid, in the order in which they were taken, positions below 1e6 mm. distance in mm and
  /// angle in degrees, both above 0.
  ReceiverPlaces(const std::vector<Matrix4>& poses, double distance, double angle);

  std::vector<std::size_t> Place;   ///< of each pose
  std::vector<std::size_t> Visit;   ///< of each pose, numbered through all places
  std::vector<std::size_t> Middles; ///< of each place, the number of its first pose
  std::vector<std::size_t> Visited; ///< of each visit, the place
};

/// By which angle, 0 to 180 degrees, two rigid poses are turned against each other.
double GetTurn(const Matrix4& a, const Matrix4& b);

/// One measurement of both receivers, coordinates of the receivers to mm of the transmitter.
struct ReceiverPair
{
  Matrix4 First, Second;
  double Time;        ///< s; NaN: not known
  std::size_t Record; ///< row or slice of the recording, for messages
};

struct TrackerSelfTestOptions
{
  /// mm/s; pairs in which a receiver moves faster are left out, since the two are not measured at
  /// the same instant.
  double SpeedLimit = 50;
  double RevisitDistance = 20; ///< mm, see ReceiverPlaces
  double RevisitAngle = 15;    ///< degrees
  TrackerAccuracy Accuracy;    ///< as specified, of one receiver
  double RangeLimit = 760;     ///< mm from the transmitter for which Accuracy is specified

  void Describe(Properties& properties) const; ///< with the ranges
};

class TrackerSelfTest
{
public:
  /// Throws std::invalid_argument for options out of range, poses that are not rigid or beyond 1 km,
  /// and when fewer than 10 pairs can be used.
  ///
  /// The constant transform between the receivers is the median (least sum of distances), so that
  /// metal in one corner does not move it. Each place (ReceiverPlaces of the first receiver) counts
  /// once, however long the receivers stayed.
  static TrackerSelfTest Solve(
    const std::vector<ReceiverPair>& pairs, const TrackerSelfTestOptions& options = {});

  Matrix4 SecondToFirst; ///< median, mm
  double Separation = 0; ///< mm between the receivers, its translation's length

  struct Sample
  {
    std::size_t Record;
    Vec3 Middle;            ///< mm, between the two receivers as measured
    Vec3 Deviation;         ///< mm, second receiver from where the first and the median put it
    double SeparationError; ///< mm, measured less median distance
    double AngleError;      ///< degrees
    double Distance;        ///< mm from the transmitter, of the farther receiver
    std::size_t Place;
  };
  std::vector<Sample> Samples; ///< that were used
  std::size_t TooFast = 0;     ///< pairs left out
  /// Pairs left out because turning the sign of a position mends them: the tracker mistook the
  /// hemisphere.
  std::size_t OtherHemisphere = 0;

  struct Errors
  {
    double Separation = 0; ///< mm
    double Position = 0;   ///< mm
    double Angle = 0;      ///< degrees
  };
  Errors Rms;
  Errors Largest; ///< absolute
  /// Rms to expect of receivers that err independently, by Accuracy evenly in all directions.
  Errors Expected;
  double SeparationRange = 0; ///< mm, largest less smallest distance
  std::size_t Worst = 0;      ///< sample with the largest Deviation

  std::size_t Places = 0;
  std::size_t Revisited = 0; ///< places with two visits and more
  double Noise = 0;          ///< mm, standard deviation of Deviation within a visit
  double Repeatability = 0;  ///< mm, of the visits' means within a place; NaN without Revisited
  double Warp = 0;           ///< mm, RMS of the places' means
  double Extent = 0;         ///< mm, diagonal of the box about all Middles

  /// Samples by distance from the transmitter, in steps of 100 mm, and their Rms.
  struct DistanceRow
  {
    double From, To;
    std::size_t Samples;
    Errors Rms;
  };
  std::vector<DistanceRow> ByDistance;

  /// Pairs of places by how far they are apart, in steps of 100 mm, and the RMS of how much the
  /// places' mean deviations differ: what a sweep of that length has to reckon with.
  struct ApartRow
  {
    double From, To;
    std::size_t Pairs;
    double Position; ///< mm
  };
  std::vector<ApartRow> ByApart;

  /// What to do, the most important first; the first sentence is the verdict.
  std::vector<std::string> GetAdvice() const;

private:
  void AddSample(const Sample& sample);
  void AdviseOnMeasuring(std::vector<std::string>& advice) const;
  void CompareVisits(
    const std::vector<std::size_t>& visits, const std::vector<std::size_t>& placesOfVisits);

  TrackerSelfTestOptions Options;
};
}
#endif
