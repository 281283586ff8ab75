// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The slices of a tracked stack as the kernel takes them.
#ifndef lacunaSliceImages_h
#define lacunaSliceImages_h

#include "lacunaSliceFan.h"
#include "lacunaSliceFlags.h"
#include "lacunaSliceImage.h"
#include "lacunaSweepEnds.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace lacuna
{
class Execution;
}
class vtkDataArray;
class vtkImageData;
class vtkInformation;
class vtkLacunaSliceAlgorithm;
class vtkLacunaSliceStream;
namespace lacuna
{
class TrackedSlices;
}

namespace lacuna
{
/// Which slices of a stack to take, and which part of them.
struct SliceSelection
{
  /// As the properties of filter say, for a stack in its input.
  static SliceSelection Make(vtkLacunaSliceAlgorithm* filter, vtkInformation* input);

  /// First column, first row, width and height, in pixels of the original slices; a width or height
  /// of 0 reaches to the edge.
  std::array<int, 4> Clip{ 0, 0, 0, 0 };
  /// Flags of SliceStatus that do not matter.
  unsigned char AcceptedFlags = 0;
  int BadPoses = 0; ///< vtkLacunaSliceAlgorithm::BadPoseRules
  /// The stack is replayed: slices whose image is invalid (2) are listed as Others, so that what is
  /// laid out by the poses of all does not depend on the time.
  bool IsReplay = false;
  /// The last time step of the replay is reached: no slices are to come.
  bool IsAtEnd = false;
  /// Where sweeps end is found in the slices (lacunaSweepEnds.h), and slices are marked there.
  bool HasSweepEnds = true;
  /// Ends the name of a slice in errors.
  std::string Suffix;
};

/// The slices of one stack that are taken, in the order of the stack. Not a part of the module's
/// interface.
struct SliceImages
{
  /// Refers to the pixels of stack, which must outlive this object. Throws std::exception with a
  /// text for the user when stack is not what lacunaTrackedSlices.h wants, for bad poses as
  /// selection says, and when its clip leaves less than 2 x 2 pixels.
  /// stream: when given, the slices are its own, stack is a preview of them, and Slices have no
  /// pixels: see ForEachPart. It must outlive this object, too.
  SliceImages(
    vtkImageData* stack, const SliceSelection& selection, vtkLacunaSliceStream* stream = nullptr);

  /// Index along z, of the stack's extent, of each of Slices.
  const std::vector<int>& GetLayers() const { return this->Layers; }

  /// A warning when these are the slices of a preview only; else empty.
  std::string DescribePreview() const;

  /// Slices of the whole stack, used or not.
  int GetNumberOfLayers() const { return this->Extent[5] - this->Extent[4] + 1; }

  /// Gives f the slices with their pixels, in order: all at once, or, of a stream, as many as are
  /// read at a time; the pixels are there until f returns. first and last: how much of Slices is
  /// done before and after it, from 0 to 1. Progress of reading covers begin..end of the whole.
  using Part =
    std::function<void(const std::vector<SliceImage>& slices, double first, double last)>;
  void ForEachPart(Execution& execution, double begin, double end, const Part& f) const;

  /// Of the slices with these indices in Slices (ascending), with pixels that storage holds.
  std::vector<SliceImage> Load(const std::vector<std::size_t>& indices,
    std::vector<unsigned char>& storage, Execution& execution) const;

  /// Slices that were taken without lifting the probe.
  struct Sweep
  {
    int First, Last;   ///< numbers of slices
    double WidestStep; ///< mm that a corner moves at most from one of them to the next
    SweepEnd End;      ///< of the sweep; not of the last one
  };
  /// "2 sweeps: slices 0 to 20, at most 1 mm apart; slices 21 to 41, ..."; and where they end.
  std::string DescribeSweeps() const;

  /// How many slices of the stack are flagged with what, for a message: "20 of 21 are flagged in
  /// SliceStatus: 18 pose invalid (1), 2 gated out (8)".
  std::string DescribeFlags() const;
  /// What to do to get more of them: "set UseTooFast, UseGatedOut to take the flagged ones".
  std::string DescribeRemedy() const;

  /// Cuts all slices to a fan; once.
  void ApplyFan(const SliceFan& fan);

  /// Makes Others of all slices: they count for the place of the output alone.
  void HideSlices();

  /// A warning about slices that are left out because of bad poses (LeftOut, also of several
  /// stacks); names the first ten.
  static std::string DescribeLeftOut(const std::vector<std::string>& leftOut);

  vtkImageData* Stack;
  vtkLacunaSliceStream* Stream;             ///< null when the slices are in the stack
  vtkSmartPointer<vtkDataArray> GreyLevels; ///< in one piece of memory
  std::vector<SliceImage> Slices;
  /// In a replay: slices whose pose is known, but not their image. They have no pixels.
  std::vector<SliceImage> Others;
  /// A replay has not shown all of them yet, or they are being taken: too little to see is no error.
  bool IsMoreToCome = false;
  /// ImageToReference of Slices, then of Others.
  std::vector<Matrix4> Poses;
  /// Columns and rows of the slices' windows in the original slices.
  SliceFan::Window Window;
  /// In the order of Slices, which are marked where one begins; only one without HasSweepEnds.
  std::vector<Sweep> Sweeps;
  /// Where sweeps end that are joined; only without HasSweepEnds, and mostly empty.
  std::string JoinedEnds;
  /// One sentence for each slice that is left out because of a bad pose.
  std::vector<std::string> LeftOut;

private:
  struct Candidate;
  int Extent[6]; // of the whole stack
  std::array<double, 3> Origin, Spacing;
  std::vector<int> Layers; // of Slices: indices along z
  std::vector<bool> FindSlicesToCome(const TrackedSlices& tracked) const;
  std::vector<std::int64_t> FindLayers(vtkIdType slices) const;
  SliceImage CutFirstLayer(const std::array<int, 4>& clip);
  std::vector<Candidate> FindCandidates(
    const TrackedSlices& tracked, const SliceSelection& selection);
  void FindSweeps(const TrackedSlices& tracked, const SliceSelection& selection,
    const std::vector<Candidate>& gatedOut, std::vector<Candidate>& candidates);
  static std::vector<const Candidate*> FindKnown(const TrackedSlices& tracked,
    const std::vector<Candidate>& gatedOut, const std::vector<Candidate>& candidates);
  void PartSweeps(const TrackedSlices& tracked, const std::vector<const Candidate*>& known);
  void JoinSweeps();
  std::string DescribeEnds() const;
  void DropBadPoses(const TrackedSlices& tracked, std::vector<Candidate>& candidates,
    const SliceSelection& selection);

  SliceFlagCounts Flags; // of slices that are left out
};
}
#endif
