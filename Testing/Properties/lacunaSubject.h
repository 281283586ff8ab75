// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The algorithms of Lacuna as the tests of properties see them: how to make one, what it takes, and
/// which properties it has.
#ifndef lacunaSubject_h
#define lacunaSubject_h

#include "lacunaDice.h"
#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"

#include <climits>
#include <functional>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace lacunaProperties
{
/// One property: a way to set it to a random value.
struct Property
{
  std::string Name;
  /// Sets a value within the property's range, or a hostile one; gives it as text.
  std::function<std::string(vtkAlgorithm*, Dice&, bool isHostile)> Set;
};

using Inputs = std::vector<vtkSmartPointer<vtkDataObject>>; ///< one for each port; null: none

struct Subject
{
  std::string Name;
  std::function<vtkSmartPointer<vtkAlgorithm>()> New;
  /// Inputs that fit together.
  std::function<Inputs(Dice&)> MakeInputs;
  std::vector<Property> Properties;
  /// Cost of one case in units of a Speckle Filter: fewer cases are tried of a dear one.
  int Cost = 1;
  /// Whether output 0 has the extent, spacing, origin and direction of input 0.
  bool KeepsGeometry = false;
  /// Whether it asks for no memory to speak of, however large its input is.
  bool IsFrugal = false;
  /// Whether there may be an output besides an error: that a file could not be written as well.
  bool KeepsOutput = false;
  /// Arrays in which NaN says that there is no value.
  std::set<std::string> MayBeNaN = {};
  /// What makes a run of it sensible that begins with the properties' defaults.
  std::function<void(vtkAlgorithm*)> Prepare = nullptr;
  /// A writer's file without extension; gives its whole name. None: no writer.
  std::function<std::string(vtkAlgorithm*, const std::string& path)> SetFile = nullptr;
};

/// All of them.
const std::vector<Subject>& GetSubjects();

void AddImageSubjects(std::vector<Subject>& subjects);
void AddSliceSubjects(std::vector<Subject>& subjects);
void AddSurfaceSubjects(std::vector<Subject>& subjects);
void AddSourceSubjects(std::vector<Subject>& subjects);
void AddReaderSubjects(std::vector<Subject>& subjects);

template <class T>
vtkSmartPointer<vtkAlgorithm> NewOf()
{
  return vtkSmartPointer<T>::New();
}

/// A number of the range, at times its ends; evenly in the logarithm when the range is wide.
double UsualReal(Dice& dice, double lowest, double highest);
double HostileReal(Dice& dice);
int HostileWhole(Dice& dice);

/// SetFile of a writer of files with the extension.
template <class T>
std::function<std::string(vtkAlgorithm*, const std::string&)> FileOf(const std::string& extension)
{
  return [=](vtkAlgorithm* algorithm, const std::string& path)
  {
    const std::string name = path + "." + extension;
    dynamic_cast<T*>(algorithm)->SetFileName(name.c_str());
    return name;
  };
}

template <class T>
T* Cast(vtkAlgorithm* algorithm)
{
  return dynamic_cast<T*>(algorithm);
}

template <class T>
Property Real(const char* name, void (T::*set)(double), double lowest, double highest)
{
  return { name,
    [=](vtkAlgorithm* algorithm, Dice& dice, bool isHostile)
    {
      const double value = isHostile ? HostileReal(dice) : UsualReal(dice, lowest, highest);
      (Cast<T>(algorithm)->*set)(value);
      std::ostringstream text;
      text.precision(17);
      text << value;
      return text.str();
    } };
}

template <int N, class T>
Property Reals(const char* name, void (T::*set)(const double*), double lowest, double highest)
{
  return { name,
    [=](vtkAlgorithm* algorithm, Dice& dice, bool isHostile)
    {
      double values[N];
      std::ostringstream text;
      text.precision(17);
      for (double& value : values)
      {
        value =
          isHostile && dice.Chance(0.5) ? HostileReal(dice) : UsualReal(dice, lowest, highest);
        text << value << ' ';
      }
      (Cast<T>(algorithm)->*set)(values);
      return text.str();
    } };
}

/// Also enumerations.
template <class T>
Property Whole(const char* name, void (T::*set)(int), int lowest, int highest)
{
  return { name,
    [=](vtkAlgorithm* algorithm, Dice& dice, bool isHostile)
    {
      const int value = isHostile ? dice.Pick({ HostileWhole(dice), lowest - 1, highest + 1 })
                                  : dice.Whole(lowest, highest);
      (Cast<T>(algorithm)->*set)(value);
      return std::to_string(value);
    } };
}

template <int N, class T>
Property Wholes(const char* name, void (T::*set)(const int*), int lowest, int highest)
{
  return { name,
    [=](vtkAlgorithm* algorithm, Dice& dice, bool isHostile)
    {
      int values[N];
      std::string text;
      for (int& value : values)
      {
        value = isHostile && dice.Chance(0.5) ? HostileWhole(dice) : dice.Whole(lowest, highest);
        text += std::to_string(value) + ' ';
      }
      (Cast<T>(algorithm)->*set)(values);
      return text;
    } };
}

template <class T>
Property Switch(const char* name, void (T::*set)(bool))
{
  return { name,
    [=](vtkAlgorithm* algorithm, Dice& dice, bool)
    {
      const bool value = dice.Chance(0.5);
      (Cast<T>(algorithm)->*set)(value);
      return std::string(value ? "on" : "off");
    } };
}

/// One of the words; a hostile one is no name of anything.
template <class T, class Text>
Property Word(const char* name, void (T::*set)(Text), const std::vector<std::string>& words)
{
  return { name,
    [=](vtkAlgorithm* algorithm, Dice& dice, bool isHostile)
    {
      const std::string value = isHostile
        ? dice.Pick<std::string>({ "no such thing", "\t", "%s%n", std::string(5000, 'x') })
        : dice.Pick(words);
      if constexpr (std::is_same_v<Text, std::string>)
      {
        (Cast<T>(algorithm)->*set)(value);
      }
      else
      {
        (Cast<T>(algorithm)->*set)(value.c_str());
      }
      return '"' + value.substr(0, 40) + '"';
    } };
}

/// Whatever is not one of these.
template <class T>
Property Other(const char* name, const std::function<std::string(T*, Dice&, bool isHostile)>& set)
{
  return { name, [=](vtkAlgorithm* algorithm, Dice& dice, bool isHostile) {
            return set(Cast<T>(algorithm), dice, isHostile);
          } };
}
}
#endif
