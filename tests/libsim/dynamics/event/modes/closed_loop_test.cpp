#include "libsim/dynamics/event/modes/closed_loop.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "libsim/dynamics/event/modes/modal_kernels.hpp"
#include "libsim/dynamics/event/modes/secular_roots.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::event::closed_loop_test {
namespace {

using Complex = std::complex<double>;

ContactModes paper_modes(std::int64_t count = 50, double position = 0.03) {
  Scene scene = paper_scene();
  scene.string.modes = count;
  return contact_modes(make_modal_basis(scene.string), position, {});
}

double critical_damping(const ContactModes& modes, double stiffness) {
  return 2.0 * std::sqrt(stiffness * modes.effective_mass());
}

std::vector<OpenLoopMode> open_loop(const ContactModes& modes) {
  std::vector<OpenLoopMode> result;
  for (std::size_t n = 0; n < modes.size(); ++n) result.push_back({modes.pole[n], modes.drive[n]});
  return result;
}

// Real matrix of (Re Z, Im Z) with the adherence force closing the loop, Im Z as it is.
Eigen::MatrixXd closed_matrix(const ContactModes& modes, double stiffness, double damping) {
  const auto n = static_cast<Eigen::Index>(modes.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    a(i, i) += modes.pole[k].real();
    a(i, n + i) -= modes.pole[k].imag();
    a(n + i, i) += modes.pole[k].imag();
    a(n + i, n + i) += modes.pole[k].real();
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto m = static_cast<std::size_t>(j);
      a(i, j) -= modes.drive[k] * damping;
      a(i, n + j) -=
          modes.drive[k] * (stiffness * modes.compliance[m] - damping * modes.quadrature[m]);
    }
  }
  return a;
}

std::vector<Complex> with_conjugates(const std::vector<SecularRoot>& roots) {
  std::vector<Complex> all;
  for (const SecularRoot& root : roots) {
    all.push_back(root.value());
    if (!root.is_real()) all.push_back(std::conj(root.value()));
  }
  return all;
}

void expect_the_eigenvalues(const ContactModes& modes, double stiffness, double damping) {
  const auto roots = secular_roots(open_loop(modes), stiffness, damping);
  ASSERT_TRUE(roots.has_value());
  std::vector<Complex> found = with_conjugates(*roots);
  const Eigen::MatrixXd matrix = closed_matrix(modes, stiffness, damping);
  const auto expected = matrix.eigenvalues();
  ASSERT_EQ(found.size(), static_cast<std::size_t>(expected.size()));
  for (const Complex& value : expected) {
    const auto nearest = std::min_element(found.begin(), found.end(), [&](Complex a, Complex b) {
      return std::abs(a - value) < std::abs(b - value);
    });
    // The dense eigenvalues carry eps·‖A‖ times their condition, about 20; ‖A‖ ≤ its norm.
    EXPECT_LT(std::abs(*nearest - value), 20 * 2.2e-16 * matrix.norm());
    found.erase(nearest);
  }
}

TEST(SecularRoots, AreTheEigenvaluesOfTheHeldString) {
  for (const double stiffness : {1e2, 1e5, 1e8}) {
    const ContactModes modes = paper_modes();
    expect_the_eigenvalues(modes, stiffness, critical_damping(modes, stiffness));
    expect_the_eigenvalues(modes, stiffness, 0.0);
  }
}

// Poles and roots on the imaginary axis, one root far above all poles: iterates that start on the
// axis cannot pass through each other. A root found twice would be a wrong motion, not a failure.
TEST(SecularRoots, AreFoundWithoutAnyDamping) {
  for (const std::int64_t count : {3, 50, 150}) {
    for (const double position : {0.03, 0.0471}) {
      for (const double stiffness : {1e2, 1e5, 1e7, 1e9}) {
        for (const double damping : {0.0, 1e-3}) {
          ContactModes modes = paper_modes(count, position);
          for (Complex& pole : modes.pole) pole = {0.0, std::abs(pole)};
          std::fill(modes.quadrature.begin(), modes.quadrature.end(), 0.0);
          for (std::size_t n = 0; n < modes.size(); ++n) {
            modes.compliance[n] = 1.0 / modes.pole[n].imag();
          }
          expect_the_eigenvalues(modes, stiffness, damping);
          EXPECT_TRUE(make_closed_loop(modes, stiffness, damping).has_value())
              << count << " modes, " << stiffness << " N/m, " << damping << " N s/m";
        }
      }
    }
  }
}

