// Error against run time of every regularizer with every way to choose its parameter: the paper's
// case (51 200 samples of R_1 at 5 % noise, relative rms error of the force over 0.1 s to 0.95 s)
// and shaw, heat, phillips and deriv2 (n = 128, 1 % noise, relative error of x). Medians over noise
// draws; times are processor times with transfer functions or singular values prepared. The joint
// estimate of both reactions stands beside the one-sided pairs.
//
//     regularizer_error [--quick] > regularizer_error.csv
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <functional>
#include <memory>

#include "benchmarks/problems/ill_posed_problems.hpp"
#include "benchmarks/problems/svd_problem.hpp"
#include "libinverse/estimator.hpp"
#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"
#include "libinverse/spectral/regularizers/regularizers.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/signal/measurement.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

constexpr double kRate = 51200.0;

double processor_milliseconds() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

using Rule = std::pair<std::string, std::shared_ptr<const ParameterChoice>>;
using Filter = std::pair<std::string, std::shared_ptr<const Regularizer>>;

template <class Choice>
Rule rule(const char* name, const CurveOptions& curve) {
  typename Choice::Options options;
  options.curve = curve;
  return {name, std::make_shared<const Choice>(options)};
}

std::vector<Rule> rules(const char* measure) {
  CurveOptions curve;
  curve.measure = measure;
  return {rule<MinimalProduct>("minimal_product", curve),
          rule<LCurve>("l_curve", curve),
          rule<LCurveAdaptive>("l_curve_adaptive", curve),
          rule<GeneralizedCrossValidation>("gcv", curve),
          rule<RobustCrossValidation>("robust_gcv", curve),
          rule<Discrepancy>("discrepancy", curve),
          rule<QuasiOptimality>("quasi_optimality", curve),
          rule<CumulativePeriodogram>("ncp", curve),
          rule<PredictiveRisk>("upre", curve),
          rule<Evidence>("evidence", curve)};
}

template <class Plugin>
Filter filter(const char* name, typename Plugin::Options options = {}) {
  return {name, std::make_shared<const Plugin>(options)};
}

std::vector<Filter> filters(double corner) {
  return {filter<WaterLevel>("water_level"),
          filter<WaterLevelClip>("water_level_clip"),
          filter<TruncatedSvd>("truncated_svd"),
          filter<Tikhonov>("tikhonov 0"),
          filter<Tikhonov>("tikhonov 1", {.order = 1}),
          filter<Tikhonov>("tikhonov 2", {.order = 2}),
          filter<WienerFilter>("wiener", {.corner = corner})};
}

struct Outcome {
  double error = 0.0;
  double parameter = 0.0;  // relative to the largest singular value
  bool warned = false;
};

// One inversion of a draw with a rule.
using Invert = std::function<Outcome(const ParameterChoice&, std::size_t draw)>;

double quantile_of(const std::vector<Outcome>& outcomes, double Outcome::*member, double q) {
  std::vector<double> values;
  for (const Outcome& outcome : outcomes) values.push_back(outcome.*member);
  return quantile(std::move(values), q);
}

void print_row(const std::string& problem, const std::string& filter_name,
               const std::string& rule_name, std::size_t draws, const Invert& invert,
               const ParameterChoice& choice, double best) {
  std::vector<Outcome> outcomes;
  std::vector<double> times;
  for (std::size_t draw = 0; draw < draws; ++draw) {
    const double start = processor_milliseconds();
    outcomes.push_back(invert(choice, draw));
    times.push_back(processor_milliseconds() - start);
  }
  const auto warned = std::count_if(outcomes.begin(), outcomes.end(),
                                    [](const Outcome& outcome) { return outcome.warned; });
  fmt::print("{},{},{},{:.4g},{:.4g},{:.4g},{:.4g},{:.3g},{:.3g},{}\n", problem, filter_name,
             rule_name, quantile_of(outcomes, &Outcome::error, 0.5),
             quantile_of(outcomes, &Outcome::error, 0.1),
             quantile_of(outcomes, &Outcome::error, 0.9), best,
             quantile_of(outcomes, &Outcome::parameter, 0.5), quantile(times, 0.5), warned);
}

// The smallest error any parameter reaches, on average over the draws' medians: what a rule aims
// at.
double best_of(const Invert& invert, std::size_t draws, double largest, const char* measure) {
  std::vector<double> best(draws, 1e300);
  for (std::size_t draw = 0; draw < draws; ++draw) {
    double level = largest;
    while (level > 1e-10 * largest) {
      CurveOptions none;
      none.points = 0;
      none.measure = measure;
      const GivenParameter fixed({.value = level, .curve = none});
      best[draw] = std::min(best[draw], invert(fixed, draw).error);
      level *= 0.85;
    }
  }
  return quantile(best, 0.5);
}

