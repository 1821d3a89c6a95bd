#include "bespoke/anchors/detail/meshlab_points.h"

#include <expat.h>

#include <exception>
#include <map>
#include <memory>
#include <new>

#include "bespoke/anchors/detail/point_text.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

using Attributes = std::map<std::string, std::string>;

/// What expat calls collects here. Its C code must not see exceptions, so they wait until it has returned.
struct PickedPoints {
  bool has_root = false;
  std::vector<Attributes> points;
  std::exception_ptr thrown;
};

void XMLCALL begin_element(void* data, const XML_Char* name, const XML_Char** attributes) try {
  auto& found = *static_cast<PickedPoints*>(data);
  const std::string_view element = name;
  if (element == "PickedPoints") found.has_root = true;
  if (element != "point") return;
  found.points.emplace_back();
  for (; *attributes; attributes += 2) found.points.back()[attributes[0]] = attributes[1];
} catch (...) {
  static_cast<PickedPoints*>(data)->thrown = std::current_exception();
}

PickedPoints picked_points(const std::string& text, const std::string& file) {
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                            &XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  PickedPoints found;
  XML_SetUserData(parser.get(), &found);
  XML_SetStartElementHandler(parser.get(), begin_element);
  const XML_Status status = XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), 1);
  if (found.thrown) std::rethrow_exception(found.thrown);
  if (status != XML_STATUS_OK)
    throw FormatError(file + ":" + std::to_string(XML_GetCurrentLineNumber(parser.get())) +
                      ": is no XML: " + XML_ErrorString(XML_GetErrorCode(parser.get())));
  if (!found.has_root) throw FormatError(file + ": no <PickedPoints>: not a file of picked points");
  return found;
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char letter : text)
    if (letter == '<')
      result += "&lt;";
    else if (letter == '"')
      result += "&quot;";
    else if (letter == '&')
      result += "&amp;";
    else
      result += letter;
  return result;
}

}  // namespace

std::vector<NamedPoint> parse_meshlab(const std::string& text, const std::string& file) {
  const PickedPoints found = picked_points(text, file);
  std::vector<NamedPoint> points;
  for (std::size_t i = 0; i < found.points.size(); ++i) {
    Attributes attributes = found.points[i];
    const std::string where = file + ": point " + std::to_string(i);
    NamedPoint point;
    for (const int axis : {0, 1, 2}) {
      const auto coordinate = attributes.find(std::string(1, "xyz"[axis]));
      if (coordinate == attributes.end()) throw FormatError(where + " has not all of x, y and z");
      point.x[axis] = finite_number(coordinate->second, where);
    }
    point.name = attributes["name"];
    if (attributes["active"] != "0") points.push_back(std::move(point));
  }
  return points;
}

std::string meshlab_text(const std::vector<NamedPoint>& points) {
  std::string text = "<!DOCTYPE PickedPoints>\n<PickedPoints>\n";
  for (const NamedPoint& point : points)
    text += " <point x=\"" + all_digits(point.x.x()) + "\" y=\"" + all_digits(point.x.y()) + "\" z=\"" +
            all_digits(point.x.z()) + "\" active=\"1\" name=\"" + escaped(point.name) + "\"/>\n";
  return text + "</PickedPoints>\n";
}

}  // namespace bespoke
