// Modes refined without the force: errors at the Cramér–Rao bound, within their deviations.
#include "libinverse/structure/blind_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/base/random.hpp"
#include "tests/refusal.hpp"

namespace modcal {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi, kRate = 3200.0;
constexpr double kLow = 20.0, kHigh = 400.0;

// Six modes, two of them 6 % apart, at an acceleration, a velocity and a displacement.
ModalModel structure(std::size_t sensors) {
  const std::vector<double> frequencies = {47.0, 88.0, 161.0, 171.0, 256.0, 372.0};
  const std::vector<double> ratios = {0.01, 0.008, 0.006, 0.007, 0.005, 0.004};
  const std::vector<SensorKind> kinds = {SensorKind::kAcceleration, SensorKind::kVelocity,
                                         SensorKind::kDisplacement};
  ModalModel model{
      .sensors = {kinds.begin(), kinds.begin() + static_cast<std::ptrdiff_t>(sensors)}};
  for (std::size_t n = 0; n < 6; ++n) model.poles.push_back({kTurn * frequencies[n], ratios[n]});
  for (std::size_t k = 0; k < sensors; ++k) {
    for (std::size_t n = 0; n < 6; ++n) {
      const double at = static_cast<double>((n + 1) * (k + 2));
      model.constants.push_back(std::cos(0.9 * at));
      model.quadrature.push_back(0.2 * std::sin(1.7 * at));
    }
  }
  return model;
}

// One second out of the middle of a force that never stops: the structure rings at both ends.
StructureRecord clean_record(const ModalModel& model) {
  const auto long_count = static_cast<std::size_t>(6.0 * kRate),
             count = static_cast<std::size_t>(kRate);
  const RealFft fft(long_count);
  std::vector<double> normal(2 * fft.bins());
  fill_standard_normal(StreamKey(11).with("force"), normal);
  const FrequencyGrid grid = FrequencyGrid::of_record(long_count, kRate);
  const auto transfers = model.transfer(grid);
  const auto middle = [&](std::vector<Complex> spectrum) {
    std::vector<double> samples(long_count);
    fft.inverse(spectrum, samples);
    return std::vector<double>(samples.begin() + 2 * static_cast<std::ptrdiff_t>(count),
                               samples.begin() + 3 * static_cast<std::ptrdiff_t>(count));
  };
  std::vector<Complex> force(fft.bins());
  for (std::size_t i = 1; i < force.size(); ++i) {
    const double at = grid.omega(i) / kTurn;
    if (at < 5.0 || at > 600.0) continue;
    force[i] = 100.0 * Complex(normal[2 * i], normal[2 * i + 1]);
  }
  StructureRecord record{.sample_rate = kRate, .force = middle(force)};
  for (const std::vector<Complex>& transfer : transfers) {
    std::vector<Complex> spectrum = force;
    for (std::size_t i = 0; i < spectrum.size(); ++i) spectrum[i] *= transfer[i];
    record.responses.push_back(middle(spectrum));
  }
  return record;
}

struct Noisy {
  StructureRecord record;
  BinVariances variances;
};

Noisy with_noise(StructureRecord record, double level, std::uint64_t seed) {
  Noisy noisy{.record = std::move(record)};
  std::size_t k = 0;
  for (std::vector<double>& response : noisy.record.responses) {
    double power = 0.0;
    for (const double x : response) power += x * x / static_cast<double>(response.size());
    std::vector<double> normal(response.size());
    fill_standard_normal(StreamKey(seed).with("noise").with(k++), normal);
    const double sd = level * std::sqrt(power);
    for (std::size_t j = 0; j < response.size(); ++j) response[j] += sd * normal[j];
    const auto spectra = ContourSpectra::of(noisy.record, 0.0, kLow, kHigh);
    noisy.variances.of.emplace_back(spectra.count(), sd * sd * spectra.noise_power());
  }
  return noisy;
}

ModalModel started_off(ModalModel model, std::uint64_t seed) {
  std::vector<double> normal(2 * model.poles.size());
  fill_standard_normal(StreamKey(seed).with("start"), normal);
  for (std::size_t n = 0; n < model.poles.size(); ++n) {
    model.poles[n].omega *= 1.0 + 0.005 * std::clamp(normal[2 * n], -2.0, 2.0);
    model.poles[n].zeta *= 1.0 + 0.1 * std::clamp(normal[2 * n + 1], -2.0, 2.0);
  }
  return model;
}

Eigen::VectorXd logarithms(const ModalModel& model) {
  Eigen::VectorXd result(2 * std::ssize(model.poles));
  for (std::size_t n = 0; n < model.poles.size(); ++n) {
    const auto i = static_cast<Eigen::Index>(2 * n);
    result[i] = std::log(model.poles[n].omega);
    result[i + 1] = std::log(model.poles[n].zeta);
  }
  return result;
}

// Of the poles that lie within 1.96 of their deviations.
double share_within(const Eigen::VectorXd& off, const BlindFit& fit) {
  const Eigen::ArrayXd sd = fit.covariance.diagonal().head(off.size()).array().sqrt();
  return (off.array().abs() < 1.96 * sd).cast<double>().mean();
}

class BlindFitOf : public testing::TestWithParam<std::pair<std::size_t, double>> {};

TEST_P(BlindFitOf, ReachesTheBoundFromOnePercentOff) {
  const auto [sensors, level] = GetParam();
  const ModalModel truth = structure(sensors);
  const StructureRecord clean = clean_record(truth);
  const StructureChange change{.frequency = 0.01, .damping = 0.3, .residue = 0.0};
  // The bound: without noise in the data, the noise in the weights alone.
  Noisy bound = with_noise(clean, level, 0);
  bound.record = clean;
  const BlindFit best = fit_blindly(truth, ContourSpectra::of(clean, 0.0, kLow, kHigh),
                                    bound.variances, change, false);
  const Eigen::VectorXd sd = best.covariance.diagonal().cwiseSqrt();
  double squares = 0.0, inside = 0.0, misfit = 0.0;
  constexpr int kSeeds = 20;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Noisy noisy = with_noise(clean, level, seed);
    const auto spectra = ContourSpectra::of(noisy.record, 0.0, kLow, kHigh);
    const BlindFit fit =
        fit_blindly(started_off(truth, seed), spectra, noisy.variances, change, false);
    const Eigen::VectorXd off = logarithms(fit.model) - logarithms(truth);
    squares += off.cwiseQuotient(sd).squaredNorm() / static_cast<double>(off.size()) / kSeeds;
    inside += share_within(off, fit) / kSeeds;
    misfit += fit.misfit / kSeeds;
  }
  // 240 squares, a third more scattered for their correlations: the root of their mean has a
  // deviation of .06, the share of 95 % one of .02, χ² of 1900 degrees and more one of .01.
  EXPECT_LT(std::sqrt(squares), 1.2);
  EXPECT_GT(std::sqrt(squares), 0.75);
  EXPECT_GT(inside, 0.89);
  EXPECT_NEAR(misfit, 1.0, 0.04);
}

