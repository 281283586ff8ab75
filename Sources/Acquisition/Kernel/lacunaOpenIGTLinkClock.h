// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A sender's time stamps in the time of the acquisition.
#ifndef lacunaOpenIGTLinkClock_h
#define lacunaOpenIGTLinkClock_h

#include <deque>
#include <map>
#include <optional>
#include <string>

namespace lacuna
{
/// Estimates how far a sender's clock is from ours by the smallest difference of arrival and stamp
/// over the last seconds: of the message that was on its way for the shortest time. Times are so
/// free of the jitter of the way, never later than the arrival, and later than the truth by the
/// shortest time under way, which no stamp can tell (temporal calibration does). The devices of a
/// sender mostly share its clock; their estimates are then one, so that their times fit together
/// better than either fits ours. All times are s.
class OpenIGTLinkClock
{
public:
  /// The window is long enough for some message to be fast, and short enough for the drift of the
  /// clocks, 1 ms at 50 parts in a million.
  explicit OpenIGTLinkClock(double window = 20);

  /// Devices whose stamps are kept, twice as many as a connection keeps whose messages nobody wants.
  /// Messages of further ones are of the time they came: the names that a server sends may never end.
  static constexpr std::size_t MostDevices = 128;
  /// Takes in that a message of a device with this stamp came then, and gives the stamp in our time.
  double ToLocal(const std::string& device, double stamp, double arrival);
  /// Our time minus the device's; nothing before its first stamp.
  std::optional<double> GetOffset(const std::string& device) const;
  /// How far the stamps of two devices are apart when that is so much, half a second, that they are
  /// taken for those of two clocks and the estimates are not one; else 0.
  double GetStep(const std::string& a, const std::string& b) const;
  /// The longest time in the window that a device's message was on its way beyond the shortest.
  double GetJitter(const std::string& device) const;
  /// How often the offset of a device, and so of all that share its clock, has changed by more than
  /// 8 ms: times of another revision do not fit together. It mostly becomes smaller, in the first
  /// seconds, when a message is faster than all before.
  int GetRevision() const { return this->Revision; }
  /// How often a device's clock was set or began anew.
  int GetNumberOfSteps(const std::string& device) const;

private:
  struct Part ///< of the window
  {
    double Begin;
    double Smallest;
    double Largest;
  };
  struct Estimate
  {
    std::deque<Part> Parts;
    double NewestStamp = 0;
    int Steps = 0;
    std::optional<double> Revised; ///< offset that a revision is by, which follows drift
    double RevisedTime = 0;
    double GetSmallest() const;
    double GetLargest() const;
  };
  double GetOffset(const Estimate& own) const;
  void Revise(Estimate& own, double arrival);

  double Window;
  std::map<std::string, Estimate> Devices;
  int Revision = 0;
};
}
#endif
