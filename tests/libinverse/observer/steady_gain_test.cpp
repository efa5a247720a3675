#include "libinverse/observer/steady_gain.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>

#include "libsim/base/error.hpp"
#include "libsim/model/transfer.hpp"
#include "tests/libinverse/observer/bowed_record.hpp"

namespace modcal::observer::steady_gain_test {
namespace {

constexpr double kContact = 0.03;
const double kNoise[2] = {0.01, 0.02};

ModalBasis short_basis(std::int64_t modes) {
  StringModel string = paper_scene().string;
  string.modes = modes;
  return make_modal_basis(string);
}

TEST(SteadyGain, SolvesTheRiccatiEquation) {
  for (const double q : {0.1, 1e-3}) {
    const SteadyGain result = steady_gain(short_basis(50), kContact, kRecordRate, q, kNoise);
    EXPECT_TRUE(result.converged);
    EXPECT_LE(result.doublings, 25u);
    EXPECT_LT(result.residual, 1e-12);
  }
}

// The covariance recursion of the filter, written out in displacements and velocities (another
// state than that of the tested code), run until it no longer changes.
TEST(SteadyGain, IsTheLimitOfTheFilterRecursion) {
  const ModalBasis basis = short_basis(3);
  const auto n = static_cast<Eigen::Index>(basis.size());
  const double period = 1.0 / kRecordRate, q = 0.05;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 2 * n), h = Eigen::MatrixXd::Zero(2, 2 * n);
  Eigen::VectorXd b(2 * n);
  const std::vector<double> shape = basis.shape_at(kContact);
  const std::vector<double> left = reaction_gains(basis, End::kLeft);
  const std::vector<double> right = reaction_gains(basis, End::kRight);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto m = static_cast<std::size_t>(i);
    const double decay = basis.zeta[m] * basis.omega[m];
    const double damped = std::sqrt(basis.omega[m] * basis.omega[m] - decay * decay);
    const double e = std::exp(-decay * period), c = std::cos(damped * period),
                 s = std::sin(damped * period);
    a(2 * i, 2 * i) = e * (c + decay / damped * s);
    a(2 * i, 2 * i + 1) = e * s / damped;
    a(2 * i + 1, 2 * i) = -e * s * basis.omega[m] * basis.omega[m] / damped;
    a(2 * i + 1, 2 * i + 1) = e * (c - decay / damped * s);
    // Answer to a held force: A turns the distance to the static deflection.
    const double deflection = shape[m] / (basis.mass[m] * basis.omega[m] * basis.omega[m]);
    b(2 * i) = deflection * (1.0 - a(2 * i, 2 * i));
    b(2 * i + 1) = -deflection * a(2 * i + 1, 2 * i);
    h(0, 2 * i) = left[m];
    h(1, 2 * i) = right[m];
  }
  const Eigen::Matrix2d r =
      Eigen::Vector2d(kNoise[0] * kNoise[0], kNoise[1] * kNoise[1]).asDiagonal();
  Eigen::MatrixXd p = Eigen::MatrixXd::Zero(2 * n, 2 * n), k;
  for (int i = 0; i < 40000; ++i) {
    k = p * h.transpose() * (h * p * h.transpose() + r).inverse();
    p = a * (p - k * h * p) * a.transpose() + q * q * b * b.transpose();
  }
  const SteadyGain result = steady_gain(basis, kContact, kRecordRate, q, kNoise);
  // The error's covariance with that gain and no force at work.
  Eigen::MatrixXd quiet = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  for (int i = 0; i < 40000; ++i) {
    quiet = a *
            ((Eigen::MatrixXd::Identity(2 * n, 2 * n) - k * h) * quiet *
                 (Eigen::MatrixXd::Identity(2 * n, 2 * n) - k * h).transpose() +
             k * r * k.transpose()) *
            a.transpose();
  }
  const double excess =
      0.5 * ((h * quiet * h.transpose()).diagonal().array() / r.diagonal().array()).sum();
  EXPECT_GT(excess, 1e-3);
  EXPECT_NEAR(result.quiet_misfit, 1.0 + excess, 1e-6 * excess);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto m = static_cast<std::size_t>(i);
    const double decay = basis.zeta[m] * basis.omega[m];
    const double damped = std::sqrt(basis.omega[m] * basis.omega[m] - decay * decay);
    for (int sensor = 0; sensor < 2; ++sensor) {
      const std::complex<double> expected =
          shape[m] * std::complex<double>(k(2 * i + 1, sensor) + decay * k(2 * i, sensor),
                                          damped * k(2 * i, sensor));
      const auto& row = result.gain[static_cast<std::size_t>(sensor)];
      // The recursion forgets like e^{−2·(slowest pole)·t}; what is left is rounding of 4e4 steps.
      EXPECT_LT(std::abs(row.at(m) - expected), 1e-8 * std::abs(expected)) << m << ' ' << sensor;
    }
  }
}

TEST(SteadyGain, RefusesNoiseThatIsNotPositive) {
  const double silent[2] = {0.01, 0.0};
  EXPECT_THROW(steady_gain(short_basis(3), kContact, kRecordRate, 0.1, silent), InvalidInput);
  EXPECT_THROW(steady_gain(short_basis(3), kContact, kRecordRate, 0.0, kNoise), InvalidInput);
}

}  // namespace
}  // namespace modcal::observer::steady_gain_test
