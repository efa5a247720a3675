#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <atomic>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/scene/simulator.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::ensemble_test {
namespace {

template <typename Work>
void with_threads(int threads, const Work& work) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  tbb::task_arena(threads).execute(work);
}

Ensemble forces(std::size_t size) {
  return {.size = size,
          .scene =
              [](std::size_t i) {
                Scene scene = paper_scene();
                scene.duration = 0.01;
                scene.bow.normal_force = 0.05 * static_cast<double>(i + 1);
                return scene;
              },
          .sample_rate = 51200.0,
          .outputs = OutputRequest::all()};
}

TEST(Ensemble, GivesTheSameBitsForAnyNumberOfThreads) {
  const ModalEvent simulator({});
  const Ensemble ensemble = forces(24);
  using Record = std::vector<double>;
  const auto keep = [](std::size_t, const Simulation& simulation) {
    Record all = simulation.force.samples;
    const Record& reaction = simulation.left_reaction.samples;
    all.insert(all.end(), reaction.begin(), reaction.end());
    return all;
  };
  std::vector<Record> alone;
  for (std::size_t i = 0; i < ensemble.size; ++i) {
    alone.push_back(
        keep(i, simulator.simulate(ensemble.scene(i), ensemble.sample_rate, ensemble.outputs)));
  }
  for (const int threads : {1, 2, 3}) {
    with_threads(threads, [&] {
      EXPECT_EQ(reduce_ensemble<Record>(simulator, ensemble, keep), alone) << threads;
    });
  }
}

TEST(Ensemble, HandsEveryResultOverOnce) {
  std::vector<int> taken(50, 0);
  std::vector<std::size_t> steps(50, 0);
  simulate_ensemble(ModalEvent({}), forces(50), [&](std::size_t i, const Simulation& simulation) {
    ++taken[i];
    steps[i] = simulation.steps;
  });
  EXPECT_EQ(taken, std::vector<int>(50, 1));
  for (const std::size_t count : steps) EXPECT_GE(count, 511u);
}

TEST(Ensemble, CarriesTheErrorOfTheFirstWrongScene) {
  Ensemble ensemble = forces(20);
  const auto right = ensemble.scene;
  ensemble.scene = [right](std::size_t i) {
    Scene scene = right(i);
    if (i >= 7) scene.bow.position = 0.33 + 0.01 * static_cast<double>(i);
    return scene;
  };
  for (const int threads : {1, 2, 3}) {
    with_threads(threads, [&] {
      try {
        simulate_ensemble(ModalEvent({}), ensemble, [](std::size_t, const Simulation&) {});
        ADD_FAILURE() << "no exception";
      } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("0.4 m"), std::string::npos) << error.what();
      }
    });
  }
}

// Records of eleven hours: without polling inside a scene the test would not end.
TEST(Ensemble, StopsInTheMiddleOfAScene) {
  for (const auto& entry : Simulator::registry()) {
    const Choice<Simulator> choice(entry.name);
    Ensemble ensemble = forces(4);
    const auto scene = ensemble.scene;
    std::atomic<bool> wish{false};
    ensemble.outputs = {};
    ensemble.scene = [&](std::size_t i) {
      Scene endless = scene(i);
      endless.duration = 40000.0;
      wish = true;
      return endless;
    };
    bool taken = false;
    EXPECT_THROW(simulate_ensemble(
                     *choice.make(), ensemble,
                     [&](std::size_t, const Simulation&) { taken = true; }, StopToken(wish)),
                 Interrupted)
        << entry.name;
    EXPECT_FALSE(taken);
  }
}

}  // namespace
}  // namespace modcal::ensemble_test
