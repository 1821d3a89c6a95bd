#pragma once

#include "bespoke/error.h"

namespace bespoke {

/// A file's name ends in nothing that says a format known for its use: an argument that is wrong, whatever
/// the file holds.
class UnknownEnding : public InvalidInput {
  using InvalidInput::InvalidInput;
};

}  // namespace bespoke
