#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>

#include "bespoke/error.h"
#include "bespoke/product/carry_product.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke::test {

/// A motion of one frame out of functions of a point.
inline PointMotion point_motion(const std::function<Vector3(const Vector3&)>& image,
                                const std::function<Matrix3(const Vector3&)>& jacobian) {
  PointMotion motion;
  motion.images = [image](const Points& x) {
    Points y(3, x.cols());
    for (Eigen::Index i = 0; i < x.cols(); ++i) y.col(i) = image(x.col(i));
    return std::vector<Points>{y};
  };
  motion.jacobians = [jacobian](const Points& x) {
    Points j(3, 3 * x.cols());
    for (Eigen::Index i = 0; i < x.cols(); ++i) j.middleCols<3>(3 * i) = jacobian(x.col(i));
    return std::vector<Points>{j};
  };
  return motion;
}

inline PointMotion identity_motion() {
  return point_motion([](const Vector3& x) { return x; },
                      [](const Vector3&) -> Matrix3 { return Matrix3::Identity(); });
}

/// x ↦ A x + b.
inline PointMotion affine_motion(const Matrix3& linear, const Vector3& offset) {
  return point_motion([=](const Vector3& x) -> Vector3 { return linear * x + offset; },
                      [=](const Vector3&) { return linear; });
}

/// (x, y, z) ↦ (x, y, z + x² / 2): a bend whose Jacobian differs from place to place.
inline PointMotion bend_motion() {
  return point_motion([](const Vector3& x) { return Vector3(x[0], x[1], x[2] + 0.5 * x[0] * x[0]); },
                      [](const Vector3& x) {
                        Matrix3 jacobian = Matrix3::Identity();
                        jacobian(2, 0) = x[0];
                        return jacobian;
                      });
}

/// Products of a test's own.
class ProductFiles : public ::testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& content) const {
    write_text(directory_ / name, content);
    return (directory_ / name).string();
  }

  /// The carried file's bytes.
  std::string carried(const std::string& name, const std::string& content, const PointMotion& motion) {
    const std::filesystem::path out = directory_ / ("out_" + name);
    summary_ = carry_product(file(name, content), {out}, motion);
    return read_text(out);
  }
  std::string complaint(const std::string& name, const std::string& content) {
    return error_message<FormatError>([&] { carried(name, content, identity_motion()); });
  }

  ScratchDirectory directory_;
  CarrySummary summary_;  ///< of the last product
};

/// The bytes of a value in a binary file.
template <class Value>
std::string bytes(Value value, bool big_endian = false) {
  std::string result(sizeof value, '\0');
  std::memcpy(result.data(), &value, sizeof value);
  return big_endian ? std::string(result.rbegin(), result.rend()) : result;
}

}  // namespace bespoke::test
