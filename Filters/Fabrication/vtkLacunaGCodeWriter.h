// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaGCodeWriter
 * @brief a tool path as a program for a milling machine
 *
 * Writes poly lines with the point arrays Motion and FeedRate, the output of
 * vtkLacunaMillingToolPath, as G-code for a Fanuc 0-M control: G21 G90, straight motions (and arcs
 * if ArcTolerance asks for them), coordinates with a decimal point and at most three decimals (x and y to the nearest, z up), modal
 * words left out when they do not change. See lacuna::MakeGCode for what it refuses.
 *
 * A path that has been mirrored, scaled, bent, tilted or lowered since it was made (PressPosition) is
 * refused. One that lies elsewhere, or that Milling Tool Path warned of, is refused with the warnings
 * unless AcceptWarnings is on.
 *
 * Comments at the top name Lacuna's version, the tool, the steps of the provenance and the day, and
 * say of a path that lies elsewhere, or was made over a mould that did, that it was moved.
 * There is never a number in the file that is not finite.
 *
 * The file is written beside its final name and renamed when it is complete. On failure Write()
 * returns 0, GetErrorCode() says why (vtkErrorCode), and what was at FileName stays. In parallel
 * each process has a writer, with its number as Piece; all bring the whole input up to date, and
 * piece 0 writes.
 *
 * Source: Fanuc Series 0-M, Operator's Manual; RS-274-D.
 */
#ifndef vtkLacunaGCodeWriter_h
#define vtkLacunaGCodeWriter_h

#include "vtkLacunaFiltersFabricationModule.h" // for export macro
#include "vtkLacunaWriter.h"

class vtkPolyData;

namespace lacuna
{
struct GCodeOptions;
}

class VTKLACUNAFILTERSFABRICATION_EXPORT vtkLacunaGCodeWriter : public vtkLacunaWriter
{
public:
  static vtkLacunaGCodeWriter* New();
  vtkTypeMacro(vtkLacunaGCodeWriter, vtkLacunaWriter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The file to write, usually *.nc or *.gcode. */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}
  ///@{
  /** O number, 1..9999. Default 1. */
  vtkSetMacro(ProgramNumber, int);
  vtkGetMacro(ProgramNumber, int);
  ///@}
  ///@{
  /** T and H number, 1..99. Default 1. */
  vtkSetMacro(ToolNumber, int);
  vtkGetMacro(ToolNumber, int);
  ///@}
  ///@{
  /** 54..59 for G54..G59. Default 54. */
  vtkSetMacro(WorkOffset, int);
  vtkGetMacro(WorkOffset, int);
  ///@}
  ///@{
  /** Turns per minute; 0: the path's. Default 0. */
  vtkSetMacro(SpindleSpeed, double);
  vtkGetMacro(SpindleSpeed, double);
  ///@}
  ///@{
  /** N10, N20, .. before each block. Default off. */
  vtkSetMacro(LineNumbers, bool);
  vtkGetMacro(LineNumbers, bool);
  vtkBooleanMacro(LineNumbers, bool);
  ///@}
  ///@{
  /** mm. Above 0, 0.001 to 1: cuts in upright planes along x or y are joined to arcs (G02, G03) and
   * longer straight motions, which lie on them or at most this much above, so that they cut no deeper
   * (0.25 um, from rounding the arcs' centres). Default 0: off. */
  vtkSetMacro(ArcTolerance, double);
  vtkGetMacro(ArcTolerance, double);
  ///@}
  ///@{
  /** Least and largest x, y and z, mm, that the tool's tip may reach; a path or template that leaves
   * them is refused. 1 -1 on an axis: no limit there. Default 1 -1 1 -1 1 -1. */
  vtkSetVector6Macro(Envelope, double);
  vtkGetVector6Macro(Envelope, double);
  ///@}
  ///@{
  /** Whether a path is written of which vtkLacunaMillingToolPath, or this writer, warns, instead of
   * refused with those warnings. Default off. */
  vtkSetMacro(AcceptWarnings, bool);
  vtkGetMacro(AcceptWarnings, bool);
  vtkBooleanMacro(AcceptWarnings, bool);
  ///@}
  ///@{
  /** Whether a path over a mirror image of the patient (lacuna::Mirrored) is written, with a comment
   * and a warning, instead of refused. Default off. */
  vtkSetMacro(AllowMirrored, bool);
  vtkGetMacro(AllowMirrored, bool);
  vtkBooleanMacro(AllowMirrored, bool);
  ///@}
  ///@{
  /** Lines before and after the motions; empty: the default ones, see lacuna::GCodeOptions. Words that
   * would give the path another meaning, and places outside of Envelope or below the path's start or
   * end, are refused, see lacuna::FillInTemplate. */
  vtkSetStringMacro(Header);
  vtkGetStringMacro(Header);
  vtkSetStringMacro(Footer);
  vtkGetStringMacro(Footer);
  ///@}

  ///@{
  /** Number of this process, and of processes; only piece 0 writes. ParaView sets them. Default: 0
   * and 1. */
  vtkSetClampMacro(Piece, int, 0, VTK_INT_MAX);
  vtkGetMacro(Piece, int);
  vtkSetClampMacro(NumberOfPieces, int, 1, VTK_INT_MAX);
  vtkGetMacro(NumberOfPieces, int);
  ///@}

  ///@{
  /** Of the last Write(): bytes and blocks; 0 when it failed. */
  vtkGetMacro(FileSize, vtkTypeInt64);
  vtkGetMacro(NumberOfBlocks, vtkTypeInt64);
  ///@}

protected:
  vtkLacunaGCodeWriter() = default;
  ~vtkLacunaGCodeWriter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  void WriteFile() override;
  void Describe(lacuna::Properties& properties) const override;
  void ClearResults() override;

private:
  vtkLacunaGCodeWriter(const vtkLacunaGCodeWriter&) = delete;
  void operator=(const vtkLacunaGCodeWriter&) = delete;

  void WriteProgram(vtkPolyData* path);
  lacuna::GCodeOptions GetOptions() const; // the numbers
  lacuna::GCodeOptions GetOptions(vtkPolyData* path, bool isMoved) const;

  int ProgramNumber = 1;
  int ToolNumber = 1;
  int WorkOffset = 54;
  double SpindleSpeed = 0;
  bool LineNumbers = false;
  double ArcTolerance = 0;
  double Envelope[6] = { 1, -1, 1, -1, 1, -1 };
  bool AcceptWarnings = false;
  bool AllowMirrored = false;
  char* Header = nullptr;
  char* Footer = nullptr;
  vtkTypeInt64 NumberOfBlocks = 0;
};
#endif
