// Calibrations of recorded strokes and plucks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "libsim/signal/statistics.hpp"
#include "tests/experiments/kinds/recorded_stroke.hpp"
#include "tests/refusal.hpp"

namespace modcal::calibrate_records_test {
namespace {

using nlohmann::json;

class CalibrateRecords : public RecordedStroke {};

json calibration_of(const StudyResult& result) {
  for (const auto& [name, content] : result.files) {
    if (name == "calibration.json") return json::parse(content);
  }
  return {};
}

TEST_F(CalibrateRecords, FindFromARecordedPluckWhatASimulatedOneTells) {
  CalibrateOptions options = simulated(0.3, 51200.0);
  PluckRecordOptions pluck;
  pluck.start = Choice<InitialMotion>::of<Pluck>(
      "pluck", {.position = 0.043, .displacement = 1e-3, .width = 3e-3});
  pluck.duration = 0.3;
  options.plucks = {pluck};
  const json direct = calibration_of(options.run(context()));

  const Observation observed = stroke(options);
  write("stroke.csv",
        {*observed.reaction(End::kLeft), *observed.reaction(End::kRight), *observed.reference});
  const CalibrationRecord decay = observe_plucks(options.plucks, options.inversion.observation,
                                                 options.inversion.key(), context())[0];
  const RealFft fft(decay.data.samples);
  std::vector<Signal> signals;
  for (const End end : kEnds) {
    signals.push_back({.quantity = end == End::kLeft ? "R1" : "R2",
                       .unit = "N",
                       .sample_rate = decay.data.sample_rate,
                       .samples = fft.inverse(decay.data.reaction(end))});
  }
  signals.push_back(*observed.reference);
  write("pluck.csv", signals);
  const json recorded = calibration_of(run("", "plucks: [{record: pluck.csv}]\n"));

  ASSERT_EQ(recorded["parameters"].size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const double expected = direct["parameters"][i]["final"];
    // The record starts from the string that it tells: what the search converges to is the same to
    // its tolerance, 1e-4 of minus the log likelihood or 0.014 deviations.
    EXPECT_NEAR(recorded["parameters"][i]["final"].get<double>(), expected,
                0.014 * direct["parameters"][i]["sd"].get<double>())
        << i;
  }
  EXPECT_TRUE(recorded["continuation"]["right"].get<bool>());
  EXPECT_NEAR(recorded["continuation"]["chi2"], direct["continuation"]["chi2"].get<double>(),
              0.014 * direct["continuation"]["chi2_sd"].get<double>());
}

TEST_F(CalibrateRecords, FailByThePriorsWhereTheFitIsNotWrong) {
  // x_c is known to half a micrometer; this prior, ten deviations off, moves it by a fortieth of
  // one.
  CalibrateOptions options = simulated(0.3, 51200.0);
  options.calibration.parameters.unknowns.priors = {
      {.parameter = "x_c", .mean = 30.1e-3, .deviation = 1e-5}};
  const StudyResult result = options.run(context());
  EXPECT_TRUE(calibration_of(result)["continuation"]["fits"].get<bool>());
  EXPECT_EQ(result.status, report::Status::kFailed);
  EXPECT_THAT(result.summary, testing::HasSubstr("warning: the data contradict the priors stated"));
  EXPECT_THAT(result.summary, testing::Not(testing::HasSubstr("search failed")));
  EXPECT_THAT(result.summary, testing::Not(testing::HasSubstr("FIT IS WRONG")));
}

// The start is 2 mm off and may move by 1: what is found on the bound is not the string's.
TEST_F(CalibrateRecords, FailWhereTheStringLiesBeyondTheBounds) {
  CalibrateOptions options = simulated(0.3, 51200.0);
  options.inversion.model_error.contact = 2e-3;
  options.calibration.parameters.ranges.contact = 1e-3;
  const StudyResult result = options.run(context());
  EXPECT_EQ(result.status, report::Status::kFailed);
  EXPECT_THAT(result.summary, testing::HasSubstr("x_c ended on the bound of its range"));
  options.calibration.parameters.ranges.contact = 3e-3;
  EXPECT_EQ(options.run(context()).status, report::Status::kOk);
}

struct Lines {
  double duration = 0.5;  // of the record [s]
  double noise = 0.1;     // over a reaction's standard deviation
  double begins = 0.0;    // the record, after the force [s]
  double ends = 10.0;     // the force [s]
};

// Reactions of the paper's string, 60 modes each stepped exactly for a force that is linear between
// the samples of a grid eight times as fine; lines of the force, k^(-3/2), whose phases wander.
std::vector<Signal> lines_of_force(const Lines& lines) {
  constexpr double sample_rate = 44100.0;
  StringModel string = paper_scene().string;
  string.modes = 60;
  const ModalBasis basis = make_modal_basis(string);
  const std::vector<double> shape = basis.shape_at(0.03);
  constexpr std::size_t kFine = 8, kLines = 30;
  const auto first_sample = static_cast<std::size_t>(lines.begins * sample_rate);
  const auto count = first_sample + static_cast<std::size_t>(lines.duration * sample_rate);
  const double step = 1.0 / (static_cast<double>(kFine) * sample_rate);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> phases(kLines);
  std::vector<std::complex<double>> motion(basis.size());
  Signal left{.quantity = "R1", .unit = "N", .sample_rate = sample_rate}, right = left;
  right.quantity = "R2";
  double before = 0.0;
  for (std::size_t i = 0; i < count * kFine; ++i) {
    double force = 0.0;
    for (std::size_t k = 1; k <= kLines; ++k) {
      phases[k - 1] += 2.0 * std::numbers::pi * 196.4 * static_cast<double>(k) * step +
                       0.02 * static_cast<double>(k) * std::sqrt(step / 5e-3) * normal(random);
      force += std::sin(phases[k - 1]) * std::pow(static_cast<double>(k), -1.5);
    }
    if (i == 0) phases.assign(kLines, 0.0), force = 0.0;
    if (static_cast<double>(i) * step > lines.ends) force = 0.0;
    double at_left = 0.0, at_right = 0.0;
    for (std::size_t n = 0; n < basis.size(); ++n) {
      // q = Im z/ω_d of z' = λz + f φ/m, λ = −ζω + iω_d.
      const double damped = basis.omega[n] * std::sqrt(1.0 - basis.zeta[n] * basis.zeta[n]);
      const std::complex<double> pole(-basis.zeta[n] * basis.omega[n], damped);
      const std::complex<double> turn = std::exp(pole * step), first = (turn - 1.0) / pole;
      const std::complex<double> slope = (first - step) / (pole * step);
      motion[n] =
          turn * motion[n] + shape[n] / basis.mass[n] * (before * (first - slope) + force * slope);
      const double pull = basis.tension * std::numbers::pi / basis.length *
                          static_cast<double>(n + 1) * motion[n].imag() / damped;
      at_left -= pull;
      at_right += n % 2 == 0 ? -pull : pull;
    }
    before = force;
    if (i % kFine != 0 || i < first_sample * kFine) continue;
    left.samples.push_back(at_left);
    right.samples.push_back(at_right);
  }
  for (Signal* signal : {&left, &right}) {
    const double noise = lines.noise * standard_deviation(signal->samples);
    for (double& x : signal->samples) x += noise * normal(random);
  }
  return {left, right};
}

class CalibrateLines : public CalibrateRecords {
 protected:
  StudyResult calibrated(const Lines& lines, const std::string& modes,
                         const std::string& position = "30 mm") {
    write("stroke.csv", lines_of_force(lines));
    const LoadedExperiment loaded = load_experiment(parse_yaml(
        "kind: calibrate\nrecord: {file: stroke.csv, left: {channel: R1}, right: {channel: R2}}\n"
        "string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196.5 Hz, modes: " +
            modes + "}\nbow: {position: " + position + "}\n",
        (folder() / "experiment.yaml").string()));
    EXPECT_EQ(format_mistakes(loaded.document, loaded.mistakes), "");
    return loaded.experiment->run(context());
  }
};

// Half a second of lines that fade into noise tells about ten modes of the forty in whose band
// there is power. At its modes the string moves both ends alike, wherever the contact is: from 38
// mm the search ends 46 of its deviations from the true 30 mm, and from 60 mm at 60.
TEST_F(CalibrateLines, TakeNoMoreModesThanAreTold) {
  for (const char* const position : {"30 mm", "38 mm", "60 mm"}) {
    const StudyResult untold = calibrated({}, "auto", position);
    EXPECT_EQ(untold.status, report::Status::kFailed) << position;
    EXPECT_THAT(untold.answer, testing::HasSubstr("the ends do not tell x_c in this record"));
  }
  // Of the budget that is left no other start comes to an end.
  const StudyResult cut =
      calibrated({}, "auto", "30 mm}\ncalibration: {budget: {evaluations: 600}");
  EXPECT_EQ(cut.status, report::Status::kFailed);
  EXPECT_THAT(cut.summary, testing::HasSubstr("before another start is tried: raise calibration"));
  const StudyResult taken =
      calibrated({}, "auto", "30 mm}\ncalibration: {parameters: {contact: false}");
  EXPECT_EQ(taken.status, report::Status::kOk) << taken.answer;
  EXPECT_THAT(taken.summary, testing::HasSubstr("modes taken (modes: auto): none above mode"));
  const json found = calibration_of(taken);
  EXPECT_LT(found["modes"].size(), 40u);
  for (const json& parameter : found["parameters"]) {
    if (parameter["name"] == "f0") {
      EXPECT_NEAR(parameter["final"].get<double>(), 196.0, 4.0 * parameter["sd"].get<double>());
    }
  }
  const StudyResult stated = calibrated({}, "60");
  EXPECT_EQ(stated.status, report::Status::kFailed);
  EXPECT_THAT(stated.summary, testing::HasSubstr("60 modes are stated, and none above mode"));
}

// Where nothing drives the string, both ends still tell f0 and B, but no x_c: the force of this
// record has ended before it begins.
TEST_F(CalibrateLines, RefuseAStringThatRingsByItself) {
  const StudyResult ringing = calibrated({.noise = 0.001, .begins = 0.21, .ends = 0.2}, "auto");
  EXPECT_EQ(ringing.status, report::Status::kFailed) << ringing.summary;
  EXPECT_THAT(ringing.answer, testing::HasSubstr("it rings by itself (free decays leave 1"));
  EXPECT_THAT(ringing.answer, testing::HasSubstr("kind: identify"));
  // The end of the force is within the record.
  const StudyResult driven = calibrated({.noise = 0.01, .begins = 0.1, .ends = 0.2}, "auto");
  EXPECT_THAT(driven.summary, testing::Not(testing::HasSubstr("rings by itself (")));
}

// Noise as large as the reactions leaves no mode to tell, and f0 and x_c many places.
TEST_F(CalibrateLines, RefuseARecordThatTellsNoMode) {
  const StudyResult noisy = calibrated({.duration = 0.2, .noise = 2.0}, "auto");
  EXPECT_EQ(noisy.status, report::Status::kFailed);
  EXPECT_THAT(noisy.summary, testing::HasSubstr("of its modes, too few for a string"));
}

// The second part of the file ends behind it.
TEST_F(CalibrateLines, OfAListAreCheckedPartByPart) {
  write("stroke.csv", lines_of_force({}));
  const LoadedExperiment loaded = load_experiment(parse_yaml(
      "kind: calibrate\nrecord: {file: stroke.csv, left: {channel: R1}, right: {channel: R2}}\n"
      "string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196.5 Hz}\n"
      "bow: {position: 30 mm}\nsweep: {product: {record.stop: [0.4 s, 2 s], seed: [1, 2]}}\n",
      (folder() / "experiment.yaml").string()));
  const std::vector<Finding> findings = loaded.experiment->lint_records(folder());
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_THAT(findings[0].text, testing::HasSubstr("stop = 2 s is not in the record"));
}

// One would count twice.
TEST_F(CalibrateRecords, RefuseACopyOfAStroke) {
  const Observation observed = stroke(simulated(0.1, 51200.0));
  const std::vector<Signal> signals = {*observed.reaction(End::kLeft),
                                       *observed.reaction(End::kRight), *observed.reference};
  write("stroke.csv", signals);
  write("again.csv", signals);
  EXPECT_THAT(refusal_of([&] { run("", "further_strokes: {records: [again.csv]}\n"); }),
              testing::HasSubstr("strokes 1 and 2 have the same samples"));
}

TEST_F(CalibrateRecords, SayWhereTheNoiseStatedIsTooMuch) {
  const Observation observed = stroke(simulated(0.3, 51200.0));
  write("stroke.csv",
        {*observed.reaction(End::kLeft), *observed.reaction(End::kRight), *observed.reference});
  const double spread[] = {standard_deviation(observed.reaction(End::kLeft)->samples),
                           standard_deviation(observed.reaction(End::kRight)->samples)};
  const StudyResult overstated = run(
      fmt::format(", noise_rms_1: {:g} N, noise_rms_2: {:g} N", 0.03 * spread[0], 0.03 * spread[1]),
      "");
  // Three times the noise there is: within the 2 % to which 0.3 s tell it, three of them.
  const double chi2 = calibration_of(overstated)["continuation"]["chi2"];
  EXPECT_NEAR(9.0 * chi2, 1.0, 0.1);
  EXPECT_THAT(overstated.summary,
              testing::HasSubstr(fmt::format(
                  "noise overstated: the data scatter less than the noise levels say; standard "
                  "deviations are too wide by a factor of {:.3g}",
                  1.0 / std::sqrt(chi2))));
  EXPECT_THAT(run("", "").summary, testing::Not(testing::HasSubstr("overstated")));
}

}  // namespace
}  // namespace modcal::calibrate_records_test
