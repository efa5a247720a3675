// Calibrations of records that no part of the libraries has made: benchmarks/truth.
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
namespace {

constexpr double kFundamental = 294.0, kInharmonicity = 1.1e-4, kContact = 0.041;

// Half a second: a third of the price of the others' records, and every mode rings out in it.
truth::TruthRecord stroke(const truth::TruthMismatch& mismatch, truth::Reactions reactions) {
  return truth::simulate({.fundamental = kFundamental, .inharmonicity = kInharmonicity},
                         {.position = kContact},
                         {.duration = 0.5, .reactions = reactions, .mismatch = mismatch});
}

const truth::TruthRecord& equal_sensors() {
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

Choice<DampingLaw> damping_of(const truth::TruthRecord& record) {
  TableDamping::Options table;
  for (const auto& mode : record.modes) {
    table.frequencies.push_back(mode.omega / (2.0 * M_PI));
    table.ratios.push_back(mode.decay / mode.omega);
  }
  return Choice<DampingLaw>::of<TableDamping>("table", std::move(table));
}

// From f0 1.5 % too high, B 20 % too low, x_c 1 mm too far and one ζ for all modes, as somebody
// starts who has the record alone.
CalibrationResult calibrated(truth::TruthRecord record, const Settings& settings) {
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

const CalibratedParameter& parameter(const CalibrationResult& result, std::string_view name) {
  const auto found = std::find_if(result.parameters.begin(), result.parameters.end(),
                                  [&](const auto& one) { return one.name == name; });
  EXPECT_NE(found, result.parameters.end()) << name;
  return *found;
}

// Errors in standard deviations.
double error(const CalibrationResult& result, std::string_view name, double truth) {
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
FrequencyErrors frequency_errors(const CalibrationResult& result,
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

void expect_right(const CalibrationResult& result) {
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

TEST(ForeignRecord, IsCalibratedWithinItsDeviations) {
  for (const double noise : {0.01, 0.05}) {
    SCOPED_TRACE(noise);
    expect_right(calibrated(equal_sensors(), {.noise = noise}));
  }
}

TEST(ForeignRecord, WithoutTheModesAboveItIsWrong) {
  const CalibrationResult result =
      calibrated(equal_sensors(), {.support = {.remainder = "none"}, .exact_sensors = true});
  EXPECT_GT(frequency_errors(result).by_data, 2.0 * kFour);
  EXPECT_FALSE(result.continuation->right);
}

// Differences between two answers in the larger of their standard deviations.
double difference(const CalibrationResult& a, const CalibrationResult& b, std::string_view name) {
  const CalibratedParameter &one = parameter(a, name), &other = parameter(b, name);
  return std::abs(one.final - other.final) / std::max(one.deviation, other.deviation);
}
double largest_difference(const CalibrationResult& a, const CalibrationResult& b) {
  double largest = 0.0;
  for (const char* name : {"f0", "B", "x_c", "gain", "delay"}) {
    largest = std::max(largest, difference(a, b, name));
  }
  const std::vector<ModeVerdict>&first = a.continuation->modes, &second = b.continuation->modes;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const ModeVerdict &one = first[i], &other = second[i];
    if (one.source != ModeSource::kIdentified || other.source != ModeSource::kIdentified) continue;
    largest = std::max(largest, std::abs(one.frequency / other.frequency - 1.0) /
                                    std::max(one.deviation, other.deviation));
  }
  return largest;
}

// The same bins, in which 28 modes lie: what is stated above costs time and changes nothing. The
// noise is stated, too: where it is read begins above the modes. (From one ζ for all modes, as
// above, gain and f_1 differ by 0.4.)
TEST(ForeignRecord, TheNumberOfModesIsNoMatter) {
  Settings settings{
      .modes = 30, .highest_frequency = 8500.0, .known_noise = true, .known_damping = true};
  const CalibrationResult few = calibrated(equal_sensors(), settings);
  settings.modes = 50;
  const CalibrationResult many = calibrated(equal_sensors(), settings);
  expect_right(few);
  expect_right(many);
  EXPECT_LT(largest_difference(few, many), 0.3);
  // Where there are none above, it matters.
  settings.modes = 30;
  settings.support.remainder = "none";
  EXPECT_GT(largest_difference(calibrated(equal_sensors(), settings), many), 1.0);
}

TEST(ForeignRecord, SensorsMayDiffer) {
  const truth::TruthRecord record =
      stroke({.gain = 1.005, .delay = 1e-6}, truth::Reactions::kTension);
  const CalibrationResult result = calibrated(record, {});
  expect_right(result);
  EXPECT_LT(std::abs(error(result, "gain", 1.005)), kFour);
  EXPECT_LT(std::abs(error(result, "delay", 1e-6)), kFour);
  // Taken to be equal, no cause is the right one: the frequencies are wrong, and the misfit is
  // plain.
  const CalibrationResult exact = calibrated(record, {.exact_sensors = true});
  EXPECT_GT(frequency_errors(exact).by_data, 2.0 * kFour);
  EXPECT_FALSE(exact.continuation->right);
}

// A resonance of the body in one reaction is a response of its sensor that nobody has stated.
TEST(ForeignRecord, ABodyMayRingInOneReaction) {
  const truth::TruthRecord record =
      stroke({.body_peak = 0.0125, .body_frequency = 280.0, .body_damping = 0.02},
             truth::Reactions::kTension);
  expect_right(calibrated(record, {.noise = 2e-3}));
  const CalibrationResult without = calibrated(record, {.noise = 2e-3, .response = false});
  EXPECT_GT(frequency_errors(without).by_data, 2.0 * kFour);
}

// Damped, such a record is told by what rings at its start, and leads into false minima: two modes
// 1 and 3 % off, "leaving the law", were accepted.
TEST(ForeignRecord, MayBeginInMidStroke) {
  truth::TruthRecord record = truth::simulate(
      {.fundamental = kFundamental, .inharmonicity = kInharmonicity}, {.position = kContact},
      {.duration = 0.8, .reactions = truth::Reactions::kTension});
  const auto before = static_cast<std::ptrdiff_t>(std::lround(0.3 * record.rate));
  for (std::vector<double>* reaction : {&record.r1, &record.r2}) {
    reaction->erase(reaction->begin(), reaction->begin() + before);
  }
  const CalibrationResult result = calibrated(std::move(record), {});
  expect_right(result);
}

TEST(ForeignRecord, HumOfTheMainsIsNoMatter) {
  truth::TruthRecord record = equal_sensors();
  for (std::size_t j = 0; j < record.r1.size(); ++j) {
    const double turn = 2.0 * M_PI * 49.96 * static_cast<double>(j) / record.rate;
    for (int h = 1; h <= 6; ++h) {
      record.r1[j] += 0.02 / h * std::cos(h * turn + h);
      record.r2[j] -= 0.01 / h * std::sin(h * turn);
    }
  }
  const CalibrationResult result = calibrated(record, {});
  expect_right(result);
  ASSERT_GE(result.continuation->lines.size(), 8u);
  // Half a second: a fiftieth of a bin of 2 Hz.
  EXPECT_NEAR(result.continuation->lines.front(), 49.96, 0.04);
  EXPECT_TRUE(calibrated(equal_sensors(), {}).continuation->lines.empty());
}

const ScoreTest& test_of(const CalibrationResult& result, std::string_view cause) {
  const std::vector<ScoreTest>& tests = result.continuation->tests;
  const auto found = std::find_if(tests.begin(), tests.end(),
                                  [&](const ScoreTest& test) { return test.cause == cause; });
  EXPECT_NE(found, tests.end()) << cause;
  return *found;
}

// A tuning that drifts is found, to first order, and free in the fit that is reported.
TEST(ForeignRecord, ItsTuningMayDrift) {
  constexpr double kDrift = 2e-4;
  const CalibrationResult result =
      calibrated(stroke({.drift = kDrift}, truth::Reactions::kTension), {});
  expect_right(result);
  ASSERT_EQ(result.continuation->freed.size(), 1u);
  const ScoreTest& freed = result.continuation->freed.front();
  EXPECT_EQ(freed.cause, "drift of the tuning");
  const double deviation = kDrift / std::sqrt(freed.statistic);
  // First order: of mode 40, whose width is 2ζ = 3e-3, a tenth.
  EXPECT_NEAR(freed.amplitude, kDrift, 4.0 * deviation + 0.1 * kDrift);
  EXPECT_GT(freed.shift, 1.0);
}

// A bow that wanders along the string by a millimeter is what the fit names first, and refuses: x_c
// is not one number.
TEST(ForeignRecord, ItsContactMayMove) {
  const CalibrationResult result =
      calibrated(stroke({.wander = 1e-3}, truth::Reactions::kTension), {});
  EXPECT_FALSE(result.continuation->right);
  const ScoreTest* cause = first_cause(result.continuation->tests);
  ASSERT_NE(cause, nullptr);
  EXPECT_EQ(cause->cause, "contact that moves");
  EXPECT_TRUE(cause->refuses());
  EXPECT_FALSE(cause->remedy().empty());
}

TEST(ForeignRecord, AStillContactIsNotSaidToMove) {
  const CalibrationResult result = calibrated(equal_sensors(), {});
  EXPECT_FALSE(test_of(result, "contact that moves").named());
}

// What a second polarization does to both ends alike cannot be told: the fit is refused by what it
// does to one of them.
TEST(ForeignRecord, ASecondPolarizationIsNamed) {
  const CalibrationResult result =
      calibrated(stroke({.polarization = {0.1, 0.03}}, truth::Reactions::kTension), {});
  EXPECT_FALSE(result.continuation->right);
  EXPECT_TRUE(test_of(result, "second polarization").named());
  const ScoreTest* cause = first_cause(result.continuation->tests);
  ASSERT_NE(cause, nullptr);
  EXPECT_TRUE(cause->refuses());
  EXPECT_FALSE(cause->remedy().empty());
}

// Alike at both ends it moves all frequencies. What it is estimated to move them by, the deviations
// hold: of both amplitudes, a share of 2 % of 1.02, to first order.
TEST(ForeignRecord, ASecondPolarizationAlikeAtBothEndsIsInTheDeviations) {
  constexpr double kShare = 0.02, kDetuning = 1e-3;
  const CalibrationResult result = calibrated(
      stroke({.polarization = {kShare, kShare}, .detuning = kDetuning}, truth::Reactions::kTension),
      {.noise = 5e-3});
  const ScoreTest& test = test_of(result, "second polarization");
  EXPECT_EQ(test.detail, "detuned by +0.1 %");
  // Both ends alike by ±3 % move f_n by that share of the detuning, less where the record tells it.
  EXPECT_GT(test.untold(9, 9), 0.0);
  EXPECT_LT(std::sqrt(test.untold(9, 9)), std::sqrt(2.0) * kPolarizationWidth * kDetuning);
  const double amplitude = std::sqrt(2.0) * kShare / (1.0 + kShare);
  EXPECT_NEAR(test.amplitude, amplitude, kFour * test.amplitude / std::sqrt(test.statistic));
  EXPECT_GT(test.statistic, 4.0 * kFour);
  EXPECT_LT(std::abs(error(result, "f0", kFundamental)), kFour);
  EXPECT_LT(frequency_errors(result).largest, kFour);
}

std::vector<double> frequencies_of(const truth::TruthRecord& record) {
  std::vector<double> frequencies;
  for (const auto& mode : record.modes) frequencies.push_back(mode.omega / (2.0 * M_PI));
  return frequencies;
}

// A bridge that noise hides moves f_1 and f_2 by 1.4e-4 off the law that all others follow, and no
// test sees it: the deviations hold what it may be.
TEST(ForeignRecord, ABridgeThatNoiseHidesIsInTheDeviations) {
  const truth::TruthRecord record =
      stroke({.body_frequency = 430.0, .body_damping = 0.02, .bridge_mass = 0.2},
             truth::Reactions::kTension);
  const CalibrationResult result = calibrated(record, {.noise = 0.05});
  EXPECT_TRUE(result.continuation->right);
  EXPECT_LT(frequency_errors(result, frequencies_of(record)).largest, kFour);
  EXPECT_LT(std::abs(error(result, "x_c", kContact)), kFour);
  const double lowest = result.continuation->modes[0].deviation;
  const CalibrationResult rigid = calibrated(equal_sensors(), {.noise = 0.05});
  // What the same noise hides of a string with rigid ends is as large.
  EXPECT_GT(rigid.continuation->modes[0].deviation, 0.2 * lowest);
}

// What its body does to the record is taken out, and what is left follows the law of the string on
// rigid ends; the frequencies are those on the bridge.
TEST(ForeignRecord, ABridgeThatMovesIsTakenOut) {
  const truth::TruthRecord record =
      stroke({.body_frequency = 350.0, .body_damping = 0.02, .bridge_mass = 0.05},
             truth::Reactions::kTension);
  const CalibrationResult result = calibrated(record, {.noise = 5e-3});
  const ContinuationResult& found = *result.continuation;
  EXPECT_TRUE(found.right) << found.chi2;
  ASSERT_FALSE(found.freed.empty());
  const ScoreTest& body = found.freed.front();
  EXPECT_EQ(body.cause, "bridge that moves");
  // Where its mode is and how heavy: a step of the search is 1.7 %.
  EXPECT_NEAR(body.place, 350.0, 0.035 * 350.0);
  EXPECT_NEAR(1.0 / body.amplitude, 0.05, 0.5 * 0.05);
  EXPECT_NE(body.detail.find(" Hz, of 0.0"), std::string::npos) << body.detail;
  EXPECT_GT(body.shift, kFour);
  EXPECT_LT(frequency_errors(result, frequencies_of(record)).largest, kFour);
  EXPECT_LT(std::abs(error(result, "x_c", kContact)), kFour);
  EXPECT_LT(std::abs(error(result, "f0", kFundamental)), kFour);
}

// A sensor with a mode of its own moves no frequency; for a bridge it is taken only where that
// moves none, either.
TEST(ForeignRecord, AResonanceOfASensorMovesNoFrequency) {
  const CalibrationResult result =
      calibrated(stroke({.body_peak = 0.0125, .body_frequency = 280.0, .body_damping = 0.02},
                        truth::Reactions::kTension),
                 {.noise = 2e-3});
  EXPECT_FALSE(result.continuation->freed.empty());
  expect_right(result);
}

TEST(ForeignRecord, ANonlinearSensorIsNamed) {
  truth::TruthRecord record = equal_sensors();
  double power = 0.0;
  for (const double r : record.r2) power += r * r / static_cast<double>(record.r2.size());
  for (double& r : record.r2) r *= 1.0 + 0.005 * r * r / power;
  const CalibrationResult result = calibrated(record, {});
  EXPECT_TRUE(test_of(result, "nonlinear sensor").named());
  EXPECT_FALSE(result.continuation->right);
}

// Of an equal record no test says anything, whatever the noise; and none is made of a simulation.
TEST(ForeignRecord, NoCauseIsSeenWhereThereIsNone) {
  for (const double noise : {0.002, 0.05}) {
    const CalibrationResult result = calibrated(equal_sensors(), {.noise = noise});
    ASSERT_EQ(result.continuation->tests.size(), 6u);
    for (const ScoreTest& test : result.continuation->tests) {
      EXPECT_FALSE(test.named()) << test.cause << " " << test.log_p;
    }
    EXPECT_TRUE(result.continuation->freed.empty());
  }
}

TEST(ForeignRecord, SupportsMayFeelTheBending) {
  const truth::TruthRecord record = stroke({}, truth::Reactions::kSupport);
  expect_right(calibrated(record, {.support = {.reaction = "support"}}));
}

}  // namespace
}  // namespace modcal::foreign_record_test
