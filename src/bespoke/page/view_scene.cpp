#include "bespoke/page/view_scene.h"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "bespoke/anchors/anchor_audit.h"
#include "bespoke/error.h"
#include "bespoke/page/detail/display_mesh.h"
#include "bespoke/page/detail/input_quality.h"
#include "bespoke/page/detail/mesh_record.h"
#include "bespoke/page/detail/packed_arrays.h"
#include "bespoke/page/detail/places.h"
#include "bespoke/page/detail/shown_unit.h"
#include "bespoke/page/detail/space_samples.h"
#include "bespoke/page/detail/vertex_fields.h"
#include "bespoke/quality/signed_distance.h"
#include "bespoke/report/inspection.h"
#include "bespoke/report/quality_report.h"

namespace bespoke {
namespace {

// Space around the source that slices show, beyond source and products: a sixth of the diagonal.
constexpr double space_margin = 1.0 / 6;

// Below a millionth of the diagonal nothing is worth a triangle's place: meshes get at least this many.
constexpr std::size_t min_faces = 1000;

/// Times between which the motion's elastic part is straight.
std::vector<double> knots_of(const Asset& asset) {
  const std::size_t pieces = asset.path == RotationPath::flow ? asset.steps.size() : 1;
  std::vector<double> knots;
  for (std::size_t k = 0; k <= pieces; ++k)
    knots.push_back(static_cast<double>(k) / static_cast<double>(pieces));
  return knots;
}

class SceneMaker {
 public:
  SceneMaker(const ViewInput& input, const ViewOptions& options)
      : input_(input),
        options_(options),
        rigid_(input.asset.target_from_source),
        chain_(loaded_chain(input.asset.steps)),
        knots_(knots_of(input.asset)) {}

  std::string make(const Progress& progress) {
    Json record = {{"page", "view"},
                   {"title", input_.title},
                   {"unit", shown_unit(input_.asset)},
                   {"command", input_.command},
                   {"diagonal", diagonal(input_.source.vertices)},
                   {"motion", motion()}};
    record["meshes"] = meshes(progress);
    record["anchors"] = anchors();
    record["places"] = Json::array();
    for (const Place& place : places_to_see(input_.asset, input_.source, input_.findings))
      record["places"].push_back({{"kind", place.kind},
                                  {"text", place.text},
                                  {"at", to_json(place.at)},
                                  {"side", "source"},
                                  {"value", nullptr}});
    record["lattice"] = lattice();
    record["levels"] = levels();
    record["patterns"] = patterns();
    record["info"] = Json::parse(inspection_json(input_.asset));
    record["quality"] = quality(progress);
    record["notes"] = {
        "Carried vertices are rounded to 65,536 steps of their box: within 1e-5 of its diagonal of what "
        "apply writes, at every t.",
        "Values are those at vertices. Stretch is of the surface, clearance the distance from the model with "
        "its side; grey is not known."};
    for (const std::string& note : input_.notes) record["notes"].push_back(note);
    return packed_scene(record, arrays_);
  }

 private:
  Json motion() const {
    return {{"rotation", to_json(rigid_.rotation)},
            {"translation", to_json(rigid_.translation)},
            {"path", name_of(rotation_paths, input_.asset.path)},
            {"knots", knots_}};
  }

  std::vector<Points> at_knots(const Points& x) const {
    if (knots_.size() == 2) return {x, chain_(x)};
    return chain_.at(x, knots_);
  }

  Points carried(const Points& x) const { return rigid_ * chain_(x); }

  std::size_t faces_for(const TriangleMesh& mesh) const {
    auto all = static_cast<double>(input_.source.faces.cols() + input_.target.faces.cols());
    for (const NamedProduct& product : input_.products) all += static_cast<double>(product.mesh.faces.cols());
    const double share = std::min(1.0, static_cast<double>(options_.max_faces) / all);
    return std::max(min_faces,
                    static_cast<std::size_t>(std::ceil(share * static_cast<double>(mesh.faces.cols()))));
  }

  Json meshes(const Progress& progress) {
    const SignedDistance from_source(input_.source), from_target(input_.target);
    Json meshes = Json::array();
    progress.step("colours", 0, input_.products.size() + 2);
    meshes.push_back(source_mesh(from_target));
    meshes.push_back(target_mesh());
    for (std::size_t i = 0; i < input_.products.size(); ++i) {
      progress.step("colours", meshes.size(), input_.products.size() + 2);
      meshes.push_back(product_mesh(i, from_source, from_target));
    }
    return meshes;
  }

  Json source_mesh(const SignedDistance& from_target) {
    const DisplayMesh display = display_mesh(input_.source, faces_for(input_.source));
    const Points x = display.shown(input_.source.vertices);
    std::vector<VertexField> fields{
        distance_field("target_distance", "distance to the target, carried", from_target, carried(x))};
    for (VertexField& field : deformation_fields(chain_, x, display.shown(vertex_normals(input_.source))))
      fields.push_back(std::move(field));
    add_findings(display, fields);
    return record("source", "source", input_.source, display, at_knots(x), fields);
  }

