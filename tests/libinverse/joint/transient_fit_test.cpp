#include "libinverse/joint/transient_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <numeric>

#include "libinverse/joint/tuning.hpp"
#include "tests/libinverse/joint/joint_case.hpp"

namespace modcal::transient_fit_test {
namespace {

using Index = Eigen::Index;

// Six modes, any numbers for transfer functions and spectra, and a prior from less than the noise
// to much more.
struct Case {
  static constexpr std::size_t kSamples = 256;
  static constexpr double kSlow = 6000.0;

  ModalBasis basis = violin_g();
  FrequencyGrid grid = FrequencyGrid::of_record(kSamples, kSlow);
  std::array<std::vector<Complex>, 2> transfer, spectra;
  std::vector<double> prior = std::vector<double>(grid.bins);
  std::array<double, 2> noise = {0.1, 0.4};

  Case() {
    for (auto* numbers : {&basis.omega, &basis.zeta, &basis.mass}) numbers->resize(6);
    const std::vector<double> draw = normal_draw(8 * grid.bins, StreamKey(5));
    for (std::size_t k = 0; k < grid.bins; ++k) {
      const double* z = &draw[8 * k];
      for (std::size_t r = 0; r < 2; ++r) {
        transfer[r].emplace_back(z[2 * r], z[2 * r + 1]);
        spectra[r].emplace_back(z[4 + 2 * r], z[5 + 2 * r]);
      }
      prior[k] = 1e-3 * std::pow(1e4, static_cast<double>(k) / static_cast<double>(grid.bins));
    }
  }
  TransientFit::Setting setting() const {
    return {.transfer = {transfer[0], transfer[1]}, .noise_variance = noise, .prior = prior};
  }
  static TransientFit::Spectra spans(std::array<std::vector<Complex>, 2>& of) {
    return {of[0], of[1]};
  }
  Eigen::Vector2cd pair(const std::array<std::vector<Complex>, 2>& of, std::size_t k) const {
    return {of[0][k], of[1][k]};
  }
  // Σ_k⁻¹ of Σ_k = diag(v) + P_k h_k h_kᴴ.
  Eigen::Matrix2cd precision(std::size_t k) const {
    const Eigen::Vector2cd h = pair(transfer, k);
    Eigen::Matrix2cd covariance = prior[k] * h * h.adjoint();
    covariance.diagonal() += Eigen::Vector2cd(noise[0], noise[1]);
    return covariance.inverse();
  }
  // Both ends' transforms of both parts of every decay: geometric sums with the poles of the
  // string.
  Eigen::Matrix2Xcd decays(std::size_t k) const {
    Eigen::Matrix2Xcd all(2, static_cast<Index>(2 * basis.size()));
    for (std::size_t n = 0; n < basis.size(); ++n) {
      const double omega = basis.omega[n], zeta = basis.zeta[n];
      const Complex rate(-zeta * omega, omega * std::sqrt(1.0 - zeta * zeta));
      const Complex turn(0.0, grid.omega(k) / kSlow);
      const Complex one = 0.5 / (1.0 - std::exp(rate / kSlow - turn));
      const Complex other = 0.5 / (1.0 - std::exp(std::conj(rate) / kSlow - turn));
      const auto column = static_cast<Index>(2 * n);
      for (int r = 0; r < 2; ++r) {
        const double gain = reaction_gains(basis, r == 0 ? End::kLeft : End::kRight)[n];
        all(r, column) = gain * (one + other);
        all(r, column + 1) = gain * Complex(0.0, 1.0) * (one - other);
      }
    }
    return all;
  }
};

// By least squares with that covariance: what is left has no part along any decay,
// Σ_k Re d_kᴴ Σ_k⁻¹ e_k = 0.
TEST(TransientFit, LeavesNothingAlongADecay) {
  const Case the;
  auto left = the.spectra;
  TransientFit::Workspace workspace;
  TransientFit(the.basis, kPosition, the.grid, Case::kSlow, false, {})
      .subtract(the.setting(), Case::spans(left), workspace);
  const auto columns = static_cast<Index>(2 * the.basis.size());
  Eigen::VectorXd along = Eigen::VectorXd::Zero(columns), size = along;
  double taken = 0.0;
  for (std::size_t k = 1; k < the.grid.bins; ++k) {
    const Eigen::VectorXd term =
        (the.decays(k).adjoint() * the.precision(k) * the.pair(left, k)).real();
    along += term;
    size += term.cwiseAbs();
    taken = std::max(taken, (the.pair(left, k) - the.pair(the.spectra, k)).norm());
  }
  // The ridge of 1e-13 and the rounding of 12 equations.
  for (Index i = 0; i < columns; ++i) EXPECT_LT(std::abs(along[i]), 1e-9 * size[i]) << i;
  EXPECT_GT(taken, 1e-2);
}

// The jackknife over clusters of bins, Δ_g = (1.001 N − a_gᵀ a_g)⁻¹ a_gᵀ e_g: a force that errs in
// one bin alone by κ times the error along it has the power Σ_g |κ d Δ_g|², which the window of
// mean square 1 spreads over the bins beside.
TEST(TransientFit, TellsTheErrorsOfItsDecays) {
  const Case the;
  auto left = the.spectra, spectra = the.spectra;
  const TransientFit fit(the.basis, kPosition, the.grid, Case::kSlow, false, {});
  TransientFit::Workspace workspace;
  fit.subtract(the.setting(), Case::spans(left), workspace);
  constexpr std::size_t kBin = 60;
  std::vector<double> force(the.grid.bins, 0.0), variance(the.grid.bins, 0.0);
  force[kBin] = 0.7;
  fit.error_variances(the.setting(), Case::spans(spectra),
                      {.force = force, .variance = {variance, {}, {}}}, workspace);
  const double found = std::accumulate(variance.begin(), variance.end(), 0.0);

  const auto columns = static_cast<Index>(2 * the.basis.size());
  const auto normal_of = [&](std::size_t k) {
    return Eigen::MatrixXd((the.decays(k).adjoint() * the.precision(k) * the.decays(k)).real());
  };
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(columns, columns);
  for (std::size_t k = 1; k < the.grid.bins; ++k) whole += normal_of(k);
  // Along the force, in units of the noise and the force that it is told with.
  const Eigen::Vector2cd h = the.pair(the.transfer, kBin);
  const double q = std::norm(h[0]) / the.noise[0] + std::norm(h[1]) / the.noise[1];
  const Eigen::Vector2cd weighted(h[0] / the.noise[0], h[1] / the.noise[1]);
  const Eigen::RowVectorXcd along =
      weighted.adjoint() * the.decays(kBin) / std::sqrt(q * (1.0 + q * the.prior[kBin]));
  const auto size = static_cast<std::size_t>(
      std::round(kClusterWidth * the.basis.omega[0] * std::sqrt(1.0 - 1e-6) / the.grid.spacing));
  double expected = 0.0;
  for (std::size_t first = 1; first < the.grid.bins; first += size) {
    Eigen::MatrixXd rest = 1.001 * whole;
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(columns);
    for (std::size_t k = first; k < std::min(first + size, the.grid.bins); ++k) {
      rest -= normal_of(k);
      slope += (the.decays(k).adjoint() * the.precision(k) * the.pair(left, k)).real();
    }
    const Eigen::VectorXd moved = rest.lu().solve(slope);
    expected += std::norm(0.7 * (along * moved.cast<Complex>())(0));
  }
  EXPECT_NEAR(found / expected, 1.0, 1e-6);  // of matrices of condition 1e4 and the ridge
}

// Six decays whose poles the fit's own ones miss by a fifth of a radian over the record, of up to a
// thousand times the noise. They leave it but for two decays a mode, 24 of 254 numbers: 0.906 with
// a deviation of √(2/254) = 0.09. A force is none of them. The same of decays that last and end in
// phase with their beginning, whose columns are far larger than they.
TEST(TransientFit, KnowsAStringThatRingsByItself) {
  for (const bool lasts : {false, true}) {
    Case the;
    const double turn = 2.0 * std::numbers::pi * Case::kSlow / Case::kSamples;
    for (std::size_t n = 0; n < the.basis.size() && lasts; ++n) {
      the.basis.zeta[n] = 1e-4;
      the.basis.omega[n] = turn * std::round(the.basis.omega[n] / turn);
    }
    const TransientFit fit(the.basis, 0.05, the.grid, Case::kSlow, false, {});
    for (double& omega : the.basis.omega) omega += 5.0;
    const std::size_t bins = the.grid.bins - 1;
    // Of as many times the noise, whatever the damping.
    const double size = lasts ? 0.001 : 0.01;
    TransientFit::Workspace workspace;
    for (std::size_t r = 0; r < 2; ++r) {
      std::vector<Complex> spectrum(the.grid.bins);
      for (std::size_t k = 0; k < the.grid.bins; ++k) {
        const Eigen::Vector2cd ringing =
            the.decays(k) * Eigen::VectorXd::LinSpaced(12, 0.5 * size, size).cast<Complex>();
        spectrum[k] =
            std::sqrt(0.5 * the.noise[r]) * the.spectra[r][k] + ringing[static_cast<Index>(r)];
      }
      const double free = fit.ringing_misfit(the.setting(), r, spectrum, bins, {}, workspace);
      EXPECT_NEAR(free, 0.906, 4.0 * 0.09);
      for (std::size_t k = 0; k < the.grid.bins; ++k) spectrum[k] += 2.0 * the.transfer[r][k];
      EXPECT_GT(fit.ringing_misfit(the.setting(), r, spectrum, bins, {}, workspace), 3.0);
    }
  }
}

// A drift of a hundred times the noise and a line between two bins, as sensors add them to a string
// that rings: with decays of their own 0.89 is left, without them far more.
TEST(TransientFit, TakesHumAndDriftFromAStringThatRings) {
  const Case the;
  const TransientFit fit(the.basis, 0.05, the.grid, Case::kSlow, false, {});
  constexpr double kLine = 150.0;
  std::vector<double> added(Case::kSamples);
  for (std::size_t j = 0; j < added.size(); ++j) {
    const double time = static_cast<double>(j) / Case::kSlow;
    added[j] = 5.0 * static_cast<double>(j) / Case::kSamples +
               3.0 * std::sin(2.0 * std::numbers::pi * kLine * time);
  }
  std::vector<Complex> spectrum = RealFft(Case::kSamples).forward(added);
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    spectrum[k] += std::sqrt(0.5 * the.noise[0]) * the.spectra[0][k];
  }
  TransientFit::Workspace workspace;
  const auto misfit = [&](std::span<const double> lines) {
    return fit.ringing_misfit(the.setting(), 0, spectrum, the.grid.bins - 1, lines, workspace);
  };
  EXPECT_NEAR(misfit(std::array{kLine}), 0.89, 4.0 * 0.09);
  EXPECT_GT(misfit({}), 10.0);
}

}  // namespace
}  // namespace modcal::transient_fit_test
