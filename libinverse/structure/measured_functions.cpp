#include "libinverse/structure/measured_functions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libinverse/structure/function_contour.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"
#include "libsim/base/turn.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

std::vector<double> powers_of(const std::vector<Complex>& values, std::size_t from = 0) {
  std::vector<double> powers;
  for (std::size_t m = from; m < values.size(); ++m) powers.push_back(std::norm(values[m]));
  return powers;
}

double spacing_hz(const FrequencyGrid& grid) { return grid.spacing / kTurn; }

std::vector<Complex> mean_of(const std::vector<Transfers>& sessions, std::size_t k) {
  std::vector<Complex> mean(sessions.front()[k].size(), 0.0);
  for (const Transfers& session : sessions) {
    for (std::size_t l = 0; l < mean.size(); ++l) {
      mean[l] += session[k][l] / static_cast<double>(sessions.size());
    }
  }
  return mean;
}

// Variance of one more session over Σ_s |H_s − mean|².
double further(std::size_t sessions) {
  const auto count = static_cast<double>(sessions);
  return (1.0 + 1.0 / count) / (count - 1.0);
}

// What a contour weighs lines by that were not measured, over all (Poisson's kernel).
double weight_outside(double omega, double first, double last, double decay) {
  if (decay <= 0.0) return 0.0;
  const auto within = [decay](double from, double to) {
    return (std::atan(to / decay) - std::atan(from / decay)) / std::numbers::pi;
  };
  return 0.5 - within(0.0, last - omega) + within(omega - first, omega + first);
}

// A factor 1 + share u(ω), E|u|² = 1 at every frequency, which changes over kReach.
void multiply_by_factor(std::vector<Complex>& values, const ContourSpectra& spectra, double share,
                        const StreamKey& key) {
  if (share <= 0.0) return;
  const double highest = spectra.s(spectra.count() - 1).imag() / kTurn;
  std::vector<double> knots(2 * (static_cast<std::size_t>(highest / kReach) + 2));
  fill_standard_normal(key, knots);
  for (std::size_t m = 0; m < values.size(); ++m) {
    const double place = spectra.s(m).imag() / kTurn / kReach, knot = std::floor(place);
    const auto i = 2 * static_cast<std::size_t>(knot);
    const double turn = 0.5 * std::numbers::pi * (place - knot);
    const Complex u = std::cos(turn) * Complex(knots[i], knots[i + 1]) +
                      std::sin(turn) * Complex(knots[i + 2], knots[i + 3]);
    values[m] *= 1.0 + std::sqrt(0.5) * share * u;
  }
}

}  // namespace

ContourSpectra MeasuredFunctions::lines(std::size_t session, double low, double high) const {
  const Transfers& response = sessions[session];
  MODCAL_REQUIRE(!response.empty() && sensors.size() == response.size(),
                 "{} kinds of sensors for {} response functions", sensors.size(), response.size());
  ContourSpectra spectra{.grid = grid, .bins = bins_between(grid, kTurn * low, kTurn * high)};
  spectra.samples = 2 * (grid.bins - 1);
  spectra.sample_rate = static_cast<double>(spectra.samples) * grid.spacing / kTurn;
  MODCAL_REQUIRE(spectra.count() > 0, "no line of the response lies from {:g} Hz to {:g} Hz", low,
                 high);
  spectra.force.assign(spectra.count(), 1.0);
  for (std::size_t k = 0; k < response.size(); ++k) {
    MODCAL_REQUIRE(response[k].size() == grid.bins, "response {} has {} lines in the place of {}",
                   k + 1, response[k].size(), grid.bins);
    const auto first = response[k].begin() + static_cast<std::ptrdiff_t>(spectra.bins.first);
    spectra.responses.emplace_back(first, first + static_cast<std::ptrdiff_t>(spectra.count()));
    for (std::size_t m = 0; m < spectra.count(); ++m) {
      const Complex h = spectra.responses.back()[m];
      MODCAL_REQUIRE(std::isfinite(h.real()) && std::isfinite(h.imag()),
                     "response {} is not finite at {:g} Hz: leave that line out of the band", k + 1,
                     spectra.s(m).imag() / kTurn);
    }
  }
  return spectra;
}

