// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaPolhemusVideoSource
 * @brief a Polhemus FASTRAK and a video signal become tracked slices, live
 *
 * The tracker (through libserialport, or another one through OpenIGTLink) and the video (through
 * FFmpeg or OpenIGTLink) are driven by threads of their own, which come back by themselves when a
 * device was unplugged; see lacunaSweepAcquisition.h for the clock model, lacunaSweepTaking.h for
 * what is taken (Carr 1996, ch. 2). Nothing in this class waits for a device.
 *
 * Connect opens the devices, Start takes slices, Stop ends that; Start goes on with the sweep, Clear
 * begins a new one. Opening a state file or setting properties opens nothing. Poll, or GetNeedsUpdate
 * which ParaView calls for a live source, takes over what has come and marks this algorithm as
 * modified; an update gives it. Changed properties are heeded at the next update: those of the
 * devices (vtkLacunaLiveDevices.h) reopen them, during a capture only one that does not work.
 *
 * Output port 0: tracked slices (lacunaTrackedSlices.h) of the sweep, unsigned char, empty before
 * the first slice. Field data, one tuple a slice: ImageToReference (absent while there is no
 * calibration), ProbeToTracker and TrackerToReference (double, 16), Timestamp (s since Connect),
 * SliceStatus, FrameNumber (of the video's frames since Connect), Residual (s from the slice's
 * instant to the nearest measurement) and Speed (mm/s); one tuple: ImageToProbe. The stack's origin
 * is the corner of CropRectangle, so that its coordinates are those of the whole frame. Making it
 * costs the same however many slices there are.
 *
 * Output port 1: the newest frame as a stack of one slice, also while nothing is captured. Before the
 * first frame it is 768 x 576 pixels, black over a wedge of all grey levels, flagged as invalid, so
 * that views can be made ready.
 *
 * What is wrong and what to do is in Message, and a warning at the next update when it is new. One
 * process only.
 */
#ifndef vtkLacunaPolhemusVideoSource_h
#define vtkLacunaPolhemusVideoSource_h

#include "vtkLacunaLiveDevices.h"
#include "vtkLacunaSourcesAcquisitionModule.h" // for export macro

#include <memory> // for std::unique_ptr
#include <string> // for std::string

namespace lacuna
{
struct AcquisitionRules;
struct LiveSweep;
}

class VTKLACUNASOURCESACQUISITION_EXPORT vtkLacunaPolhemusVideoSource : public vtkLacunaLiveDevices
{
public:
  static vtkLacunaPolhemusVideoSource* New();
  vtkTypeMacro(vtkLacunaPolhemusVideoSource, vtkLacunaLiveDevices);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum CaptureModes
  {
    Movement = 0,
    EveryFrame = 1
  };

  ///@{
  /// The XML file that Probe Calibration writes, with a transform from Image to Probe. Default:
  /// none: the slices have no ImageToReference.
  vtkSetFilePathMacro(CalibrationFileName);
  vtkGetFilePathMacro(CalibrationFileName);
  ///@}
  ///@{
  /// mm from pixel to pixel, for a calibration that does not have it. Default: 0: it has.
  vtkSetMacro(PixelSpacing, double);
  vtkGetMacro(PixelSpacing, double);
  ///@}
  ///@{
  /// s to add to the frames' times, from Temporal Calibration. Default: 0.
  vtkSetMacro(TimeOffset, double);
  vtkGetMacro(TimeOffset, double);
  ///@}

  ///@{
  /// s for which the last pose holds when no other comes. For trackers that send a pose only when it
  /// changes, such as robots and 3D Slicer. Slices keep their own Timestamp; Residual is the age of
  /// the pose; after that time SliceStatus is 1. Default: 0: no pose is held.
  vtkSetMacro(HoldLastPose, double);
  vtkGetMacro(HoldLastPose, double);
  ///@}

  ///@{
  /// What becomes a slice. Default: Movement.
  vtkSetMacro(CaptureMode, int);
  vtkGetMacro(CaptureMode, int);
  ///@}
  ///@{
  /// mm that a corner of the image must have moved since the last slice. Default: 0.5.
  vtkSetMacro(MovementThreshold, double);
  vtkGetMacro(MovementThreshold, double);
  ///@}
  ///@{
  /// mm/s above which slices are flagged as too fast; 0: none are. Default: 23.
  vtkSetMacro(SpeedLimit, double);
  vtkGetMacro(SpeedLimit, double);
  ///@}
  ///@{
  /// Most memory for pixels, in MiB; the capture stops there and keeps what it has. Default: 0, half
  /// of the memory that is free when the devices are opened.
  vtkSetMacro(MemoryLimit, int);
  vtkGetMacro(MemoryLimit, int);
  ///@}
  ///@{
  /// Sequence file (.mhd or .nhdr) to which slices are written while they are taken. When it exists
  /// the next free of sweep-2.mhd, sweep-3.mhd ... is taken. Default: none.
  vtkSetFilePathMacro(RecordFileName);
  vtkGetFilePathMacro(RecordFileName);
  ///@}
  ///@{
  /// 0 (raw) to 9. Default: 0.
  vtkSetMacro(RecordCompression, int);
  vtkGetMacro(RecordCompression, int);
  ///@}
  ///@{
  /// Whether every new frame of the video is a reason for an update, also when no slice was taken.
  /// Default: on.
  vtkSetMacro(LiveDisplay, bool);
  vtkGetMacro(LiveDisplay, bool);
  vtkBooleanMacro(LiveDisplay, bool);
  ///@}

