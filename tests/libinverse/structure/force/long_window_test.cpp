// What is supposed of a force where its window is too long for pulses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "benchmarks/problems/known_structures.hpp"
#include "libinverse/structure/force/structure_force.hpp"
#include "libsim/base/random.hpp"
#include "tests/refusal.hpp"

namespace modcal::long_window_test {
namespace {

using namespace known_structures;

TEST(LongWindow, HasASmoothForceBySelection) {
  StructureTable table{.model = six_modes(2), .low = kLow, .high = kHigh};
  table.scatters.assign(2, {.modal = 0.05, .noise = 0.01});
  // Instants are 1/(3 high) apart: 6000 in 5 s.
  StructureRecord record{.sample_rate = kRate};
  for (std::size_t k = 0; k < 2; ++k) {
    record.responses.emplace_back(static_cast<std::size_t>(5.0 * kRate));
    fill_standard_normal(StreamKey(1).with("response").with(k), record.responses[k]);
  }
  const StructureForce chosen = structure_force(table, record, {.draws = 2});
  EXPECT_EQ(chosen.shape, ForceShape::kSmooth);
  EXPECT_EQ(chosen.untried, 6000.0);
  const StructureForce stated =
      structure_force(table, record, {.shape = ForceShape::kSmooth, .draws = 2});
  EXPECT_EQ(stated.untried, 0.0);
  EXPECT_EQ(chosen.force, stated.force);
  EXPECT_EQ(chosen.deviation, stated.deviation);
  EXPECT_THAT(refusal_of([&] {
                structure_force(table, record, {.shape = ForceShape::kImpacts, .draws = 2});
              }),
              testing::HasSubstr("holds 6000 instants of a pulse"));
  // A shorter window of the same record has room for them.
  EXPECT_EQ(structure_force(table, record, {.window = 0.1, .draws = 2}).untried, 0.0);
}

}  // namespace
}  // namespace modcal::long_window_test