  /// Confidence, and how far the map misses the fitted place of vertices.
  void add_findings(const DisplayMesh& display, std::vector<VertexField>& fields) const {
    const auto shown = [&](const std::vector<double>& all) {
      std::vector<double> values;
      for (const int vertex : display.original) values.push_back(all[static_cast<std::size_t>(vertex)]);
      return values;
    };
    const auto count = static_cast<std::size_t>(input_.source.vertices.cols());
    const std::vector<double>& confidence = input_.findings.confidence;
    if (!confidence.empty()) {
      if (confidence.size() != count)
        throw InvalidInput("the confidences are " + std::to_string(confidence.size()) +
                           ", the source's vertices " + std::to_string(count));
      fields.push_back(
          {"confidence", "confidence of the surface fit", false, std::nullopt, shown(confidence)});
    }
    if (!input_.findings.unmet) return;
    std::vector<double> missed(count, 0.0);
    for (const FitFindings::Unmet& unmet : *input_.findings.unmet)
      if (unmet.vertex >= 0 && static_cast<std::size_t>(unmet.vertex) < count)
        missed[static_cast<std::size_t>(unmet.vertex)] = unmet.residual;
    fields.push_back({"unmet", "unmet by", true, std::nullopt, shown(missed)});
  }

  Json target_mesh() {
    const DisplayMesh display = display_mesh(input_.target, faces_for(input_.target));
    const Points x = display.shown(input_.target.vertices);
    const SignedDistance from_carried({carried(input_.source.vertices), input_.source.faces});
    return record("target", "target", input_.target, display, {x},
                  {distance_field("source_distance", "distance to the source, carried", from_carried, x)});
  }

  /// Pieces name the triangles of their product, so that stays whole.
  std::size_t faces_for_product(std::size_t number) const {
    const TriangleMesh& mesh = input_.products[number].mesh;
    for (const ProductPattern& pattern : input_.patterns)
      if (pattern.product == number) return static_cast<std::size_t>(mesh.faces.cols());
    return faces_for(mesh);
  }

  Json product_mesh(std::size_t number, const SignedDistance& from_source,
                    const SignedDistance& from_target) {
    const NamedProduct& product = input_.products[number];
    const DisplayMesh display = display_mesh(product.mesh, faces_for_product(number));
    const Points x = display.shown(product.mesh.vertices), as_carried = carried(x);
    const bool is_corrected = !input_.corrected.empty();
    const Points after = is_corrected ? display.shown(input_.corrected[number]) : as_carried;
    std::vector<VertexField> fields = clearance_fields(from_source, from_target, x, after);
    if (is_corrected) {
      fields.push_back(carried_clearance_field(from_target, as_carried));
      fields.push_back(move_field(as_carried, after));
    }
    for (VertexField& field : deformation_fields(chain_, x, display.shown(vertex_normals(product.mesh))))
      fields.push_back(std::move(field));
    std::vector<Points> knots = at_knots(x);
    if (is_corrected) knots.back() = inverse(rigid_) * after;
    return record("product", product.name, product.mesh, display, knots, fields);
  }

  Json record(const char* role, const std::string& name, const TriangleMesh& whole,
              const DisplayMesh& display, const std::vector<Points>& knots,
              const std::vector<VertexField>& fields) {
    return mesh_record({role, name, whole, display, knots, fields, shown_unit(input_.asset)}, arrays_);
  }

  Json anchors() const {
    Anchors pairs;
    for (const AnchorRecord& anchor : input_.asset.record.anchors)
      pairs.pairs.push_back({anchor.name, anchor.a, anchor.b, anchor.weight});
    std::vector<std::string> suspicions(pairs.pairs.size());
    for (const SuspiciousAnchor& suspicious : audit_anchors(pairs).suspicious)
      suspicions[suspicious.index] = suspicious.swapped_with
                                         ? "perhaps swapped with " + label(pairs, *suspicious.swapped_with)
                                         : "far from where the other pairs put it";
    const Points images = carried(source_points(pairs));
    Json list = Json::array();
    for (std::size_t i = 0; i < pairs.pairs.size(); ++i) {
      const AnchorRecord& anchor = input_.asset.record.anchors[i];
      list.push_back({{"name", anchor.name},
                      {"a", to_json(anchor.a)},
                      {"b", to_json(anchor.b)},
                      {"image", to_json(Vector3(images.col(static_cast<Eigen::Index>(i))))},
                      {"residual", anchor.residual},
                      {"sigma", anchor.sigma > 0 ? Json(anchor.sigma) : Json()},
                      {"weight", std::isfinite(anchor.weight) ? Json(anchor.weight) : Json()},
                      {"suspicion", suspicions[i].empty() ? Json() : Json(suspicions[i])}});
    }
    return list;
  }

