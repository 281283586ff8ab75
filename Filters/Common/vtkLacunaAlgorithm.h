// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The base of Lacuna's sources, readers and filters.
///
/// An algorithm says in its constructor how ranks share its work (Share), and implements Make (the work) and Describe
/// (its properties, what each may be). Where the outputs have another grid or type than the first input it implements
/// Announce, and where it needs another part of the input than its share, Ask. The base does the rest: it refuses values
/// that no property may have, asks for the input, refuses what is not sound or does not fit into the memory, reports
/// progress, stops, empties the outputs after an error, brings errors to all ranks, crops images, prints the properties,
/// and records the provenance with the marks of laterality and coordinates. VTK calls RequestData, which calls
/// MakeOutputs, which calls Make.
#ifndef vtkLacunaAlgorithm_h
#define vtkLacunaAlgorithm_h

#include "lacunaAlgorithmExecution.h"
#include "lacunaControllerRanks.h"
#include "lacunaProperties.h"
#include "lacunaVersionCompat.h" // for stops
#include "vtkAlgorithm.h"
#include "vtkLacunaFiltersCommonModule.h" // for export macro

#include <array>
#include <cstdint>
#include <string>
#include <vector>

class vtkDataObject;
class vtkInformation;
class vtkInformationVector;

namespace lacuna
{
/// How the ranks of an MPI program share the work of an algorithm.
enum class Share
{
  Parts,     ///< each rank asks for what its part of the output needs
  EachRank,  ///< each rank has the whole input, and makes its part of the output
  FirstRank, ///< each rank has the whole input; the first one, of meshes who is asked for the first piece, makes all
  Together   ///< each rank has the whole input; all ranks work for one result (Ports::Ranks)
};

/// The inputs and outputs of an algorithm, as VTK passes them.
class VTKLACUNAFILTERSCOMMON_EXPORT Ports
{
public:
  Ports(vtkInformationVector** inputs, vtkInformationVector* outputs, const lacuna::Ranks& ranks,
    bool haveMet = false)
    : Ranks(ranks)
    , HaveMet(haveMet)
    , Inputs(inputs)
    , Outputs(outputs)
  {
  }

  /// Null when nothing is connected, or data of another type.
  template <class Data>
  Data* GetInput(int port = 0, int connection = 0) const
  {
    return Data::GetData(this->Inputs[port], connection);
  }
  template <class Data>
  Data* GetOutput(int port = 0) const
  {
    return Data::GetData(this->Outputs, port);
  }
  /// What VTK knows of them; null when nothing is connected.
  vtkInformation* GetInputInformation(int port = 0, int connection = 0) const;
  vtkInformation* GetOutputInformation(int port = 0) const;

  /// The extent of an output that is asked for; of this rank when the output is made in parts.
  std::array<int, 6> GetExtent(int port = 0) const;

  /// Whether the first piece is asked for. Meshes and tables that are not made in parts are in it.
  bool IsFirst() const;

  /// Whether any part of an image is asked for, or nothing is known of the first one.
  bool IsAsked() const;

  /// Those that work together now: of Share::Together all ranks after a change, otherwise this one alone.
  const lacuna::Ranks& Ranks;
  /// Of Share::Together: all ranks have worked together since the last change, and one of them is asked for more. A
  /// result that is kept may be used.
  const bool HaveMet;

private:
  vtkInformationVector** Inputs;
  vtkInformationVector* Outputs;
};

/// What vtkLacunaAlgorithm does, whatever the class of VTK. All errors are exceptions with a sentence for the user.
/// Make is called only when all properties have values that they may have (Describe).
class VTKLACUNAFILTERSCOMMON_EXPORT Algorithm : public Described
{
public:
  /// A function that says whether all ranks execute an algorithm when something has changed. Only these can agree on
  /// errors without waiting for ever. Null: no algorithm. The program that runs pipelines on all ranks sets it.
  static void SetExecutesOnAllRanks(bool (*function)(vtkAlgorithm*));

protected:
  Algorithm(vtkAlgorithm* self);
  ~Algorithm() override;
  Algorithm(const Algorithm&) = delete;
  void operator=(const Algorithm&) = delete;

  /// For the constructors of algorithms.
  Share Sharing = Share::EachRank;
  /// Whether Make is called for a first input without points and rows, too.
  bool TakesEmpty = false;
  /// Whether VTK calls Make for each block of composite inputs; otherwise these are refused.
  bool TakesBlocks = false;
  /// Whether the outputs are in the coordinates of the first input, or in those that Make marks.
  bool KeepsPlace = true;

  /// Sets grids, scalar types and times of the outputs, as far as they differ from the first input's.
  virtual void Announce(const Ports& ports);

  /// Asks for the input that the outputs need, by AskFor and AskForWhole: by default as Sharing says, and
  /// for the same part as the output's of images that are shared by Parts.
  virtual void Ask(const Ports& ports);

