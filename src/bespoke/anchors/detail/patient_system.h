#pragma once

#include <string>

#include "bespoke/anchors/anchor_files.h"

namespace bespoke {

/// LPS and RAS differ by half a turn about z; twice is none.
Vector3 in_system(const Vector3& x, PatientSystem from, PatientSystem to);

/// By the name that files have, or by 3D Slicer's older number for it. Throws FormatError "where: …".
PatientSystem patient_system_named(const std::string& name, const std::string& where);

}  // namespace bespoke
