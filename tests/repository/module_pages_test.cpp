#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/file_text.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;
using ::testing::AnyOfArray;
using ::testing::Each;
using ::testing::IsEmpty;
using ::testing::IsSubsetOf;

const fs::path library = fs::path(BESPOKE_SOURCE_DIR) / "src" / "bespoke";

constexpr long max_lines = 40;

/// First group of every match.
std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), expression), end; match != end; ++match)
    found.push_back(match->str(1));
  return found;
}

std::set<std::string> directories() {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(library))
    if (entry.is_directory()) names.insert(entry.path().filename());
  return names;
}

bool is_source(const fs::path& path) { return path.extension() == ".h" || path.extension() == ".cpp"; }

/// Of modules that have named ones, such as "product/gltf/scene"; `detail` is none.
std::set<std::string> subfolders() {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(library)) {
    const fs::path name = fs::relative(entry.path(), library);
    if (entry.is_directory() && name.has_parent_path() && name.filename() != "detail") names.insert(name);
  }
  return names;
}

/// The modules that the files of a module include, other than itself.
std::set<std::string> included_modules(const std::string& module) {
  std::set<std::string> modules;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(library / module)) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    for (const std::string& name : matches(test::read_text(entry.path()), "#include \"bespoke/([a-z0-9_]+)/"))
      modules.insert(name);
  }
  modules.erase(module);
  return modules;
}

/// What the page says after "Includes:", up to the end of the sentence.
std::set<std::string> modules_on_page(const std::string& page) {
  const std::vector<std::string> sentences = matches(page, "\n- Includes:([^.]*)\\.");
  if (sentences.size() != 1) return {"no sentence that begins with \"- Includes:\""};
  const std::vector<std::string> names = matches(sentences.front(), "`([a-z0-9_]+)`");
  return {names.begin(), names.end()};
}

/// The modules in the order of the table on the library's page.
std::vector<std::string> modules_in_order() {
  return matches(test::read_text(library / "README.md"),
                 "\n\\| \\[`([a-z0-9_]+)`\\]\\(\\1/README\\.md\\) \\|");
}

TEST(ModulePages, TableListsEveryModule) {
  const std::vector<std::string> modules = modules_in_order();
  EXPECT_EQ(std::set<std::string>(modules.begin(), modules.end()), directories());
}

TEST(ModulePages, HaveAtMostFortyLines) {
  for (const std::string& module : directories()) {
    const std::string page = test::read_text(library / module / "README.md");
    EXPECT_GT(page.size(), 0u) << module;
    EXPECT_LE(std::count(page.begin(), page.end(), '\n'), max_lines) << module;
  }
}

TEST(ModulePages, NameTheModulesThatAreIncluded) {
  for (const std::string& module : directories())
    EXPECT_EQ(modules_on_page(test::read_text(library / module / "README.md")), included_modules(module))
        << module;
}

TEST(ModulePages, ModulesIncludeOnlyThoseAboveThemInTheTable) {
  std::vector<std::string> above;
  for (const std::string& module : modules_in_order()) {
    EXPECT_THAT(included_modules(module), IsSubsetOf(above)) << module;
    above.push_back(module);
  }
}

TEST(ModulePages, SubfoldersHavePages) {
  for (const std::string& folder : subfolders()) {
    const std::string page = test::read_text(library / folder / "README.md");
    EXPECT_EQ(page.rfind("# " + folder + "\n", 0), 0u) << folder;
    EXPECT_LE(std::count(page.begin(), page.end(), '\n'), max_lines) << folder;
  }
}

TEST(ModulePages, FoldersHoldAtMostTwelveUnits) {
  for (const fs::directory_entry& folder : fs::recursive_directory_iterator(library)) {
    if (!folder.is_directory()) continue;
    std::set<std::string> units;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
      if (is_source(entry.path())) units.insert(entry.path().stem());
    EXPECT_LE(units.size(), 12u) << folder;
  }
}

// The module's page lists them in their order; each may include those above it and the module's own headers.
TEST(ModulePages, SubfoldersIncludeOnlyThoseAboveThemInTheirModulesTable) {
  for (const std::string& module : directories()) {
    const std::vector<std::string> listed = matches(test::read_text(library / module / "README.md"),
                                                    "\n\\| \\[`([a-z0-9_/]+)`\\]\\(\\1/README\\.md\\) \\|");
    std::set<std::string> above;
    for (const std::string& folder : listed) {
      above.insert(module + "/" + folder);
      for (const fs::directory_entry& entry : fs::directory_iterator(library / module / folder)) {
        if (!is_source(entry.path())) continue;
        for (const std::string& header :
             matches(test::read_text(entry.path()),
                     "#include \"bespoke/(" + module + "/[a-z0-9_/]+)/[a-z0-9_]+\\.h"))
          EXPECT_TRUE(above.contains(header)) << entry.path() << ": " << header;
      }
    }
    for (const std::string& folder : subfolders())
      if (folder.rfind(module + "/", 0) == 0) {
        EXPECT_TRUE(above.contains(folder)) << folder;
      }
  }
}

