#include "experiments/kinds/limit/structure_limit.hpp"

#include <cmath>
#include <complex>

#include "experiments/kinds/structure/structure_files.hpp"
#include "libsim/base/random.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

/// The structure as it is, and what its sensors read without noise.
struct StructureLimitExperiment::Truth {
  StructureTable table;
  StructureRecord record;
  std::vector<double> rms;  ///< of every response

  std::vector<double> noise_at(double level) const {
    std::vector<double> noise;
    for (const double one : rms) noise.push_back(level * one);
    return noise;
  }
  /// The table, known to have such noise and no scatter.
  StructureTable with_noise(double level) const {
    StructureTable result = table;
    for (std::size_t k = 0; k < rms.size(); ++k) result.scatters[k] = {0.0, level * rms[k]};
    return result;
  }
};

namespace {

using Index = Eigen::Index;

std::vector<double> relative_errors(const ModalModel& found, const ModalModel& truth) {
  std::vector<double> errors;
  for (std::size_t n = 0; n < truth.poles.size(); ++n) {
    errors.push_back(std::log(found.poles[n].omega / truth.poles[n].omega));
    errors.push_back(std::log(found.poles[n].zeta / truth.poles[n].zeta));
  }
  const auto constant = [](const ModalModel& model, std::size_t j) {
    return Complex(model.constants[j], model.quadrature.empty() ? 0.0 : model.quadrature[j]);
  };
  for (std::size_t j = 0; j < truth.constants.size(); ++j) {
    // A mode that does not move a sensor has no factor there.
    const Complex own = constant(truth, j);
    const Complex d = own == 0.0 ? Complex(0.0) : constant(found, j) / own - 1.0;
    errors.push_back(d.real());
    errors.push_back(d.imag());
  }
  return errors;
}

std::vector<double> deviations_of(const BlindFit& fit) {
  const Eigen::VectorXd sd = fit.covariance.diagonal().cwiseSqrt();
  return {sd.begin(), sd.end()};
}

// Those of relative_errors(): factors of the constants that the fit began with are turned and
// scaled to factors of the true ones.
std::vector<double> deviations_of(const BlindFit& fit, const ModalModel& start,
                                  const ModalModel& truth) {
  std::vector<double> sd = deviations_of(fit);
  const auto first = static_cast<Index>(2 * truth.poles.size());
  for (Index i = first; i + 1 < std::ssize(sd); i += 2) {
    const auto j = static_cast<std::size_t>(i - first) / 2;
    const Complex own(truth.constants[j], truth.quadrature[j]);
    if (own == 0.0) continue;
    const Complex g = Complex(start.constants[j], start.quadrature[j]) / own;
    Eigen::Matrix2d turn;
    turn << g.real(), -g.imag(), g.imag(), g.real();
    const Eigen::Matrix2d turned = turn * fit.covariance.block<2, 2>(i, i) * turn.transpose();
    for (Index part = 0; part < 2; ++part) {
      sd[static_cast<std::size_t>(i + part)] = std::sqrt(turned(part, part));
    }
  }
  return sd;
}

// The bound: the curvature of the likelihood and of the prior at the truth, all samples counted.
std::vector<double> bound_at(const StructureTable& table, const StructureRecord& record,
                             const std::vector<double>& noise, const StructureChange& change) {
  const auto spectra = ContourSpectra::of(record, 0.0, table.low, table.high);
  BinVariances variances;
  for (const double sd : noise) {
    variances.of.emplace_back(spectra.count(), sd * sd * spectra.noise_power());
  }
  return deviations_of(fit_blindly(table.model, spectra, variances, change, false));
}

}  // namespace

void StructureLimitOptions::visit(OptionVisitor& visitor) {
  StructureSceneOptions::visit(visitor);
  visitor("change",
          "standard deviations by which the table of each draw is off, and the refinement allows "
          "for",
          change);
}

StructureLimitExperiment::StructureLimitExperiment(CalibrationLimitOptions options)
    : ProductExperiment(axes_of(options)), options_(std::move(options)) {}

