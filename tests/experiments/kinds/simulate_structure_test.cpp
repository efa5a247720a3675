// Kind "simulate" with a table of modes: the force is found again from what the sensors read, a
// string written as a table is the string, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "experiments/kinds/structure/structure_files.hpp"
#include "experiments/loader.hpp"
#include "experiments/runs/task_experiment.hpp"
#include "experiments/study/study.hpp"
#include "libsim/model/transfer.hpp"
#include "tests/folder_test.hpp"

namespace modcal::simulate_structure_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class BowOnAStructure : public FolderTest {
 protected:
  StudyResult run(const std::string& file, const std::vector<std::string>& changes = {}) const {
    YamlDocument document = read_yaml_file(file);
    std::size_t number = 0;
    for (const std::string& change : changes) apply_assignment(document, change, ++number);
    LoadedExperiment loaded = load_experiment(std::move(document));
    check_records(loaded);
    if (loaded.has_errors()) throw InvalidInput(format_mistakes(loaded.document, loaded.mistakes));
    SharedWork work;
    return loaded.experiment->run(
        {.work = work, .folder = loaded.document.folder(), .command = "test"});
  }
  // What is said of an experiment of these keys.
  std::string said(const std::string& keys) const {
    write("said.yaml", keys);
    LoadedExperiment loaded = load_experiment(read_yaml_file(path("said.yaml")));
    check_records(loaded);
    return format_mistakes(loaded.document, loaded.mistakes);
  }
  void write_signals(const StudyResult& result) const {
    const SignalFile& file = result.signal_files.at(0);
    std::string text = "t [s]";
    for (const Signal& s : file.signals) text += fmt::format(",{} [{}]", s.quantity, s.unit);
    for (std::size_t j = 0; j < file.signals[0].size(); ++j) {
      text += fmt::format("\n{:.17g}", static_cast<double>(j) / file.signals[0].sample_rate);
      for (const Signal& s : file.signals) text += fmt::format(",{:.17g}", s.samples[j]);
    }
    write("signals.csv", text + "\n");
  }
};

const std::string kBar = std::string(MODCAL_CONFIGS) + "/structures/bow_on_bar.yaml";

TEST_F(BowOnAStructure, ItsForceIsFoundFromItsSensors) {
  const StudyResult made = run(kBar);
  EXPECT_THAT(made.answer, HasSubstr("the contact slips 250"));
  write_signals(made);
  for (const auto& [file, text] : made.files) write(file, text);
  write("found.yaml",
        "kind: identify_force\ntable: table.yaml\nshape: smooth\nwindow: 1.2 s\n"
        "record:\n  file: signals.csv\n  force: {channel: f_c}\n"
        "  responses: [{channel: a1}, {channel: a2}, {channel: d_mid, kind: displacement}]\n");
  const StudyResult found = run(path("found.yaml"));
  const auto force =
      std::ranges::find(found.files, "force.json", &std::pair<std::string, std::string>::first);
  ASSERT_NE(force, found.files.end());
  const auto told = nlohmann::json::parse(force->second)["force"][0];
  // The friction force is of one sign: most of its power is its mean, which the displacement tells.
  // 0.5 % of it lies above the table's band, the noise is 0.1 %.
  EXPECT_LT(told["relative_error"].get<double>(), 0.01);
  EXPECT_LT(told["relative_error_in_band"].get<double>(), 0.004);
  EXPECT_GT(told["coverage"].get<double>(), 0.93);
  EXPECT_EQ(found.status, report::Status::kOk) << found.summary;
  // A table that begins above 0 Hz does not tell it, and two accelerations do not.
  std::ifstream modes(std::string(MODCAL_CONFIGS) + "/structures/bar_modes.json");
  auto table = nlohmann::json::parse(modes);
  table["low"] = 5.0;
  write("above.json", table.dump());
  write("above.yaml",
        "kind: identify_force\ntable: above.json\nshape: smooth\nwindow: 1.2 s\n"
        "record:\n  file: signals.csv\n"
        "  responses: [{channel: a1}, {channel: a2}, {channel: d_mid, kind: displacement}]\n");
  const StudyResult above = run(path("above.yaml"));
  EXPECT_EQ(above.status, report::Status::kFailed);
  EXPECT_THAT(above.answer, HasSubstr("fit the modes from a lower frequency on"));
  table["sensors"].erase(2);
  for (auto& mode : table["modes"]) mode["constants"].erase(2);
  write("two.json", table.dump());
  write("accelerations.yaml",
        "kind: identify_force\ntable: two.json\nshape: smooth\nwindow: 1.2 s\n"
        "record:\n  file: signals.csv\n  responses: [{channel: a1}, {channel: a2}]\n");
  const StudyResult untold = run(path("accelerations.yaml"));
  EXPECT_EQ(untold.status, report::Status::kFailed);
  EXPECT_THAT(untold.answer, HasSubstr("rejected: the force rises towards 5 Hz"));
}