// A header in a folder of MODULE may be named by the files of MODULE and by the tests alone.
TEST(ModulePages, DetailsStayInTheirModules) {
  for (const char* tree : {"src", "samples", "tools"})
    for (const fs::directory_entry& entry :
         fs::recursive_directory_iterator(fs::path(BESPOKE_SOURCE_DIR) / tree)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      const std::string from = fs::relative(entry.path(), library).begin()->string();
      for (const std::string& module :
           matches(test::read_text(entry.path()), "\"bespoke/([a-z0-9_]+)/[a-z0-9_]+/"))
        EXPECT_EQ(module, from) << entry.path();
    }
}

TEST(ModulePages, PublicHeadersNameNoDetails) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(library))
    if (entry.path().extension() == ".h" && entry.path().parent_path().parent_path() == library) {
      EXPECT_THAT(matches(test::read_text(entry.path()), "\"bespoke/([a-z0-9_]+)/[a-z0-9_]+/"), IsEmpty())
          << entry.path();
    }
}

std::set<std::string> installed_headers() {
  const std::vector<std::string> names =
      matches(test::read_text(fs::path(BESPOKE_SOURCE_DIR) / "cmake" / "BespokePublicHeaders.cmake"),
              "\n  ([a-z0-9_/]+\\.h)");
  return {names.begin(), names.end()};
}

TEST(ModulePages, InstalledHeadersIncludeOnlyInstalledOnes) {
  const std::set<std::string> installed = installed_headers();
  ASSERT_GT(installed.size(), 0u);
  for (const std::string& header : installed)
    EXPECT_THAT(matches(test::read_text(library / header), "#include \"bespoke/([^\"]+)\""),
                Each(AnyOfArray(installed)))
        << header;
}

TEST(ModulePages, SampleProgramsIncludeOnlyInstalledHeaders) {
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(BESPOKE_SOURCE_DIR) / "samples"))
    if (entry.path().extension() == ".cpp") {
      EXPECT_THAT(matches(test::read_text(entry.path()), "#include <bespoke/([^>]+)>"),
                  Each(AnyOfArray(installed_headers())))
          << entry.path();
    }
}

// A heavy or replaceable library is known to few files: the places that each may be included from.
TEST(ModulePages, LibrariesAreIncludedInTheirPlacesOnly) {
  const std::map<std::string, std::set<fs::path>> places = {
      {"openvdb/",
       {"asset/grids/grid_conversion.cpp", "asset/grids/source_distance.cpp", "asset/grids/vdb_grid.h",
        "asset/grids/vdb_leaves.h", "asset/grids/vdb_part.cpp", "cloud/detail/surface_net.cpp"}},
      {"OpenMesh/", {"topology/half_edge_mesh.h"}},
      {"meshoptimizer.h", {"topology/decimation.cpp"}},
      {"cairo/", {"pattern/sheet/sheet_pdf.cpp"}},
      {"polyclipping/", {"pattern/sheet/seam_allowance.cpp"}},
      {"nifti/", {"exchange/detail/nifti_file.cpp"}},
      {"openssl/", {"base64.cpp", "sha256.cpp"}},
      {"png.h", {"page/detail/picture.cpp"}},
      {"zip.h", {"product/threemf/threemf_write.cpp", "product/threemf/zip_file.cpp"}},
      {"tbb/", {"parallel.cpp", "thread_arena.cpp"}},
      {"nlohmann/",
       {"anchors/anchor_files.cpp", "anchors/detail/anchor_json.cpp", "anchors/detail/point_files.cpp",
        "anchors/detail/slicer_markups.cpp", "asset/detail/record_json.cpp", "exchange/glb_file.cpp",
        "pattern/sheet/pattern_json.cpp", "pattern/read_pattern.cpp", "pattern/seam_file.cpp",
        "pipeline/summary_json.h", "product/gltf/document/gltf_json.h"}}};
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(library)) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    const std::string text = test::read_text(entry.path());
    for (const auto& [name, files] : places)
      if (text.find("#include <" + name) != std::string::npos) {
        EXPECT_TRUE(files.contains(fs::relative(entry.path(), library))) << entry.path() << ": " << name;
      }
  }
}

TEST(ModulePages, LinkToPagesThatExist) {
  std::vector<fs::path> pages{library / "README.md"};
  for (const std::string& module : directories()) pages.push_back(library / module / "README.md");
  for (const fs::path& page : pages)
    for (const std::string& link : matches(test::read_text(page), "\\]\\(([^)#]+)"))
      EXPECT_TRUE(fs::exists(page.parent_path() / link)) << page << ": " << link;
}

}  // namespace
}  // namespace bespoke
