#pragma once

namespace bespoke {

/// Wendland's compactly supported, positive definite functions of three variables as functions of s = r/λ, 1
/// at 0 and 0 from 1 on. `slope_over_s` is φ'(s)/s, finite at 0: ∇φ(|x|/λ) = x · slope_over_s(s) / λ².

/// φ₃,₁ (C2): (1 − s)⁴ (4 s + 1).
struct WendlandC2 {
  static double value(double s) {
    const double q = s < 1 ? 1 - s : 0;
    return q * q * q * q * (4 * s + 1);
  }
  static double slope_over_s(double s) {
    const double q = s < 1 ? 1 - s : 0;
    return -20 * q * q * q;
  }
  /// max over s of |φ'(s)|, at s = 1/4.
  static constexpr double max_slope = 135.0 / 64.0;
};

/// φ₃,₂ (C4): (1 − s)⁶ (35 s² + 18 s + 3) / 3. The paper's Eq. 16 (credited there to Buhmann).
struct WendlandC4 {
  static double value(double s) {
    const double q = s < 1 ? 1 - s : 0;
    const double q2 = q * q;
    return q2 * q2 * q2 * ((35 * s + 18) * s + 3) / 3;
  }
  static double slope_over_s(double s) {
    const double q = s < 1 ? 1 - s : 0;
    const double q2 = q * q;
    return -56.0 / 3.0 * q2 * q2 * q * (5 * s + 1);
  }
};

}  // namespace bespoke
