#include "bespoke/product/text/text_records.h"

#include <algorithm>

#include "bespoke/error.h"
#include "bespoke/product/carry/directions.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

constexpr double position_resolution = 1e-7;  // of the diagonal
constexpr std::size_t longest_head = std::size_t{1} << 20;

struct Findings {
  std::size_t points = 0, normals = 0;
  Box box;
  CarriedDecimals point_decimals, normal_decimals;
  FaceFaults faults;
};

Findings inspect(const TextRecords& records) {
  Findings found;
  found.points = records.points.size();
  found.normals = records.normals.size();
  found.faults.add(records.faces);
  for (const NumberTriple& point : records.points) {
    for (const NumberText& number : point) found.point_decimals.add(number);
    found.box.extend(Vector3(point[0].value, point[1].value, point[2].value));
  }
  for (const NumberTriple& normal : records.normals)
    for (const NumberText& number : normal) found.normal_decimals.add(number);
  return found;
}

void merge(const Findings& block, Findings& all) {
  all.faults.add(block.faults);
  all.points += block.points;
  all.normals += block.normals;
  all.box.extend(block.box);
  all.point_decimals.merge(block.point_decimals);
  all.normal_decimals.merge(block.normal_decimals);
}

Points means(const Points& x, Eigen::Index of) {
  if (of == 1) return x;
  Points result(3, x.cols() / of);
  for (Eigen::Index i = 0; i < result.cols(); ++i) result.col(i) = x.middleCols(i * of, of).rowwise().mean();
  return result;
}

struct Decimals {
  int points = 0, normals = 0;
};

std::vector<std::string> carry_block(const TextBlock& block, const TextRecords& records,
                                     const Decimals& decimals, const PointMotion& motion,
                                     const std::filesystem::path& path) {
  if (records.points.empty()) return std::vector<std::string>(motion.frames, std::string(block.bytes));
  const Points x = values(records.points);
  const std::vector<Points> images = motion.images(x);
  const auto normal_count = static_cast<Eigen::Index>(records.normals.size());
  std::vector<Points> jacobians;
  if (normal_count > 0) jacobians = motion.jacobians(means(x, x.cols() / normal_count));
  std::vector<std::string> texts;
  for (std::size_t frame = 0; frame < motion.frames; ++frame) {
    std::vector<NumberEdit> edits;
    require_finite(images[frame], path);
    add_edits(records.points, images[frame], decimals.points, edits);
    if (normal_count > 0)
      add_edits(records.normals, moved_normals(values(records.normals), jacobians[frame]), decimals.normals,
                edits);
    for (NumberEdit& edit : edits) edit.point = records.point;
    texts.push_back(edited(block.bytes, std::move(edits)));
  }
  return texts;
}

}  // namespace

GatheredFaces gather_text(const InputFile& file, const TextFormat& format, GatheredNormals normals) {
  GatheredFaces gathered(file.path());
  TextCutter cutter = format.cutter();
  walk_blocks(
      {file, format.begin()}, [&](const Window& window) { return cutter(window); },
      [&](const TextBlock& block) { return format.records(block); },
      [&](const TextBlock&, TextRecords&& records) {
        if (!records.points.empty()) gathered.add_points(values(records.points));
        if (normals == GatheredNormals::of_points && !records.normals.empty())
          gathered.add_normals(values(records.normals));
        if (!records.texture.empty())
          gathered.add_texture(Eigen::Map<const Eigen::Matrix2Xd>(
              records.texture.front().data(), 2, static_cast<Eigen::Index>(records.texture.size())));
        gathered.add_faces(records.faces);
      },
      {});
  format.require_complete(cutter.sums());
  return gathered;
}

int position_decimals(const Box& box, const CarriedDecimals& carried) {
  if (box.isEmpty()) return 0;
  double extent = box.diagonal().norm();
  if (!(extent > 0)) extent = box.min().cwiseAbs().maxCoeff();  // a single place
  if (!(extent > 0)) extent = 1;
  return std::max(carried.decimals(), decimals_for(position_resolution * extent));
}

int position_decimals(const std::vector<NumberTriple>& points) {
  Box box;
  CarriedDecimals carried;
  for (const NumberTriple& point : points) {
    for (const NumberText& number : point) carried.add(number);
    box.extend(Vector3(point[0].value, point[1].value, point[2].value));
  }
  return position_decimals(box, carried);
}

void require_finite(const Points& images, const std::filesystem::path& path) {
  if (images.allFinite()) return;
  throw InvalidInput(path.string() + ": a point goes to a place that is not finite");
}

std::string file_head(const InputFile& file) {
  std::string head(static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), longest_head)), '\0');
  file.read(0, head.data(), head.size());
  return head;
}

std::string text_head(const InputFile& file) {
  std::string head = file_head(file);
  require_utf8(head, file.path());
  return head;
}

CarrySummary carry_text(const InputFile& file, std::vector<OutputFile>& outputs, const TextFormat& format,
                        const PointMotion& motion, const Progress& progress) {
  Findings all;
  TextCutter check_cutter = format.cutter();
  walk_blocks(
      {file, format.begin()}, [&](const Window& window) { return check_cutter(window); },
      [&](const TextBlock& block) { return inspect(format.records(block)); },
      [&](const TextBlock&, Findings&& found) { merge(found, all); }, progress);
  format.require_complete(check_cutter.sums());
  if (all.points == 0) throw FormatError(file.path().string() + ": the file has no vertices");

  const Decimals decimals{position_decimals(all.box, all.point_decimals),
                          std::max(all.normal_decimals.decimals(), decimals_for(direction_resolution))};
  std::string head(static_cast<std::size_t>(format.begin()), '\0');
  file.read(0, head.data(), head.size());
  for (OutputFile& output : outputs) output.write(head);
  TextCutter cutter = format.cutter();
  walk_blocks(
      {file, format.begin()}, [&](const Window& window) { return cutter(window); },
      [&](const TextBlock& block) {
        return carry_block(block, format.records(block), decimals, motion, file.path());
      },
      [&](const TextBlock&, std::vector<std::string>&& texts) {
        for (std::size_t frame = 0; frame < outputs.size(); ++frame) outputs[frame].write(texts[frame]);
      },
      progress);
  CarrySummary summary;
  summary.points = all.points;
  summary.directions = all.normals;
  summary.degenerate = all.faults.degenerate(file.path());
  if (summary.degenerate.count > 0) summary.warnings.push_back(to_string(summary.degenerate));
  return summary;
}

}  // namespace bespoke