TEST_F(BowOnAStructure, AStringAsATableIsTheString) {
  const std::string string =
      "string: {length: 0.33, linear_density: 3.1e-3, fundamental: 196 Hz, modes: 20, damping: "
      "{type: constant, ratio: 1e-3}}";
  StringModel model{.length = 0.33, .linear_density = 3.1e-3, .fundamental = 196.0, .modes = 20};
  model.damping =
      Choice<DampingLaw>::of<ConstantDamping>("constant", ConstantDamping::Options{.ratio = 1e-3});
  const ModalBasis basis = make_modal_basis(model);
  StructureTable table{.model = end_reactions(basis, 0.0314),
                       .names = {"R1", "R2"},
                       .scatters = {{}, {}},
                       .low = 100.0,
                       .high = 4500.0};
  table.model.quadrature.assign(40, 0.0);
  table.model.residuals.resize(2);
  table.frequency_deviations.assign(20, 0.0);
  table.damping_deviations.assign(20, 0.0);
  const std::vector<double> shape = basis.shape_at(0.0314);
  for (std::size_t n = 0; n < 20; ++n) {
    table.contact.push_back(shape[n] * shape[n] / basis.mass[n]);
  }
  write("table.yaml", table_text(table));
  const std::string rest =
      "simulator: modal_event\nmeasurement: {remove_mean: false}\nfiles: [csv]\n";
  write("string.yaml", "kind: simulate\nscene:\n  " + string +
                           "\n  bow: {position: 31.4 mm}\n  duration: 50 ms\n" + rest);
  write("table_bow.yaml",
        "kind: simulate\nstructure: {table: table.yaml, duration: 50 ms, rest: 0 s, oversampling: "
        "1}\n" +
            rest);
  const StudyResult a = run(path("string.yaml")), b = run(path("table_bow.yaml"));
  const auto& one = a.signal_files.at(0).signals;
  const auto& other = b.signal_files.at(0).signals;
  ASSERT_EQ(one.size(), 5u);
  ASSERT_EQ(other.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    double error = 0.0, power = 0.0;
    for (std::size_t j = 0; j < one[i].size(); ++j) {
      error += std::pow(one[i].samples[j] - other[i].samples[j], 2);
      power += std::pow(one[i].samples[j], 2);
    }
    // A frequency in Hz and back is a rounding off, and each of 20 switches carries that over.
    EXPECT_LT(std::sqrt(error / power), 1e-9) << one[i].quantity;
  }
}

TEST_F(BowOnAStructure, TheRecordRestsFirstAndHasNothingFolded) {
  const std::vector<std::string> changes = {"structure.duration=0.3 s", "structure.rest=50 ms",
                                            "measurement.noise_level=0"};
  const StudyResult made = run(kBar, changes);
  for (const Signal& signal : made.signal_files.at(0).signals) {
    ASSERT_EQ(signal.size(), 6000u);
    // The filter reaches 13 samples back.
    for (std::size_t j = 0; j < 1000 - 13; ++j) ASSERT_EQ(signal.samples[j], 0.0);
    EXPECT_NE(signal.samples[1010], 0.0);
  }
}

TEST_F(BowOnAStructure, SweepsOverItsSettings) {
  YamlDocument document = read_yaml_file(kBar);
  apply_assignment(document, "structure.duration=0.1 s", 1);
  apply_assignment(document, "sweep={product: {structure.bow.normal_force: [1 N, 5 N]}}", 2);
  const LoadedExperiment loaded = load_experiment(std::move(document));
  EXPECT_EQ(format_mistakes(loaded.document, loaded.mistakes), "");
  const auto* list = dynamic_cast<const TaskExperiment*>(loaded.experiment.get());
  ASSERT_NE(list, nullptr);
  SharedWork work;
  const StudyContext context{.work = work, .folder = loaded.document.folder(), .command = "test"};
  const auto highest = [&](std::size_t task) {
    const auto outcome = nlohmann::json::parse(list->run_task(task, context));
    return outcome["numbers"].dump();
  };
  EXPECT_NE(highest(0), highest(1));
}

