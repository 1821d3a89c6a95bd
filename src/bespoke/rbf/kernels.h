#pragma once

namespace bespoke {

/// Wendland's compactly supported, positive definite functions of three variables as functions of s = r/λ, 1
/// at 0 and 0 from 1 on. `slope_over_s` is φ'(s)/s, finite at 0: ∇φ(|x|/λ) = x · slope_over_s(s) / λ².

/// Each formula stands once, in s and q = max(0, 1 − s), for numbers and for vectors of numbers; these are
/// written to `out` because returning them depends on the instruction set (-Wpsabi).

/// φ₃,₁ (C2): (1 − s)⁴ (4 s + 1).
struct WendlandC2 {
  template <class Number>
  static void value(const Number& s, const Number& q, Number& out) {
    out = (q * q) * (q * q) * (4 * s + 1);
  }
  template <class Number>
  static void slope_over_s(const Number&, const Number& q, Number& out) {
    out = -20 * (q * q) * q;
  }
  static double value(double s);
  static double slope_over_s(double s);
  /// max over s of |φ'(s)|, at s = 1/4.
  static constexpr double max_slope = 135.0 / 64.0;
};

/// φ₃,₂ (C4): (1 − s)⁶ (35 s² + 18 s + 3) / 3. The paper's Eq. 16 (credited there to Buhmann).
struct WendlandC4 {
  template <class Number>
  static void value(const Number& s, const Number& q, Number& out) {
    const Number q2 = q * q;
    out = q2 * q2 * q2 * ((35 * s + 18) * s + 3) / 3;
  }
  template <class Number>
  static void slope_over_s(const Number& s, const Number& q, Number& out) {
    const Number q2 = q * q;
    out = -56.0 / 3.0 * q2 * q2 * q * (5 * s + 1);
  }
  static double value(double s);
  static double slope_over_s(double s);
};

namespace kernels_detail {

inline double rest(double s) { return s < 1 ? 1 - s : 0; }

template <class Function>
double value(double s) {
  double result;
  Function::value(s, rest(s), result);
  return result;
}

template <class Function>
double slope_over_s(double s) {
  double result;
  Function::slope_over_s(s, rest(s), result);
  return result;
}

}  // namespace kernels_detail

inline double WendlandC2::value(double s) { return kernels_detail::value<WendlandC2>(s); }
inline double WendlandC2::slope_over_s(double s) { return kernels_detail::slope_over_s<WendlandC2>(s); }
inline double WendlandC4::value(double s) { return kernels_detail::value<WendlandC4>(s); }
inline double WendlandC4::slope_over_s(double s) { return kernels_detail::slope_over_s<WendlandC4>(s); }

}  // namespace bespoke
