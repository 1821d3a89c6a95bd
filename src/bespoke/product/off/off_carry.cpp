#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/off/off_text.h"

namespace bespoke {

CarrySummary carry_off(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress) {
  const OffHeader header = read_off_header(file);
  return carry_text(file, outputs, OffText(file.path(), header), motion, progress);
}

}  // namespace bespoke
