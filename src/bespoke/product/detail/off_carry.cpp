#include "bespoke/product/detail/off_text.h"
#include "bespoke/product/detail/product_formats.h"

namespace bespoke {

CarrySummary carry_off(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress) {
  const OffHeader header = read_off_header(file);
  return carry_text(file, outputs, OffText(file.path(), header), motion, progress);
}

}  // namespace bespoke