  /// Begins to open the devices.
  void Connect();
  /// Ends the capture and closes them, within a second and what the disk needs for slices that wait
  /// for it. The slices stay, with the calibration that they have.
  void Disconnect();
  /// Takes slices from now on, after Connect if need be.
  void Start();
  /// Ends the capture, within a second and a TimeOffset above 0.
  void Stop();
  /// Begins a new sweep without slices. When slices could not be recorded, also those of devices that
  /// have been closed since, that is an error at first; a second call drops them, if none has been
  /// taken in between.
  void Clear();
  /// Takes over what has come.
  void Poll() { this->GetNeedsUpdate(); }
  /// The same; whether there is something new.
  bool GetNeedsUpdate();

  /// Slices of the output.
  vtkIdType GetSliceCount() const;
  /// Whether frames become slices.
  bool GetCapturing() const;
  ///@{
  /// Whether data come from it.
  bool GetTrackerWorks() const;
  bool GetVideoWorks() const;
  ///@}
  ///@{
  /// What became of the sweep's frames, see lacuna::CaptureCounts.
  vtkIdType GetFrameCount() const;
  vtkIdType GetStillFrames() const;
  vtkIdType GetFramesWithoutPose() const;
  vtkIdType GetFramesOfWrongSize() const;
  vtkIdType GetFramesPastLimit() const;
  ///@}
  /// Frames that did not come, or could not be decoded, during captures.
  vtkIdType GetMissingFrames() const;
  /// Slices that are flagged as too fast.
  vtkIdType GetTooFastSlices() const;
  /// mm/s, of the fastest corner of the image, now; NaN when it is not known.
  double GetSpeed() const;
  /// s, the largest of the sweep.
  double GetLargestResidual() const;
  /// Slices of the sweep: those of the output, and those that the next Poll takes over.
  vtkIdType GetTakenSlices() const;
  ///@{
  /// Slices that are on the disk, and the file they are in.
  vtkIdType GetRecordedSlices() const;
  vtkIdType GetVerifiedSlices() const; ///< read back after Stop, and as they were taken
  const char* GetRecordedFileName();
  ///@}
  /// Slices that are to be recorded and not on the disk yet; for less than a second if all is well.
  vtkIdType GetWaitingSlices() const;
  /// MiB that are free on that disk; NaN when nothing is recorded.
  double GetDiskSpace() const;
  /// Why nothing is written, or what happened to the file; empty: all is well.
  const char* GetDiskMessage();
  ///@{
  /// MiB of pixels, taken or waiting for the disk, and how many there may be; 0 before Connect.
  double GetMemoryUsed() const;
  double GetMemoryLimitNow() const;
  ///@}
  /// What is wrong now and what to do, a line each; empty: all is well.
  const char* GetMessage();

protected:
  vtkLacunaPolhemusVideoSource();
  ~vtkLacunaPolhemusVideoSource() override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;
  /// Configure does it: what is wrong is said once, not with each update, and what was taken stays in view.
  void CheckProperties() const override {}
  std::string Parameters(int port) const override;

private:
  vtkLacunaPolhemusVideoSource(const vtkLacunaPolhemusVideoSource&) = delete;
  void operator=(const vtkLacunaPolhemusVideoSource&) = delete;

  std::string DescribeRules() const;
  std::string DescribeKept() const;
  bool DevicesDiffer() const;
  bool DevicesWait() const;
  void ReplaceBrokenDevices();
  void Open();
  void Close();
  void Configure();
  void ListRules(lacuna::Properties& properties) const;
  lacuna::AcquisitionRules GetRules() const;
  lacuna::AcquisitionRules MakeRules(bool keepsCalibration);
  void Apply(lacuna::AcquisitionRules rules, bool keepsCalibration);
  bool TakeOver();
  void CollectNews();

  char* CalibrationFileName = nullptr;
  double PixelSpacing = 0;
  double TimeOffset = 0;
  double HoldLastPose = 0;
  int CaptureMode = Movement;
  double MovementThreshold = 0.5;
  double SpeedLimit = 23;
  int MemoryLimit = 0;
  char* RecordFileName = nullptr;
  int RecordCompression = 0;
  bool LiveDisplay = true;
  std::unique_ptr<lacuna::LiveSweep> Now;
};
#endif