  Json lattice() {
    Box box = bounding_box(input_.source.vertices);
    for (const NamedProduct& product : input_.products) box.extend(bounding_box(product.mesh.vertices));
    const Vector3 margin = Vector3::Constant(space_margin * box.diagonal().norm());
    const SpaceLattice space = space_lattice(Box(box.min() - margin, box.max() + margin),
                                             options_.space_samples / (knots_.size() - 1));
    const Points nodes = space.nodes();
    const std::vector<Points> images = at_knots(nodes);
    Json places = Json::array();
    for (std::size_t k = 1; k < images.size(); ++k) places.push_back(arrays_.add_points(images[k]));
    return {{"origin", to_json(space.lattice.origin)},
            {"spacing", space.lattice.voxel_size},
            {"size", space.size},
            {"places", std::move(places)},
            {"determinant", arrays_.add_values(determinants(chain_, nodes))}};
  }

  Json levels() {
    Json list = Json::array();
    for (std::size_t step = 0; step < input_.asset.steps.size(); ++step) {
      const Pyramid& pyramid = input_.asset.steps[step].pyramid;
      for (std::size_t k = 0; k < pyramid.levels.size(); ++k) {
        const PyramidLevel& level = pyramid.levels[k];
        Points corners(3, static_cast<Eigen::Index>(level.leaves.size()));
        for (std::size_t leaf = 0; leaf < level.leaves.size(); ++leaf)
          corners.col(static_cast<Eigen::Index>(leaf)) =
              pyramid.lattice(static_cast<int>(k))(first_node(level.leaves[leaf]));
        list.push_back({{"step", step},
                        {"level", k},
                        {"voxel_size", level.voxel_size},
                        {"leaf_size", leaf_edge * level.voxel_size},
                        {"leaves", arrays_.add_points(corners)}});
      }
    }
    return list;
  }

  Json piece(const WrittenPiece& piece) {
    const auto numbers = [&](const std::vector<int>& all) {
      return arrays_.add(std::vector<std::uint32_t>(all.begin(), all.end()), 32);
    };
    return {{"name", piece.name},
            {"places", arrays_.add_points(piece.places)},
            {"faces", arrays_.add_faces(piece.faces)},
            {"outline", numbers(piece.outline)},
            {"product_faces", numbers(piece.product_faces)},
            {"strain", arrays_.add_values(piece.strain)}};
  }

  Json patterns() {
    constexpr std::size_t first_product = 2;  // behind source and target
    Json list = Json::array();
    for (const ProductPattern& of_product : input_.patterns) {
      Json pieces = Json::array();
      for (const WrittenPiece& written : of_product.pattern.pieces) pieces.push_back(piece(written));
      list.push_back({{"mesh", first_product + of_product.product}, {"pieces", std::move(pieces)}});
    }
    return list;
  }

  Json quality(const Progress& progress) const {
    return Json::parse(quality_json(input_quality(input_, chain_, progress), product_names(input_),
                                    input_.asset.record.unit));
  }

  const ViewInput& input_;
  const ViewOptions& options_;
  const RigidTransform& rigid_;
  const ElasticChain chain_;
  const std::vector<double> knots_;
  PackedArrays arrays_;
};

}  // namespace

std::string view_scene(const ViewInput& input, const ViewOptions& options, const Progress& progress) {
  require_valid(input.source, "source");
  require_valid(input.target, "target");
  if (options.max_faces == 0 || options.space_samples < 8)
    throw InvalidInput("a scene of " + std::to_string(options.max_faces) + " faces and " +
                       std::to_string(options.space_samples) + " samples of space: at least 1 and 8");
  for (const ProductPattern& of_product : input.patterns) {
    if (of_product.product >= input.products.size())
      throw InvalidInput(of_product.pattern.path + ": there is no product that its pieces are of");
    const NamedProduct& product = input.products[of_product.product];
    require_pattern_of(of_product.pattern, product.name, product.mesh.faces.cols());
  }
  if (!input.corrected.empty() && input.corrected.size() != input.products.size())
    throw InvalidInput(std::to_string(input.corrected.size()) + " corrected products of " +
                       std::to_string(input.products.size()));
  for (std::size_t i = 0; i < input.corrected.size(); ++i)
    if (input.corrected[i].cols() != input.products[i].mesh.vertices.cols())
      throw InvalidInput(input.products[i].name + ": " + std::to_string(input.corrected[i].cols()) +
                         " corrected vertices of " + std::to_string(input.products[i].mesh.vertices.cols()));
  return SceneMaker(input, options).make(progress);
}

}  // namespace bespoke
