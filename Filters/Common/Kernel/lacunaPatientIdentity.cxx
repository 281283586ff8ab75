// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaPatientIdentity.h"

#include <algorithm>
#include <iterator>
#include <string>

namespace lacuna
{
namespace
{
// In lower case, letters and digits only, as MakeKey leaves names.
constexpr std::string_view Geometry[] = { "patientposition", "patientorientation",
  "imagepositionpatient", "imageorientationpatient" };

constexpr std::string_view Parts[] = { "patient", "physician", "operator", "institution", "birth",
  "surname", "lastname", "firstname", "givenname", "familyname", "middlename", "personname",
  "medicalrecord" };

constexpr std::string_view Keywords[] = { "accessionnumber", "acquisitiondate",
  "acquisitiondatetime", "admissionid", "admittingdate", "contentcreatorsname", "contentdate",
  "countryofresidence", "currentdepartment", "dob", "ethnicgroup", "fillerordernumber",
  "imagecomments", "insuranceplanidentification", "instancecreationdate", "issuerofadmissionid",
  "militaryrank", "mrn", "nameofphysiciansreadingstudy", "namesofintendedrecipientsofresults",
  "occupation", "orderenteredby", "placerordernumber", "regionofresidence", "requestingservice",
  "requestedprocedureid", "responsibleorganization", "responsibleperson", "reviewername",
  "scheduledprocedurestepid", "performedprocedurestepid", "seriesdate", "seriesinstanceuid",
  "socialsecuritynumber", "sopinstanceuid", "ssn", "stationname", "studycomments", "studydate",
  "studydescription", "studyid", "studyinstanceuid", "telephonenumber", "telephonenumbers",
  "verifyingobservername", "verifyingorganization", "visitcomments" };

// Of the same attributes; all of group 0010, the patient's, identify without being listed.
constexpr std::string_view Tags[] = { "00080012", "00080018", "00080020", "00080021", "00080022",
  "00080023", "0008002a", "00080050", "00080080", "00080081", "00080082", "00080090", "00080092",
  "00080094", "00080096", "0008009c", "0008009d", "00081010", "00081030", "00081040", "00081041",
  "00081048", "00081049", "00081050", "00081052", "00081060", "00081062", "00081070", "00081072",
  "00081080", "0020000d", "0020000e", "00200010", "00204000", "00321032", "00321033", "00324000",
  "00380010", "00380011", "00380020", "00380300", "00380400", "00384000", "00400006", "00400009",
  "00400253", "00401001", "00402008", "00402010", "00402016", "00402017", "0040a027", "0040a075",
  "0040a123" };

std::string MakeKey(std::string_view name)
{
  std::string key;
  for (const char c : name)
  {
    const char lower = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if ((lower >= 'a' && lower <= 'z') || (lower >= '0' && lower <= '9'))
    {
      key += lower;
    }
  }
  return key;
}

template <class List>
bool Has(const List& list, std::string_view key)
{
  return std::find(std::begin(list), std::end(list), key) != std::end(list);
}

bool IsTag(std::string_view key)
{
  return key.size() == 8 &&
    std::all_of(key.begin(), key.end(),
      [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}
}

bool IdentifiesPatient(std::string_view name)
{
  const std::string key = MakeKey(name);
  if (Has(Geometry, key))
  {
    return false;
  }
  // ITK and its kin put a word before a tag: "DICOM.0010,0010", "dicom:0010|0010"
  const std::string_view tag =
    key.rfind("dicom", 0) == 0 ? std::string_view(key).substr(5) : std::string_view(key);
  if (IsTag(tag))
  {
    return tag.substr(0, 4) == "0010" || Has(Tags, tag);
  }
  return std::any_of(std::begin(Parts), std::end(Parts),
           [&](std::string_view part) { return key.find(part) != std::string::npos; }) ||
    Has(Keywords, tag);
}
}
