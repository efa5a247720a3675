// Strokes of the paper's string, simulated, and calibrated as records.
#pragma once

#include <gtest/gtest.h>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/loader.hpp"
#include "libsim/dynamics/scene/scene.hpp"
#include "libsim/records/record_file.hpp"
#include "tests/folder_test.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {

class RecordedStroke : public FolderTest {
 protected:
  StudyContext context() { return {.work = work_, .folder = folder(), .command = "test"}; }

  // The law of the paper's string from a stroke with 1 % noise.
  static CalibrateOptions simulated(double duration, double sample_rate) {
    CalibrateOptions options;
    ObservationOptions& observation = options.inversion.observation;
    observation.has_scene = true;
    observation.truth.scene = paper_scene();
    observation.truth.scene.duration = duration;
    observation.truth.simulator.select("modal_event");
    observation.measurement.sample_rate = sample_rate;
    observation.measurement.noise_level = 0.01;
    options.calibration = calibration_to_the_bound();
    options.calibration.parameters.frequencies = "none";
    return options;
  }

  Observation stroke(const CalibrateOptions& options) {
    return observe(options.inversion.observation, {.force = true}, work_.truths,
                   options.inversion.key(), folder());
  }

  void write(const std::string& file, const std::vector<Signal>& signals) {
    write_csv(folder() / file, signals);
  }

  // What was recorded is a simulation of exactly the stated modes.
  StudyResult run(const std::string& noise, const std::string& further,
                  const std::string& sensors = ", sensors: [exact]",
                  const std::string& fundamental = "196 Hz") {
    const LoadedExperiment loaded = load_experiment(
        parse_yaml("kind: calibrate\n"
                   "record: {file: stroke.csv, left: {channel: R1}, right: {channel: R2}, "
                   "reference: {channel: f_c}}\n"
                   "string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: " +
                       fundamental +
                       ", modes: 50}\n"
                       "bow: {position: 30 mm}\n"
                       "calibration: {parameters: {frequencies: none, damping: factor" +
                       sensors + "}, objective: {type: joint_likelihood" + noise +
                       "}, remainder: none}\n" + further,
                   (folder() / "experiment.yaml").string()));
    EXPECT_EQ(format_mistakes(loaded.document, loaded.mistakes), "");
    return loaded.experiment ? loaded.experiment->run(context()) : StudyResult();
  }
  SharedWork work_;
};

}  // namespace modcal
