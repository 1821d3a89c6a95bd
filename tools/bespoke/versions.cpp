#include "versions.h"

#include <expat.h>
#include <openssl/opensslv.h>
#include <openvdb/version.h>
#include <tbb/tbb.h>
#include <zlib.h>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace bespoke::command {
namespace {

std::string dotted(int major, int minor, int patch) {
  return std::to_string(major) + '.' + std::to_string(minor) + '.' + std::to_string(patch);
}

}  // namespace

std::string versions_json() {
  const nlohmann::ordered_json versions = {
      {"bespoke", BESPOKE_VERSION},
      {"openvdb", OPENVDB_LIBRARY_VERSION_STRING},
      {"tbb", dotted(TBB_VERSION_MAJOR, TBB_VERSION_MINOR, 0)},
      {"eigen", dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
      {"openssl", OPENSSL_VERSION_TEXT},
      {"zlib", ZLIB_VERSION},
      {"expat", dotted(XML_MAJOR_VERSION, XML_MINOR_VERSION, XML_MICRO_VERSION)},
      {"nlohmann_json",
       dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH)},
      {"cli11", CLI11_VERSION},
      {"compiler", __VERSION__}};
  return versions.dump(1);
}

}  // namespace bespoke::command