std::vector<Finding> StructureLimitExperiment::lint() const {
  const ObservationOptions& observation = options_.observation;
  std::vector<Finding> findings =
      options_.structure.lint(observation.truth.simulator, observation.measurement);
  // That identify_force needs the mean: no record is written here.
  std::erase_if(findings, [](const Finding& finding) { return !finding.is_error; });
  lint_levels(options_.noise_levels, findings);
  for (std::size_t i = 0; i < options_.noise_levels.size(); ++i) {
    if (options_.noise_levels[i] > 0.0) continue;
    add_finding(findings, fmt::format("noise_levels.{}", i),
                "without noise a structure has no bound: state levels above 0");
  }
  const CalibrationLimitOptions plain;
  refuse_beside_structure({{"scene", observation.has_scene},
                           {"record", observation.has_record},
                           {"string", observation.has_string},
                           {"bow", observation.has_bow},
                           {"measurement.noise_level", observation.measurement.noise_level > 0.0},
                           {"model_error", !same_options(options_.model_error, plain.model_error)},
                           {"calibration", !same_options(options_.calibration, plain.calibration)},
                           {"known_noise", !options_.known_noise},
                           {"inversion", options_.has_inversion}},
                          findings);
  return findings;
}

std::vector<Finding> StructureLimitExperiment::lint_records(
    const std::filesystem::path& folder) const {
  const ObservationOptions& observation = options_.observation;
  std::vector<Finding> findings =
      options_.structure.lint_table(folder, observation.truth.simulator, observation.measurement);
  if (!findings.empty()) return findings;
  const StructureTable table = read_table(folder / options_.structure.table);
  if (table.model.sensors.size() < 2) {
    add_finding(findings, "structure.table",
                "one response is explained by any model and some force: a table of two sensors and "
                "more has a bound");
  }
  return findings;
}

std::vector<PlanLine> StructureLimitExperiment::plan() const {
  return {{fmt::format("simulate a bow on the structure of {} once", options_.structure.table)},
          {fmt::format("tasks: {} refinements ({} noise levels, {} seeds)", task_count(),
                       options_.noise_levels.size(), options_.seeds),
           {{"tasks", task_count()},
            {"noise_levels", options_.noise_levels.size()},
            {"seeds", options_.seeds}}}};
}

std::vector<FileRead> StructureLimitExperiment::files_read() const {
  return {options_.structure.file_read(options_.observation.measurement.sample_rate)};
}

std::shared_ptr<const LimitQuestion> StructureLimitExperiment::limit_question() const {
  throw InvalidInput(
      "the limit of a structure depends on the force that acts: run the file, its tables state the "
      "bound");
}

std::string StructureLimitExperiment::fingerprint(std::size_t task,
                                                  const std::filesystem::path& folder) const {
  CalibrationLimitOptions options = options_;
  options.noise_levels = {level_of(task)};
  options.seeds = 1;
  const std::filesystem::path table = folder / options.structure.table;
  std::string text = fmt::format("calibration_limit {} {} ", place(task, 1), input_digest(table));
  for (const auto& other : files_named_by_table(table)) {
    text += fmt::format("{} ", input_digest(other));
  }
  return text + modcal::fingerprint([&](OptionVisitor& visitor) { options.visit(visitor); });
}

const StructureLimitExperiment::Truth& StructureLimitExperiment::truth(
    const StudyContext& context) const {
  std::call_once(simulated_, [&] {
    try {
      truth_ = std::make_shared<const Truth>(simulated(context));
    } catch (const InvalidInput& error) {
      failure_ = error.what();  // simulated once, whatever comes of it
    }
  });
  MODCAL_REQUIRE(truth_ != nullptr, "{}", failure_);
  return *truth_;
}

StructureLimitExperiment::Truth StructureLimitExperiment::simulated(
    const StudyContext& context) const {
  const ObservationOptions& observation = options_.observation;
  const double rate = observation.measurement.sample_rate;
  Truth truth{.table = read_table(context.folder / options_.structure.table),
              .record = {.sample_rate = rate}};
  const DrivenStructure driven = options_.structure.driven(truth.table);
  truth.table.model = driven.model;
  truth.table.model.quadrature.resize(driven.model.constants.size());
  truth.table.frequency_deviations.clear();
  truth.table.damping_deviations.clear();
  const StructureSimulation simulated =
      simulate_structure(*observation.truth.simulator.make(), options_.structure.scene(rate),
                         driven, options_.structure.fine_rate(rate), context.stop);
  MODCAL_REQUIRE(!simulated.contact.diverged_at, "the simulation stops at {:g} s: {}",
                 *simulated.contact.diverged_at, simulated.contact.explanation);
  for (const std::vector<double>& fine : simulated.sensors) {
    truth.record.responses.push_back(options_.structure.recorded(fine, rate));
    truth.rms.push_back(standard_deviation(truth.record.responses.back()));
    MODCAL_REQUIRE(truth.rms.back() > 0.0,
                   "sensor {} of {} does not move: leave it out of the table",
                   truth.table.names[truth.rms.size() - 1], options_.structure.table);
  }
  return truth;
}

