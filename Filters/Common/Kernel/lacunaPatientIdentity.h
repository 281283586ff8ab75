// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The one rule for what readers, writers and live sources leave out because it identifies a
/// patient.
#ifndef lacunaPatientIdentity_h
#define lacunaPatientIdentity_h

#include <string_view>

namespace lacuna
{
/// Whether a field of this name may identify the patient or who treats them. Letter case, blanks and
/// punctuation do not count. A name identifies when
///
/// - it contains "patient": all but DICOM's four attributes of geometry (PatientPosition,
///   PatientOrientation, ImagePositionPatient, ImageOrientationPatient);
/// - it contains "physician", "operator", "institution" or "birth", or the like;
/// - it is the keyword of another identifying attribute of DICOM (PS3.15, table E.1-1), such as
///   AccessionNumber or StudyID;
/// - it is the tag of such an attribute, as ITK writes it: "0010|0010", "(0010,0010)".
///
/// What describes the scan and the device, not the person, is kept: modality, protocol, series
/// number, kernel, manufacturer. lacunaSequenceText.h looks at texts, too, and keeps transforms.
bool IdentifiesPatient(std::string_view name);
}
#endif
