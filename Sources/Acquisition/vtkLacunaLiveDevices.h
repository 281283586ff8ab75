// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaLiveDevices
 * @brief which tracker and which video a live source has
 *
 * The devices of vtkLacunaPolhemusVideoSource as properties: where they are and how they are set. It
 * opens none.
 */
#ifndef vtkLacunaLiveDevices_h
#define vtkLacunaLiveDevices_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaSourcesAcquisitionModule.h" // for export macro

#include <string> // for std::string

namespace lacuna
{
class Clock;
struct AcquisitionDevices;
}

class VTKLACUNASOURCESACQUISITION_EXPORT vtkLacunaLiveDevices
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  vtkTypeMacro(vtkLacunaLiveDevices, vtkImageAlgorithm);

  enum Fields
  {
    Both = 0,
    Top = 1,
    Bottom = 2
  };
  enum RecordFormats
  {
    Binary = 0,
    Ascii = 1
  };
  enum RecordUnits
  {
    Centimetre = 0,
    Inch = 1
  };
  enum TrackerResets
  {
    Nothing = 0,
    Frames = 1,
    Factory = 2
  };

  ///@{
  /// Serial port of the tracker, "/dev/ttyUSB0", or a server of poses,
  /// "igtl://host:18944?transform=ProbeToTracker" (see lacunaOpenIGTLinkAddress.h), for which
  /// the settings of the serial line and of the FASTRAK below mean nothing. Default: none.
  vtkSetStringMacro(TrackerConnection);
  vtkGetStringMacro(TrackerConnection);
  ///@}
  ///@{
  /// That of the switches at the tracker's rear. Default: 115200.
  vtkSetMacro(BaudRate, int);
  vtkGetMacro(BaudRate, int);
  ///@}
  ///@{
  /// The receiver on the probe, 1 to 4. Default: 1.
  vtkSetMacro(Station, int);
  vtkGetMacro(Station, int);
  ///@}
  ///@{
  /// Direction from the transmitter to the middle of the half of space that the receiver is in, in
  /// the transmitter's coordinates. Default: 1 0 0.
  vtkSetVector3Macro(Hemisphere, double);
  vtkGetVector3Macro(Hemisphere, double);
  ///@}
  ///@{
  /// Whether the tracker shall not smooth its measurements, which delays them. Default: off (as it is
  /// set).
  vtkSetMacro(FiltersOff, bool);
  vtkGetMacro(FiltersOff, bool);
  vtkBooleanMacro(FiltersOff, bool);
  ///@}
  ///@{
  /// How the tracker writes its records. ASCII is longer, which costs records a second, and coarser
  /// below 57600 baud: 0.01 of RecordUnit. Default: Binary.
  vtkSetMacro(RecordFormat, int);
  vtkGetMacro(RecordFormat, int);
  ///@}
  ///@{
  /// The unit that the tracker writes lengths in; slices have mm in any case. Default: Centimetre.
  vtkSetMacro(RecordUnit, int);
  vtkGetMacro(RecordUnit, int);
  ///@}
  ///@{
  /// What of the tracker's own settings is undone when it is opened: its alignment and boresight,
  /// so that poses are in the transmitter's frame; all but the serial line's; or nothing, for a
  /// tracker that another program has aligned. Default: Frames.
  vtkSetMacro(TrackerReset, int);
  vtkGetMacro(TrackerReset, int);
  ///@}
  ///@{
  /// Whether a press of the stylus's button, or of a foot switch in its place, starts or stops the
  /// capture. Default: off.
  vtkSetMacro(ButtonStarts, bool);
  vtkGetMacro(ButtonStarts, bool);
  vtkBooleanMacro(ButtonStarts, bool);
  ///@}

  ///@{
  /// "/dev/video0", a file, the address of a stream ("rtsp://..."), a server of images
  /// ("igtl://host:18944?image=Image_Reference") or a test signal
  /// ("lavfi:testsrc2=size=768x576:rate=25"). Default: none.
  vtkSetStringMacro(VideoURL);
  vtkGetStringMacro(VideoURL);
  ///@}
  ///@{
  /// For FFmpeg, "standard=PAL:channel=1:video_size=768x576". Default: none.
  vtkSetStringMacro(VideoOptions);
  vtkGetStringMacro(VideoOptions);
  ///@}
  ///@{
  /// What is used of interlaced frames, whose fields are of two instants. Default: Both.
  vtkSetMacro(Field, int);
  vtkGetMacro(Field, int);
  ///@}
  ///@{
  /// s from the instant that a frame shows to its arrival; below 0: one frame's time for a frame
  /// grabber (/dev/...), 0 for others. Default: -1.
  vtkSetMacro(VideoLatency, double);
  vtkGetMacro(VideoLatency, double);
  ///@}
  ///@{
  /// First column, first row, columns and rows that are kept of a frame; 0 columns or rows: to its
  /// end. Default: 0 0 0 0.
  vtkSetVector4Macro(CropRectangle, int);
  vtkGetVector4Macro(CropRectangle, int);
  ///@}

protected:
  vtkLacunaLiveDevices() = default;
  ~vtkLacunaLiveDevices() override;

  void Describe(lacuna::Properties& properties) const override;
  /// The properties of each device, in one line.
  std::string DescribeTracker() const;
  std::string DescribeVideo() const;
  std::string DescribeCrop() const;
  std::string DescribeDevices() const;
  /// What opens these devices. The clock must live longer.
  lacuna::AcquisitionDevices MakeDevices(const lacuna::Clock& clock) const;

  bool ButtonStarts = false;

private:
  vtkLacunaLiveDevices(const vtkLacunaLiveDevices&) = delete;
  void operator=(const vtkLacunaLiveDevices&) = delete;

  void ListTracker(lacuna::Properties& properties) const;
  void ListVideo(lacuna::Properties& properties) const;
  void ListCrop(lacuna::Properties& properties) const;

  char* TrackerConnection = nullptr;
  int BaudRate = 115200;
  int Station = 1;
  double Hemisphere[3] = { 1, 0, 0 };
  bool FiltersOff = false;
  int RecordFormat = Binary;
  int RecordUnit = Centimetre;
  int TrackerReset = Frames;
  char* VideoURL = nullptr;
  char* VideoOptions = nullptr;
  int Field = Both;
  double VideoLatency = -1;
  int CropRectangle[4] = { 0, 0, 0, 0 };
};
#endif
