// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkLacunaScanRegion
 * @brief   Finds what the probe sees on the screen of a scanner, and the screen's ruler
 *
 * The scan region is the rectangle of a linear probe or the sector of a curved or phased one
 * (lacunaScanRegion.h); the ruler's ticks give the size of a pixel once it is told how many mm a
 * tick is (lacunaDepthRuler.h): the screen does not say, so it is never assumed.
 *
 * Input: vtkImageData, a picture of the screen or a stack of them such as tracked slices; colours
 * become grey. Spacing 1 along columns and rows. Pictures of VTK's readers of PNG, JPEG and BMP,
 * which begin with the bottom row, are counted from the top as vtkLacunaAssembleTrackedSlices does.
 *
 * Output port 0: vtkTable with the text columns Quantity, Value and Remark, to read. Port 1:
 * vtkPolyData in the image's coordinates, to see: lines with the cell data Part (0 the region's
 * border, 1 ClipRectangle, 2 ticks of the depth, 3 ticks of the width), in the plane of the first
 * slice.
 *
 * Field data of both, under the names of vtkLacunaSweptVolume's properties where they are such:
 * Confidence (0 to 1), ClipRectangle (4, pixels), of a sector FanOrigin (2, pixels), FanAngles (2,
 * degrees), FanRadiiInPixels (2, in widths of a pixel) and, when the size of a pixel is known,
 * FanRadii (2, mm). DepthTick and WidthTick (2 each: pixels from tick to tick, and their standard
 * deviation) where a ruler is found. PixelSpacing (2, mm a column and a row) when TickLength is given
 * and the depth ruler is found. PixelAspect (height by width of a pixel) when both rulers are found,
 * if a tick is as many mm in both.
 *
 * Where hardly anything changes, as in a dark bath, it is a proposal from all slices
 * (lacunaScanOutline.h), with Confidence below 0.5. Below that there is a warning.
 *
 * It is an error when the region is not found and none can be proposed; the text says why.
 *
 * @sa vtkLacunaSweptVolume
 */
#ifndef vtkLacunaScanRegion_h
#define vtkLacunaScanRegion_h

#include "vtkLacunaAlgorithm.h"
#include "vtkLacunaFiltersReconstructionModule.h" // for export macro
#include "vtkTableAlgorithm.h"

class VTKLACUNAFILTERSRECONSTRUCTION_EXPORT vtkLacunaScanRegion
  : public vtkLacunaAlgorithmOf(vtkTableAlgorithm)
{
public:
  static vtkLacunaScanRegion* New();
  vtkTypeMacro(vtkLacunaScanRegion, vtkTableAlgorithm);

  ///@{
  /// mm from tick to tick of the ruler, of the finest ticks; 0: not known. Default: 0.
  vtkSetMacro(TickLength, double);
  vtkGetMacro(TickLength, double);
  ///@}

  ///@{
  /// Height of a pixel by its width, above 0: a sector has round arcs only in the right one.
  /// Default: 1.
  vtkSetMacro(PixelAspect, double);
  vtkGetMacro(PixelAspect, double);
  ///@}

protected:
  vtkLacunaScanRegion();
  ~vtkLacunaScanRegion() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  void Make(const lacuna::Ports& ports, lacuna::AlgorithmExecution& execution) override;
  void Describe(lacuna::Properties& properties) const override;

private:
  vtkLacunaScanRegion(const vtkLacunaScanRegion&) = delete;
  void operator=(const vtkLacunaScanRegion&) = delete;

  double TickLength = 0;
  double PixelAspect = 1;
};
#endif
