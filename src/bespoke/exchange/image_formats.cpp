#include "bespoke/exchange/image_formats.h"

#include <fstream>

#include "bespoke/atomic_file.h"
#include "bespoke/error.h"
#include "bespoke/exchange/detail/image_files.h"
#include "bespoke/unknown_ending.h"

namespace bespoke {
namespace {

struct ImageFormat {
  std::string_view ending;
  bool says_world_space;
  void (*write)(std::ostream& out, const DisplacementImage& image, const ImageNotes& notes);
};

constexpr std::array image_formats{
    ImageFormat{".vti", false, &write_vti}, ImageFormat{".nrrd", true, &write_nrrd},
    ImageFormat{".nii.gz", true, &write_nifti_gz}, ImageFormat{".vdb", false, &write_vdb}};

const ImageFormat& format_of(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  for (const ImageFormat& format : image_formats)
    if (name.ends_with(format.ending)) return format;
  throw UnknownEnding(path.string() + ": unknown ending '" + path.extension().string() +
                      "'; displacement images are written as " + image_endings());
}

}  // namespace

void write_displacement_image(const std::filesystem::path& path, const DisplacementImage& image,
                              const ImageNotes& notes) {
  const ImageFormat& format = format_of(path);
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    format.write(out, image, notes);
    out.flush();
    if (!out) throw FileError(path.string() + ": cannot be written");
  });
}

void require_image_ending(const std::filesystem::path& path) { format_of(path); }

bool says_world_space(const std::filesystem::path& path) { return format_of(path).says_world_space; }

std::string image_endings() {
  std::string endings;
  for (const ImageFormat& format : image_formats)
    endings += (endings.empty() ? "" : ", ") + std::string(format.ending);
  return endings;
}

}  // namespace bespoke
