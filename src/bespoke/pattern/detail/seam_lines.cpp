#include "bespoke/pattern/detail/seam_lines.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/pattern/detail/convex_parts.h"
#include "bespoke/topology/seams.h"

namespace bespoke {
namespace {

// Of an edge: points nearer to one another, or to its ends, are one.
constexpr double one_place = 1e-6;

std::string numbered(int vertex) { return std::to_string(vertex + 1); }

class LineCutter {
 public:
  LineCutter(const Garment& garment, const SeamFile& seams)
      : garment_(garment),
        joined_(joined_at_seams(garment.mesh)),
        edges_(mesh_edges(joined_.mesh)),
        points_of_edge_(edges_.edges.size()),
        faces_of_vertex_(joined_.first.size()) {
    result_.seams = seams;
    for (int f = 0; f < static_cast<int>(joined_.mesh.faces.cols()); ++f)
      for (const int v : joined_.mesh.faces.col(f)) faces_of_vertex_[index(v)].push_back(f);
  }

  FacesAlongLines run() {
    std::vector<std::vector<int>> lines;  // points by number
    for (const SeamCut& cut : result_.seams.cuts) {
      lines.emplace_back();
      for (const EdgePoint& point : cut.line)
        if (const int p = number_of(point, lines.size()); lines.back().empty() || lines.back().back() != p)
          lines.back().push_back(p);
    }
    for (std::size_t s = 0; s < lines.size(); ++s)
      for (std::size_t k = 0; k + 1 < lines[s].size(); ++k) add_part(s, k, lines[s]);
    cut_faces();
    for (std::size_t s = 0; s < lines.size(); ++s) set_edges(s);
    return std::move(result_);
  }

 private:
  /// A part of a line: along an edge, or through a face.
  struct Part {
    int from = 0, to = 0;
    std::optional<int> edge, face;
  };

  static std::size_t index(int number) { return static_cast<std::size_t>(number); }
  int own_count() const { return static_cast<int>(garment_.mesh.vertices.cols()); }
  bool is_added(int point) const { return point >= own_count(); }
  int joined(int vertex) const { return joined_.of_vertex[index(vertex)]; }

  std::optional<int> edge_between(int a, int b) const {
    const std::pair<int, int> key = std::minmax({joined(a), joined(b)});
    const auto found =
        std::lower_bound(edges_.edges.begin(), edges_.edges.end(), key,
                         [](const MeshEdge& edge, const auto& k) { return std::pair(edge.a, edge.b) < k; });
    if (found == edges_.edges.end() || std::pair(found->a, found->b) != key) return {};
    return static_cast<int>(found - edges_.edges.begin());
  }

  /// Of a vertex its own number, joined; of a point on an edge that of an added vertex.
  int number_of(const EdgePoint& point, std::size_t seam) {
    const auto own = [&](int vertex) { return joined_.first[index(joined(vertex))]; };
    if (point.a == point.b || point.share < one_place) return own(point.a);
    if (point.share > 1 - one_place) return own(point.b);
    const std::optional<int> edge = edge_between(point.a, point.b);
    if (!edge)
      throw InvalidInput(garment_.path + ": seam " + std::to_string(seam) + ": no edge joins vertices " +
                         numbered(point.a) + " and " + numbered(point.b));
    const MeshEdge& of = edges_.edges[index(*edge)];
    const double share = joined(point.a) == of.a ? point.share : 1 - point.share;
    for (const auto& [at, vertex] : points_of_edge_[index(*edge)])
      if (std::abs(at - share) < one_place) return vertex;
    result_.added.push_back(
        {{joined_.first[index(of.a)], joined_.first[index(of.b)], joined_.first[index(of.b)]},
         {1 - share, share, 0}});
    edge_of_added_.push_back(*edge);
    const int vertex = own_count() + static_cast<int>(result_.added.size()) - 1;
    points_of_edge_[index(*edge)].emplace_back(share, vertex);
    std::sort(points_of_edge_[index(*edge)].begin(), points_of_edge_[index(*edge)].end());
    return vertex;
  }

  std::vector<int> faces_at(int point) const {
    if (!is_added(point)) return faces_of_vertex_[index(joined(point))];
    const int edge = edge_of_added_[index(point - own_count())];
    std::vector<int> faces;
    for (const int f : faces_of_vertex_[index(edges_.edges[index(edge)].a)])
      if ((edges_.of_face.col(f).array() == edge).any()) faces.push_back(f);
    return faces;
  }

