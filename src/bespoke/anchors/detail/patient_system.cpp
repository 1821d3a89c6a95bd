#include "bespoke/anchors/detail/patient_system.h"

#include "bespoke/error.h"

namespace bespoke {

Vector3 in_system(const Vector3& x, PatientSystem from, PatientSystem to) {
  return from == to ? x : Vector3(-x.x(), -x.y(), x.z());
}

PatientSystem patient_system_named(const std::string& name, const std::string& where) {
  if (name == "LPS" || name == "1") return PatientSystem::lps;
  if (name == "RAS" || name == "0") return PatientSystem::ras;
  throw FormatError(where + ": the coordinate system is \"" + name.substr(0, 40) + "\", not LPS or RAS");
}

}  // namespace bespoke
