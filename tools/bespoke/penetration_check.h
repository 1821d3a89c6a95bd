#pragma once

#include <memory>
#include <string>

#include "bespoke/pipeline/open_map.h"

namespace bespoke::command {

/// Finds products that penetrate the target of their map, where both of its models are known.
class PenetrationCheck {
 public:
  /// The files of the models; nothing is checked where one is empty. Throws whatever reading throws.
  PenetrationCheck(const std::string& source, const std::string& target);
  ~PenetrationCheck();

  /// A warning, or nothing. Throws InvalidInput for models that the map was not made of.
  std::string operator()(const std::string& product, const OpenedMap& map) const;

 private:
  struct Models;
  std::unique_ptr<const Models> models_;
};

}  // namespace bespoke::command
