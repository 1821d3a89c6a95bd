#include "bespoke/catalog/map_index.h"

#include "bespoke/catalog/detail/page_cells.h"
#include "bespoke/page/html_text.h"

namespace bespoke {
namespace {

std::string link(const std::string& file, const std::string& content) {
  return "<a href=\"" + link_address(file) + "\">" + content + "</a>";
}

std::string row_of(const MapIndexRow& row) {
  const std::string picture = "<img width=\"160\" height=\"160\" loading=\"lazy\" alt=\"" +
                              escaped(row.name) + "\" src=\"" + link_address(row.picture) + "\">";
  std::string products;
  for (const std::string& product : row.products)
    products += (products.empty() ? "" : "<br>") + escaped(product);
  return "<tr><td>" + link(row.page, picture) + "</td><td>" + link(row.page, escaped(row.name)) + "</td>" +
         number_cell(number(row.t)) + "<td>" + products + "</td><td>" +
         link(row.map.file, escaped(row.map.file)) + "</td>" +
         number_cell(number(row.map.tolerance) + " " + escaped(row.map.unit)) +
         number_cell(number(row.map.error_p99)) + number_cell(number(row.map.error_max)) +
         proof_cell(row.map) + size_cell(row.map) + "</tr>\n";
}

}  // namespace

std::string map_index(const std::vector<MapIndexRow>& rows, const std::vector<std::string>& missing) {
  std::string page =
      page_head("Results", std::to_string(rows.size()) + (rows.size() == 1 ? " result" : " results")) +
      table_head({"result", "name", "t", "products", "map", "tolerance", "error p99", "max", "proof",
                  "file's size"});
  for (const MapIndexRow& row : rows) page += row_of(row);
  page += "</tbody></table>\n";
  if (!missing.empty()) page += "<h2 class=\"bad\">Not made</h2>\n<ul>\n";
  for (const std::string& name : missing) page += "<li>" + escaped(name) + "</li>\n";
  if (!missing.empty()) page += "</ul>\n";
  return page + "</body></html>\n";
}

}  // namespace bespoke