TEST(SecularRoots, FindRealRootsOfAnOverdampedContact) {
  const ContactModes modes = paper_modes(4);
  const double damping = 20.0 * critical_damping(modes, 1e5);
  const auto roots = secular_roots(open_loop(modes), 1e5, damping);
  ASSERT_TRUE(roots.has_value());
  EXPECT_EQ(std::count_if(roots->begin(), roots->end(), [](auto r) { return r.is_real(); }), 2);
  expect_the_eigenvalues(modes, 1e5, damping);
}

TEST(SecularRoots, KeepTheDigitsOfAModeThatHardlyMoves) {
  ContactModes modes = paper_modes(6, 0.05);
  modes.drive[3] = 1e-22;
  const auto roots = secular_roots(open_loop(modes), 1e5, 2.0);
  ASSERT_TRUE(roots.has_value());
  // First-order perturbation: μ − λ = −(K + Cλ) d/(2iω_d σ), σ the function without that mode.
  const Complex pole = modes.pole[3];
  const Complex gain = 1e5 + 2.0 * pole;
  Complex rest = 1.0;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    if (n == 3) continue;
    rest += gain * modes.drive[n] / ((pole - modes.pole[n]) * (pole - std::conj(modes.pole[n])));
  }
  const Complex expected = -gain * 1e-22 / (Complex(0.0, 2.0 * pole.imag()) * rest);
  double nearest = HUGE_VAL;
  for (const SecularRoot& root : *roots) {
    nearest = std::min(nearest, std::abs(root.minus(pole) - expected));
  }
  EXPECT_LT(nearest, 1e-12 * std::abs(expected));
}

TEST(ClosedLoop, RefusesADoubleRoot) {
  // One undamped mode with K + mω² = C²/4m.
  ContactModes modes = paper_modes(1, 0.165);
  modes.pole[0] = {0.0, 1000.0};
  const double mass = 1.0 / modes.drive[0];
  const double stiffness = 1e4;
  const double damping = 2.0 * std::sqrt(mass * (stiffness + mass * 1e6));
  EXPECT_FALSE(make_closed_loop(modes, stiffness, damping).has_value());
  EXPECT_TRUE(make_closed_loop(modes, stiffness, 1.01 * damping).has_value());
}

TEST(ClosedLoop, CoordinatesGoThereAndBack) {
  for (const double stiffness : {1e3, 1e5, 1e7}) {
    const ContactModes modes = paper_modes();
    auto loop = make_closed_loop(modes, stiffness, critical_damping(modes, stiffness));
    ASSERT_TRUE(loop.has_value());
    PlanarVector state(modes.size()), coordinates(loop->roots), back(modes.size());
    double size = 0.0;
    for (std::size_t n = 0; n < modes.size(); ++n) {
      state.set(n, {std::sin(1.0 + 3.0 * static_cast<double>(n)),
                    std::cos(2.0 * static_cast<double>(n))});
      size += std::norm(state.at(n));
    }
    apply(loop->to_closed, loop->modes, state, coordinates);
    apply(loop->to_open, loop->roots, coordinates, back);
    double error = 0.0;
    for (std::size_t n = 0; n < modes.size(); ++n) error += std::norm(back.at(n) - state.at(n));
    // Two maps of condition ≤ 30 with 50-term sums: 30² · 50 eps.
    EXPECT_LT(std::sqrt(error / size), 30 * 30 * 50 * 1.1e-16) << stiffness;
  }
}

