// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaGateSlices
 * @brief   Marks tracked slices that were taken at the wrong phase of heart or breath, or too fast
 *
 * The heart and the chest move; slices of one phase make a sharp volume. This filter gives each
 * slice a gate value and marks those outside of GateRange as gated out (SliceStatus 8), and those
 * during which the probe moved faster than SpeedLimit as too fast (4). Flags that slices have
 * already stay. Nothing else changes: all filters that take tracked slices leave marked ones out,
 * unless they are told not to.
 *
 * Input port 0: tracked slices (see lacunaTrackedSlices.h), with Timestamp (s) unless they are
 * matched by frame number. Port 1, optional: a vtkTable of a gate signal, one row for each sample.
 * Without it the gate values are a field data array of the slices, one value for each: numbers, or
 * the texts of numbers, as fields of sequence files come (an empty text is no value).
 *
 * Gate values at the slices' times are interpolated between the rows (lacunaGateSignal.h): plain
 * values and phases evenly, phases along the shorter way around the cycle; between triggers (R
 * waves) the phase grows evenly from 0 to Period. Slices before the first row, after the last one
 * or in a gap of the table have no gate value: they are gated out, and a warning says how many.
 *
 * Output: the slices, with SliceStatus, and field data array Gate (double, NaN where there is no
 * value), Provenance.
 *
 * Slices that are too many for the memory (vtkLacunaSliceStream.h) are marked like others, and their
 * stream is passed on.
 *
 * It is an error when columns or arrays are missing or have the wrong length, when there is nothing
 * to gate by, and for a range or period that makes no sense.
 *
 * @sa lacunaTrackedSlices.h, lacunaGateSignal.h, lacunaSliceMotion.h
 */
#ifndef vtkLacunaGateSlices_h
#define vtkLacunaGateSlices_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersReconstructionModule.h" // for export macro

#include <string>
#include <vector>

class vtkImageData;
class vtkTable;

class VTKLACUNAFILTERSRECONSTRUCTION_EXPORT vtkLacunaGateSlices
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaGateSlices* New();
  vtkTypeMacro(vtkLacunaGateSlices, vtkImageAlgorithm);

  enum GateTypes
  {
    Value = 0,
    Phase = 1,
    Trigger = 2
  };
  enum Keys
  {
    Timestamp = 0,
    FrameNumber = 1
  };

  ///@{
  /// What the gate values are. Value: a number that goes up and down. Phase: a number that grows by
  /// Period in each cycle. Trigger: the rows of the table are the instants at which cycles begin,
  /// and the gate value is the phase since, 0 to Period. Default: Value.
  vtkSetMacro(GateType, int);
  vtkGetMacro(GateType, int);
  void SetGateTypeToValue() { this->SetGateType(Value); }
  void SetGateTypeToPhase() { this->SetGateType(Phase); }
  void SetGateTypeToTrigger() { this->SetGateType(Trigger); }
  ///@}

  ///@{
  /// First and last gate value to accept. Phases wrap around: 0.9 0.2 with a Period of 1 are those
  /// from 0.9 on and those up to 0.2, and so are -0.1 0.2. Default: 0 1.
  vtkSetVector2Macro(GateRange, double);
  vtkGetVector2Macro(GateRange, double);
  ///@}

  ///@{
  /// By how much a phase grows in a cycle: 1, 100 (percent), 360 (degrees) ... Default: 1.
  vtkSetMacro(Period, double);
  vtkGetMacro(Period, double);
  ///@}

  ///@{
  /// The column of gate values, or without a table the field data array. Default: Gate.
  void SetGateColumn(const char* name);
  const char* GetGateColumn() const { return this->GateColumn.c_str(); }
  ///@}

  ///@{
  /// What says which row belongs to which slice: times, between which values are interpolated, or
  /// the numbers of frames, each of which has a row of its own. Default: Timestamp.
  vtkSetMacro(MatchBy, int);
  vtkGetMacro(MatchBy, int);
  void SetMatchByToTimestamp() { this->SetMatchBy(Timestamp); }
  void SetMatchByToFrameNumber() { this->SetMatchBy(FrameNumber); }
  ///@}

  ///@{
  /// The column of times (s) or frame numbers. Empty: Timestamp or Time, FrameNumber or Frame.
  /// Default: empty.
  void SetKeyColumn(const char* name);
  const char* GetKeyColumn() const { return this->KeyColumn.c_str(); }
  ///@}

  ///@{
  /// Seconds to add to the table's times to get those of the slices. Default: 0.
  vtkSetMacro(TimeOffset, double);
  vtkGetMacro(TimeOffset, double);
  ///@}

  ///@{
  /// Rows further apart than this many s have nothing between them. 0 = no limit. Default: 0.
  vtkSetMacro(MaximumTimeGap, double);
  vtkGetMacro(MaximumTimeGap, double);
  ///@}

  ///@{
  /// Slices whose fastest corner moved by more than this many mm/s since the slice before are too
  /// fast. Slices whose pose cannot be true (see lacunaPoseJudge.h; a warning names them) have
  /// no speed, and the slice after one has its speed since the slice before it, as in
  /// vtkLacunaSlicePlanes. 0 = no limit. Default: 0.
  vtkSetMacro(SpeedLimit, double);
  vtkGetMacro(SpeedLimit, double);
  ///@}

  /// Takes the table of input port 1 away.
  void RemoveGateTable() { this->SetInputConnection(1, nullptr); }

protected:
  vtkLacunaGateSlices();
  ~vtkLacunaGateSlices() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Announce(const lacuna::Ports& ports) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaGateSlices(const vtkLacunaGateSlices&) = delete;
  void operator=(const vtkLacunaGateSlices&) = delete;

  std::vector<double> GetGates(vtkImageData* slices, vtkTable* table, vtkIdType count);
  std::vector<double> GetGatesByTime(vtkImageData* slices, vtkTable* table, vtkIdType count);
  std::vector<double> GetGatesByFrame(vtkImageData* slices, vtkTable* table, vtkIdType count);
  void WarnOfEmptyKeys(const std::vector<double>& keys);
  std::vector<double> GetSpeeds(vtkImageData* slices, const int whole[6], vtkIdType count);

  int GateType = Value;
  double GateRange[2] = { 0, 1 };
  double Period = 1;
  std::string GateColumn = "Gate";
  int MatchBy = Timestamp;
  std::string KeyColumn;
  double TimeOffset = 0;
  double MaximumTimeGap = 0;
  double SpeedLimit = 0;
};
#endif
