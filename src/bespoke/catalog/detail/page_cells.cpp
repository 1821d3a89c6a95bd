#include "bespoke/catalog/detail/page_cells.h"

#include "bespoke/number_format.h"
#include "bespoke/page/html_text.h"

namespace bespoke {
namespace {

constexpr const char* style =
    "body{font:14px system-ui,sans-serif;margin:2em;color:#222}table{border-collapse:collapse}"
    "td,th{padding:.4em .8em;border-bottom:1px solid #ddd;text-align:left;vertical-align:middle}"
    "td.n{text-align:right;font-variant-numeric:tabular-nums}code{font-size:12px}img{display:block}"
    ".bad{color:#a31515}";

}  // namespace

std::string page_head(const std::string& title, const std::string& heading) {
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + escaped(title) +
         "</title><style>" + style + "</style></head><body>\n<h1>" + escaped(heading) + "</h1>\n";
}

std::string table_head(const std::vector<std::string>& headings) {
  std::string head = "<table><thead><tr>";
  for (const std::string& heading : headings) head += "<th>" + heading + "</th>";
  return head + "</tr></thead><tbody>\n";
}

std::string number(double value) { return format_number(value, 3); }

std::string number_cell(const std::string& text) { return "<td class=\"n\">" + text + "</td>"; }

std::string proof_cell(const CatalogEntry& entry) {
  if (entry.bijection) return "<td>bijection, det ≥ " + number(entry.min_determinant) + "</td>";
  return "<td class=\"bad\">" + std::to_string(entry.folded) + " cells fold, " +
         std::to_string(entry.undecided) + " undecided</td>";
}

std::string size_cell(const CatalogEntry& entry) {
  constexpr double megabyte = 1e6;
  return number_cell(number(static_cast<double>(entry.bytes) / megabyte) + " MB");
}

}  // namespace bespoke