TEST(ClosedLoop, ObservesWhatTheModesShow) {
  ContactModes modes = paper_modes(20);
  // A sensor of another structure than a string sees both parts of Z.
  for (std::complex<double>& gain : modes.left_gain) gain *= std::complex(0.6, 0.8);
  const double stiffness = 1e5, damping = critical_damping(modes, stiffness);
  auto loop = make_closed_loop(modes, stiffness, damping);
  ASSERT_TRUE(loop.has_value());
  PlanarVector state(modes.size()), w(loop->roots);
  double y = 0.0, v = 0.0, left = 0.0, right = 0.0;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const Complex z{std::sin(1.0 + 3.0 * static_cast<double>(n)),
                    1.0 / (1.0 + static_cast<double>(n))};
    state.set(n, z);
    y += modes.compliance[n] * z.imag();
    v += z.real() - modes.quadrature[n] * z.imag();
    left += (std::conj(modes.left_gain[n]) * z).real();
    right += (std::conj(modes.right_gain[n]) * z).real();
  }
  apply(loop->to_closed, loop->modes, state, w);
  std::array<double, ClosedLoop::kRows> row{};
  modal_kernels().real_products(loop->observed, w, row);
  double force = 0.0;
  for (std::size_t j = 0; j < loop->roots; ++j) force += w.re[j];
  // Rounding of 20-term sums through maps of condition below 30.
  EXPECT_NEAR(force, -stiffness * y - damping * v, 1e-12 * (stiffness * std::abs(y) + damping));
  EXPECT_NEAR(row[ClosedLoop::kVelocity], v, 1e-12 * 20);
  EXPECT_NEAR(row[ClosedLoop::kLeft], left, 1e-12 * std::abs(modes.left_gain[0]) * 20);
  EXPECT_NEAR(row[ClosedLoop::kRight], right, 1e-12 * std::abs(modes.left_gain[0]) * 20);
}

// Z = −(d/λ) f − (d/λ²) f' − (d/λ³) f'' answers a slow force, and the sensor reads Re(ḡ Z).
TEST(ClosedLoop, ASensorSeesBothPartsOfTheAnswerToASlowForce) {
  ContactModes modes = paper_modes(20);
  for (std::complex<double>& gain : modes.left_gain) gain *= std::complex(0.6, 0.8);
  const auto loop = make_closed_loop(modes, 1e5, critical_damping(modes, 1e5));
  ASSERT_TRUE(loop.has_value());
  std::array<double, 3> sums{}, sizes{};
  for (std::size_t n = 0; n < modes.size(); ++n) {
    Complex answer = -std::conj(modes.left_gain[n]) * modes.drive[n];
    for (std::size_t k = 0; k < 3; ++k) {
      answer /= modes.pole[n];
      sums[k] += answer.real();
      sizes[k] += std::abs(answer);
    }
  }
  // A few roundings of each of 20 terms.
  EXPECT_NEAR(loop->left.value, sums[0], 1e-14 * sizes[0]);
  EXPECT_NEAR(loop->left.rate, sums[1], 1e-14 * sizes[1]);
  EXPECT_NEAR(loop->left.curvature, sums[2], 1e-14 * sizes[2]);
}

// Beyond 512 modes the matrices of the change of basis are computed, not kept; the rounding of the
// sums grows with their terms.
TEST(ClosedLoop, CoordinatesOfManyModesGoThereAndBack) {
  const ContactModes modes = paper_modes(700, 0.0471);
  auto loop = make_closed_loop(modes, 1e5, critical_damping(modes, 1e5));
  ASSERT_TRUE(loop.has_value());
  EXPECT_EQ(loop->to_closed.matrix.count, 0u);
  PlanarVector state(modes.size()), coordinates(loop->roots), back(modes.size());
  double size = 0.0, y = 0.0, v = 0.0;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const Complex z{std::sin(1.0 + 3.0 * static_cast<double>(n)),
                    std::cos(2.0 * static_cast<double>(n))};
    state.set(n, z);
    size += std::norm(z);
    y += modes.compliance[n] * z.imag();
    v += z.real() - modes.quadrature[n] * z.imag();
  }
  apply(loop->to_closed, loop->modes, state, coordinates);
  apply(loop->to_open, loop->roots, coordinates, back);
  double error = 0.0, force = 0.0, gross = 0.0;
  for (std::size_t n = 0; n < modes.size(); ++n) error += std::norm(back.at(n) - state.at(n));
  EXPECT_LT(std::sqrt(error / size), 30 * 30 * 700 * 1.1e-16);
  for (std::size_t j = 0; j < loop->roots; ++j) {
    force += coordinates.re[j];
    gross += std::abs(coordinates.at(j));
  }
  EXPECT_NEAR(force, -1e5 * y - loop->damping * v, 30 * 700 * 1.1e-16 * gross);
}

}  // namespace
}  // namespace modcal::event::closed_loop_test