Transfers MeasuredFunctions::at(const ContourSpectra& spectra) const {
  const FunctionContour contour(grid, spectra);
  Transfers result;
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    result.push_back(contour.of(mean_of(sessions, k), sensors[k]));
  }
  return result;
}

std::vector<std::vector<double>> MeasuredFunctions::variances(const ContourSpectra& spectra) const {
  const FunctionContour contour(grid, spectra);
  const double own_spacing = spacing_hz(spectra.grid);
  std::vector<std::vector<double>> result;
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const std::vector<Complex> mean = mean_of(sessions, k), own = contour.of(mean, sensors[k]);
    const std::vector<double> flank = smoothed(powers_of(own), own_spacing, kFlank);
    std::vector<double>& variance = result.emplace_back(spectra.count(), 0.0);
    const double share = scatter.empty() ? 0.0 : scatter[k];
    if (sessions.size() > 1) {
      for (const Transfers& session : sessions) {
        const std::vector<Complex> moved = contour.of(session[k], sensors[k]);
        for (std::size_t m = 0; m < variance.size(); ++m) {
          variance[m] += further(sessions.size()) * std::norm(moved[m] - own[m]);
        }
      }
      variance = smoothed(variance, own_spacing, kFlank);
    }
    const double first = first_line_of(mean), lines = static_cast<double>(mean.size() - 1);
    const double edge =
        smoothed(powers_of(mean, static_cast<std::size_t>(first)), spacing_hz(grid), kReach).back();
    std::vector<double> by_line(spectra.count(), 0.0);
    if (!random.empty()) {
      std::vector<double> of_lines(mean.size(), 0.0);
      for (auto l = static_cast<std::size_t>(first); l < mean.size(); ++l) {
        of_lines[l] = random[k][l] * std::norm(mean[l]);
      }
      by_line = contour.variance_of(of_lines);
    }
    for (std::size_t m = 0; m < variance.size(); ++m) {
      const double omega = spectra.s(m).imag();
      const double outside =
          weight_outside(omega, first * grid.spacing, lines * grid.spacing, contour.decay());
      variance[m] += by_line[m] + share * share * flank[m] + outside * outside * edge;
    }
  }
  return result;
}

Transfers MeasuredFunctions::drawn(const ContourSpectra& spectra, double wide, std::uint64_t seed,
                                   std::size_t draw) const {
  const FunctionContour contour(grid, spectra);
  const StreamKey key = StreamKey(seed).with("functions").with(draw);
  std::vector<double> shares(sessions.size(), 0.0);
  if (sessions.size() > 1) {
    fill_standard_normal(key.with("session"), shares);
    const double few = student_quantile(sessions.size() - 1) / student_quantile(0);
    for (double& share : shares) share *= wide * few * std::sqrt(further(sessions.size()));
  }
  Transfers result;
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const std::vector<Complex> mean = mean_of(sessions, k);
    std::vector<Complex> lines = mean;
    std::vector<double> normal(2 * lines.size());
    fill_standard_normal(key.with("line").with(k), normal);
    for (std::size_t l = 0; l < lines.size(); ++l) {
      for (std::size_t i = 0; i < sessions.size(); ++i) {
        lines[l] += shares[i] * (sessions[i][k][l] - mean[l]);
      }
      if (random.empty()) continue;
      // Half of a complex number's power each.
      lines[l] += wide * std::sqrt(0.5 * random[k][l] * std::norm(mean[l])) *
                  Complex(normal[2 * l], normal[2 * l + 1]);
    }
    std::vector<Complex>& values = result.emplace_back(contour.of(lines, sensors[k]));
    multiply_by_factor(values, spectra, wide * (scatter.empty() ? 0.0 : scatter[k]),
                       key.with("factor").with(k));
  }
  return result;
}

double MeasuredFunctions::rings_on() const {
  double most = 0.0;
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const std::vector<double> response = impulse_response(mean_of(sessions, k), sensors[k]);
    const std::size_t eighth = response.size() / 8;
    const auto power = [&](std::size_t from) {
      double sum = 0.0;
      for (std::size_t j = from * eighth; j < (from + 2) * eighth; ++j)
        sum += response[j] * response[j];
      return sum;
    };
    most = std::max(most, std::sqrt(power(5) / std::max(power(0), 1e-300)));
  }
  return most;
}

}  // namespace modcal
