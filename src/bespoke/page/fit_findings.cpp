#include "bespoke/page/fit_findings.h"

#include <cmath>
#include <sstream>

#include "bespoke/error.h"
#include "bespoke/json_reason.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/summary_json.h"
#include "bespoke/text_lines.h"

namespace bespoke {

FitFindings findings_of(const FittedMapping& fit) {
  FitFindings findings{fit.confidence, std::vector<FitFindings::Unmet>()};
  for (const UnmetVertex& vertex : fit.summary.elastic.unmet)
    findings.unmet->push_back({vertex.vertex, vertex.residual, to_string(vertex.reason)});
  return findings;
}

std::vector<double> read_confidence(const std::filesystem::path& path) {
  std::istringstream lines(read_text_file(path));
  std::vector<double> values;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    double value = 0;
    std::string rest;
    if (!(words >> value) || words >> rest || !(value >= 0 && value <= 1))
      throw FormatError(path.string() + ":" + std::to_string(values.size() + 1) + ": \"" +
                        line.substr(0, 40) + "\" is not a number from 0 to 1");
    values.push_back(value);
  }
  return values;
}

std::vector<FitFindings::Unmet> read_unmet_vertices(const std::filesystem::path& path) {
  try {
    const Json report = Json::parse(read_text_file(path));
    std::vector<FitFindings::Unmet> unmet;
    for (const Json& entry : report.at("unmet_vertices"))
      unmet.push_back({entry.at("vertex").get<int>(), entry.at("residual").get<double>(),
                       entry.at("reason").get<std::string>()});
    return unmet;
  } catch (const Json::exception& error) {
    throw FormatError(path.string() + ": not a report of `bespoke fit`: " + json_reason(error.what()));
  }
}

}  // namespace bespoke
