// Calibrations of records that no part of the libraries has made: benchmarks/truth.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "benchmarks/truth/truth.hpp"
#include "libcalib/calibration.hpp"
#include "libcalib/identifiability/tuning.hpp"
#include "libcalib/objectives/joint_likelihood.hpp"
#include "libsim/model/damping.hpp"

namespace modcal::foreign_record_test {

constexpr double kFundamental = 294.0, kInharmonicity = 1.1e-4, kContact = 0.041;

// Half a second: a third of the price of the others' records, and every mode rings out in it.
inline truth::TruthRecord stroke(const truth::TruthMismatch& mismatch, truth::Reactions reactions) {
  return truth::simulate({.fundamental = kFundamental, .inharmonicity = kInharmonicity},
                         {.position = kContact},
                         {.duration = 0.5, .reactions = reactions, .mismatch = mismatch});
}

inline const truth::TruthRecord& equal_sensors() {
  static const truth::TruthRecord record = stroke({}, truth::Reactions::kTension);
  return record;
}

struct Settings {
  std::int64_t modes = 40;
  double noise = 0.01;
  SupportOptions support = {};
  bool exact_sensors = false;
  bool response = true;  ///< else gain, delay and corner alone
  bool all_frequencies = true;
  double highest_frequency = std::numeric_limits<double>::quiet_NaN();  ///< [Hz]
  bool known_noise = false;                                             ///< stated, not read
  bool known_damping = false;  ///< else 1e-3 for every mode
};

inline Choice<DampingLaw> damping_of(const truth::TruthRecord& record) {
  TableDamping::Options table;
  for (const auto& mode : record.modes) {
    table.frequencies.push_back(mode.omega / (2.0 * M_PI));
    table.ratios.push_back(mode.decay / mode.omega);
  }
  return Choice<DampingLaw>::of<TableDamping>("table", std::move(table));
}

// From f0 1.5 % too high, B 20 % too low, x_c 1 mm too far and one ζ for all modes, as somebody
// starts who has the record alone.
inline CalibrationResult calibrated(truth::TruthRecord record, const Settings& settings) {
  add_noise(record, settings.noise, 5);
  StringModel string{.length = 0.33,
                     .linear_density = 1e-3,
                     .fundamental = 1.015 * kFundamental,
                     .inharmonicity = 0.8 * kInharmonicity,
                     .modes = settings.modes};
  if (settings.known_damping) string.damping = damping_of(record);
  CalibrationOptions options = calibration_to_the_bound();
  options.objective = Choice<Objective>::of<JointLikelihood>(
      "joint_likelihood", {.highest_frequency = settings.highest_frequency});
  options.parameters.frequencies = settings.all_frequencies ? "all" : "none";
  options.parameters.unknowns.damping = "auto";
  options.parameters.unknowns.exact_sensors = settings.exact_sensors;
  if (!settings.response) {
    for (UnknownOption& sensor : options.parameters.unknowns.sensor) sensor.free = true;
    options.parameters.unknowns.priors = {
        {"gain", 1.0, 0.02}, {"delay", 0.0, 2e-5}, {"corner", 0.0, 1.0}};
  }
  options.support = settings.support;
  std::vector<CalibrationRecord> records = {
      {.data = CalibrationData::of_records(record.r1, record.r2, record.rate), .recorded = true}};
  if (settings.known_noise) records[0].noise = {record.noise[0], record.noise[1]};
  return calibrate({make_modal_basis(string), kContact + 1e-3}, std::move(records), options);
}

inline const CalibratedParameter& parameter(const CalibrationResult& result,
                                            std::string_view name) {
  const auto found = std::find_if(result.parameters.begin(), result.parameters.end(),
                                  [&](const auto& one) { return one.name == name; });
  EXPECT_NE(found, result.parameters.end()) << name;
  return *found;
}

// Errors in standard deviations.
inline double error(const CalibrationResult& result, std::string_view name, double truth) {
  const CalibratedParameter& found = parameter(result, name);
  EXPECT_GT(found.deviation, 0.0) << name;
  return (found.final - truth) / found.deviation;
}

struct FrequencyErrors {
  double largest = 0.0;
  double by_data = 0.0;  ///< largest in the deviations that suspected causes do not widen
  std::size_t identified = 0;
};
// truth: of f_n [Hz]; empty: the string's law.
inline FrequencyErrors frequency_errors(const CalibrationResult& result,
                                        const std::vector<double>& truths = {}) {
  FrequencyErrors errors;
  const std::vector<ModeVerdict>& modes = result.continuation->modes;
  for (std::size_t i = 0; i < modes.size(); ++i) {
    if (modes[i].source != ModeSource::kIdentified) continue;
    const double truth =
        truths.empty() ? stiff_string_frequency(kFundamental, kInharmonicity, i + 1) : truths[i];
    const double error = std::abs(modes[i].frequency / truth - 1.0);
    errors.largest = std::max(errors.largest, error / modes[i].deviation);
    errors.by_data = std::max(errors.by_data, error / modes[i].data_deviation);
    ++errors.identified;
  }
  return errors;
}

// Four deviations: of these few dozen numbers one beyond by chance in 400 runs.
constexpr double kFour = 4.0;

inline void expect_right(const CalibrationResult& result) {
  EXPECT_TRUE(result.continuation->right) << result.continuation->chi2;
  for (const ScoreTest& test : result.continuation->tests) {
    EXPECT_FALSE(test.refuses()) << test.cause << ", S " << test.statistic << ", " << test.shift;
  }
  EXPECT_LT(std::abs(error(result, "f0", kFundamental)), kFour);
  EXPECT_LT(std::abs(error(result, "B", kInharmonicity)), kFour);
  EXPECT_LT(std::abs(error(result, "x_c", kContact)), kFour);
  const FrequencyErrors errors = frequency_errors(result);
  EXPECT_LT(errors.largest, kFour);
  EXPECT_GT(errors.identified, 20u);
  for (const ModeVerdict& mode : result.continuation->modes) {
    EXPECT_NE(mode.tie, LawTie::kLeaves);
  }
}

inline const ScoreTest& test_of(const CalibrationResult& result, std::string_view cause) {
  const std::vector<ScoreTest>& tests = result.continuation->tests;
  const auto found = std::find_if(tests.begin(), tests.end(),
                                  [&](const ScoreTest& test) { return test.cause == cause; });
  EXPECT_NE(found, tests.end()) << cause;
  return *found;
}

}  // namespace modcal::foreign_record_test