  /// Fills the outputs.
  virtual void Make(const Ports& ports, lacuna::AlgorithmExecution& execution) = 0;

  /// Fills the outputs of those that make nothing: ranks but the first, or when the input is empty. By default they are
  /// empty, without field data.
  virtual void MakeNothing(const Ports& ports);

  /// "Name=value Name=value", for the provenance of an output. Called after Make. By default what Describe lists.
  /// Without any and without inputs nothing is recorded.
  virtual std::string Parameters(int port) const;

  /// The inputs that the outputs are made of, for the provenance; the outputs get the marks of the first one. By
  /// default all that have points or rows.
  virtual std::vector<vtkDataObject*> GetOrigins(const Ports& ports) const;

  /// For Announce of grids that depend on data: executes what is connected to an input now, asked for by Ask. When it
  /// is up to date, as it usually is, this does nothing.
  void UpdateInput(const Ports& ports, int port = 0);

  /// Asks for an extent of an image, or refuses it and asks for one point when it does not fit into the memory.
  void AskFor(vtkInformation* input, const std::array<int, 6>& extent);
  void AskForWhole(vtkInformation* input);

  /// For Ask of outputs that are made in parts: the extent that VTK will ask this rank for.
  static std::array<int, 6> GetPart(vtkInformation* output);

  /// When something changed, and the time steps of the inputs: while these stay, a result may be kept. They change on
  /// all ranks alike.
  std::vector<double> GetTimes() const;

  int AnnounceOutputs(vtkInformationVector** inputs, vtkInformationVector* outputs);
  int AskForInputs(vtkInformationVector** inputs, vtkInformationVector* outputs);
  int MakeOutputs(vtkInformationVector** inputs, vtkInformationVector* outputs);

private:
  /// What all ranks agreed on, and when. Each then does the same whatever it is asked for, or it would wait for others.
  struct Agreement
  {
    std::vector<double> Times;
    std::string Error;
  };

  void RefuseBlocks();
  void CheckInputs(const Ports& ports, int only = -1) const;
  using Fingerprints = std::vector<std::array<std::uint64_t, 4>>; // of all inputs
  Fingerprints GetFingerprints() const;
  std::string CompareInputs(const lacuna::ControllerRanks& ranks, const Fingerprints& own) const;
  void CheckRequest(const Ports& ports) const;
  bool HasWork(const Ports& ports) const;
  void Finish(const Ports& ports) const;
  void Fail(vtkInformationVector* outputs, const std::string& error);

  vtkAlgorithm* Self;
  std::string Announced;    ///< error of Announce, which is reported with the data
  std::string Refused;      ///< what does not fit into the memory
  bool IsElsewhere = false; ///< a grid is made by the first rank alone
  double BlocksAt = -1;     ///< when blocks were refused; VTK then comes with each of them
  Agreement Agreed;
  Agreement Shown; ///< error that is on the screen
};
}

#ifdef __VTK_WRAP__ // wrappers know classes of VTK only
#define vtkLacunaAlgorithmOf(Super) Super
#else
#define vtkLacunaAlgorithmOf(Super) vtkLacunaAlgorithm<Super>
#endif

/// A class of VTK as one of Lacuna's algorithms: derive from vtkLacunaAlgorithmOf(vtkImageAlgorithm) and its like.
/// Superclass is VTK's class there: a call of its RequestData or RequestInformation would pass this base by.
template <class Super>
class vtkLacunaAlgorithm
  : public Super
  , public lacuna::Algorithm
{
public:
  void PrintSelf(ostream& os, vtkIndent indent) override
  {
    this->Super::PrintSelf(os, indent);
    this->PrintProperties(os, indent);
  }

  /// A stop, and that it is over, is no change when there are several ranks: the others do not know of it.
  void SetAbortExecute(vtkTypeBool stop) override
  {
    this->KeepTime([&] { this->Super::SetAbortExecute(stop); });
  }
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20220823)
  void SetAbortOutput(bool stopped) override
  {
    this->KeepTime([&] { this->Super::SetAbortOutput(stopped); });
  }
#endif

protected:
  vtkLacunaAlgorithm()
    : Algorithm(this)
  {
  }

  /// An error of a file is no change either: it may be that of one rank.
  void SetErrorCode(unsigned long code) override
  {
    const vtkTimeStamp before = this->MTime;
    this->Super::SetErrorCode(code);
    this->MTime = before;
  }

  int RequestInformation(
    vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) override
  {
    return this->AnnounceOutputs(inputs, outputs);
  }
  int RequestUpdateExtent(
    vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) override
  {
    return this->AskForInputs(inputs, outputs);
  }
  int RequestData(
    vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) override
  {
    return this->MakeOutputs(inputs, outputs);
  }

private:
  template <class Callable>
  void KeepTime(const Callable& change)
  {
    const vtkTimeStamp before = this->MTime;
    change();
    this->MTime = lacuna::ControllerRanks().GetNumber() > 1 ? before : this->MTime;
  }
};
#endif
