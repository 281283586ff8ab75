// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkLacunaSkullBone
 * @brief takes away from the CT of a head all that is not skull
 *
 * Input 0: vtkImageData, active point scalars of one component, any type, any direction matrix.
 * Input 1 (optional): closed surfaces (vtkPolyData, world mm); bone within them is taken away.
 *
 * Kept is the largest part of voxels at or above Level that share a face, edge or corner, and every part
 * smaller than SmallPart that comes within Gap of it, which is thin bone. All else at or above Level is
 * taken away: head holder, table, tubes, loose specks.
 *
 * Output: the input's grid and arrays. Voxels taken away become at most as far below Level as kept bone is
 * above it on average. So do those within two voxels of them, so that interpolation finds no edge there.
 * No other voxel changes, nor does any within two voxels of kept bone that was not taken away itself.
 *
 * With BridgeDiameter, bone then closes the holes of the vault into which no circle of this diameter fits, between
 * the tables of the bone around them (lacunaSkullBridge.h). Voxels get brighter there, never darker: by depth, to at
 * most as far above Level as kept bone is on average.
 * Field data: that of the input, and
 * | array         | components | meaning                                                    |
 * |---------------|------------|------------------------------------------------------------|
 * | BoneLevel     | 1          | Level                                                      |
 * | RemovedVolume | 1          | of the voxels at or above Level that were taken away, ml   |
 * | BridgedVolume | 1          | of the voxels below Level that were made bone, ml          |
 */
#ifndef vtkLacunaSkullBone_h
#define vtkLacunaSkullBone_h

#include "vtkImageAlgorithm.h"
#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersCranioplastyModule.h" // for export macro

#include <array> // for the proposed level

class vtkDataArray;
class vtkImageData;

class VTKLACUNAFILTERSCRANIOPLASTY_EXPORT vtkLacunaSkullBone
  : public vtkLacunaAlgorithmOf(vtkImageAlgorithm)
{
public:
  static vtkLacunaSkullBone* New();
  vtkTypeMacro(vtkLacunaSkullBone, vtkImageAlgorithm);

  static constexpr double Gap = 3;         ///< mm between the middles of voxels
  static constexpr double SmallPart = 1;   ///< ml
  static constexpr double MostBridge = 20; ///< mm

  ///@{
  /// Bone is at or above it, in the input's grey levels. Default 300 (Hounsfield units).
  vtkSetMacro(Level, double);
  vtkGetMacro(Level, double);
  ///@}

  ///@{
  /// Holes of the vault that are narrower are closed, mm: 0 (none, the default) to 20.
  vtkSetMacro(BridgeDiameter, double);
  vtkGetMacro(BridgeDiameter, double);
  ///@}

  /// Twice the level that a panel proposes for the input as it is now: 300 in Hounsfield units.
  double* GetProposedLevelRange() VTK_SIZEHINT(2);

  /// Closed surfaces whose inside is taken away, such as bone flaps and metal plates. Optional.
  void SetExcludeConnection(vtkAlgorithmOutput* output);
  void RemoveExclude();

protected:
  vtkLacunaSkullBone();
  ~vtkLacunaSkullBone() override = default;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaSkullBone(const vtkLacunaSkullBone&) = delete;
  void operator=(const vtkLacunaSkullBone&) = delete;
  // Throws for any image that is not possible.
  vtkDataArray* GetCheckedScalars(vtkImageData* input) const;

  double Level = 300;
  double BridgeDiameter = 0;
  std::array<double, 2> ProposedLevelRange{ 300, 300 };
};
#endif
