// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The base of Lacuna's writers. In parallel each process has a writer, with its number as Piece: all bring the whole
/// input up to date, and the first one writes.
#ifndef vtkLacunaWriter_h
#define vtkLacunaWriter_h

#include "lacunaProperties.h"
#include "vtkLacunaFiltersCommonModule.h" // for export macro
#include "vtkWriter.h"

#include <string>

#ifdef __VTK_WRAP__ // wrappers know classes of VTK only
#define vtkLacunaWriter vtkWriter
#else
class VTKLACUNAFILTERSCOMMON_EXPORT vtkLacunaWriter
  : public vtkWriter
  , public lacuna::Described
{
public:
  vtkAbstractTypeMacro(vtkLacunaWriter, vtkWriter);
  /// FileName, what Describe lists, and FileSize.
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// 1 when a file was written, else 0; then GetErrorCode() says why. Nothing written is always an error: VTK does
  /// not come to WriteData when a filter upstream has nothing.
  int Write() override;

  int ProcessRequest(
    vtkInformation* request, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

protected:
  vtkLacunaWriter() = default;
  ~vtkLacunaWriter() override = default;
  void WriteData() override;

  /// Asks for the input, by default for all of it; returns why it was refused (lacuna::AskForAll).
  virtual std::string Ask(vtkInformation* input);

  /// Writes FileName and sets FileSize. All errors are exceptions with a sentence for the user.
  virtual void WriteFile() = 0;

  /// Clears what is known of the last file.
  virtual void ClearResults();

  char* FileName = nullptr;
  int Piece = 0;
  int NumberOfPieces = 1;
  vtkTypeInt64 FileSize = 0;

private:
  vtkLacunaWriter(const vtkLacunaWriter&) = delete;
  void operator=(const vtkLacunaWriter&) = delete;

  void RequireInput();

  std::string Refused;
};
#endif
#endif
