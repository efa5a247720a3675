#pragma once

#include "experiments/kinds/axis_experiment.hpp"

namespace modcal {

/// A kind whose options do all the work: lint(), plan(), planned_simulations() and run(); where
/// they have them files_read() and limit_question().
template <typename Options>
class StudyExperiment final : public Experiment {
 public:
  explicit StudyExperiment(Options options) : options_(std::move(options)) {}
  std::vector<Finding> lint() const override { return options_.lint(); }
  std::vector<Finding> lint_records(const std::filesystem::path& folder) const override {
    return record_findings(options_, folder);
  }
  std::vector<PlanLine> plan() const override { return options_.plan(); }
  std::optional<PlannedSimulations> planned_simulations() const override {
    return options_.planned_simulations();
  }
  std::vector<FileRead> files_read() const override { return files_read_by(options_); }
  std::shared_ptr<const LimitQuestion> limit_question() const override {
    if constexpr (requires { options_.limit_question(); }) {
      return std::make_shared<const LimitQuestion>(options_.limit_question());
    }
    return nullptr;
  }
  std::shared_ptr<const SearchTask> search_task(const StudyContext& context) const override {
    if constexpr (requires { options_.search_task(context); }) return options_.search_task(context);
    return nullptr;
  }
  std::string_view for_structures() const override { return Options::kForStructures; }
  StudyResult run(const StudyContext& context) const override { return options_.run(context); }

 private:
  Options options_;
};

// Every kind of experiment as a list of tasks: with a section "sweep" it is run once a cell.

/// What one run of a list leaves: the numbers of its tables, but not what it took.
struct RunOutcome {
  std::string failure;  ///< why there are none; empty: there are
  /// "levels.f_c.std": table, first cell of the row (where there are several rows), column.
  std::vector<std::pair<std::string, double>> numbers;
  std::vector<std::pair<std::string, std::string>> units;  ///< of those that have one
  std::vector<std::string> warnings;                       ///< of the run
  void visit(ResultVisitor& visitor);
};

/// The numbers of a result, or the reason where it has failed.
RunOutcome run_outcome(const StudyResult& result);

/// A row a setting with the median of every number over its draws (draws of one setting differ in
/// seeds alone), the same against the first axis of numbers, and tasks.csv with every number of
/// every task.
StudyResult sum_up_runs(const TaskExperiment& list, const TaskOutcomes& outcomes);

struct KindListSettings {
  static constexpr bool kNeedsAxes = false;
  void visit(OptionVisitor& /*visitor*/) {}
};

/// An experiment of any kind over axes of its options.
template <typename Options>
class KindList final : public AxisExperiment<Options, KindListSettings> {
 public:
  using AxisExperiment<Options, KindListSettings>::AxisExperiment;
  std::string run_task(std::size_t task, const StudyContext& context) const override {
    StudyContext quiet = context;
    quiet.numbers_alone = true;
    return report::json_line(
        attempted([&] { return run_outcome(this->options_.cells[task].run(quiet)); }));
  }
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext& /*context*/) const override {
    return sum_up_runs(*this, outcomes);
  }
};

/// Options of a kind and, where they state axes, of a list of it.
template <typename Options>
class KindRecipe final : public Recipe<Experiment> {
 public:
  void visit(OptionVisitor& visitor) override { options_.visit(visitor); }
  std::shared_ptr<const Experiment> make() const override {
    if (options_.cells.size() > 0) return std::make_shared<const KindList<Options>>(options_);
    return std::make_shared<const StudyExperiment<Options>>(options_.base);
  }
  std::unique_ptr<Recipe<Experiment>> clone() const override {
    return std::make_unique<KindRecipe>(*this);
  }

 private:
  typename AxisExperiment<Options, KindListSettings>::Options options_;
};

/// Row of the registry: kind_of<SimulateOptions>("simulate", "summary").
template <typename Options>
constexpr RegistryEntry<Experiment> kind_of(std::string_view name, std::string_view summary) {
  return {name, summary, +[]() -> std::unique_ptr<Recipe<Experiment>> {
            return std::make_unique<KindRecipe<Options>>();
          }};
}

}  // namespace modcal