TEST_F(BowOnAStructure, RefusesWhatTheTableDoesNotTell) {
  EXPECT_THAT(said("kind: identify\nstructure: {table: modes.yaml}\n"),
              AllOf(HasSubstr("unknown key \"table\": identify finds modes from free decays"),
                    HasSubstr("kind: fit_modes")));
  const std::string plate = std::string(MODCAL_CONFIGS) + "/structures/plate_modes.json";
  const auto with = [&](const std::string& keys, const std::string& table,
                        const std::string& rate) {
    return said("kind: simulate\nstructure: {table: " + table + keys +
                "}\nsimulator: modal_event\nmeasurement: {remove_mean: false, sample_rate: " +
                rate + "}\n");
  };
  const std::string bar = std::string(MODCAL_CONFIGS) + "/structures/bar_modes.json";
  EXPECT_THAT(with("", plate, "10 kHz"),
              AllOf(HasSubstr("said.yaml:2:"), HasSubstr("does not tell how the contact moves")));
  EXPECT_THAT(with(", contact: a1", plate, "10 kHz"),
              HasSubstr("the modal constant of \"a1\" at 56.7852 Hz is -0.0143: negative"));
  EXPECT_THAT(with(", contact: a9", bar, "20 kHz"),
              HasSubstr("the table has no sensor \"a9\"; it has a1, a2, d_mid"));
  EXPECT_THAT(with("", bar, "5 kHz"),
              HasSubstr("the mode at 3336.07 Hz is not below half the sample rate, 2500 Hz"));
  EXPECT_THAT(with(", rest: 2 s", bar, "20 kHz"),
              HasSubstr("2 s of rest leave nothing of a record of 1 s"));
  EXPECT_EQ(with("", bar, "20 kHz"), "");
  EXPECT_THAT(said("kind: simulate\n"), HasSubstr("one of both is simulated: state scene:"));
  EXPECT_THAT(said("kind: simulate\nstructure: {table: " + bar +
                   "}\nfigures: [{id: a, quantities: [R1]}]\n"),
              HasSubstr("figure a draws R1, the reaction at the end of a string"));
}

// Every other kind says what to state in its place.
TEST_F(BowOnAStructure, EveryKindSaysWhatTakesATable) {
  for (const auto& [kind, instead] :
       std::vector<std::pair<std::string, std::string>>{{"invert", "kind: identify_force"},
                                                        {"sweep", "sweep: {product: ...}"},
                                                        {"pluck_then_bow", "kind: fit_modes"},
                                                        {"schelleng", "kind: simulate"}}) {
    for (const std::string key : {"table", "model", "structure"}) {
      const std::string config = fmt::format("kind: {}\n{}: {{table: modes.yaml}}\n", kind, key);
      EXPECT_THAT(said(config), HasSubstr(fmt::format("error: unknown key \"{}\": ", key))) << kind;
      EXPECT_THAT(said(config), HasSubstr(instead)) << kind;
    }
  }
  for (const std::string kind : {"calibrate", "calibration_limit"}) {
    EXPECT_THAT(said(fmt::format("kind: {}\ntable: modes.yaml\n", kind)),
                HasSubstr("unknown key \"table\": state structure: {table: modes.yaml"));
  }
  const std::string plate = std::string(MODCAL_CONFIGS) + "/structures/plate_modes.json";
  EXPECT_THAT(said(fmt::format("kind: benchmark\nsweep: {{product: {{seed: [1, 2]}}}}\n"
                               "structure: {{table: {}, record: {{file: a.csv, responses: "
                               "[{{channel: a}}, {{channel: b}}]}}}}\n",
                               plate)),
              HasSubstr("error: benchmark compares optimizers on a string"));
  EXPECT_THAT(said("kind: identify_force\nmodel: {table: modes.yaml}\n"),
              HasSubstr("unknown key \"model\": state table: modes.yaml"));
  EXPECT_THAT(said("kind: simulate\ntable: modes.yaml\n"),
              HasSubstr("unknown key \"table\": state structure: {table: modes.yaml"));
}

}  // namespace
}  // namespace modcal::simulate_structure_test
