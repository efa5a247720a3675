#include "experiments/kinds/benchmark/benchmark_outcome.hpp"

#include <array>

#include "experiments/kinds/number_json.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using nlohmann::json;

// Name and member of every number of an outcome.
struct NumberMember {
  const char* name;
  double BenchmarkOutcome::*member;
};
constexpr std::array kNumbers = {
    NumberMember{"initial_value", &BenchmarkOutcome::initial_value},
    NumberMember{"value", &BenchmarkOutcome::value},
    NumberMember{"truth_value", &BenchmarkOutcome::truth_value},
    NumberMember{"initial_error", &BenchmarkOutcome::initial_error},
    NumberMember{"frequency_error", &BenchmarkOutcome::frequency_error},
    NumberMember{"frequency_rms_error", &BenchmarkOutcome::frequency_rms_error},
    NumberMember{"frequency_bound", &BenchmarkOutcome::frequency_bound},
    NumberMember{"contact_error", &BenchmarkOutcome::contact_error},
    NumberMember{"correlation", &BenchmarkOutcome::correlation}};

StopReason read_stop(const std::string& name) {
  for (int i = 0; i <= static_cast<int>(StopReason::kNoProgress); ++i) {
    if (name_of(static_cast<StopReason>(i)) == name) return static_cast<StopReason>(i);
  }
  throw InvalidInput("unknown stop reason: " + name);
}

}  // namespace

std::string outcome_text(const BenchmarkOutcome& outcome) {
  if (!outcome.failure.empty()) return json{{"failure", outcome.failure}}.dump();
  json trace = json::array();
  for (const auto& [evaluations, value] : outcome.trace) {
    trace.push_back({evaluations, number_json(value)});
  }
  json object = {{"stop", name_of(outcome.stop)},
                 {"evaluations", outcome.evaluations},
                 {"success", outcome.success},
                 {"trace", std::move(trace)}};
  for (const NumberMember& number : kNumbers) {
    object[number.name] = number_json(outcome.*number.member);
  }
  return object.dump();
}

BenchmarkOutcome read_benchmark_outcome(const std::string& text) {
  try {
    const json object = json::parse(text);
    BenchmarkOutcome outcome;
    outcome.failure = object.value("failure", std::string());
    if (!outcome.failure.empty()) return outcome;
    outcome.stop = read_stop(object.at("stop").get<std::string>());
    outcome.evaluations = object.at("evaluations").get<std::int64_t>();
    outcome.success = object.at("success").get<bool>();
    for (const json& point : object.at("trace")) {
      outcome.trace.emplace_back(point.at(0).get<std::int64_t>(), read_number(point.at(1)));
    }
    for (const NumberMember& number : kNumbers) {
      outcome.*number.member = read_number(object.at(number.name));
    }
    return outcome;
  } catch (const json::exception& error) {
    throw InvalidInput(std::string("the stored outcome of a task cannot be read: ") + error.what());
  }
}

std::string reason_of(const BenchmarkOutcome& outcome) {
  if (outcome.success) return {};
  if (!outcome.failure.empty()) return "refused or broke: " + outcome.failure;
  if (outcome.stop == StopReason::kNotFinite) return "met a value that is not finite";
  if (outcome.value > outcome.truth_value) {
    const bool cut =
        outcome.stop == StopReason::kEvaluationBudget || outcome.stop == StopReason::kTimeBudget;
    return cut ? "was cut by the budget before it reached the value at the truth"
               : "ended in a minimum above the value at the truth";
  }
  return "found a value below that at the truth: the objective's minimum lies elsewhere";
}

}  // namespace modcal