std::string StructureLimitExperiment::run_task(std::size_t task,
                                               const StudyContext& context) const {
  return report::json_line(attempted([&] { return draw(task, context); }));
}

StructureLimitOutcome StructureLimitExperiment::draw(std::size_t task,
                                                     const StudyContext& context) const {
  const Truth& truth = this->truth(context);
  const double level = level_of(task);
  const StreamKey key =
      StreamKey(static_cast<std::uint64_t>(options_.seed)).with(std::uint64_t{place(task, 1)});
  StructureRecord record = truth.record;
  const std::vector<double> noise = truth.noise_at(level);
  for (std::size_t k = 0; k < noise.size(); ++k) {
    std::vector<double> normal(record.samples());
    // Every level has its own noise, so that levels are independent; starts are the same at all.
    fill_standard_normal(key.with(level).with("measurement noise").with(k), normal);
    for (std::size_t j = 0; j < normal.size(); ++j) record.responses[k][j] += noise[k] * normal[j];
  }
  StructureTable start = truth.with_noise(level);
  Eigen::VectorXd off = modcal::deviations_of(options_.structure.change, start.model);
  std::vector<double> normal(static_cast<std::size_t>(off.size()));
  fill_standard_normal(key.with("start"), normal);
  off.array() *= Eigen::Map<const Eigen::ArrayXd>(normal.data(), off.size());
  start.model = moved_by(start.model, off);
  // The weights leave a seventh of what rings at the record's end.
  const BlindFit fit =
      refined_table(start, record, 2.0 / record.duration(), options_.structure.change, false);
  StructureLimitOutcome outcome{.errors = relative_errors(fit.model, truth.table.model),
                                .deviations = deviations_of(fit, start.model, truth.table.model)};
  outcome.errors.resize(outcome.deviations.size());  // constants that are known have none
  return outcome;
}

StudyResult StructureLimitExperiment::sum_up(const TaskOutcomes& outcomes,
                                             const StudyContext& context) const {
  std::vector<StructureLimitLevel> levels;
  for (const double level : options_.noise_levels) levels.push_back({.noise_level = level});
  StudyResult result;
  for_each_outcome<StructureLimitOutcome>(
      outcomes, result, [&](std::size_t task, StructureLimitOutcome outcome, double /*seconds*/) {
        levels[place(task, 0)].outcomes.push_back(std::move(outcome));
      });
  return sum_up_levels(std::move(levels), context, std::move(result));
}

StudyResult StructureLimitExperiment::replay(std::size_t task, const StudyContext& context) const {
  StructureLimitLevel level{.noise_level = level_of(task)};
  level.outcomes = {attempted([&] { return draw(task, context); })};
  StudyResult result;
  result.failed_tasks = level.outcomes[0].failure.empty() ? 0 : 1;
  return sum_up_levels({level}, context, std::move(result));
}

StudyResult StructureLimitExperiment::sum_up_levels(std::vector<StructureLimitLevel> levels,
                                                    const StudyContext& context,
                                                    StudyResult result) const {
  const Truth& truth = this->truth(context);
  for (StructureLimitLevel& level : levels) {
    level.bound = bound_at(truth.table, truth.record, truth.noise_at(level.noise_level),
                           options_.structure.change);
    for (const StructureLimitOutcome& outcome : level.outcomes) {
      const bool whole = outcome.errors.size() == level.bound.size() &&
                         outcome.deviations.size() == level.bound.size();
      MODCAL_REQUIRE(whole || !outcome.failure.empty(),
                     "the stored outcome of a task has {} errors and {} deviations of {} unknowns",
                     outcome.errors.size(), outcome.deviations.size(), level.bound.size());
    }
  }
  std::vector<double> frequencies;
  for (std::size_t n = 0; n < truth.table.model.poles.size(); ++n) {
    frequencies.push_back(truth.table.frequency(n));
  }
  sum_up_structure_limit(frequencies, truth.table.names, levels, result);
  return result;
}

}  // namespace modcal