  /// The edge that both lie on.
  std::optional<int> common_edge(int p, int q) const {
    if (!is_added(p) && !is_added(q)) return edge_between(p, q);
    if (!is_added(p)) return common_edge(q, p);
    const int edge = edge_of_added_[index(p - own_count())];
    if (is_added(q))
      return edge_of_added_[index(q - own_count())] == edge ? std::optional(edge) : std::nullopt;
    const MeshEdge& of = edges_.edges[index(edge)];
    return of.a == joined(q) || of.b == joined(q) ? std::optional(edge) : std::nullopt;
  }

  void add_part(std::size_t seam, std::size_t k, const std::vector<int>& line) {
    ++uses_[line[k]];
    ++uses_[line[k + 1]];
    Part part{line[k], line[k + 1], common_edge(line[k], line[k + 1]), {}};
    if (!part.edge) {
      const std::vector<int> others = faces_at(part.to);
      for (const int f : faces_at(part.from))
        if (std::find(others.begin(), others.end(), f) != others.end()) part.face = f;
      if (!part.face)
        throw InvalidInput(garment_.path + ": seam " + std::to_string(seam + 1) + ": points " +
                           std::to_string(k + 1) + " and " + std::to_string(k + 2) +
                           " of its line lie in no common face");
      chords_[*part.face].push_back({part.from, part.to});
    }
    parts_of_seam_.resize(result_.seams.cuts.size());
    parts_of_seam_[seam].push_back(part);
  }

  /// Weights of a point of the face's border.
  Vector3 weights_in(int face, int point) const {
    const auto corner = [&](int vertex) {
      for (int k = 0; k < 3; ++k)
        if (joined_.mesh.faces(k, face) == vertex) return Vector3(Vector3::Unit(k));
      return Vector3(Vector3::Zero());
    };
    if (!is_added(point)) return corner(joined(point));
    const AddedVertex& added = result_.added[index(point - own_count())];
    return added.weights[0] * corner(joined(added.of[0])) + added.weights[1] * corner(joined(added.of[1]));
  }

  /// Its corners and the points on its edges, in order.
  ConvexPart border_of(int face) const {
    ConvexPart border;
    for (int k = 0; k < 3; ++k) {
      border.push_back({garment_.mesh.faces(k, face), Vector3::Unit(k)});
      const int edge = edges_.of_face(k, face);
      if (edge == MeshEdges::none) continue;
      std::vector<int> points;
      for (const auto& [share, vertex] : points_of_edge_[index(edge)]) points.push_back(vertex);
      if (edges_.edges[index(edge)].a != joined_.mesh.faces(k, face))
        std::reverse(points.begin(), points.end());
      for (const int point : points) border.push_back({point, weights_in(face, point)});
    }
    return border;
  }

  void cut_faces() {
    std::vector<Eigen::Vector3i> faces;
    std::vector<Vector3> weights;
    for (int f = 0; f < static_cast<int>(garment_.mesh.faces.cols()); ++f) {
      const auto add = [&](const FaceCorner& a, const FaceCorner& b, const FaceCorner& c) {
        faces.emplace_back(a.vertex, b.vertex, c.vertex);
        weights.insert(weights.end(), {a.weights, b.weights, c.weights});
        result_.of_face.push_back(f);
      };
      std::vector<ConvexPart> parts{border_of(f)};
      const auto cross = [&](const Vector3& at) {
        const Eigen::Vector3i of = garment_.mesh.faces.col(f);
        result_.added.push_back({{of[0], of[1], of[2]}, at});
        return own_count() + static_cast<int>(result_.added.size()) - 1;
      };
      if (const auto found = chords_.find(f); found != chords_.end())
        for (const auto& [from, to] : found->second)
          split_parts(parts, weights_in(f, from), weights_in(f, to), cross);
      for (const ConvexPart& part : parts) visit_triangles(part, add);
      if (chords_.contains(f)) parts_of_face_[f] = std::move(parts);
    }
    result_.faces.resize(3, static_cast<Eigen::Index>(faces.size()));
    result_.corner_weights.resize(3, static_cast<Eigen::Index>(weights.size()));
    for (std::size_t f = 0; f < faces.size(); ++f) result_.faces.col(static_cast<Eigen::Index>(f)) = faces[f];
    for (std::size_t k = 0; k < weights.size(); ++k)
      result_.corner_weights.col(static_cast<Eigen::Index>(k)) = weights[k];
  }

  /// Of an edge between two of its points, in parts.
  void add_along(int edge, int from, int to, std::vector<std::array<int, 2>>& edges) const {
    const MeshEdge& of = edges_.edges[index(edge)];
    std::vector<int> all{joined_.first[index(of.a)]};
    for (const auto& [share, vertex] : points_of_edge_[index(edge)]) all.push_back(vertex);
    all.push_back(joined_.first[index(of.b)]);
    const auto at = [&](int point) {
      const int wanted = is_added(point) ? point : joined_.first[index(joined(point))];
      return std::find(all.begin(), all.end(), wanted) - all.begin();
    };
    for (auto k = std::min(at(from), at(to)); k < std::max(at(from), at(to)); ++k)
      edges.push_back({all[static_cast<std::size_t>(k)], all[static_cast<std::size_t>(k) + 1]});
  }

