#include <ostream>

#include "bespoke/asset/vector_grid.h"
#include "bespoke/exchange/detail/image_files.h"

namespace bespoke {

void write_vdb(std::ostream& out, const DisplacementImage& image, const ImageNotes& notes) {
  const std::string bytes =
      vdb_of_one_grid({"displacement", notes.content, image.origin, image.spacing, image.size, image.values});
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace bespoke
