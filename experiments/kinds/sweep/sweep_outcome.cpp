#include "experiments/kinds/sweep/sweep_outcome.hpp"

#include <array>

#include "experiments/kinds/number_json.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using nlohmann::json;

constexpr std::array kStatuses = {ChoiceStatus::kNotComputed, ChoiceStatus::kChosen,
                                  ChoiceStatus::kGiven,       ChoiceStatus::kNoParameter,
                                  ChoiceStatus::kEdgeOfRange, ChoiceStatus::kNoInteriorMinimum,
                                  ChoiceStatus::kNotReached};

ChoiceStatus read_status(const std::string& name) {
  for (const ChoiceStatus status : kStatuses) {
    if (name_of(status) == name) return status;
  }
  throw InvalidInput("unknown status of a parameter choice: " + name);
}

json score_json(const WindowScore& score) {
  return {number_json(score.start), number_json(score.correlation),
          number_json(score.relative_rms_error), number_json(score.anti_aliased)};
}

WindowScore read_score(const json& value) {
  return {read_number(value.at(0)), read_number(value.at(1)), read_number(value.at(2)),
          read_number(value.at(3))};
}

json side_json(const TaskScores& side) {
  json scores = json::array();
  for (const WindowScore& score : side.scores) scores.push_back(score_json(score));
  return {{"side", side.side},
          {"parameter", number_json(side.parameter)},
          {"status", name_of(side.status)},
          {"scores", std::move(scores)},
          {"whole", score_json(side.whole)},
          {"misfit", number_json(side.misfit)},
          {"warnings", side.warnings}};
}

TaskScores read_side(const json& value) {
  TaskScores side;
  side.side = value.at("side").get<std::string>();
  side.parameter = read_number(value.at("parameter"));
  side.status = read_status(value.at("status").get<std::string>());
  for (const json& score : value.at("scores")) side.scores.push_back(read_score(score));
  side.whole = read_score(value.at("whole"));
  side.misfit = read_number(value.at("misfit"));
  side.warnings = value.at("warnings").get<std::vector<std::string>>();
  return side;
}

}  // namespace

std::string outcome_text(const TaskOutcome& outcome) {
  if (!outcome.failure.empty()) return json{{"failure", outcome.failure}}.dump();
  json sides = json::array();
  for (const TaskScores& side : outcome.sides) sides.push_back(side_json(side));
  return json{{"sides", std::move(sides)}}.dump();
}

TaskOutcome read_outcome(const std::string& text) {
  try {
    const json value = json::parse(text);
    TaskOutcome outcome;
    outcome.failure = value.value("failure", std::string());
    if (outcome.failure.empty()) {
      for (const json& side : value.at("sides")) outcome.sides.push_back(read_side(side));
    }
    return outcome;
  } catch (const json::exception& error) {
    throw InvalidInput(std::string("the stored outcome of a task cannot be read: ") + error.what());
  }
}

}  // namespace modcal
