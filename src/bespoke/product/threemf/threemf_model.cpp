#include "bespoke/product/threemf/threemf_model.h"

#include <array>
#include <cstring>
#include <sstream>

#include "bespoke/enum_names.h"
#include "bespoke/error.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/text/number_text.h"
#include "bespoke/product/text/text_blocks.h"
#include "bespoke/product/threemf/xml_reader.h"

namespace bespoke {
namespace {

constexpr std::string_view core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02|";
constexpr std::string_view production = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
constexpr std::string_view materials = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";
constexpr std::string_view production_path =
    "http://schemas.microsoft.com/3dmanufacturing/production/2015/06|path";
constexpr std::string_view relationship =
    "http://schemas.openxmlformats.org/package/2006/relationships|Relationship";
constexpr std::string_view root_type = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
constexpr const char* relationships_part = "_rels/.rels";

constexpr std::array units{
    Named<std::string_view>{"micron", "um"},     Named<std::string_view>{"millimeter", "mm"},
    Named<std::string_view>{"centimeter", "cm"}, Named<std::string_view>{"inch", "in"},
    Named<std::string_view>{"foot", "ft"},       Named<std::string_view>{"meter", "m"}};

/// On one line of a message.
std::string printable(std::string text) {
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return text;
}

/// "/3D/a.model" is the entry "3D/a.model".
std::string entry_name(const char* path) { return *path == '/' ? path + 1 : path; }

/// What is said of an element's attributes, which must be there.
class Attributes {
 public:
  Attributes(const XmlElement& element, const XmlReader& reader) : element_(element), reader_(reader) {}

  const char* text(const char* name) const {
    const char* const text = element_.attribute(name);
    if (!text) reader_.fail("<" + short_name() + "> has no " + name);
    return text;
  }

  double number(const char* name) const {
    const char* const word = text(name);
    const double value = number(word, word + std::strlen(word), name);
    if (!fits_float(value)) reader_.fail(std::string(name) + " is not finite in single precision");
    return value;
  }

  std::uint64_t whole(const char* name) const {
    const char* const word = text(name);
    long long value = 0;
    if (!read_integer(word, word + std::strlen(word), value) || value < 0)
      reader_.fail(std::string(name) + ": " + in_quotes(word) + " is no whole number from 0 on");
    return static_cast<std::uint64_t>(value);
  }

  /// Twelve numbers, by rows of a matrix that points are multiplied with from the left; or the identity.
  AffineMap transform() const {
    AffineMap map;
    if (!element_.attribute("transform")) return map;
    std::istringstream words(text("transform"));
    std::array<double, 12> values;
    std::string word;
    for (double& value : values) {
      if (!(words >> word)) reader_.fail("transform has fewer than twelve numbers");
      value = number(word.data(), word.data() + word.size(), "transform");
    }
    if (words >> word) reader_.fail("transform has more than twelve numbers");
    map.linear = Eigen::Map<const Matrix3>(values.data());  // by columns: the transpose of these rows
    map.offset = Eigen::Map<const Vector3>(values.data() + 9);
    return map;
  }

  ThreemfPlace place() const {
    ThreemfPlace place;
    if (const char* const path = element_.attribute(production_path)) place.part = entry_name(path);
    place.object = whole("objectid");
    place.to_outer = transform();
    place.line = reader_.line();
    return place;
  }

 private:
  double number(const char* begin, const char* end, const char* name) const {
    NumberText read;
    if (!read_number(begin, end, read))
      reader_.fail(std::string(name) + ": " + in_quotes({begin, static_cast<std::size_t>(end - begin)}) +
                   " is no finite number");
    return read.value;
  }
  std::string short_name() const {
    return std::string(element_.name().substr(element_.name().rfind('|') + 1));
  }

  const XmlElement& element_;
  const XmlReader& reader_;
};

class ModelReader {
 public:
  ThreemfModel read(const ZipFile& package, const ZipEntry& entry, bool unit_only) {
    unit_only_ = unit_only;
    reader_.begin = [this](const XmlElement& element) { begin(element); };
    reader_.end = [this](std::string_view name) {
      if (name.starts_with(core) && name.substr(core.size()) == "object") object_ = nullptr;
    };
    reader_.read(package, entry);
    if (!has_model_) reader_.fail("has no <model> of the 3MF core namespace");
    return std::move(model_);
  }

