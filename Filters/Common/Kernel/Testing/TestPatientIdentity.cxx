// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPatientIdentity.h"

#include <gtest/gtest.h>

using namespace lacuna;

TEST(PatientIdentity, IsFoundAnywhereInAName)
{
  for (const char* name : { "PatientName", "StudyPatientName", "patientID", "OTHER_PATIENT_IDS",
         "Patient's Name", "OutpatientClinic", "patient birth date", "DateOfBirth", "Birth-Name",
         "ReferringPhysicianName", "PhysiciansOfRecord", "NameOfPhysiciansReadingStudy",
         "OperatorsName", "Operator", "InstitutionName", "Institutional Department Name",
         "AccessionNumber", "StudyID", "study-id", "MedicalRecordLocator", "StationName",
         "SeriesInstanceUID", "MRN", "Family Name", "EthnicGroup", "DICOM.PatientName",
         "DICOM.StudyDate" })
  {
    EXPECT_TRUE(IdentifiesPatient(name)) << name;
  }
}

TEST(PatientIdentity, IsFoundByTagsOfDicom)
{
  for (const char* name : { "0010|0010", "(0010,0020)", "0010 1040", "00101000", "0008|0050",
         "(0008,0080)", "0008|1070", "0020|000D", "dicom:0010|0030", "0040|a123" })
  {
    EXPECT_TRUE(IdentifiesPatient(name)) << name;
  }
  for (const char* name : { "0008|0060", "0018|0050", "0020|0032", "0028|1052", "(0018,5100)" })
  {
    EXPECT_FALSE(IdentifiesPatient(name)) << name;
  }
}

TEST(PatientIdentity, LeavesGeometryAndDevices)
{
  for (const char* name : { "PatientPosition", "patient_orientation", "ImagePositionPatient",
         "ImageOrientationPatient", "ImageOrientation(Patient)", "ProbeToTrackerTransform",
         "Timestamp", "FrameNumber", "ImageStatus", "ElementSpacing", "Modality", "ProtocolName",
         "SeriesNumber", "ConvolutionKernel", "Manufacturer", "Note", "DobbsFilter", "", "To",
         "LacunaProvenance0", "FirstColumn" })
  {
    EXPECT_FALSE(IdentifiesPatient(name)) << name;
  }
}