  std::vector<int> chain_of(const Part& part) const {
    const int f = *part.face;
    return vertices_along(parts_of_face_.at(f), weights_in(f, part.from), weights_in(f, part.to));
  }

  /// Whether a line that ends there, behind another one in the same face, leaves a cut shorter than the face:
  /// neither the border nor a further line is there, and it ends where it meets the other line.
  bool ends_inside(int point) const {
    const std::vector<int> faces = faces_at(point);
    const auto on_border = [&](int f) {
      for (int k = 0; k < 3; ++k)
        if (edges_.on_boundary(f, k) && is_on_edge(point, edges_.of_face(k, f))) return true;
      return false;
    };
    if (std::any_of(faces.begin(), faces.end(), on_border)) return false;
    return uses_.at(point) < 2;
  }

  bool is_on_edge(int point, int edge) const {
    if (is_added(point)) return edge_of_added_[index(point - own_count())] == edge;
    const MeshEdge& of = edges_.edges[index(edge)];
    return of.a == joined(point) || of.b == joined(point);
  }

  void set_edges(std::size_t seam) {
    SeamCut& cut = result_.seams.cuts[seam];
    std::vector<std::array<int, 2>> edges;
    for (const auto& [a, b] : cut.edges)
      if (const auto edge = edge_between(a, b))
        add_along(*edge, a, b, edges);
      else
        edges.push_back({a, b});  // is refused where pieces are cut
    if (seam < parts_of_seam_.size()) {
      const std::vector<Part>& parts = parts_of_seam_[seam];
      const bool is_closed = parts.size() > 1 && parts.front().from == parts.back().to;
      for (std::size_t k = 0; k < parts.size(); ++k) {
        if (parts[k].edge) {
          add_along(*parts[k].edge, parts[k].from, parts[k].to, edges);
          continue;
        }
        std::vector<int> chain = chain_of(parts[k]);
        if (!is_closed && k == 0 && chain.size() > 2 && ends_inside(parts[k].from))
          chain.erase(chain.begin());
        if (!is_closed && k + 1 == parts.size() && chain.size() > 2 && ends_inside(parts[k].to))
          chain.pop_back();
        for (std::size_t i = 0; i + 1 < chain.size(); ++i) edges.push_back({chain[i], chain[i + 1]});
      }
    }
    cut.edges = std::move(edges);
    cut.line.clear();
  }

  const Garment& garment_;
  JoinedMesh joined_;
  MeshEdges edges_;
  std::vector<std::vector<std::pair<double, int>>> points_of_edge_;  ///< share from a, vertex
  std::vector<std::vector<int>> faces_of_vertex_;
  std::vector<int> edge_of_added_;
  std::map<int, std::vector<std::array<int, 2>>> chords_;  ///< of faces
  std::map<int, std::vector<ConvexPart>> parts_of_face_;
  std::map<int, int> uses_;  ///< of points: how many parts of lines end there
  std::vector<std::vector<Part>> parts_of_seam_;
  FacesAlongLines result_;
};

}  // namespace

FacesAlongLines faces_along_lines(const Garment& garment, const SeamFile& seams) {
  return LineCutter(garment, seams).run();
}

Garment cut_along(const Garment& garment, const FacesAlongLines& cut) {
  Garment result = garment;
  const Eigen::Index own = garment.mesh.vertices.cols();
  result.mesh.vertices.conservativeResize(3, own + static_cast<Eigen::Index>(cut.added.size()));
  for (std::size_t k = 0; k < cut.added.size(); ++k) {
    const AddedVertex& vertex = cut.added[k];
    const Eigen::Vector3i of(vertex.of[0], vertex.of[1], vertex.of[2]);
    result.mesh.vertices.col(own + static_cast<Eigen::Index>(k)) =
        garment.mesh.vertices(Eigen::all, of) * vertex.weights;
  }
  result.mesh.faces = cut.faces;
  result.group_of_face.clear();
  for (const int face : cut.of_face)
    result.group_of_face.push_back(garment.group_of_face[static_cast<std::size_t>(face)]);
  if (garment.texture.cols() == 0) return result;
  result.texture.resize(2, cut.corner_weights.cols());
  for (Eigen::Index corner = 0; corner < cut.corner_weights.cols(); ++corner)
    result.texture.col(corner) =
        garment.texture.middleCols<3>(3 * cut.of_face[static_cast<std::size_t>(corner / 3)]) *
        cut.corner_weights.col(corner);
  return result;
}

}  // namespace bespoke
