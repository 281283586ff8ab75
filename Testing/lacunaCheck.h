// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Assertions of the tests that run under VTK's test driver. Each prints what it expected; a test
/// ends with `return lacunaCheck::Result();`.
#ifndef lacunaCheck_h
#define lacunaCheck_h

#include "vtkAlgorithm.h"
#include "vtkCommand.h"
#include "vtkExecutive.h"
#include "vtkNew.h"
#include "vtkObject.h"
#include "vtkSmartPointer.h"

#include <cmath>
#include <exception>
#include <iostream>
#include <string>

namespace lacunaCheck
{
inline int& Failures()
{
  static int failures = 0;
  return failures;
}

inline int Result()
{
  return Failures() == 0 ? 0 : 1;
}

inline void Fail(const char* file, int line, const std::string& what)
{
  ++Failures();
  std::cerr << file << ":" << line << ": " << what << "\n";
}

/// Keeps the errors and warnings of one VTK object instead of printing them.
class Messages : public vtkCommand
{
public:
  static Messages* New() { return new Messages; }
  vtkTypeMacro(Messages, vtkCommand);

  void Watch(vtkObject* object)
  {
    object->AddObserver(vtkCommand::ErrorEvent, this);
    object->AddObserver(vtkCommand::WarningEvent, this);
  }

  void Execute(vtkObject*, unsigned long event, void* text) override
  {
    std::string& kept = event == vtkCommand::ErrorEvent ? this->Errors : this->Warnings;
    kept += static_cast<const char*>(text);
  }

  /// True when an error was raised that contains text.
  bool HasError(const std::string& text) const
  {
    return !this->Errors.empty() && this->Errors.find(text) != std::string::npos;
  }
  bool HasWarning(const std::string& text) const
  {
    return !this->Warnings.empty() && this->Warnings.find(text) != std::string::npos;
  }

  std::string Errors;
  std::string Warnings;
};

/// The messages of an algorithm and of its executive, which complains of the failed request.
inline vtkSmartPointer<Messages> Watch(vtkAlgorithm* algorithm)
{
  vtkNew<Messages> messages;
  messages->Watch(algorithm);
  messages->Watch(algorithm->GetExecutive());
  return messages;
}
}

#define LACUNA_CHECK(condition)                                                                    \
  do                                                                                               \
  {                                                                                                \
    if (!(condition))                                                                              \
    {                                                                                              \
      lacunaCheck::Fail(__FILE__, __LINE__, "expected " #condition);                               \
    }                                                                                              \
  } while (false)

/// The same with words of the test's own.
#define LACUNA_CHECK_THAT(condition, what)                                                         \
  do                                                                                               \
  {                                                                                                \
    if (!(condition))                                                                              \
    {                                                                                              \
      lacunaCheck::Fail(__FILE__, __LINE__, std::string("not so: ") + (what));                     \
    }                                                                                              \
  } while (false)

#define LACUNA_CHECK_NEAR(value, expected, tolerance)                                              \
  do                                                                                               \
  {                                                                                                \
    const double lacunaValue = (value);                                                            \
    const double lacunaExpected = (expected);                                                      \
    if (!(std::abs(lacunaValue - lacunaExpected) <= (tolerance)))                                  \
    {                                                                                              \
      lacunaCheck::Fail(__FILE__, __LINE__,                                                        \
        std::string(#value " is ") + std::to_string(lacunaValue) + ", expected " +                 \
          std::to_string(lacunaExpected));                                                         \
    }                                                                                              \
  } while (false)

/// The text must contain `part`.
#define LACUNA_CHECK_CONTAINS(text, part)                                                          \
  do                                                                                               \
  {                                                                                                \
    const std::string lacunaText = (text);                                                         \
    if (lacunaText.find(part) == std::string::npos)                                                \
    {                                                                                              \
      lacunaCheck::Fail(                                                                           \
        __FILE__, __LINE__, "expected '" + std::string(part) + "' in '" + lacunaText + "'");       \
    }                                                                                              \
  } while (false)

/// The statement must throw an exception whose text contains `part`.
#define LACUNA_CHECK_THROWS(statement, part)                                                       \
  do                                                                                               \
  {                                                                                                \
    std::string lacunaText;                                                                        \
    try                                                                                            \
    {                                                                                              \
      statement;                                                                                   \
    }                                                                                              \
    catch (const std::exception& e)                                                                \
    {                                                                                              \
      lacunaText = e.what();                                                                       \
    }                                                                                              \
    if (lacunaText.find(part) == std::string::npos)                                                \
    {                                                                                              \
      lacunaCheck::Fail(__FILE__, __LINE__,                                                        \
        "expected an exception with '" + std::string(part) + "' from " #statement ", got '" +      \
          lacunaText + "'");                                                                       \
    }                                                                                              \
  } while (false)
#endif
