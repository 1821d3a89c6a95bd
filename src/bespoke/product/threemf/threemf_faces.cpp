#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/threemf/threemf_model.h"

namespace bespoke {
namespace {

// Objects may show others many times over; beyond these a file of a few lines would take all memory or time.
constexpr std::size_t max_triangles = 100'000'000;
constexpr std::size_t max_places = 1'000'000;
constexpr int deepest = 64;  // a circle of components has no end

class ThreemfFaces {
 public:
  explicit ThreemfFaces(const InputFile& file) : package_(file), gathered_(file.path()) {}

  Product read() {
    const std::string root = root_part_of_3mf(package_);
    for (const ThreemfPlace& item : part(root).items) show(item, root, {}, 0);
    Product product = gathered_.product(false);
    if (product.corners.empty()) fail(root, "its build shows no triangles");
    return product;
  }

 private:
  const ThreemfModel& part(const std::string& name) {
    const auto at = parts_.find(name);
    return at != parts_.end() ? at->second
                              : parts_.emplace(name, read_3mf_part(package_, name)).first->second;
  }

  void show(const ThreemfPlace& place, const std::string& from, const AffineMap& to_build, int depth) {
    const std::string line = ":" + std::to_string(place.line);
    const std::string& holder = place.part.empty() ? from : place.part;
    const ThreemfModel& model = part(holder);
    if (model.unit != part(from).unit) fail(holder, "is in another unit than " + from);
    const auto at = model.objects.find(place.object);
    if (at == model.objects.end())
      fail(from + line, "names the object " + std::to_string(place.object) + ", which is not in " + holder);
    if (depth == deepest) fail(from + line, "components nest too deep, or in a circle");
    if (++places_ > max_places) fail(from + line, "components show too many objects");
    const AffineMap combined{to_build.linear * place.to_outer.linear, to_build * place.to_outer.offset};
    add(at->second, combined, from + line);
    for (const ThreemfPlace& component : at->second.components) show(component, holder, combined, depth + 1);
  }

  void add(const ThreemfObject& object, const AffineMap& to_build, const std::string& where) {
    triangles_ += object.corners.size() / 3;
    vertices_ += object.coordinates.size() / 3;
    if (triangles_ > max_triangles || vertices_ > max_triangles)
      fail(where, "the build shows more than " + std::to_string(max_triangles) + " triangles or vertices");
    const double determinant = to_build.linear.determinant();
    if (!(std::abs(determinant) > 0)) fail(where, "its transform flattens the object");
    const Points vertices = Eigen::Map<const Points>(
        object.coordinates.data(), 3, static_cast<Eigen::Index>(object.coordinates.size() / 3));
    const auto first = static_cast<std::uint32_t>(vertices_ - object.coordinates.size() / 3);
    gathered_.add_points(to_build * vertices);
    std::vector<std::uint32_t> faces;
    for (std::size_t at = 0; at < object.corners.size(); at += 3) {
      const auto corner = [&](std::size_t k) {
        return first + static_cast<std::uint32_t>(object.corners[at + k]);
      };
      // A mirror image keeps its outside outside.
      if (determinant > 0)
        faces.insert(faces.end(), {3, corner(0), corner(1), corner(2)});
      else
        faces.insert(faces.end(), {3, corner(0), corner(2), corner(1)});
    }
    gathered_.add_faces(faces);
  }

  [[noreturn]] void fail(const std::string& where, const std::string& what) const {
    throw FormatError(package_.path().string() + ": " + where + ": " + what);
  }

  ZipFile package_;
  GatheredFaces gathered_;
  std::map<std::string, ThreemfModel> parts_;
  std::size_t places_ = 0, triangles_ = 0, vertices_ = 0;
};

}  // namespace

Product read_3mf_faces(const InputFile& file) { return ThreemfFaces(file).read(); }

}  // namespace bespoke