INSTANTIATE_TEST_SUITE_P(Cases, BlindFitOf,
                         testing::Values(std::pair{3ul, 0.01}, std::pair{3ul, 0.05},
                                         std::pair{2ul, 0.01}, std::pair{2ul, 0.05}));

TEST(BlindFit, CorrectsResiduesThatAreThreePercentOff) {
  const ModalModel truth = structure(3);
  const StructureRecord clean = clean_record(truth);
  double inside = 0.0, ignored = 0.0, misfit = 0.0;
  constexpr int kSeeds = 15;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    ModalModel table = started_off(truth, seed);
    std::vector<double> normal(2 * table.constants.size());
    fill_standard_normal(StreamKey(seed).with("residues"), normal);
    for (std::size_t i = 0; i < table.constants.size(); ++i) {
      const Complex wrong = Complex(table.constants[i], table.quadrature[i]) *
                            Complex(1.0 + 0.03 * normal[2 * i], 0.03 * normal[2 * i + 1]);
      table.constants[i] = wrong.real();
      table.quadrature[i] = wrong.imag();
    }
    const Noisy noisy = with_noise(clean, 0.01, seed);
    const auto spectra = ContourSpectra::of(noisy.record, 0.0, kLow, kHigh);
    const auto fit_with = [&](double residue) {
      return fit_blindly(table, spectra, noisy.variances,
                         {.frequency = 0.01, .damping = 0.3, .residue = residue}, false);
    };
    const BlindFit fit = fit_with(0.03), other = fit_with(0.0);
    inside += share_within(logarithms(fit.model) - logarithms(truth), fit) / kSeeds;
    ignored += share_within(logarithms(other.model) - logarithms(truth), other) / kSeeds;
    misfit += fit.misfit / kSeeds;
  }
  // 180 poles, as above; a prior's share of the degrees of freedom is known to some of 5000.
  EXPECT_GT(inside, 0.88);
  EXPECT_NEAR(misfit, 1.0, 0.04);
  // What the factors are for.
  EXPECT_LT(ignored, 0.6);
}

TEST(BlindFit, RefusesOneSensor) {
  const ModalModel truth = structure(1);
  const auto spectra = ContourSpectra::of(clean_record(truth), 0.0, kLow, kHigh);
  EXPECT_THAT(refusal_of([&] { fit_blindly(truth, spectra, {}, {}, false); }),
              testing::HasSubstr("one response explains any model"));
}

}  // namespace
}  // namespace modcal
