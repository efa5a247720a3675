// Is a blind calibration of any structure at the bound, and do its deviations hold? 200 draws of
// noise and of starts, K sensors of different kinds, the force and what rings at both ends unknown:
// blind_monte_carlo [SEEDS]; a plate of 27 modes and four accelerometers: blind_monte_carlo SEEDS
// plate.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string_view>

#include "benchmarks/problems/known_structures.hpp"
#include "libinverse/structure/blind_likelihood.hpp"
#include "libsim/base/random.hpp"
#include "libsim/base/task_loop.hpp"

namespace {

using namespace modcal;
using namespace modcal::known_structures;
using Eigen::VectorXd;

struct Case {
  ModalModel truth;
  double noise, residues, prior;  // rms by which residues are off; prior of them
};

struct Outcome {
  double squares = 0.0;  // (off/bound)², mean
  double inside = 0.0;   // parameters within 1.96 of their deviations
  double misfit = 0.0;
  double force = 0.0, force_error = 0.0;  // samples in the 95 % band; rms error over rms
  bool failed = false;
};

// Samples of what stands in the bins.
VectorXd in_time(const std::vector<Complex>& bins, const ContourSpectra& spectra) {
  const RealFft fft(spectra.samples);
  std::vector<Complex> whole(fft.bins());
  for (std::size_t m = 0; m < bins.size(); ++m) whole[spectra.bins.first + m] = bins[m];
  VectorXd samples(static_cast<Eigen::Index>(spectra.samples));
  fft.inverse(whole, {samples.data(), spectra.samples});
  return samples;
}

// Models, ends and noise drawn: the deviation of every sample.
VectorXd deviations(const BlindFit& fit, const BlindLikelihood& likelihood,
                    const ContourSpectra& spectra, const VectorXd& best, std::uint64_t seed) {
  constexpr int kDraws = 100;
  const std::size_t ends = 2 * fit.model.poles.size();
  VectorXd squares = VectorXd::Zero(best.size());
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<double> model(static_cast<std::size_t>(fit.change.size())),
        rest(ends + 2 * spectra.count());
    const StreamKey key = StreamKey(seed).with("draw").with(static_cast<std::uint64_t>(draw));
    fill_standard_normal(key.with("model"), model);
    fill_standard_normal(key.with("rest"), rest);
    const auto force = likelihood.force_drawn(fit.drawn(model), rest);
    squares += (in_time(force, spectra) - best).cwiseAbs2() / kDraws;
  }
  return squares.cwiseSqrt();
}

Outcome run(const Case& test, const StructureRecord& clean, const VectorXd& bound,
            std::uint64_t seed) {
  const ModalModel& truth = test.truth;
  const ModalModel table = with_wrong_residues(started_off(truth, seed, 0.01, 0.2), seed,
                                               test.residues / std::sqrt(2.0));
  const Noisy noisy = with_noise(clean, test.noise, seed);
  const BlindFit fit = fit_ringing(table, noisy.record, noisy.noise, kLow, kHigh,
                                   {.frequency = 0.01,
                                    .damping = 0.3,
                                    .residue = test.prior / std::sqrt(2.0),
                                    .coupling = 0.0});  // each residue is off by itself
  const VectorXd off = logarithms(fit.model) - logarithms(truth);
  const VectorXd sd = fit.covariance.diagonal().head(off.size()).cwiseSqrt();
  const auto spectra = ContourSpectra::of(noisy.record, 0.0, kLow, kHigh);
  const BinVariances variances = noisy.variances(spectra);
  const BlindLikelihood likelihood(spectra, fit.model.sensors, variances, false);
  const VectorXd best = in_time(fit.force, spectra), measured = in_time(spectra.force, spectra);
  const VectorXd band = deviations(fit, likelihood, spectra, best, seed);
  const Eigen::ArrayXd error = (best - measured).array().abs();
  return {.squares = off.cwiseQuotient(bound).squaredNorm() / static_cast<double>(off.size()),
          .inside = (off.array().abs() < 1.96 * sd.array()).cast<double>().mean(),
          .misfit = fit.misfit,
          .force = (error < 1.96 * band.array()).cast<double>().mean(),
          .force_error = (best - measured).norm() / measured.norm(),
          // A wrong minimum: 6 deviations are beyond any draw of these.
          .failed = !(off.cwiseQuotient(sd).cwiseAbs().maxCoeff() < 6.0)};
}

void report(const Case& test, std::uint64_t seeds) {
  const ModalModel& truth = test.truth;
  const StructureRecord clean = clean_record(truth, true);
  // The bound: the data without noise, the noise in the weights alone.
  const Noisy noisy = with_noise(clean, test.noise, 0);
  const auto spectra = ContourSpectra::of(clean, 0.0, kLow, kHigh);
  const StructureChange change{
      .frequency = 0.01, .damping = 0.3, .residue = test.prior / std::sqrt(2.0), .coupling = 0.0};
  const BlindFit best = fit_blindly(truth, spectra, noisy.variances(spectra), change, false);
  const Eigen::Index poles = 2 * std::ssize(truth.poles);
  const VectorXd bound = best.covariance.diagonal().head(poles).cwiseSqrt();
  std::vector<Outcome> outcomes(seeds);
  for_each_task(seeds, [&](std::size_t i) { outcomes[i] = run(test, clean, bound, i + 1); });
  Outcome mean;
  double spread = 0.0, errors = 0.0;
  int failures = 0;
  for (const Outcome& one : outcomes) {
    failures += one.failed ? 1 : 0;
    const double share = 1.0 / static_cast<double>(seeds);
    mean.squares += share * one.squares;
    mean.inside += share * one.inside;
    mean.misfit += share * one.misfit;
    spread += share * one.misfit * one.misfit;
    mean.force += share * one.force;
    errors += share * one.force_error;
  }
  fmt::print(
      "| {} | {:g} % | {:g} % | {} | {:.3f} | {:.1f} % | {:.4f} ± {:.3f} ({:.3f}) | {:.3f} | "
      "{:.1f} % | {} of {} |\n",
      truth.sensors.size(), 100 * test.noise, 100 * test.residues,
      test.prior > 0.0 ? "free" : "known", std::sqrt(mean.squares), 100 * mean.inside, mean.misfit,
      std::sqrt(std::max(0.0, spread - mean.misfit * mean.misfit)), std::sqrt(2.0 / best.degrees),
      errors, 100 * mean.force, failures, seeds);
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** arguments) {
  const std::uint64_t seeds = count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 200;
  fmt::print(
      "| sensors | noise | residues off | residues | RMSE/bound | poles in 95 % | chi2/dof ± sd "
      "(expected) | "
      "force error | force in 95 % | failures |\n|---|---|---|---|---|---|---|---|---|---|\n");
  const bool of_plate = count > 2 && std::string_view(arguments[2]) == "plate";
  const std::vector<Case> cases =
      of_plate
          ? std::vector<Case>{{plate(), 0.01, 0.0, 0.0}, {plate(), 0.05, 0.0, 0.0}}
          : std::vector<Case>{{six_modes(3), 0.01, 0.0, 0.0},   {six_modes(3), 0.05, 0.0, 0.0},
                              {six_modes(2), 0.01, 0.0, 0.0},   {six_modes(2), 0.05, 0.0, 0.0},
                              {six_modes(3), 0.01, 0.03, 0.03}, {six_modes(3), 0.01, 0.03, 0.0}};
  for (const Case& test : cases) report(test, seeds);
}
