// Kind "identify_force" with tables of several places: where the force acts, and forces at all of
// them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/kinds/structure/structure_files.hpp"
#include "libsim/base/error.hpp"
#include "tests/experiments/kinds/structure_config.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::identify_places_test {
namespace {

using structure_config::file_of, structure_config::kFolder, structure_config::run;
using testing::Contains, testing::HasSubstr;

class PlacesOf : public FolderTest {
 protected:
  // A table whose contact is elsewhere: every mode is driven by another share, as by its shape
  // there.
  static StructureTable driven_by_cosines() {
    StructureTable other = read_table(kFolder + "plate_modes.json");
    const std::size_t modes = other.model.poles.size();
    for (std::size_t i = 0; i < other.model.constants.size(); ++i) {
      const double shape = std::cos(2.0 * static_cast<double>(i % modes));
      other.model.constants[i] *= shape;
      other.model.quadrature[i] *= shape;
    }
    return other;
  }
};

TEST_F(PlacesOf, TheForceIsThatOfTheLikeliestPlace) {
  const StructureTable other = driven_by_cosines();
  const auto file = write("elsewhere.yaml", table_text(other));
  const std::string right = kFolder + "plate_modes.json";
  const StudyResult alone = run("force_on_plate.yaml");
  const StudyResult found =
      run("force_on_plate.yaml", {"table=" + file.string(), "other_places=[" + right + "]"});
  EXPECT_EQ(found.status, report::Status::kOk);
  EXPECT_THAT(found.summary, HasSubstr("95 % set: " + right + "\n"));
  auto there = file_of(found, "force.json")["force"], here = file_of(alone, "force.json")["force"];
  EXPECT_EQ(there[0].at("table"), right);
  here[0]["table"] = right;
  EXPECT_EQ(there, here);
  EXPECT_THAT(refusal_of([&] { run("force_on_plate.yaml", {"other_places=[plate_modes.json]"}); }),
              HasSubstr("plate_modes.json is named twice: each contact has a table of its own"));
  try {
    run("force_on_plate.yaml",
        {"other_places=[" + right + "]", "record.responses=[{channel: a1}]"});
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr("one response is explained by a force at any place"));
  }
}

// Of a plate that is struck at one of two contacts.
TEST_F(PlacesOf, ForcesActAtOnce) {
  const StructureTable other = driven_by_cosines();
  const std::string file = write("elsewhere.yaml", table_text(other)).string();
  const std::vector<std::string> both = {"other_contacts=[" + file + "]"};
  const StudyResult found = run("force_on_plate.yaml", both);
  // Nothing acts there: the strike is told as it is alone, but for what the other may do.
  const auto document = file_of(found, "force.json");
  ASSERT_EQ(document["force"].size(), 2u);
  EXPECT_EQ(document["force"][1]["table"], file);
  EXPECT_LT(document["force"][0]["relative_error_in_band"].get<double>(), 0.1);
  EXPECT_GT(document["force"][0]["coverage"].get<double>(), 0.9);
  EXPECT_LT(std::abs(document["force"][1]["peak_n"].get<double>()), 5.0);
  EXPECT_THAT(found.answer, HasSubstr("; " + file + ": "));
  const std::string silent = file + ": no force is told there beside the others";
  EXPECT_THAT(found.warnings, Contains(HasSubstr(silent)));
  // Whichever of them is the first, sensors that contradict both refuse the answer.
  const std::string modes = kFolder + "plate_modes.json";
  const std::string turned =
      "record.responses=[{channel: a1}, {channel: a2, turned: true}, {channel: a3}, {channel: a4}]";
  for (const auto& [first, second] : {std::pair(modes, file), std::pair(file, modes)}) {
    const StudyResult wrong =
        run("force_on_plate.yaml", {"table=" + first, "other_contacts=[" + second + "]", turned});
    EXPECT_EQ(wrong.status, report::Status::kFailed) << first;
    EXPECT_THAT(wrong.answer, testing::StartsWith("rejected: ")) << first;
  }
  EXPECT_THAT(refusal_of([&] {
                run("force_on_plate.yaml", {"other_contacts=[" + file + ", /." + file + "]"});
              }),
              HasSubstr("is named twice: each contact has a table of its own"));
  const auto signals = found.signal_files.front().signals;
  ASSERT_EQ(signals.size(), 4u);
  EXPECT_EQ(signals[2].quantity, "f_c2");
  EXPECT_THAT(refusal_of([&] {
                run("force_on_plate.yaml",
                    {both.front(), "record.responses=[{channel: a1}, {channel: a2}]"});
              }),
              HasSubstr("2 responses are explained by forces at 2 contacts whatever they are: name "
                        "3 sensors or more, or fewer contacts"));
  EXPECT_THAT(refusal_of([&] {
                run("force_on_plate.yaml", {both.front(), "other_places=[" + file + "]"});
              }),
              HasSubstr("a place is looked for of one force alone"));
  EXPECT_THAT(refusal_of([&] {
                run("force_on_plate.yaml", {both.front(), "change.frequency=1 %"});
              }),
              HasSubstr("modes are refined beside one force alone"));
}

}  // namespace
}  // namespace modcal::identify_places_test
