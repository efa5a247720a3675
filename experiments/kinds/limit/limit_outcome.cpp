// The outcome of a calibration as text.
#include <nlohmann/json.hpp>

#include "experiments/kinds/limit/calibration_limit_experiment.hpp"
#include "experiments/kinds/number_json.hpp"

namespace modcal {
namespace {

using nlohmann::json;

json numbers(std::span<const double> values) {
  json list = json::array();
  for (const double value : values) list.push_back(number_json(value));
  return list;
}

void read_numbers(const json& list, std::span<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = read_number(list.at(i));
}

}  // namespace

std::string outcome_text(const LimitOutcome& outcome) {
  if (!outcome.failure.empty()) return json{{"failure", outcome.failure}}.dump();
  return json{{"law", numbers(outcome.law)},
              {"law_deviation", numbers(outcome.law_deviation)},
              {"frequencies", numbers(outcome.frequencies)},
              {"deviations", numbers(outcome.deviations)},
              {"contact", number_json(outcome.contact)},
              {"contact_deviation", number_json(outcome.contact_deviation)},
              {"sensors", numbers(outcome.sensors)},
              {"sensor_deviation", numbers(outcome.sensor_deviation)},
              {"law_chi2", number_json(outcome.law_chi2)},
              {"chi2", number_json(outcome.chi2)},
              {"chi2_deviation", number_json(outcome.chi2_deviation)},
              {"right", outcome.right()},
              {"fits", outcome.fits},
              {"priors_hold", outcome.priors_hold},
              {"paper_error", number_json(outcome.paper_error)},
              {"force_correlation", number_json(outcome.force_correlation)}}
      .dump();
}

LimitOutcome read_limit_outcome(const std::string& text) {
  try {
    const json object = json::parse(text);
    LimitOutcome outcome;
    outcome.failure = object.value("failure", std::string());
    if (!outcome.failure.empty()) return outcome;
    read_numbers(object.at("law"), outcome.law);
    read_numbers(object.at("law_deviation"), outcome.law_deviation);
    outcome.frequencies.resize(object.at("frequencies").size());
    outcome.deviations.resize(outcome.frequencies.size());
    read_numbers(object.at("frequencies"), outcome.frequencies);
    read_numbers(object.at("deviations"), outcome.deviations);
    outcome.contact = read_number(object.at("contact"));
    outcome.contact_deviation = read_number(object.at("contact_deviation"));
    if (object.contains("sensors")) {
      read_numbers(object.at("sensors"), outcome.sensors);
      read_numbers(object.at("sensor_deviation"), outcome.sensor_deviation);
    }
    outcome.law_chi2 = read_number(object.at("law_chi2"));
    outcome.chi2 = read_number(object.at("chi2"));
    outcome.chi2_deviation = read_number(object.at("chi2_deviation"));
    outcome.fits = object.value("fits", object.at("right").get<bool>());
    outcome.priors_hold = object.value("priors_hold", true);
    outcome.paper_error = read_number(object.at("paper_error"));
    outcome.force_correlation = read_number(object.at("force_correlation"));
    return outcome;
  } catch (const json::exception& error) {
    throw InvalidInput(std::string("not the outcome of a calibration: ") + error.what());
  }
}

}  // namespace modcal
