// Where a force acts: the place of largest likelihood and the set that holds it.
#include "libinverse/structure/contact_place.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "benchmarks/problems/known_structures.hpp"
#include "tests/refusal.hpp"

namespace modcal::contact_place_test {
namespace {

using namespace known_structures;
using testing::HasSubstr;

// The six modes driven where their shapes are others: modal constants common to all sensors are
// those of the contact.
StructureTable driven_at(double place) {
  StructureTable table{.model = six_modes(3), .low = kLow, .high = kHigh};
  const std::size_t modes = table.model.poles.size();
  for (std::size_t i = 0; i < table.model.constants.size(); ++i) {
    const double shape = std::sin(place * static_cast<double>(i % modes + 1));
    table.model.constants[i] *= shape;
    table.model.quadrature[i] *= shape;
  }
  return table;
}

// At rest until a pulse; 1 s.
StructureRecord struck_at(double place, double noise, std::uint64_t seed) {
  StructureRecord record = clean_record(driven_at(place).model, true);
  return with_noise(std::move(record), noise, seed).record;
}

TEST(ContactPlace, TheRightPlaceIsTheLikeliest) {
  // Where the structure rings at its begin, a contour loses little of it.
  const std::vector<StructureTable> tables = {driven_at(1.0), driven_at(0.8), driven_at(1.2)};
  for (std::size_t right = 0; right < 3; ++right) {
    const double place = right == 0 ? 1.0 : right == 1 ? 0.8 : 1.2;
    const ContactPlaces found = weigh_places(tables, struck_at(place, 0.01, 1), 0.0);
    EXPECT_EQ(found.best, right);
    EXPECT_GT(found.probability[right], 0.99);
    EXPECT_EQ(found.credible(0.95).size(), 1u);
    double sum = 0.0;
    for (const double p : found.probability) sum += p;
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
}

// Of noise alone all neighboring bins are apart: two numbers of each and of each sensor, less one
// force.
TEST(ContactPlace, CountsTheNumbersThatTellIt) {
  const std::vector<StructureTable> tables = {driven_at(1.0), driven_at(0.8)};
  const ContactPlaces found = weigh_places(tables, struck_at(1.0, 100.0, 1), 0.0);
  const double most = 2.0 * (kHigh - kLow + 1.0) * 2.0;
  EXPECT_GT(found.numbers, 0.7 * most);
  EXPECT_LE(found.numbers, most);
}

TEST(ContactPlace, PlacesThatAreNearlyAlikeStandInOneSet) {
  const std::vector<StructureTable> tables = {driven_at(1.0), driven_at(1.0), driven_at(0.8)};
  const ContactPlaces found = weigh_places(tables, struck_at(1.0, 0.01, 1), 0.0);
  EXPECT_NEAR(found.probability[0], 0.5, 1e-3);
  EXPECT_NEAR(found.probability[1], 0.5, 1e-3);
  EXPECT_THAT(found.credible(0.95), testing::UnorderedElementsAre(0u, 1u));
}

TEST(ContactPlace, RefusesWhatCannotTell) {
  const StructureRecord record = struck_at(1.0, 0.01, 1);
  const std::vector<StructureTable> one = {driven_at(1.0)};
  EXPECT_THAT(refusal_of([&] { weigh_places(one, record, 0.0); }),
              HasSubstr("places are compared"));
  const std::vector<StructureTable> two = {driven_at(1.0), driven_at(0.8)};
  StructureRecord single = record;
  single.responses.resize(1);
  EXPECT_THAT(refusal_of([&] { weigh_places(two, single, 0.0); }),
              HasSubstr("one response is explained by a force at any place"));
}

}  // namespace
}  // namespace modcal::contact_place_test
