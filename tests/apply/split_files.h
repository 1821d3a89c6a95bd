#pragma once

#include <string>

#include "apply/motions.h"
#include "bespoke/apply/detail/refine_product.h"
#include "bespoke/product/carry_product.h"
#include "product/product_files.h"

namespace bespoke::test {

class SplitFiles : public ProductFiles {
 protected:
  /// The file with its edges split for a chord error under `bend`, otherwise as it was.
  std::string split(const std::string& name, const std::string& content, double length) {
    const std::filesystem::path in = file(name, content), out = directory_ / ("out_" + name);
    refined_ = refine_product(read_product(in), bend, length);
    carry_product(in, {out}, identity_motion(), {{}, {}, &refined_.splits});
    return read_text(out);
  }

  RefinedProduct refined_;
};

}  // namespace bespoke::test
