#pragma once

#include <string>
#include <vector>

#include "bespoke/asset/asset.h"

namespace bespoke {

/// Something that two assets say of themselves in two ways.
struct FieldDifference {
  std::string name;  ///< for instance "tolerance" or "options.surface_fit.max_stretch"
  std::string a;     ///< as JSON; empty: not there
  std::string b;
};

/// A pair of anchors that two maps were not fitted to in the same way.
struct AnchorDifference {
  std::string name;                 ///< or its number, from 1, of pairs without one
  bool in_a = false, in_b = false;  ///< whether it is there
  double moved_source = 0;          ///< between the two, mesh units; 0 where it is in one alone
  double moved_target = 0;
  bool other_accuracy = false;  ///< weight or sigma
};

struct RecordDifference {
  std::vector<FieldDifference> fields;  ///< of models, methods, lengths, steps and options
  std::vector<AnchorDifference> anchors;

  bool is_empty() const { return fields.empty() && anchors.empty(); }
};

/// What two assets record differently, apart from what was found (errors, certificates, stages).
RecordDifference record_difference(const Asset& a, const Asset& b);

}  // namespace bespoke
