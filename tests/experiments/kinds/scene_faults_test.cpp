// Extreme scenes with every simulator: right, at rest, or refused with the words of the table.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "experiments/loader.hpp"
#include "experiments/study/study.hpp"
#include "tests/refusal.hpp"

namespace modcal::scene_faults_test {
namespace {

constexpr const char* kScene = R"(kind: simulate
scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 30}
  bow: {position: 31 mm, velocity: 0.1 m/s, normal_force: 1 N}
  friction: {type: coulomb_exponential, static: 0.4, dynamic: 0.2, decay: 5 s/m}
  duration: 5 ms
simulator: {SIMULATOR}
measurement: {sample_rate: 51.2 kHz, noise_level: 0}
outputs: [R1, R2]
files: [csv]
)";

// With what each is compared with the reference, and the largest rms difference of a reaction from
// it, relative. The fixed steps find a switch to within a step of 0.1 us, of some hundred that a
// period of the highest mode has; between switches modal_exact is exact and the explicit scheme of
// second order. modal_event states 1e-6 for its default step.
struct Simulated {
  const char* name;
  const char* settings;
  const char* step;  ///< the key of its time step
  double most;
};
constexpr Simulated kSimulators[] = {
    {"modal_event", "type: modal_event", "max_step", 1e-4},
    {"modal_exact", "type: modal_exact, time_step: 0.1 us", "time_step", 0.02},
    {"newmark_explicit", "type: newmark_explicit, time_step: 0.1 us", "time_step", 0.05}};
// With a step of the sampling period, 20 us: some ten a period of the highest mode.
constexpr double kCoarse = 0.1;
constexpr const char* kReference = "type: modal_event, nodes: 5, max_step: 0.4 us";

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? ""
                                    : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(line);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(trimmed(part));
  return parts;
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const std::size_t at = text.find(from);
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

struct Found {
  std::string refusal;  ///< empty: there are signals
  std::vector<Signal> signals;
};

Found simulated(const char* settings, const char* step, const std::vector<std::string>& changes) {
  Found found;
  const std::string said = refusal_of([&] {
    YamlDocument document = parse_yaml(replaced(kScene, "SIMULATOR", settings), "scene.yaml");
    for (std::size_t i = 0; i < changes.size(); ++i) {
      const bool is_step = changes[i].find("STEP") != std::string::npos;
      if (is_step && step == nullptr) continue;
      apply_assignment(document, is_step ? replaced(changes[i], "STEP", step) : changes[i], i + 1);
    }
    const LoadedExperiment loaded = load_experiment(std::move(document));
    if (loaded.has_errors()) throw InvalidInput(format_mistakes(loaded.document, loaded.mistakes));
    SharedWork work;
    const StudyResult result =
        loaded.experiment->run({.work = work, .folder = ".", .command = "test"});
    found.signals = result.signal_files.at(0).signals;
  });
  if (said != "accepted") found.refusal = said;
  return found;
}

double rms(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double value : x) sum += value * value;
  return std::sqrt(sum / static_cast<double>(x.size()));
}

double rms_difference(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> difference = x;
  for (std::size_t i = 0; i < x.size(); ++i) difference[i] -= y.at(i);
  return rms(difference);
}

void expect_right(const Found& found, const Found& reference, double most) {
  ASSERT_EQ(found.refusal, "");
  ASSERT_EQ(reference.refusal, "");
  // Of both: before the first wave has come to the far end there is nothing but what runs ahead.
  const double level =
      std::max(rms(reference.signals[0].samples), rms(reference.signals[1].samples));
  EXPECT_GT(level, 0.0);
  for (std::size_t s = 0; s < 2; ++s) {
    const std::vector<double>& wanted = reference.signals[s].samples;
    ASSERT_EQ(found.signals[s].size(), wanted.size());
    EXPECT_LE(rms_difference(found.signals[s].samples, wanted), most * level)
        << found.signals[s].quantity;
  }
}

void expect_at_rest(const Found& found) {
  ASSERT_EQ(found.refusal, "");
  for (const Signal& signal : found.signals) EXPECT_EQ(rms(signal.samples), 0.0) << signal.quantity;
}

// Noise of ten times the level of the reaction, of so many independent samples.
void expect_noisy(const Found& found, const Found& reference) {
  ASSERT_EQ(found.refusal, "");
  for (std::size_t s = 0; s < 2; ++s) {
    const std::vector<double>& clean = reference.signals[s].samples;
    const double noise = rms_difference(found.signals[s].samples, clean);
    double mean = 0.0;
    for (const double x : clean) mean += x / static_cast<double>(clean.size());
    const double level = std::sqrt(rms(clean) * rms(clean) - mean * mean);
    // The rms of n samples has the relative deviation 1/sqrt(2 n): four of them.
    EXPECT_NEAR(noise / level, 10.0, 40.0 / std::sqrt(2.0 * static_cast<double>(clean.size())));
  }
}

TEST(SceneFaults, EveryCellIsRightOrRefused) {
  std::ifstream table(MODCAL_SCENES);
  std::size_t rows = 0;
  for (std::string line; std::getline(table, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string> cells = split(line, '|');
    ASSERT_EQ(cells.size(), 5u) << line;
    SCOPED_TRACE(cells[0]);
    ++rows;
    const std::vector<std::string> changes = split(cells[1], ';');
    const Found reference = simulated(kReference, nullptr, changes);
    std::vector<std::string> quiet;
    for (const std::string& change : changes) {
      if (!change.starts_with("measurement.noise")) quiet.push_back(change);
    }
    for (std::size_t i = 0; i < std::size(kSimulators); ++i) {
      const Simulated& one = kSimulators[i];
      SCOPED_TRACE(one.name);
      const Found found = simulated(one.settings, one.step, changes);
      const std::string& expected = cells[2 + i];
      if (expected == "right") {
        expect_right(found, reference, one.most);
      } else if (expected == "coarse") {
        expect_right(found, reference, kCoarse);
      } else if (expected == "at rest") {
        expect_at_rest(found);
      } else if (expected == "noisy") {
        expect_noisy(found, simulated(one.settings, one.step, quiet));
      } else {
        EXPECT_THAT(found.refusal, testing::HasSubstr(expected));
      }
    }
  }
  EXPECT_GT(rows, 20u);
}

}  // namespace
}  // namespace modcal::scene_faults_test