void matrices(std::size_t draws) {
  for (const IllPosedProblem& problem : ill_posed_problems(128)) {
    const auto n = static_cast<std::size_t>(problem.noise_free.size());
    const double rms = 0.01 * std::sqrt(problem.noise_free.squaredNorm() / static_cast<double>(n));
    std::vector<Eigen::VectorXd> data;
    for (std::size_t draw = 0; draw < draws; ++draw) {
      std::vector<double> noise(n);
      fill_standard_normal(StreamKey(draw).with(problem.name), noise);
      data.push_back(problem.noise_free + rms * Eigen::Map<const Eigen::VectorXd>(
                                                    noise.data(), problem.noise_free.size()));
    }
    // The prior's corner at one period over the solution's interval.
    for (const auto& [name, regularizer] : filters(1.0 / (static_cast<double>(n) * problem.step))) {
      const SvdProblem svd(problem.matrix, *regularizer, problem.step);
      const double largest = svd.problem().sigma()[0];
      const Invert invert = [&, &filter_plugin = *regularizer](const ParameterChoice& choice,
                                                               std::size_t draw) {
        const SvdSolution solution = svd.solve(data[draw], filter_plugin, choice, rms);
        return Outcome{(solution.x - problem.solution).norm() / problem.solution.norm(),
                       solution.choice.parameter() / largest, !solution.choice.warnings.empty()};
      };
      const double best = best_of(invert, draws, largest, "solution");
      for (const auto& [rule_name, choice] : rules("solution")) {
        print_row(problem.name, name, rule_name, draws, invert, *choice, best);
      }
    }
  }
}

// Simulated once, measured anew for each draw.
struct PaperRecord {
  explicit PaperRecord(std::size_t draws) {
    Scene scene = paper_scene();
    scene.duration = 1.0;
    const Simulation run =
        ModalEvent(ModalEvent::Options{}).simulate(scene, kRate, OutputRequest::all());
    basis = make_modal_basis(scene.string);
    contact = scene.bow.position;
    force = run.force.samples;
    force.resize(51200);
    for (std::size_t draw = 0; draw < draws; ++draw) {
      for (std::size_t r = 0; r < 2; ++r) {
        std::vector<double> reaction = (r == 0 ? run.left_reaction : run.right_reaction).samples;
        reaction.resize(force.size());
        noise[r] = 0.05 * standard_deviation(reaction);
        std::vector<double> drawn(reaction.size());
        fill_standard_normal(StreamKey(draw).with(static_cast<std::uint64_t>(r)), drawn);
        for (std::size_t j = 0; j < drawn.size(); ++j) reaction[j] += noise[r] * drawn[j];
        remove_mean(reaction);
        reactions[r].push_back(std::move(reaction));
      }
    }
  }
  double error_of(std::span<const double> identified) const {
    const auto begin = static_cast<std::size_t>(0.1 * kRate);
    const auto count = static_cast<std::size_t>(0.95 * kRate) - begin;
    std::vector<double> part(identified.begin() + static_cast<std::ptrdiff_t>(begin),
                             identified.begin() + static_cast<std::ptrdiff_t>(begin + count));
    std::vector<double> truth(force.begin() + static_cast<std::ptrdiff_t>(begin),
                              force.begin() + static_cast<std::ptrdiff_t>(begin + count));
    remove_mean(part);
    remove_mean(truth);
    return relative_rms_error(part, truth);
  }
  ModalBasis basis;
  double contact = 0.0;
  std::vector<double> force;
  std::vector<std::vector<double>> reactions[2];
  double noise[2] = {0.0, 0.0};
};

void paper_case(std::size_t draws) {
  const PaperRecord record(draws);
  const OneSidedInversion inversion(record.basis, record.contact, End::kLeft, record.force.size(),
                                    kRate);
  for (const auto& [name, regularizer] : filters(50.0)) {
    InversionWorkspace workspace;
    InversionResult result;
    const double largest = falling_penalized_sigma(*regularizer, inversion.problem())[0];
    const Invert invert = [&, &filter_plugin = *regularizer](const ParameterChoice& choice,
                                                             std::size_t draw) {
      inversion.invert(record.reactions[0][draw],
                       {filter_plugin, choice, {.force = true}, record.noise[0]}, workspace,
                       result);
      return Outcome{record.error_of(result.force), result.choice.parameter() / largest,
                     !result.choice.warnings.empty()};
    };
    const double best = best_of(invert, std::min<std::size_t>(draws, 3), largest, "derivative");
    for (const auto& [rule_name, choice] : rules("derivative")) {
      print_row("paper", name, rule_name, draws, invert, *choice, best);
    }
  }
  const auto joint = Choice<Estimator>("joint").make()->prepare(
      {record.basis, record.contact, record.force.size(), kRate, false});
  const Invert both = [&](const ParameterChoice& choice, std::size_t draw) {
    EstimationRecord signals;
    signals.reactions = {record.reactions[0][draw], record.reactions[1][draw]};
    const auto plain = filter<WaterLevel>("").second;  // the joint estimate brings its own
    const auto estimates = joint->estimate(signals, {*plain, choice, {.force = true}});
    return Outcome{record.error_of(estimates[0].result.force),
                   estimates[0].result.choice.parameter() / estimates[0].largest_transfer,
                   !estimates[0].warnings.empty()};
  };
  const auto unused = rule<MinimalProduct>("", {}).second;
  both(*unused, 0);  // prepares the contour
  print_row("paper", "joint", "evidence", draws, both, *unused,
            std::numeric_limits<double>::quiet_NaN());
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
  fmt::print(
      "problem,regularizer,parameter choice,error (median),error (10 %),error (90 %),smallest "
      "error of any parameter,parameter over largest singular value,ms,draws with a warning\n");
  modcal::paper_case(quick ? 1 : 5);
  modcal::matrices(quick ? 3 : 25);
}
