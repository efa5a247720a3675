#include <algorithm>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/loader.hpp"
#include "experiments/problems/modcal_problems.h"

struct modcal_problem {
  std::shared_ptr<const modcal::SearchTask> task;
  std::vector<modcal::Variable> variables;
};

namespace modcal {
namespace {

std::string& message() {
  thread_local std::string text;
  return text;
}

// 0 where call() does it, else 1 with the message.
template <typename Call>
int guarded(const Call& call) {
  message().clear();
  try {
    call();
    return 0;
  } catch (const std::exception& error) {
    message() = error.what();
  }
  return 1;
}

std::unique_ptr<modcal_problem> opened(const char* file, std::span<const char* const> assignments) {
  YamlDocument document = read_yaml_file(file);
  for (std::size_t i = 0; i < assignments.size(); ++i) {
    apply_assignment(document, assignments[i], i + 1);
  }
  LoadedExperiment loaded = load_experiment(std::move(document));
  check_records(loaded);
  MODCAL_REQUIRE(!loaded.has_errors(), "{}", format_mistakes(loaded.document, loaded.mistakes));
  SharedWork work;
  const std::filesystem::path folder = loaded.document.folder();
  auto task = loaded.experiment->search_task(
      {.work = work, .folder = folder.empty() ? "." : folder, .command = {}, .stop = {}});
  MODCAL_REQUIRE(task != nullptr, "{}: kind {} searches nothing: a problem is a kind: calibrate",
                 file, loaded.kind);
  auto problem = std::make_unique<modcal_problem>();
  problem->variables = task->bound.parameters.variables();
  problem->task = std::move(task);
  return problem;
}

int copied(const std::vector<double>& numbers, const char* why_none, double* target) {
  return guarded([&] {
    MODCAL_REQUIRE(!numbers.empty(), "{}", why_none);
    std::copy(numbers.begin(), numbers.end(), target);
  });
}

template <typename Number>
void each(const modcal_problem& problem, double* target, Number number) {
  std::transform(problem.variables.begin(), problem.variables.end(), target, number);
}

}  // namespace
}  // namespace modcal

modcal_problem* modcal_problem_open(const char* file, const char* const* assignments,
                                    size_t assignment_count) {
  std::unique_ptr<modcal_problem> problem;
  modcal::guarded([&] { problem = modcal::opened(file, {assignments, assignment_count}); });
  return problem.release();
}

void modcal_problem_close(modcal_problem* problem) { delete problem; }

const char* modcal_problem_message(void) { return modcal::message().c_str(); }

size_t modcal_problem_dimension(const modcal_problem* problem) { return problem->variables.size(); }

const char* modcal_problem_name(const modcal_problem* problem, size_t i) {
  return i < problem->variables.size() ? problem->variables[i].name.c_str() : nullptr;
}

const char* modcal_problem_unit(const modcal_problem* problem, size_t i) {
  return i < problem->variables.size() ? problem->variables[i].unit.c_str() : nullptr;
}

void modcal_problem_bounds(const modcal_problem* problem, double* lower, double* upper) {
  modcal::each(*problem, lower, [](const modcal::Variable& one) { return one.lower; });
  modcal::each(*problem, upper, [](const modcal::Variable& one) { return one.upper; });
}

void modcal_problem_start(const modcal_problem* problem, double* start) {
  modcal::each(*problem, start, [](const modcal::Variable& one) { return one.initial; });
}

void modcal_problem_scale(const modcal_problem* problem, double* scale) {
  modcal::each(*problem, scale, [](const modcal::Variable& one) { return one.scale; });
}

int modcal_problem_truth(const modcal_problem* problem, double* truth) {
  return modcal::copied(problem->task->truth, "the truth of a record is not known", truth);
}

int modcal_problem_bound(const modcal_problem* problem, double* deviations) {
  std::vector<double> bound;
  if (modcal::guarded([&] { bound = problem->task->bound_deviations(); }) != 0) return 1;
  return modcal::copied(bound, "there is no bound: the truth of a record is not known",
                        deviations);
}

int modcal_problem_value(const modcal_problem* problem, const double* x, double* value) {
  const auto& function = *problem->task->bound.function;
  return modcal::guarded([&] { *value = function.value({x, problem->variables.size()}); });
}

int modcal_problem_gradient(const modcal_problem* problem, const double* x, double* gradient) {
  return modcal::guarded([&] {
    const std::span<const double> point(x, problem->variables.size());
    const auto slopes =
        modcal::gradient_at(*problem->task->bound.function, problem->variables, point);
    std::copy(slopes.begin(), slopes.end(), gradient);
  });
}
