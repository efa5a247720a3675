// String and contact point from a record, with standard deviations:
// calibrate_record FILE.wav, or calibrate_record FILE.wav simulated
#include <cstdio>

#include "libcalib/calibration.hpp"
#include "libsim/io.hpp"

using namespace modcal;

int main(int argc, char** argv) {
  if (argc < 2) return std::puts("usage: calibrate_record FILE.wav [simulated]"), 2;
  RecordOptions channels{.file = argv[1], .has_left = true, .has_right = true};
  channels.left.channel = "R1";
  channels.right.channel = "R2";
  const RecordedSignals record = load_record(channels, ".");
  // A real string has modes above those stated, and its sensors differ.
  const std::vector<CalibrationRecord> strokes = {
      {.data = CalibrationData::of_records(record.left->samples, record.right->samples,
                                           record.sample_rate),
       .recorded = argc == 2}};
  // What is known beforehand: a fundamental 1 % too high and a contact point 1 mm too far.
  const StringModel string{.length = 0.33, .linear_density = 3.1e-3, .fundamental = 198.0};
  const ModelPoint guess{.basis = make_modal_basis(string), .contact = 0.031};
  CalibrationOptions options = calibration_to_the_bound();
  options.parameters.frequencies = "none";  // f0 and B, the contact point, one factor of damping
  for (const auto& found : calibrate(guess, strokes, options).parameters) {
    std::printf("%s = %.8g +- %.1g %s\n", found.name.c_str(), found.final, found.deviation,
                found.unit.c_str());
  }
}
