#include "bespoke/catalog/catalog_file.h"
#include "bespoke/catalog/detail/page_cells.h"
#include "bespoke/page/html_text.h"

namespace bespoke {
namespace {

// Of a hash; enough to tell models apart by eye, and more than find_map requires.
constexpr std::size_t shown_digits = 12;

std::string hash_cell(const std::string& hash) {
  return "<td><code title=\"" + escaped(hash) + "\">" + escaped(hash.substr(0, shown_digits)) +
         "</code></td>";
}

std::string row(const CatalogEntry& entry) {
  const Vector3 size = entry.source.box.sizes();
  return "<tr><td><img width=\"96\" height=\"96\" alt=\"\" src=\"" + escaped(entry.thumbnail) +
         "\"></td><td><a href=\"" + link_address(entry.file) + "\">" + escaped(entry.file) + "</a></td>" +
         hash_cell(entry.source.hash) + hash_cell(entry.target.hash) + "<td>" + number(size.x()) + " × " +
         number(size.y()) + " × " + number(size.z()) + " " + escaped(entry.unit) + "</td><td>" +
         escaped(entry.surface_fit) + ", " + escaped(entry.elastic) +
         (entry.steps > 1 ? ", " + std::to_string(entry.steps) + " steps" : "") + "</td>" +
         number_cell(number(entry.tolerance)) + number_cell(number(entry.error_p99)) +
         number_cell(number(entry.error_max)) + proof_cell(entry) +
         number_cell(std::to_string(entry.anchors)) + size_cell(entry) + "</tr>\n";
}

}  // namespace

std::string catalog_page(const Catalog& catalog) {
  std::string page =
      page_head("Maps", std::to_string(catalog.assets.size()) + " maps") +
      table_head({"source", "file", "source's hash", "target's hash", "source's size", "methods", "tolerance",
                  "error p99", "max", "proof", "anchors", "file's size"});
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
