#include "benchmarks/stress/stress_cell.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/model/damping.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::stress_cell_test {
namespace {

constexpr std::array kSimulators = {"newmark_explicit", "modal_exact", "modal_event"};

// The ends of every range of the stability map.
std::vector<Scene> extreme_scenes() {
  std::vector<Scene> scenes;
  const auto add = [&scenes](auto change) {
    scenes.push_back(paper_scene());
    scenes.back().string.modes = 20;
    change(scenes.back());
  };
  add([](Scene&) {});
  for (const double stiffness : {1e2, 1e9}) {
    add([stiffness](Scene& s) {
      CoulombExponential::Options options;
      options.adherence.stiffness = stiffness;
      s.friction = Choice<FrictionLaw>::of<CoulombExponential>("coulomb_exponential", options);
    });
  }
  for (const double ratio : {0.0, 0.5}) {
    add([ratio](Scene& s) {
      s.string.damping =
          Choice<DampingLaw>::of<ConstantDamping>("constant", ConstantDamping::Options{ratio});
    });
  }
  for (const std::int64_t modes : {1, 300}) add([modes](Scene& s) { s.string.modes = modes; });
  for (const double part : {1e-6, 1.0 / 3.0, 0.5}) {
    add([part](Scene& s) { s.bow.position = part * s.string.length; });
  }
  for (const double force : {0.0, 1e-310, 1e3, 1e300}) {
    add([force](Scene& s) { s.bow.normal_force = force; });
  }
  for (const double velocity : {0.0, 1e-310, -10.0, 1e300}) {
    add([velocity](Scene& s) { s.bow.velocity = velocity; });
  }
  return scenes;
}

TEST(StabilityMap, NoOutcomeIsWrongAtTheEndsOfTheRanges) {
  int right = 0;
  std::size_t index = 0;
  for (const Scene& scene : extreme_scenes()) {
    for (const double step : {1e-8, 1e-6, 1e-4, 1e-2}) {
      for (const char* simulator : kSimulators) {
        const std::size_t samples = affordable_samples(scene, step) / 10 + 20;
        const CellResult cell = run_cell(simulator, scene, step, samples);
        EXPECT_NE(cell.outcome, Outcome::kWrong)
            << simulator << ", scene " << index << ", step " << step << ": " << cell.reason;
        EXPECT_EQ(cell.outcome == Outcome::kRight, cell.reason.empty());
        if (cell.outcome == Outcome::kRight) ++right;
      }
    }
    ++index;
  }
  EXPECT_GT(right, 100);  // most of the 216 cells are not refused
}

TEST(StabilityMap, ThePapersCaseIsRightAtItsTimeStep) {
  for (const char* simulator : kSimulators) {
    const CellResult cell = run_cell(simulator, paper_scene(), 1e-6, 5000);
    EXPECT_EQ(cell.outcome, Outcome::kRight) << simulator << ": " << cell.reason;
    EXPECT_GT(cell.passivity, 0.0);
  }
}

}  // namespace
}  // namespace modcal::stress_cell_test
