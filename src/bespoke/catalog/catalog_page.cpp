#include <cstdio>

#include "bespoke/catalog/catalog_file.h"
#include "bespoke/digits.h"

namespace bespoke {
namespace {

// Of a hash; enough to tell models apart by eye, and more than find_map asks for.
constexpr std::size_t shown_digits = 12;

constexpr const char* style =
    "body{font:14px system-ui,sans-serif;margin:2em;color:#222}table{border-collapse:collapse}"
    "td,th{padding:.4em .8em;border-bottom:1px solid #ddd;text-align:left;vertical-align:middle}"
    "td.n{text-align:right;font-variant-numeric:tabular-nums}code{font-size:12px}img{display:block}"
    ".bad{color:#a31515}";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char letter : text) switch (letter) {
      case '<':
        result += "&lt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += letter;
    }
  return result;
}

/// A relative file as a link's address: what addresses do not hold as it is, as %XX.
std::string address(const std::string& file) {
  std::string result;
  for (const char letter : file) {
    const auto byte = static_cast<unsigned char>(letter);
    const bool plain = std::isalnum(byte) != 0 || std::string("/-_.~").find(letter) != std::string::npos;
    char code[8];
    std::snprintf(code, sizeof code, "%%%02X", byte);
    result += plain ? std::string(1, letter) : code;
  }
  return result;
}

std::string number(double value) { return in_digits(value, 3); }

std::string hash_cell(const std::string& hash) {
  return "<td><code title=\"" + escaped(hash) + "\">" + escaped(hash.substr(0, shown_digits)) +
         "</code></td>";
}

std::string number_cell(const std::string& text) { return "<td class=\"n\">" + text + "</td>"; }

std::string proof(const CatalogEntry& entry) {
  if (entry.bijection) return "<td>bijection, det ≥ " + number(entry.least_determinant) + "</td>";
  return "<td class=\"bad\">" + std::to_string(entry.folded) + " cells fold, " +
         std::to_string(entry.undecided) + " undecided</td>";
}

std::string row(const CatalogEntry& entry) {
  constexpr double megabyte = 1e6;
  const Vector3 size = entry.source.box.sizes();
  return "<tr><td><img width=\"96\" height=\"96\" alt=\"\" src=\"" + escaped(entry.thumbnail) +
         "\"></td><td><a href=\"" + address(entry.file) + "\">" + escaped(entry.file) + "</a></td>" +
         hash_cell(entry.source.hash) + hash_cell(entry.target.hash) + "<td>" + number(size.x()) + " × " +
         number(size.y()) + " × " + number(size.z()) + " " + escaped(entry.unit) + "</td><td>" +
         escaped(entry.surface_fit) + ", " + escaped(entry.elastic) +
         (entry.steps > 1 ? ", " + std::to_string(entry.steps) + " steps" : "") + "</td>" +
         number_cell(number(entry.tolerance)) + number_cell(number(entry.error_p99)) +
         number_cell(number(entry.error_max)) + proof(entry) + number_cell(std::to_string(entry.anchors)) +
         number_cell(number(static_cast<double>(entry.bytes) / megabyte) + " MB") + "</tr>\n";
}

}  // namespace

std::string catalog_page(const Catalog& catalog) {
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Maps</title><style>" +
      std::string(style) + "</style></head><body>\n<h1>" + std::to_string(catalog.assets.size()) +
      " maps</h1>\n<table><thead><tr>";
  for (const char* heading : {"source", "file", "source's hash", "target's hash", "source's size", "methods",
                              "tolerance", "error p99", "max", "proof", "anchors", "file's size"})
    page += "<th>" + std::string(heading) + "</th>";
  page += "</tr></thead><tbody>\n";
  for (const CatalogEntry& entry : catalog.assets) page += row(entry);
  page += "</tbody></table>\n";
  if (!catalog.refused.empty()) page += "<h2 class=\"bad\">Refused</h2>\n<ul>\n";
  for (const RefusedFile& file : catalog.refused)
    page += "<li>" + escaped(file.file) + ": " + escaped(file.reason) + "</li>\n";
  if (!catalog.refused.empty()) page += "</ul>\n";
  if (!catalog.others.empty())
    page += "<p>" + std::to_string(catalog.others.size()) + " other volumes are no maps.</p>\n";
  return page + "</body></html>\n";
}

}  // namespace bespoke
