// Where the objectives of a calibration have their minima: against one modal frequency and against
// the contact point, all else true, on one record of a stiff string with 1 % noise; and the offset
// of the minimum of every mode beside that of the force's nearest line, a multiple of the playing
// frequency.
//
//     objective_bias frequency|contact|offsets > FILE.csv
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "benchmarks/accuracy/stiff_stroke.hpp"
#include "libcalib/objectives/force_difference.hpp"
#include "libcalib/objectives/joint_likelihood.hpp"
#include "libcalib/objectives/smooth_spectral_peak.hpp"
#include "libcalib/objectives/spectral_peak.hpp"

namespace modcal {
namespace {

constexpr std::int64_t kModes = 24;
constexpr std::size_t kShownMode = 9;

struct Labeled {
  std::string_view label;
  std::shared_ptr<const Objective> objective;
};

std::vector<Labeled> objectives(const StiffStroke& stroke, bool contact) {
  JointLikelihood::Options joint;
  joint.left_noise = stroke.left_noise;
  joint.right_noise = stroke.right_noise;
  std::vector<Labeled> all;
  all.push_back({"joint_likelihood", std::make_shared<JointLikelihood>(joint)});
  all.push_back({"force_mismatch",
                 std::make_shared<ForceMismatch>(ForceMismatch::Options{.weights = "transfer"})});
  if (contact) {
    all.push_back(
        {"contact_location", std::make_shared<ContactLocation>(ContactLocation::Options{})});
  }
  all.push_back({"spectral_peak", std::make_shared<SpectralPeak>(SpectralPeak::Options{})});
  all.push_back({"smooth_spectral_peak", std::make_shared<SmoothSpectralPeak>(
                                             SmoothSpectralPeak::Options{.softening = 0.1})});
  return all;
}

/// Values over offsets from the truth, every other parameter true.
struct Profile {
  std::vector<double> offsets, values;

  double minimum() const {
    const auto lowest = std::min_element(values.begin(), values.end()) - values.begin();
    return offsets[static_cast<std::size_t>(lowest)];
  }
};

Profile profile(const Objective& objective, const StiffStroke& stroke, const std::string& name,
                const std::vector<double>& offsets) {
  const std::vector<std::string> names = {name};
  const ParameterSet parameters(stroke.truth, names);
  const auto function = objective.bind(stroke.data, parameters);
  Profile result{.offsets = offsets};
  for (const double offset : offsets) {
    const double x = parameters.start()[0] + offset;
    result.values.push_back(function->value(std::span(&x, 1)));
  }
  return result;
}

std::vector<double> evenly(double reach, int half_count) {
  std::vector<double> values;
  for (int j = -half_count; j <= half_count; ++j) values.push_back(reach * j / half_count);
  return values;
}

/// Playing frequency [Hz]: the comb of ten harmonics that holds most of the force after 0.2 s.
double playing_frequency(const StiffStroke& stroke) {
  const std::vector<double>& force = stroke.run.force.samples;
  const std::size_t first = force.size() / 5;
  double best = 0.0, found = 0.0;
  for (int j = -150; j <= 150; ++j) {
    const double frequency = 196.0 * (1.0 + 1e-4 * j);
    double power = 0.0;
    for (int h = 1; h <= 10; ++h) {
      const double step = 2.0 * std::numbers::pi * h * frequency / kStrokeRate;
      const Complex turn = std::polar(1.0, step);
      Complex phase = 1.0, sum = 0.0;
      for (std::size_t k = first; k < force.size(); ++k, phase *= turn) sum += force[k] * phase;
      power += std::norm(sum);
    }
    if (power > best) {
      best = power;
      found = frequency;
    }
  }
  return found;
}

void print_profiles(const StiffStroke& stroke, const std::string& name, bool contact,
                    const std::vector<double>& offsets, double unit) {
  fmt::print("objective,offset,share\n");
  for (const Labeled& entry : objectives(stroke, contact)) {
    const Profile curve = profile(*entry.objective, stroke, name, offsets);
    const auto [low, high] = std::minmax_element(curve.values.begin(), curve.values.end());
    for (std::size_t j = 0; j < offsets.size(); ++j) {
      fmt::print("{},{:.6g},{:.6g}\n", entry.label, offsets[j] / unit,
                 (curve.values[j] - *low) / (*high - *low));
    }
  }
}

void print_offsets(const StiffStroke& stroke) {
  const double playing = playing_frequency(stroke);
  fmt::print("# playing frequency {:.6g} Hz\nobjective,n,offset\n", playing);
  for (std::size_t n = 1; n <= stroke.truth.basis.size(); ++n) {
    const double frequency = stroke.truth.basis.frequency(n - 1);
    const double line = std::round(frequency / playing) * playing;
    fmt::print("line,{},{:.6g}\n", n, line / frequency - 1.0);
    if (std::abs(stroke.truth.basis.shape_at(stroke.truth.contact)[n - 1]) < 0.1) continue;
    for (const Labeled& entry : objectives(stroke, false)) {
      const Profile curve =
          profile(*entry.objective, stroke, fmt::format("f_{}", n), evenly(0.03 * frequency, 100));
      // Between the steps of the grid the likelihood is searched again, on a fine one.
      const double coarse = curve.minimum();
      std::vector<double> fine = evenly(3e-4 * frequency, 30);
      for (double& offset : fine) offset += coarse;
      fmt::print(
          "{},{},{:.6g}\n", entry.label, n,
          profile(*entry.objective, stroke, fmt::format("f_{}", n), fine).minimum() / frequency);
    }
  }
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  using namespace modcal;
  const std::string_view what = argc > 1 ? argv[1] : "";
  const StiffStroke stroke = stiff_stroke(kModes, 1.0, 0.01, 1);
  if (what == "frequency") {
    const double frequency = stroke.truth.basis.frequency(kShownMode - 1);
    print_profiles(stroke, fmt::format("f_{}", kShownMode), false, evenly(0.02 * frequency, 100),
                   0.01 * frequency);
  } else if (what == "contact") {
    print_profiles(stroke, "x_c", true, evenly(1e-3, 100), 1e-3);
  } else if (what == "offsets") {
    print_offsets(stroke);
  } else {
    fmt::print(stderr, "usage: objective_bias frequency|contact|offsets\n");
    return 2;
  }
}
