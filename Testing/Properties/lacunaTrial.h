// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Runs algorithms and says what came of it.
#ifndef lacunaTrial_h
#define lacunaTrial_h

#include "lacunaSubject.h"
#include "lacunaVerdict.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lacunaProperties
{
/// What came of one run.
struct Run
{
  std::string Errors;   ///< of the algorithm and its executive
  std::string Warnings; ///< of the algorithm
  std::string Stray;    ///< messages of other objects, which a user could not place
  bool IsEmpty = true;  ///< no output has anything, no file was written
  long Allocations = 0; ///< see CountAllocations
  std::vector<Fingerprint> Outputs;
};

/// What differs; empty when nothing does, or what one of them lacked was memory that others had taken.
std::string CompareRuns(const Run& first, const Run& second);

/// A subject with inputs and properties that a seed chooses.
class Trial
{
public:
  enum Kind
  {
    Plain,  ///< inputs as made, the properties' defaults
    Varied, ///< inputs as made, properties within their ranges
    Hostile ///< inputs may be spoiled, properties be anything
  };

  /// stretch: see Dice.
  Trial(const Subject& subject, std::uint64_t seed, Kind kind, int stretch = 1);

  /// An algorithm with them; sound: with the inputs before they were spoiled.
  vtkSmartPointer<vtkAlgorithm> Make(bool sound = false) const;
  void Connect(vtkAlgorithm* algorithm, bool sound = false) const;
  /// threads: of vtkSMPTools; 0: as a user has it.
  Run Execute(vtkAlgorithm* algorithm, int threads) const;

  const Subject& What;
  const Inputs& GetInputs() const { return this->Given; }
  bool IsSpoiled() const { return this->Spoiled; }
  bool IsHostile() const { return this->HasHostile; }
  /// What was chosen, to be read.
  const std::string& GetStory() const { return this->Story; }

private:
  struct Choice
  {
    const Property* What;
    std::uint64_t Seed;
    bool IsHostile;
  };
  void SpoilInputs(Dice& dice);

  Inputs Sound;
  Inputs Given;
  std::vector<Choice> Choices;
  bool Spoiled = false;
  bool HasHostile = false;
  std::string Story;
};

/// The folder for files that writers make and readers read.
void SetOutputFolder(const std::string& folder);
const std::string& GetOutputFolder();
}
#endif
