#include "experiments/runs/task_experiment.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace modcal {
namespace {

// Looks up every task among the finished ones, over threads; hashes of their keys.
std::vector<std::size_t> find_finished(const TaskExperiment& experiment,
                                       const FinishedTasks& finished,
                                       const std::filesystem::path& folder, const StopToken& stop,
                                       TaskOutcomes& outcomes) {
  std::vector<std::size_t> keys(outcomes.size());
  const auto find = [&](std::size_t task) {
    const std::string key = finished.key_of(experiment.fingerprint(task, folder));
    keys[task] = std::hash<std::string>{}(key);
    const RecordPlace place = finished.find(key);
    if (place.is_known()) outcomes.put(task, place);
  };
  for_each_task(outcomes.size(), find, stop);
  return keys;
}

// Of a file that was written to in the meantime nobody knows which content the task has read.
void require_same_inputs(std::size_t task, const std::string& key, std::size_t begun) {
  MODCAL_REQUIRE(std::hash<std::string>{}(key) == begun,
                 "task {}: a file that the list reads has changed since the list began: what was "
                 "finished before is kept; run the command again, which does all of it with the "
                 "file as it is then",
                 task);
}

// The same for texts that differ in their numbers alone.
std::string without_numbers(std::string text) {
  std::erase_if(text, [](char c) { return c >= '0' && c <= '9'; });
  return text;
}

nlohmann::json parsed(const std::string& outcome) {
  nlohmann::json object = nlohmann::json::parse(outcome, nullptr, false);
  MODCAL_REQUIRE(object.is_object(), "the stored outcome of a task cannot be read: {}", outcome);
  return object;
}

// Members that are numbers, then the pairs of the list "numbers".
std::vector<std::pair<std::string, double>> numbers_of(const std::string& outcome) {
  std::vector<std::pair<std::string, double>> result;
  const nlohmann::json object = parsed(outcome);
  for (const auto& [name, value] : object.items()) {
    if (value.is_number()) result.emplace_back(name, value.get<double>());
  }
  const auto numbers = object.find("numbers");
  if (numbers == object.end()) return result;
  for (const auto& number : *numbers) {
    const bool is_pair = number.is_array() && number.size() >= 2 && number[0].is_string();
    if (is_pair && number[1].is_number()) {
      result.emplace_back(number[0].get<std::string>(), number[1].get<double>());
    }
  }
  return result;
}

}  // namespace

TaskOutcomes::TaskOutcomes(std::size_t tasks, const FinishedTasks* finished)
    : finished_(finished),
      places_(finished != nullptr ? tasks : 0),
      kept_(finished != nullptr ? 0 : tasks) {}

std::optional<FinishedTask> TaskOutcomes::operator[](std::size_t task) const {
  if (finished_ == nullptr) return kept_[task];
  if (!places_[task].is_known()) return std::nullopt;
  JournalRecord record = finished_->read(places_[task]);
  return FinishedTask{std::move(record.outcome), record.seconds};
}

void TaskOutcomes::refuse(std::size_t task, const InvalidInput& error) const {
  if (finished_ == nullptr) throw error;
  throw_invalid_input("{}: {}; no run has written that: delete the line, and its task is run again",
                      finished_->reader().text_of(places_[task]), error.what());
}

TaskOutcomes stored_outcomes(const TaskExperiment& experiment, const FinishedTasks& finished,
                             const std::filesystem::path& folder) {
  TaskOutcomes outcomes(experiment.task_count(), &finished);
  find_finished(experiment, finished, folder, {}, outcomes);
  return outcomes;
}

TaskOutcomes run_tasks(const TaskExperiment& experiment, const StudyContext& context,
                       RunStore* store, const Shard& shard) {
  const FinishedTasks* finished = store != nullptr ? &store->finished() : nullptr;
  TaskOutcomes outcomes(experiment.task_count(), finished);
  std::vector<std::size_t> begun;
  if (finished != nullptr) {
    begun = find_finished(experiment, *finished, context.folder, context.stop, outcomes);
  }
  std::vector<std::uint32_t> pending;
  for (std::size_t task = 0; task < outcomes.size(); ++task) {
    if (shard.holds(task) && !outcomes.has(task)) {
      pending.push_back(static_cast<std::uint32_t>(task));
    }
  }
  const auto all = static_cast<double>(shard.size(outcomes.size()));
  std::atomic<std::size_t> left{pending.size()};
  StudyContext quiet = context;  // of a task: the list reports the progress
  quiet.progress = [](double) {};
  const auto run = [&](std::size_t i) {
    const std::size_t task = pending[i];
    const Stopwatch clock;
    std::string outcome = experiment.run_task(task, quiet);
    const double seconds = clock.seconds();
    if (store == nullptr) {
      outcomes.put(task, FinishedTask{std::move(outcome), seconds});
    } else {
      std::string key = finished->key_of(experiment.fingerprint(task, context.folder));
      require_same_inputs(task, key, begun[task]);
      outcomes.put(task, store->append({std::move(key), task, seconds, std::move(outcome)}));
    }
    context.progress(1.0 - static_cast<double>(--left) / all);
  };
  for_each_task(pending.size(), run, context.stop);
  if (store != nullptr) store->finish();
  return outcomes;
}

std::string TaskExperiment::failure_in(const std::string& outcome) const {
  const nlohmann::json object = parsed(outcome);
  const auto failure = object.find("failure");
  if (failure == object.end()) return {};
  MODCAL_REQUIRE(failure->is_string(), "the stored outcome of a task cannot be read: {}", outcome);
  return failure->get<std::string>();
}

std::size_t TaskOutcomes::records() const {
  std::set<std::pair<std::uint32_t, std::uint64_t>> records;
  for (const RecordPlace& place : places_) {
    if (place.is_known()) records.emplace(place.file, place.offset);
  }
  return records.size();
}

std::optional<double> TaskExperiment::number_in(const std::string& outcome,
                                                const std::string& name) const {
  for (const auto& [own, value] : numbers_of(outcome)) {
    if (own == name) return value;
  }
  return std::nullopt;
}

std::vector<std::string> TaskExperiment::numbers_in(const std::string& outcome) const {
  std::vector<std::string> names;
  for (auto& [name, value] : numbers_of(outcome)) names.push_back(std::move(name));
  return names;
}

StudyResult TaskExperiment::run(const StudyContext& context) const {
  return sum_up(run_tasks(*this, context, nullptr, Shard{}), context);
}

void add_reason(std::size_t task, const std::string& reason, std::vector<TasksOfReason>& reasons) {
  constexpr std::size_t kNamed = 5;
  const std::string text = without_numbers(reason);
  auto known = std::ranges::find_if(
      reasons, [&text](const TasksOfReason& of) { return without_numbers(of.reason) == text; });
  if (known == reasons.end()) {
    known = reasons.insert(known, {.reason = reason, .count = 0, .first = {}});
  }
  ++known->count;
  if (known->first.size() < kNamed) known->first.push_back(task);
}

void add_failure(std::size_t task, const std::string& reason, StudyResult& result) {
  ++result.failed_tasks;
  add_reason(task, reason, result.failures);
}

void warn_of(const std::vector<TasksOfReason>& reasons, StudyResult& result) {
  for (const TasksOfReason& of : reasons) {
    result.warn(fmt::format("{} {} ({}{}): {}", of.count, of.count == 1 ? "task" : "tasks",
                            fmt::join(of.first, ", "),
                            of.count > of.first.size() ? " and others" : "", of.reason));
  }
}

}  // namespace modcal
