#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "bespoke/product/product_io.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke::test {

/// Files of a test's own, and what reading them complains of.
class MeshFiles : public ::testing::Test {
 protected:
  std::filesystem::path file(const std::string& name, const std::string& content) const {
    write_text(directory_ / name, content);
    return directory_ / name;
  }
  static std::string complaint(const std::filesystem::path& path) {
    return error_message<FormatError>([&] { read_product(path); });
  }
  std::string complaint(const std::string& name, const std::string& content) const {
    return complaint(file(name, content));
  }

  ScratchDirectory directory_;
};

inline const std::string square_obj =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
    "vt 0 0\nvt 0.5 0\nvt 0.5 0.25\n";

/// A PLY file of four vertices and one face with this body.
inline std::string ply(const std::string& format, const std::string& body,
                       const std::string& vertex_properties = "",
                       const std::string& list = "property list uchar int vertex_indices\n") {
  return "ply\nformat " + format +
         " 1.0\ncomment by hand\nobj_info element none\nelement vertex 4\nproperty float x\nproperty double "
         "y\nproperty float z\n" +
         vertex_properties + "element face 1\n" + list + "end_header\n" + body;
}

}  // namespace bespoke::test
