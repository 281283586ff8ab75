// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The scans on which laterality and position are proven.
#ifndef CTTestCases_h
#define CTTestCases_h

#include "CTTestSeries.h"

#include <map>
#include <string>

/// Scans that make a volume of exactly their pixels, by name (of a folder).
std::map<std::string, CTTestSeries> MakeExactCases();
/// Scans with a tilted gantry, which are resampled.
std::map<std::string, CTTestSeries> MakeTiltedCases();
/// The letter as a body whose surface has 300 HU, with 100 HU more for each mm inwards.
std::map<std::string, CTTestSeries> MakeBodyCases();
#endif
