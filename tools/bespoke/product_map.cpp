#include "product_map.h"

#include <cstdio>
#include <optional>
#include <system_error>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/lattice/part_map.h"
#include "bespoke/pipeline/open_map_part.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/posed_product.h"
#include "bespoke/product/product_io.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

// To know where its points are, a product is read once more, as faces in memory. Larger ones go through as
// they stream, and would have most of the map read anyway.
constexpr std::uintmax_t map_of_products = 8;

std::uintmax_t size_of(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  return error ? 0 : size;
}

/// The boxes of the products' vertices, in their own units; nothing where they are not known at a small part
/// of the map's cost.
std::optional<std::vector<Box>> boxes_of(const std::vector<std::string>& products, ModelPose pose,
                                         std::uintmax_t map_size) {
  std::uintmax_t size = 0;
  for (const std::string& product : products) {
    if (!can_read_product(product)) return std::nullopt;
    size += size_of(product);
  }
  if (size > map_size / map_of_products) return std::nullopt;
  std::vector<Box> boxes;
  try {
    for (const std::string& product : products) {
      const Points vertices = read_product(product, pose).vertices;
      Box& box = boxes.emplace_back();
      for (Eigen::Index i = 0; i < vertices.cols(); ++i) box.extend(Vector3(vertices.col(i)));
      if (box.isEmpty()) return std::nullopt;
    }
  } catch (const FormatError&) {
    return std::nullopt;  // it may be carried all the same, or is refused then
  }
  return boxes;
}

/// What the map is asked for, in its unit.
Box box_in_map(const std::vector<std::string>& products, const std::vector<Box>& boxes,
               const std::string& map_unit, const std::string& given) {
  Box all;
  for (std::size_t i = 0; i < products.size(); ++i) {
    const double scale = product_scale(products[i], map_unit, given);
    all.extend(Box(scale * boxes[i].min(), scale * boxes[i].max()));
  }
  return all;
}

}  // namespace

ProductMap::ProductMap(fs::path file, const std::vector<std::string>& products,
                       const ProductMapOptions& options, const RunContext& context)
    : file_(std::move(file)), options_(options), context_(context) {
  const bool is_partly_enough =
      options.form == MapForm::grids && !options.untrusted && !options.moves_points && !context.is_job;
  if (is_partly_enough && can_open_part(file_)) {
    if (const auto boxes = boxes_of(products, options.pose, size_of(file_))) {
      const Box stored = box_in_map(products, *boxes, {}, {});
      std::optional<OpenedPart> part = open_map_part(file_, stored);
      if (part) {
        const Box box = box_in_map(products, *boxes, part->map.unit, options_.unit);
        if (box.min() != stored.min() || box.max() != stored.max()) part = open_map_part(file_, box);
      }
      if (part) {
        map_ = std::make_shared<const OpenedMap>(std::move(part->map));
        bytes_read_ = part->bytes_read;
        file_bytes_ = part->file_bytes;
        return;
      }
    }
  }
  open_whole();
}

void ProductMap::open_whole() {
  bytes_read_ = file_bytes_ = 0;
  map_ = context_.maps.open(file_, options_.form, {.untrusted = options_.untrusted});
}

void ProductMap::use(const std::string& product, const std::function<void(const OpenedMap&)>& apply) {
  try {
    apply(*map_);
  } catch (const OutsidePart&) {
    context_.warn(
        product +
            ": its faces or parts need places of the map away from its own vertices, so all of the map "
            "is read; nothing needs to be done, it only takes longer",
        Entry::whole_map_read);
    open_whole();
    apply(*map_);
  }
}

std::string ProductMap::reading() const {
  constexpr double megabyte = 1e6;
  if (file_bytes_ == 0) return {};
  char text[80];
  std::snprintf(text, sizeof text, ": %.1f of %.1f MB read", static_cast<double>(bytes_read_) / megabyte,
                static_cast<double>(file_bytes_) / megabyte);
  return file_.string() + text;
}

}  // namespace bespoke::command
