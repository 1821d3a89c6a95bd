#include "bespoke/certificate/certificate.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "bespoke/certificate/detail/certifier.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

// A map that folds at all often folds in millions of cells, and an asset keeps the list.
constexpr std::size_t largest_number_of_places = 1000;

// Between two calls of progress; the partition does not depend on the number of threads, so counts and places
// do not.
constexpr std::size_t roots_per_step = 64;

CellCounts certify_all(const Certifier& certifier, const Progress& progress) {
  CellCounts found;
  for (std::size_t first = 0; first < certifier.roots(); first += roots_per_step) {
    progress.step("certify", first, certifier.roots());
    const std::size_t count = std::min(roots_per_step, certifier.roots() - first);
    found = combine(std::move(found), parallel_reduce(
                                          count, 1, CellCounts{},
                                          [&](std::size_t begin, std::size_t end) {
                                            return certifier.certify_roots(first + begin, first + end);
                                          },
                                          combine));
  }
  progress.step("certify", certifier.roots(), certifier.roots());
  return found;
}

}  // namespace

std::string to_string(const Certificate& certificate) {
  char text[256];
  std::snprintf(
      text, sizeof text,
      "%zu cells certified, %zu undecided, %zu folded; least determinant %.4g, of the affine part %.4g%s; "
      "%.2f s",
      certificate.certified, certificate.undecided, certificate.folded, certificate.min_determinant,
      certificate.affine_determinant, certificate.is_bijection() ? "; a bijection of space" : "",
      certificate.seconds);
  return text;
}

Certificate certify(const Pyramid& pyramid, const AffineMap& affine, double t, const Progress& progress) {
  Certificate certificate = certify_listing_all(pyramid, affine, t, progress);
  keep_first_places(certificate);
  return certificate;
}

void keep_first_places(Certificate& certificate) {
  if (certificate.places.size() > largest_number_of_places)
    certificate.places.resize(largest_number_of_places);
}

Certificate certify_listing_all(const Pyramid& pyramid, const AffineMap& affine, double t,
                                const Progress& progress) {
  const Stopwatch watch;
  require_valid(pyramid);
  if (!std::isfinite(t)) throw InvalidInput("the time t of a certificate is not finite");
  if (!(affine.linear.allFinite() && affine.offset.allFinite()))
    throw InvalidInput("the affine part of a map to certify is not finite");
  // The gradient of (1−t) x + t E(x) where u is zero.
  const Matrix3 linear = (1 - t) * Matrix3::Identity() + t * affine.linear;
  const Certifier certifier(pyramid, affine.linear, t);
  const CellCounts found = certify_all(certifier, progress);
  Certificate certificate;
  certificate.certified = found.certified;
  certificate.undecided = found.undecided;
  certificate.folded = found.folded;
  certificate.affine_determinant = linear.determinant();
  certificate.min_determinant = std::min(found.least, certificate.affine_determinant);
  certificate.places = found.places;
  certificate.seconds = watch.seconds();
  return certificate;
}

}  // namespace bespoke
