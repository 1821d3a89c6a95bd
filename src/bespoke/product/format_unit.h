#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace bespoke {

/// Metres of a unit by one of its names ("mm", "cm", "m", "metres", "in" …), whatever their case; none for
/// other names.
std::optional<double> metres_per_unit(const std::string& unit);

/// How many of the unit `to` are in one of `from`: 1 where they have one name, none where one of them is not
/// known by name.
std::optional<double> unit_factor(const std::string& from, const std::string& to);

/// The same, where a user names the unit: throws InvalidInput, with the names that are known, for one that
/// has none.
double required_unit_factor(const std::string& from, const std::string& to);

/// The unit that a file's format fixes: "m" for glTF, and what a 3MF file says (or else "mm"), for which its
/// beginning is read; empty for the others, which leave it open. By the ending of the name.
std::string unit_of_format(const std::filesystem::path& path);

/// What the coordinates of a file are multiplied by to be in `unit`: 1 where its format fixes none, or where
/// `unit` is not known by name.
double scale_to_unit(const std::filesystem::path& path, const std::string& unit);

/// The same of a product and a map's unit, where a user may name that of the product's coordinates, `given`,
/// whatever its file says: "map" is the map's own. Throws InvalidInput where `given` cannot be converted.
double product_scale(const std::filesystem::path& path, const std::string& map_unit,
                     const std::string& given = "");

/// The unit of the product's coordinates by the same rule; empty where nothing says one.
std::string product_unit(const std::filesystem::path& path, const std::string& map_unit,
                         const std::string& given = "");

/// Throws InvalidInput, naming the factor between them, where a model's format fixes a unit and `unit`, as an
/// anchors file says it, is another one or unknown. An empty one is no contradiction.
void require_unit_of_format(const std::filesystem::path& model, const std::string& unit);

/// The same of a model that messages call `model` and whose file says `own`, or nothing.
void require_unit_of_anchors(const std::string& model, const std::string& own, const std::string& unit);

}  // namespace bespoke
