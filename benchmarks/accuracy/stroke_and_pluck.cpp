// A stroke at L/11, blind to every eleventh mode, and a pluck in one fit: errors against the
// Cramér–Rao bound of both records together, over many draws of noise and of the start.
//
//     stroke_and_pluck [DRAWS]
#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdlib>

#include "benchmarks/noisy_stroke.hpp"
#include "libcalib/likelihood/all_records.hpp"
#include "libcalib/likelihood/pluck/pluck_likelihood.hpp"
#include "libcalib/optimizers/staged/continuation.hpp"
#include "libsim/dynamics/scene/scene.hpp"

namespace modcal {
namespace {

constexpr double kWidth = 2e-3;

struct Clean {
  std::array<std::vector<double>, 2> reactions;
  std::array<double, 2> deviation{};
};

Clean simulate(Scene scene) {
  scene.string = {.length = 0.33, .linear_density = 3.1e-3, .fundamental = 196.0};
  scene.bow.position = 0.03;
  const Simulation run =
      ModalEvent({}).simulate(scene, kRate, {.left_reaction = true, .right_reaction = true});
  Clean result{.reactions = {run.left_reaction.samples, run.right_reaction.samples}};
  for (std::size_t r = 0; r < 2; ++r) {
    remove_mean(result.reactions[r]);
    result.deviation[r] = kNoise * standard_deviation(result.reactions[r]);
  }
  return result;
}

NoisyRecords draw(const Clean& clean, const StreamKey& key, bool noise) {
  NoisyRecords records{
      .reactions = clean.reactions, .deviation = clean.deviation, .sample_rate = kRate};
  std::vector<double> normal(records.samples());
  for (std::size_t r = 0; noise && r < 2; ++r) {
    fill_standard_normal(key.with(std::uint64_t{r}), normal);
    for (std::size_t j = 0; j < normal.size(); ++j) {
      records.reactions[r][j] += records.deviation[r] * normal[j];
    }
    remove_mean(records.reactions[r]);
  }
  return records;
}

// Standard deviations of (δ_n, x_c, ln damping factor) at the truth, records without noise.
Eigen::VectorXd bound(const ModelPoint& truth, const Clean& stroke, const Clean* pluck) {
  const double highest = likelihood_band(truth, NAN, kRate);
  const auto whitened = [&](const Clean& clean) {
    return WhitenedRecord::of(draw(clean, StreamKey(0), false), 0.0, highest);
  };
  const StringUnknowns unknowns = StringUnknowns::frequencies(truth);
  AllRecords all(unknowns);
  const ProjectedLikelihood whole(whitened(stroke));
  all.add(std::make_shared<StrokeLikelihood>(whole, whole), unknowns.start(), {});
  if (pluck) {
    all.add(std::make_shared<PluckLikelihood>(whitened(*pluck)), unknowns.start(), {});
  }
  const QuadraticPrior prior =
      unknowns.prior(unknowns.start(), {Eigen::VectorXd::Constant(50, kWidth), 0.0});
  const Eigen::MatrixXd information =
      2.0 * all.evaluate(unknowns.start(), false).information + prior.precision;
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  return (scaled.inverse().diagonal().cwiseSqrt().array() * scale.array()).matrix();
}

struct Sums {
  double error = 0.0, bounds = 0.0, reported = 0.0, largest = 0.0;
  int count = 0;
};

// Bounds (geometric means), and RMSE and standard deviation reported over them (root mean squares)
// of what a line is about.
void print_line(const char* name, const Eigen::MatrixXd& errors, const Eigen::MatrixXd& reported,
                const Eigen::VectorXd& bounds, const Eigen::VectorXd& stroke_bounds,
                const std::vector<Eigen::Index>& which) {
  Sums sums;
  double of_stroke = 0.0;
  for (const Eigen::Index i : which) {
    const double rmse = std::sqrt(errors.col(i).squaredNorm() / static_cast<double>(errors.rows()));
    const double sd = std::sqrt(reported.col(i).squaredNorm() / static_cast<double>(errors.rows()));
    sums.error += std::pow(rmse / bounds[i], 2);
    sums.reported += std::pow(sd / bounds[i], 2);
    sums.largest = std::max(sums.largest, rmse / bounds[i]);
    sums.bounds += std::log(bounds[i]);
    of_stroke += std::log(stroke_bounds[i]);
    ++sums.count;
  }
  fmt::print("{:<34} {:>3} {:>10.2e} {:>10.2e} {:>8.2f} {:>8.2f} {:>8.2f}\n", name, sums.count,
             std::exp(of_stroke / sums.count), std::exp(sums.bounds / sums.count),
             std::sqrt(sums.error / sums.count), sums.largest,
             std::sqrt(sums.reported / sums.count));
}

void run(int draws) {
  Scene bowed, plucked;
  plucked.bow.velocity = plucked.bow.normal_force = 0.0;
  plucked.start = Choice<InitialMotion>::of<Pluck>(
      "pluck", {.position = 0.043, .displacement = 1e-3, .width = 3e-3});
  const Clean stroke = simulate(bowed), pluck = simulate(plucked);
  const NoisyStroke the = make_noisy_stroke();
  const ModelPoint& truth = the.truth;
  const Eigen::VectorXd both = bound(truth, stroke, &pluck), alone = bound(truth, stroke, nullptr);
  Eigen::MatrixXd errors(draws, 52), reported(draws, 52);
  double chi2 = 0.0;
  int right = 0;
  for (int i = 0; i < draws; ++i) {
    const StreamKey key = StreamKey(static_cast<std::uint64_t>(i + 1));
    ModelPoint start = truth;
    std::vector<double> shift(51);
    fill_uniform(key.with("start"), shift);
    for (std::size_t n = 0; n < 50; ++n) {
      start.basis.omega[n] *= 1.0 + 0.02 * (2.0 * shift[n] - 1.0);
    }
    start.contact += 1.5e-3 * (2.0 * shift[50] - 1.0);
    const auto data = [](const NoisyRecords& records) {
      return CalibrationData::of_records(records.reactions[0], records.reactions[1], kRate);
    };
    const std::vector<CalibrationData> strokes = {data(draw(stroke, key.with("stroke"), true))};
    const std::vector<PluckRecord> plucks = {
        {.data = data(draw(pluck, key.with("pluck"), true)), .noise = pluck.deviation}};
    ContinuationOptions options = the.options;
    options.law_width = kWidth;
    const ContinuationResult fit = calibrate_records(start, strokes, options, plucks);
    for (Eigen::Index n = 0; n < 50; ++n) {
      const auto j = static_cast<std::size_t>(n);
      errors(i, n) = std::log(fit.model.basis.omega[j] / truth.basis.omega[j]);
      reported(i, n) = fit.frequency_deviations[j];
    }
    errors(i, 50) = fit.contacts[0] - truth.contact;
    reported(i, 50) = fit.contact_deviations[0];
    errors(i, 51) = std::log(fit.values[0].damping);
    reported(i, 51) = fit.values[0].damping_deviation;
    chi2 += fit.chi2 / draws;
    right += fit.right ? 1 : 0;
  }
  std::vector<Eigen::Index> blind, seen;
  for (Eigen::Index n = 0; n < 50; ++n) {
    if ((n + 1) % 11 == 0)
      blind.push_back(n);
    else if (alone[n] < 5e-4)
      seen.push_back(n);
  }
  fmt::print("{:<34} {:>3} {:>10} {:>10} {:>8} {:>8} {:>8}\n", "", "n", "stroke's", "bound", "RMSE",
             "largest", "reported");
  print_line("f_11, f_22, f_33, f_44", errors, reported, both, alone, blind);
  print_line("other f_n", errors, reported, both, alone, seen);
  print_line("x_c [m]", errors, reported, both, alone, {50});
  print_line("damping factor", errors, reported, both, alone, {51});
  fmt::print("{} draws, mean chi2 {:.4f}, not contradicted {}\n", draws, chi2, right);
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  modcal::run(argc > 1 ? std::atoi(argv[1]) : 24);
  return 0;
}