 private:
  void begin(const XmlElement& element) {
    if (element.name().ends_with("|beamlattice"))
      refuse_extension(std::string(element.name().substr(0, element.name().rfind('|'))));
    if (!element.name().starts_with(core)) return;  // of an extension: materials, colours, slices …
    const std::string_view name = element.name().substr(core.size());
    const Attributes attributes(element, reader_);
    if (name == "vertex")
      add_vertex(attributes);
    else if (name == "triangle")
      add_triangle(attributes);
    else if (name == "model")
      begin_model(element);
    else if (name == "object")
      begin_object(attributes);
    else if (name == "component")
      object(name).components.push_back(attributes.place());
    else if (name == "item")
      model_.items.push_back(attributes.place());
  }

  void begin_model(const XmlElement& element) {
    has_model_ = true;
    if (const char* const unit = element.attribute("unit")) model_.unit = unit;
    if (!value_of(units, model_.unit)) reader_.fail("unknown unit " + in_quotes(model_.unit));
    if (unit_only_) return reader_.stop();
    const char* const required = element.attribute("requiredextensions");
    std::istringstream prefixes(required ? required : "");
    for (std::string prefix; prefixes >> prefix;) {
      const std::string name = reader_.namespace_of(prefix);
      if (name != production && name != materials) refuse_extension(name.empty() ? prefix : name);
    }
  }

  /// Named in full: an extension's name is at the end of its address.
  [[noreturn]] void refuse_extension(const std::string& name) const {
    const std::string what = name.find("beamlattice") != std::string::npos ? " (beam lattices)" : "";
    reader_.fail("requires the extension '" + printable(name) + "'" + what +
                 ", which is not read; export plain triangle meshes");
  }

  void begin_object(const Attributes& attributes) {
    const std::uint64_t id = attributes.whole("id");
    const auto [at, is_new] = model_.objects.try_emplace(id);
    if (!is_new) reader_.fail("a second object with the id " + std::to_string(id));
    object_ = &at->second;
  }

  ThreemfObject& object(std::string_view name) const {
    if (!object_) reader_.fail("<" + std::string(name) + "> outside of an object");
    return *object_;
  }

  void add_vertex(const Attributes& attributes) {
    std::vector<double>& coordinates = object("vertex").coordinates;
    coordinates.insert(coordinates.end(),
                       {attributes.number("x"), attributes.number("y"), attributes.number("z")});
  }

  void add_triangle(const Attributes& attributes) {
    ThreemfObject& mesh = object("triangle");
    const std::size_t vertices = mesh.coordinates.size() / 3;
    std::array<int, 3> corners;
    const std::array<const char*, 3> names{"v1", "v2", "v3"};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t corner = attributes.whole(names[k]);
      if (corner >= vertices)
        reader_.fail(std::string(names[k]) + " names vertex " + std::to_string(corner) + " of " +
                     std::to_string(vertices));
      corners[k] = static_cast<int>(corner);
    }
    const std::string fault = face_fault(corners.data(), corners.size(), 0);
    if (!fault.empty()) reader_.fail(fault);
    mesh.corners.insert(mesh.corners.end(), corners.begin(), corners.end());
  }

  XmlReader reader_;
  ThreemfModel model_;
  ThreemfObject* object_ = nullptr;
  bool has_model_ = false, unit_only_ = false;
};

ZipEntry required_entry(const ZipFile& package, const std::string& name) {
  std::optional<ZipEntry> entry = package.find(name);
  if (!entry) throw FormatError(package.path().string() + ": has no part " + in_quotes(name));
  return *std::move(entry);
}

}  // namespace

std::string root_part_of_3mf(const ZipFile& package) {
  std::string root;
  XmlReader reader;
  reader.begin = [&](const XmlElement& element) {
    const char* const type = element.attribute("Type");
    const char* const target = element.attribute("Target");
    if (element.name() == relationship && type && target && type == root_type && root.empty())
      root = entry_name(target);
  };
  reader.read(package, required_entry(package, relationships_part));
  if (root.empty())
    throw FormatError(package.path().string() + ": " + relationships_part + " names no 3D model");
  return root;
}

ThreemfModel read_3mf_part(const ZipFile& package, const std::string& part) {
  return ModelReader().read(package, required_entry(package, part), false);
}

std::string threemf_name_of_unit(const std::string& unit) {
  const std::optional<double> metres = metres_per_unit(unit);
  for (const auto& known : units)
    if (metres && metres == metres_per_unit(std::string(known.value))) return std::string(known.name);
  throw InvalidInput("3MF has no name for the unit \"" + unit + "\"; it knows um, mm, cm, m, in and ft");
}

std::string unit_of_3mf(const InputFile& file) {
  const ZipFile package(file);
  const ZipEntry root = required_entry(package, root_part_of_3mf(package));
  return std::string(*value_of(units, ModelReader().read(package, root, true).unit));
}

}  // namespace bespoke
