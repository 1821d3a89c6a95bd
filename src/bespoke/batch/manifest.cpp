#include "bespoke/batch/manifest.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "bespoke/csv_rows.h"
#include "bespoke/error.h"
#include "bespoke/json_reason.h"
#include "bespoke/pipeline/summary_json.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

constexpr const char* command_key = "command";

[[noreturn]] void fail(const std::string& what) { throw FormatError(what); }

std::string text_of(const std::string& key, const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number()) return value.dump();
  fail("\"" + key + "\" must be a text, a number, true, false, or a list of texts and numbers");
}

ManifestEntry entry_of(const std::string& key, const Json& value) {
  ManifestEntry entry{key, {}, value.is_boolean()};
  if (value.is_boolean()) {
    if (value.get<bool>()) entry.values = {"true"};
  } else if (value.is_array()) {
    if (value.empty()) fail("\"" + key + "\" is an empty list; leave it out instead");
    for (const Json& element : value) entry.values.push_back(text_of(key, element));
  } else {
    entry.values = {text_of(key, value)};
  }
  return entry;
}

/// Takes the command, which stands at the key, out of the entries.
ManifestJob job_of(std::size_t line, std::vector<ManifestEntry> entries, const std::string& key) {
  const auto is_command = [&](const ManifestEntry& entry) { return entry.key == key; };
  const auto command = std::find_if(entries.begin(), entries.end(), is_command);
  if (command == entries.end()) fail("there is no \"" + key + "\"");
  if (command->flag || command->values.size() != 1) fail("\"" + key + "\" must be one text");
  ManifestJob job{line, command->values.front(), {}};
  entries.erase(command);
  job.entries = std::move(entries);
  return job;
}

/// The parser keeps the last of two values of a key; a manifest that says a thing twice is wrong.
Json parse_object(const std::string& text) {
  std::set<std::string> keys;
  std::string twice;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& value) {
    if (depth == 1 && event == Json::parse_event_t::key && !keys.insert(value.get<std::string>()).second)
      twice = value.get<std::string>();
    return true;
  };
  Json object;
  try {
    object = Json::parse(text, watch);
  } catch (const Json::parse_error& error) {
    fail("not one JSON object: " + json_reason(error.what()));
  }
  if (!object.is_object()) fail("not a JSON object but " + std::string(object.type_name()));
  if (!twice.empty()) fail("\"" + twice + "\" is given twice");
  return object;
}

ManifestJob json_job(std::size_t line, const std::string& text) {
  const Json object = parse_object(text);
  std::vector<ManifestEntry> entries;
  for (const auto& [key, value] : object.items()) entries.push_back(entry_of(key, value));
  return job_of(line, std::move(entries), command_key);
}

/// The texts of a line's cells, with points where a spreadsheet writes decimal commas. No option takes two
/// numbers with a comma between them.
std::vector<std::string> cells(std::string_view line, char separator) {
  const CsvRow row = csv_row(line, separator);
  if (!row.is_closed) fail("a double quote is not closed");
  std::vector<std::string> texts = csv_texts(row);
  if (separator == ',') return texts;
  for (std::string& text : texts) {
    const std::string_view number =
        std::string_view(text).substr(0, text.find_first_not_of("0123456789+-,eE"));
    if (has_decimal_comma(number)) text[text.find(',')] = '.';
  }
  return texts;
}

ManifestJob csv_job(std::size_t line, const std::vector<std::string>& keys,
                    const std::vector<std::string>& values, const std::string& command) {
  if (values.size() != keys.size())
    fail(std::to_string(values.size()) + " cells, but the header has " + std::to_string(keys.size()));
  std::vector<ManifestEntry> entries;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (values[i].empty() || values[i] == "false") continue;
    entries.push_back({keys[i], {values[i]}, values[i] == "true"});
  }
  return job_of(line, std::move(entries), command);
}

bool is_blank(std::string_view line) {
  return std::all_of(line.begin(), line.end(), [](unsigned char c) { return std::isspace(c) != 0; });
}

/// Gives every line that is not blank to `take`, whose FormatError is its fault.
template <class Take>
Manifest read_lines(const std::filesystem::path& path, const Take& take) {
  const std::string text = read_text_file(path);
  Manifest manifest;
  std::size_t number = 0;
  for (const std::string_view line : text_lines(text)) {
    ++number;
    if (is_blank(line)) continue;
    try {
      take(manifest, number, line);
    } catch (const FormatError& error) {
      manifest.faults.push_back({number, error.what()});
    }
  }
  return manifest;
}

}  // namespace

Manifest read_table(const std::filesystem::path& path, const std::string& key) {
  std::optional<std::vector<std::string>> header;
  char separator = ',';
  const auto has_key = [&](const std::vector<std::string>& keys) {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
  };
  return read_lines(path, [&](Manifest& manifest, std::size_t number, std::string_view line) {
    if (header) {
      manifest.jobs.push_back(csv_job(number, *header, cells(line, separator), key));
    } else if (!csv_named_separator(line)) {
      separator = csv_separator(line, has_key).value_or(',');
      header = cells(line, separator);
    }
  });
}

Manifest read_manifest(const std::filesystem::path& path) {
  if (path.extension() == ".csv") return read_table(path, command_key);
  return read_lines(path, [](Manifest& manifest, std::size_t number, std::string_view line) {
    manifest.jobs.push_back(json_job(number, std::string(line)));
  });
}

}  // namespace bespoke
