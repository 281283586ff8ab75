// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Default colour maps of the arrays that Lacuna makes, and what is written beside their scalar bars,
/// while the plugin is loaded. Colour maps that a user has saved for a name are of higher priority and
/// win. Where maps have no value nothing is drawn; in pictures of slices such pixels stand out.
#include "vtkSMSettings.h"

namespace
{
const bool Added = vtkSMSettings::GetInstance()->AddCollectionFromString(
  R"json({ "array_lookup_tables": {
  "Intensity": { "Title": "Grey level", "PVLookupTable": {
    "ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1], "NanColor": [1, 0, 0] } },
  "BoneEcho": { "Title": "Bone (surface at 0.5)", "PVLookupTable": {
    "ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 0, 1, 0.93, 0.89, 0.8] } },
  "HounsfieldUnits": { "Title": "Hounsfield units (HU)", "PVLookupTable": {
    "ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1] } },
  "Color": { "Title": "Brightness", "PVLookupTable": {
    "ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 0, 441.673, 1, 1, 1],
    "ScalarRangeInitialized": 1, "AutomaticRescaleRangeMode": -1 } },
  "Depth": { "Title": "Depth (mm)", "PVLookupTable": {
    "ColorSpace": "Lab", "RGBPoints":
    [0, 0.98, 0.95, 0.88, 0.5, 0.5, 0.64, 0.72, 1, 0.07, 0.17, 0.34], "NanOpacity": 0 } },
  "Fitted": { "Title": "Fitted depth (mm)", "PVLookupTable": {
    "ColorSpace": "Lab", "RGBPoints":
    [0, 0.98, 0.95, 0.88, 0.5, 0.5, 0.64, 0.72, 1, 0.07, 0.17, 0.34], "NanOpacity": 0 } },
  "Deviation": { "Title": "Deviation (mm)", "PVLookupTable": {
    "ColorSpace": "Diverging", "RGBPoints":
    [-1, 0.23, 0.3, 0.75, 0, 0.87, 0.87, 0.87, 1, 0.71, 0.02, 0.15],
    "ScalarRangeInitialized": 1, "AutomaticRescaleRangeMode": -1, "NanOpacity": 0 } },
  "Distance": { "Title": "Distance (mm)" },
  "Residual": { "Title": "Residual (mm)", "PVLookupTable": {
    "ColorSpace": "Diverging", "RGBPoints":
    [-1, 0.23, 0.3, 0.75, 0, 0.87, 0.87, 0.87, 1, 0.71, 0.02, 0.15] } },
  "Support": { "Title": "Distance from the data / their spacing", "PVLookupTable": {
    "ColorSpace": "Lab", "RGBPoints":
    [0, 0.1, 0.57, 0.5, 1, 0.87, 0.84, 0.77, 5, 0.85, 0.45, 0.1],
    "ScalarRangeInitialized": 1, "AutomaticRescaleRangeMode": -1 } },
  "Asymmetry": { "Title": "Asymmetry (given - mirrored)", "PVLookupTable": { "NanOpacity": 0 } },
  "Thickness": { "Title": "Thickness (mm)", "PVLookupTable": { "NanOpacity": 0 } },
  "NormalDifference": { "Title": "Normal difference (degrees)", "PVLookupTable": {
    "NanOpacity": 0 } },
  "OccludedAngle": { "Title": "Occluded angle (2-D: rad, 3-D: sr)" },
  "WallAngle": { "Title": "Wall angle (degrees)", "PVLookupTable": { "NanOpacity": 0 } },
  "LeftOver": { "Title": "Left over (mm)", "PVLookupTable": {
    "ColorSpace": "Lab", "RGBPoints":
    [0, 0.93, 0.93, 0.9, 0.5, 0.93, 0.62, 0.32, 1, 0.55, 0.06, 0.1], "NanOpacity": 0 } },
  "FeedRate": { "Title": "Feed rate (mm/min)" },
  "Speed": { "Title": "Speed (mm/s)" },
  "RegistrationError": { "Title": "Expected error (mm)" },
  "ExpectedError": { "Title": "Expected error (mm)" },
  "PositionError": { "Title": "Position error (mm)" },
  "SeparationError": { "Title": "Separation error (mm)" },
  "AngleError": { "Title": "Angle error (degrees)" },
  "vtkValidPointMask": { "Title": "Validity", "PVLookupTable": {
    "IndexedLookup": 1, "AnnotationsInitialized": 1,
    "Annotations": ["0", "no value", "1", "valid"],
    "IndexedColors": [1, 1, 0, 0.45, 0.55, 0.62] } },
  "FilledMask": { "Title": "Filling", "PVLookupTable": {
    "IndexedLookup": 1, "AnnotationsInitialized": 1,
    "Annotations": ["0", "as measured", "1", "filled"],
    "IndexedColors": [0.87, 0.84, 0.77, 0.85, 0.45, 0.1] } },
  "DefectMask": { "Title": "Defect", "PVLookupTable": {
    "IndexedLookup": 1, "AnnotationsInitialized": 1,
    "Annotations": ["0", "beside it", "1", "defect"],
    "IndexedColors": [0.87, 0.84, 0.77, 0.85, 0.45, 0.1] } },
  "SupportMask": { "Title": "Support of the fit", "PVLookupTable": {
    "IndexedLookup": 1, "AnnotationsInitialized": 1,
    "Annotations": ["0", "not used", "1", "used", "2", "beyond a depth step", "3", "used but steep", "4", "no prior surface", "5", "near a depth step"],
    "IndexedColors": [0.87, 0.84, 0.77, 0.1, 0.57, 0.5, 0.8, 0.2, 0.2, 0.55, 0.78, 0.4,
      0.5, 0.37, 0.7, 0.95, 0.75, 0.2] } },
  "Object": { "Title": "Object", "PVLookupTable": {
    "IndexedLookup": 1, "AnnotationsInitialized": 1,
    "Annotations": ["0", "outside", "1", "object"],
    "IndexedColors": [0.2, 0.23, 0.28, 0.9, 0.82, 0.7] } },
  "PlateFace": { "Title": "Face of the plate", "PVLookupTable": {
    "IndexedLookup": 1, "AnnotationsInitialized": 1,
    "Annotations": ["0", "outer", "1", "inner", "2", "edge", "3", "screw hole", "4", "drainage hole"],
    "IndexedColors": [0.8, 0.82, 0.85, 0.35, 0.55, 0.75, 0.9, 0.6, 0.2, 0.75, 0.2, 0.2,
      0.2, 0.6, 0.5] } },
  "ModelFace": { "Title": "Face of the model", "PVLookupTable": {
    "IndexedLookup": 1, "AnnotationsInitialized": 1,
    "Annotations": ["0", "bone", "1", "floor", "2", "wall", "3", "side", "4", "bottom"],
    "IndexedColors": [0.87, 0.84, 0.77, 0.85, 0.45, 0.1, 0.9, 0.65, 0.35, 0.55, 0.6, 0.66,
      0.35, 0.4, 0.46] } },
  "PressRegion": { "Title": "Press plane 0, flange 1, plate 2", "PVLookupTable": {
    "ColorSpace": "RGB", "RGBPoints":
    [0, 0.45, 0.5, 0.56, 1, 0.9, 0.65, 0.35, 2, 0.87, 0.84, 0.77] } },
  "Motion": { "Title": "Motion", "PVLookupTable": {
    "IndexedLookup": 1, "AnnotationsInitialized": 1,
    "Annotations": ["0", "rapid", "1", "plunge", "2", "cut", "3", "lead"],
    "IndexedColors": [0.85, 0.3, 0.25, 0.95, 0.7, 0.2, 0.2, 0.5, 0.75, 0.3, 0.7, 0.5] } }
  } })json",
  0.5);
}
