#include "command/example_pair.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "support/shapes.h"

namespace bespoke::test {
namespace {

const Vector3 source_radii(1, 1.4, 0.8);
const Vector3 target_radii(1.1, 1.3, 0.95);

Matrix3 target_rotation() { return Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix(); }

Vector3 on_source(const Vector3& direction) { return source_radii.cwiseProduct(direction); }

Vector3 on_target(const Vector3& direction) {
  return target_rotation() * target_radii.cwiseProduct(direction) + Vector3(3, -1, 2);
}

Points mapped(const Points& directions, Vector3 (*map)(const Vector3&)) {
  Points points(3, directions.cols());
  for (Eigen::Index i = 0; i < directions.cols(); ++i) points.col(i) = map(directions.col(i));
  return points;
}

std::string triple(const Vector3& v) {
  std::ostringstream text;
  text.precision(17);
  text << "[" << v.x() << "," << v.y() << "," << v.z() << "]";
  return text.str();
}

/// The six axes and eight diagonals.
std::vector<Vector3> anchor_directions() {
  std::vector<Vector3> directions;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        const int length = std::abs(x) + std::abs(y) + std::abs(z);
        if (length == 1 || length == 3) directions.push_back(Vector3(x, y, z).normalized());
      }
  return directions;
}

std::string anchors_json() {
  std::string pairs;
  const std::vector<Vector3> directions = anchor_directions();
  for (std::size_t i = 0; i < directions.size(); ++i)
    pairs += std::string(i ? "," : "") + "\n {\"name\":\"p" + std::to_string(i) +
             "\",\"a\":" + triple(on_source(directions[i])) + ",\"b\":" + triple(on_target(directions[i])) +
             "}";
  return "{\"units\":\"cm\",\"pairs\":[" + pairs + "]}\n";
}

/// 9×9×9 points from inside the source to well outside the band, in one row of triangles.
std::string product_text() {
  constexpr int edge = 9;
  Points vertices(3, edge * edge * edge);
  Faces faces(3, vertices.cols() - 2);
  for (int i = 0; i < vertices.cols(); ++i)
    vertices.col(i) = 0.5 * Vector3(i / (edge * edge) - 4, i / edge % edge - 4, i % edge - 4);
  for (int i = 0; i < faces.cols(); ++i) faces.col(i) << i, i + 1, i + 2;
  return obj_text(vertices, faces);
}

}  // namespace

ExamplePair::ExamplePair() {
  const TriangleMesh coarse = shapes::icosphere(3);
  const TriangleMesh other = shapes::moved(
      shapes::icosphere(3), {Eigen::AngleAxisd(0.3, Vector3::UnitX()).toRotationMatrix(), Vector3::Zero()});
  write_text(file("source.obj"), obj_text(mapped(coarse.vertices, on_source), coarse.faces));
  write_text(file("target.obj"), obj_text(mapped(other.vertices, on_target), other.faces));
  write_text(file("anchors.json"), anchors_json());
  write_text(file("product.obj"), product_text());
}

std::vector<std::string> ExamplePair::files() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory_.path()))
    names.push_back(std::filesystem::relative(entry.path(), directory_.path()).string());
  std::sort(names.begin(), names.end());
  return names;
}

ProgramResult ExamplePair::fit(const std::string& map, const std::vector<std::string>& extra) const {
  std::vector<std::string> arguments{
      "fit", file("source.obj"), file("target.obj"), "--anchors", file("anchors.json"), "-o", file(map)};
  const bool chooses_resolution = std::any_of(extra.begin(), extra.end(), [](const std::string& option) {
    return option.starts_with("--tolerance") || option == "--voxel-size" || option == "--max-memory";
  });
  if (!chooses_resolution) arguments.insert(arguments.end(), {"--tolerance", "0.5%"});
  arguments.insert(arguments.end(), extra.begin(), extra.end());
  return bespoke(arguments);
}

ProgramResult ExamplePair::apply(const std::string& map, const std::vector<std::string>& extra) const {
  std::vector<std::string> arguments{"apply", file(map), file("product.obj")};
  arguments.insert(arguments.end(), extra.begin(), extra.end());
  return bespoke(arguments);
}

ProgramResult bespoke(const std::vector<std::string>& arguments) {
  std::vector<std::string> all{BESPOKE_COMMAND};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return run_program(all);
}

Points read_obj_points(const std::string& path) {
  std::istringstream text(read_text(path));
  std::vector<Vector3> found;
  for (std::string line; std::getline(text, line);) {
    Vector3 v;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &v.x(), &v.y(), &v.z()) == 3) found.push_back(v);
  }
  Points points(3, static_cast<Eigen::Index>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) points.col(static_cast<Eigen::Index>(i)) = found[i];
  return points;
}

double float_rounding(const Points& points) {
  const double unit_roundoff = 0x1p-24;
  return std::sqrt(3.0) * unit_roundoff * points.cwiseAbs().maxCoeff();
}

double extent(const Points& points) {
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

std::string obj_text(const Points& vertices, const Faces& faces) {
  std::ostringstream text;
  text.precision(9);
  for (Eigen::Index i = 0; i < vertices.cols(); ++i)
    text << "v " << vertices(0, i) << ' ' << vertices(1, i) << ' ' << vertices(2, i) << '\n';
  for (Eigen::Index i = 0; i < faces.cols(); ++i)
    text << "f " << faces(0, i) + 1 << ' ' << faces(1, i) + 1 << ' ' << faces(2, i) + 1 << '\n';
  return text.str();
}

}  // namespace bespoke::test
