#include "libcalib/objectives/two_sided_terms.hpp"

#include <cmath>
#include <numbers>

#include "libsim/model/transfer.hpp"

namespace modcal {
namespace {

std::vector<TwoSidedTerm> terms_with(const ModelPoint& point, const std::vector<double>& shape) {
  const ModalBasis& basis = point.basis;
  const std::vector<double> left = reaction_gains(basis, End::kLeft);
  const std::vector<double> right = reaction_gains(basis, End::kRight);
  std::vector<TwoSidedTerm> terms(basis.size());
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const double share = shape[i] / basis.mass[i];
    terms[i] = {{left[i] * share, right[i] * share}, basis.omega[i], basis.zeta[i]};
  }
  return terms;
}

}  // namespace

std::vector<TwoSidedTerm> two_sided_terms(const ModelPoint& point) {
  return terms_with(point, point.basis.shape_at(point.contact));
}

std::vector<TwoSidedTerm> contact_slope_terms(const ModelPoint& point) {
  using std::numbers::pi;
  std::vector<double> slope(point.basis.size());
  for (std::size_t i = 0; i < slope.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    const double half_turns = std::remainder(n * point.contact / point.basis.length, 2.0);
    slope[i] = n * pi / point.basis.length * std::cos(pi * half_turns);
  }
  return terms_with(point, slope);
}

}  // namespace modcal
