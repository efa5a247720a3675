// Gradients and Jacobians of the objectives against automatic differentiation: the definitions
// written once more, in dual numbers (Ceres' Jets).
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "libcalib/objectives/force_difference.hpp"
#include "libcalib/objectives/smooth_spectral_peak.hpp"
#include "libcalib/objectives/spectral_peak.hpp"
#include "tests/libcalib/calibration_case.hpp"

namespace modcal::objective_jets_test {
namespace {

using Jet = ceres::Jet<double, 4>;  // x_c, f_4, f0, B
using Names = std::vector<std::string>;

constexpr std::size_t kModes = 12;
constexpr double kTikhonov = 0.3;

struct Case {
  CalibrationData data = exact_data(paper_truth(kModes), 3200, 6400.0, 196.0);
  ParameterSet parameters{with_frequency_errors(paper_truth(kModes, 1e-4), 0.01, 2),
                          Names{"x_c", "f_4", "f0", "B"}};
  std::vector<double> x = parameters.start();
};

struct Dual {
  Jet re, im;
};
Jet square(const Dual& z) { return z.re * z.re + z.im * z.im; }

/// H_1, H_2 at ω: Σ ∓T nπ/L sin(nπx_c/L)/(m (ω_n² − ω² + 2iζω_nω)).
std::array<Dual, 2> transfer(const Case& given, double omega) {
  const ModalBasis& basis = given.parameters.initial().basis;
  const Jet contact(given.x[0], 0), fourth(given.x[1], 1), f0(given.x[2], 2), stiff(given.x[3], 3);
  std::array<Dual, 2> sum{};
  for (std::size_t i = 0; i < kModes; ++i) {
    const double n = static_cast<double>(i + 1);
    const Jet frequency = i == 3 ? fourth : n * f0 * sqrt(1.0 + stiff * n * n);
    const Jet pole = 2.0 * std::numbers::pi * frequency;
    const Dual d{pole * pole - omega * omega, 2.0 * basis.zeta[i] * pole * omega};
    const double wave = n * std::numbers::pi / basis.length;
    const Jet gain = basis.tension * wave * sin(wave * contact) / basis.mass[i] / square(d);
    const double sign = i % 2 == 0 ? -1.0 : 1.0;  // (−1)ⁿ
    sum[0].re -= gain * d.re;
    sum[0].im += gain * d.im;
    sum[1].re += sign * gain * d.re;
    sum[1].im -= sign * gain * d.im;
  }
  return sum;
}

Dual force(Complex reaction, const Dual& h) {
  const Jet power = square(h);
  return {(reaction.real() * h.re + reaction.imag() * h.im) / power,
          (reaction.imag() * h.re - reaction.real() * h.im) / power};
}

/// Both forces under the common Tikhonov filter over the objectives' band.
struct Forces {
  std::vector<std::array<Dual, 2>> transfer, force;
};

Forces forces(const Case& given) {
  const FrequencyGrid grid = given.data.grid();
  const std::vector<double>& omega = given.parameters.initial().basis.omega;
  const BinRange band = bins_between(grid, 0.5 * omega.front(), 1.04 * omega.back());
  Forces result;
  for (std::size_t k = band.first; k < band.last; ++k) {
    const auto h = transfer(given, grid.omega(k));
    Jet kept(1.0);
    for (const Dual& side : h) {
      const Jet power = square(side);
      kept *= power / (power + kTikhonov * kTikhonov);
    }
    std::array<Dual, 2> both;
    for (std::size_t r = 0; r < 2; ++r) {
      const Dual plain = force(given.data.reactions[r][k], h[r]);
      both[r] = {kept * plain.re, kept * plain.im};
    }
    result.transfer.push_back(h);
    result.force.push_back(both);
  }
  return result;
}

/// Residuals r and value of a reference against those of the objective, with all slopes.
void expect_same(const Objective& objective, const Case& given, const std::vector<Jet>& residuals,
                 double tolerance) {
  const auto function = objective.bind(given.data, given.parameters);
  const std::size_t n = 4, m = function->residual_count();
  ASSERT_EQ(m, residuals.size());
  std::vector<double> gradient(n), r(m), jacobian(m * n);
  function->evaluate(
      given.x, {.gradient = gradient.data(), .residuals = r.data(), .jacobian = jacobian.data()});
  Jet value(0.0);
  for (const Jet& residual : residuals) value += 0.5 * residual * residual;
  for (std::size_t i = 0; i < n; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    double largest = 0.0, error = 0.0;
    for (std::size_t j = 0; j < m; ++j) {
      largest = std::max(largest, std::abs(residuals[j].v[column]));
      error = std::max(error, std::abs(jacobian[j * n + i] - residuals[j].v[column]));
    }
    EXPECT_LE(error, tolerance * largest) << i;
    EXPECT_NEAR(gradient[i], value.v[column], tolerance * std::abs(value.v[column])) << i;
  }
}

void expect_gradient(const Objective& objective, const Case& given, const Jet& value,
                     double tolerance) {
  const auto function = objective.bind(given.data, given.parameters);
  std::vector<double> gradient(4);
  double plain = 0.0;
  function->evaluate(given.x, {.value = &plain, .gradient = gradient.data()});
  EXPECT_NEAR(plain, value.a, tolerance * value.a);
  for (std::size_t i = 0; i < 4; ++i) {
    const double slope = value.v[static_cast<Eigen::Index>(i)];
    EXPECT_NEAR(gradient[i], slope, tolerance * std::abs(slope)) << i;
  }
}

// The slope of the filter factors is a difference right to 1e-10; bins add up with signs.
constexpr double kFiltered = 1e-7;
// Everything else is rounding, 1e-16, times cancellations near zeros of H, some hundreds each in
// value and slope.
constexpr double kExact = 1e-10;

TEST(ObjectiveJets, ForceMismatch) {
  const Case given;
  const Forces both = forces(given);
  for (const std::string weights : {"uniform", "transfer"}) {
    double power = 0.0;
    std::vector<double> weight(both.force.size(), 1.0);
    for (std::size_t k = 0; k < weight.size(); ++k) {
      const double left = square(both.transfer[k][0]).a, right = square(both.transfer[k][1]).a;
      if (weights == "transfer") weight[k] = std::sqrt(left * right / (left + right));
      power +=
          0.5 * weight[k] * weight[k] * (square(both.force[k][0]).a + square(both.force[k][1]).a);
    }
    std::vector<Jet> residuals;
    for (std::size_t k = 0; k < weight.size(); ++k) {
      const double scale = weight[k] / std::sqrt(power);
      residuals.push_back(scale * (both.force[k][0].re - both.force[k][1].re));
      residuals.push_back(scale * (both.force[k][0].im - both.force[k][1].im));
    }
    expect_same(ForceMismatch({.weights = weights}), given, residuals, kFiltered);
  }
}

TEST(ObjectiveJets, ContactLocationAndItsSquares) {
  const Case given;
  const Forces both = forces(given);
  Jet distance(0.0), power(0.0);
  for (const auto& [left, right] : both.force) {
    distance += square({left.re - right.re, left.im - right.im});
    power += square(left) + square(right);
  }
  expect_gradient(ContactLocation({}), given, sqrt(2.0 * distance / power), kFiltered);
  std::vector<Jet> residuals;
  for (const auto& [left, right] : both.force) {
    const Jet scale = sqrt(2.0 / power);
    residuals.push_back(scale * (left.re - right.re));
    residuals.push_back(scale * (left.im - right.im));
  }
  expect_same(ContactLocationSquares({}), given, residuals, kFiltered);
}

/// Bins that any band of ±4 % holds, with how many do, in the integrals of all 12 modes.
struct Bands {
  BinRange covered;
  std::vector<double> count;
};

Bands bands(const Case& given) {
  const FrequencyGrid grid = given.data.grid();
  const ModalBasis start = given.parameters.model(given.x).basis;
  Bands result;
  result.covered = bins_between(grid, 0.96 * start.omega.front(), 1.04 * start.omega.back());
  result.count.assign(result.covered.size(), 0.0);
  for (const double omega : start.omega) {
    const BinRange band = bins_between(grid, 0.96 * omega, 1.04 * omega);
    for (std::size_t k = band.first; k < band.last; ++k) {
      result.count[k - result.covered.first] += 1.0;
    }
  }
  return result;
}

TEST(ObjectiveJets, SpectralPeakAndItsSmoothVariant) {
  const Case given;
  const FrequencyGrid grid = given.data.grid();
  const Bands all = bands(given);
  const std::size_t bins = all.covered.size();
  // |F_r|² Δω²/f_s², reaction after reaction.
  std::vector<Jet> powers(2 * bins, Jet(0.0));
  Jet sum(0.0);
  double mean = 0.0, count = 0.0;
  for (std::size_t k = 0; k < bins; ++k) {
    if (all.count[k] == 0.0) continue;
    const auto h = transfer(given, grid.omega(all.covered.first + k));
    for (std::size_t r = 0; r < 2; ++r) {
      const double scale = grid.spacing / given.data.sample_rate;
      const Complex reaction = scale * given.data.reactions[r][all.covered.first + k];
      powers[r * bins + k] = std::norm(reaction) / square(h[r]);
      sum += all.count[k] * sqrt(powers[r * bins + k]);
      mean += std::sqrt(powers[r * bins + k].a);
      count += 1.0;
    }
  }
  expect_gradient(SpectralPeak(SpectralPeak::Options{}), given, sum, kExact);
  const double floor = std::pow(0.01 * mean / count, 2);
  std::vector<Jet> residuals(2 * bins, Jet(0.0));
  for (std::size_t r = 0; r < 2; ++r) {
    for (std::size_t k = 0; k < bins; ++k) {
      if (all.count[k] == 0.0) continue;
      residuals[r * bins + k] = sqrt(2.0 * all.count[k] * sqrt(powers[r * bins + k] + floor));
    }
  }
  expect_same(SmoothSpectralPeak(SmoothSpectralPeak::Options{}), given, residuals, kExact);
}

}  // namespace
}  // namespace modcal::objective_jets_test
