#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/scene/scene.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::pluck_test {
namespace {

ModalBasis basis_of(std::int64_t modes) {
  StringModel string = paper_scene().string;
  string.modes = modes;
  return make_modal_basis(string);
}

double shape_of(const ModalState& state, const ModalBasis& basis, double x) {
  const std::vector<double> shape = basis.shape_at(x);
  double y = 0.0;
  for (std::size_t n = 0; n < basis.size(); ++n) y += shape[n] * state.displacement[n];
  return y;
}

TEST(Pluck, IsTheTriangle) {
  const ModalBasis basis = basis_of(2000);
  const ModalState state = Pluck({.position = 0.1, .displacement = 2e-3}).state(basis);
  for (const double x : {0.02, 0.05, 0.2, 0.3}) {
    const double triangle = 2e-3 * std::min(x / 0.1, (0.33 - x) / 0.23);
    // The modes left out sum to at most the tail Σ 1/n² = 1/2000 of the amplitude 2hL²/(π²x(L−x)).
    EXPECT_NEAR(shape_of(state, basis, x), triangle, 0.96 * 2e-3 / 2000.0);
  }
  for (const double v : state.velocity) EXPECT_EQ(v, 0.0);
}

TEST(Pluck, AWidePluckIsTheMeanOfThePlucksWithinItsWidth) {
  // The deflection under an even load is that under its points, averaged; a point load F at x
  // deflects the flexible string by the height h = F x (L − x)/(T L).
  const ModalBasis basis = basis_of(40);
  const double x = 0.1, width = 0.03, length = 0.33;
  const ModalState wide = Pluck({.position = x, .displacement = 1e-3, .width = width}).state(basis);
  std::vector<double> mean(basis.size());
  const int points = 2000;
  for (int i = 0; i < points; ++i) {
    const double at = x + width * ((i + 0.5) / points - 0.5);
    const double height = 1e-3 * at * (length - at) / (x * (length - x));
    const ModalState one = Pluck({.position = at, .displacement = height}).state(basis);
    for (std::size_t n = 0; n < mean.size(); ++n) mean[n] += one.displacement[n] / points;
  }
  for (std::size_t n = 0; n < mean.size(); ++n) {
    // Midpoint rule: (nπ/L · width/points)²/24 of the integrand, 1.4e-6 at n = 40.
    EXPECT_NEAR(wide.displacement[n], mean[n], 2e-6 * 1e-3);
  }
}

TEST(Pluck, RefusesAPointOffTheString) {
  const ModalBasis basis = basis_of(5);
  EXPECT_THROW(Pluck({.position = 0.33, .displacement = 1e-3}).state(basis), InvalidInput);
  EXPECT_THROW(Pluck({.position = 0.1, .displacement = 1e-3, .width = 0.21}).state(basis),
               InvalidInput);
  EXPECT_THROW(Pluck({.position = 0.1}).state(basis), InvalidInput);
}

}  // namespace
}  // namespace modcal::pluck_test
