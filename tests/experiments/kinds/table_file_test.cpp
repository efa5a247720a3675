// The file of a structure's modes, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/kinds/structure/structure_files.hpp"
#include "experiments/loader.hpp"
#include "experiments/runs/task_experiment.hpp"
#include "libsim/base/error.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::table_file_test {
namespace {

using testing::HasSubstr;

const std::string kFolder = std::string(MODCAL_CONFIGS) + "/structures/";

class TableFile : public FolderTest {};

TEST_F(TableFile, ReadsBackToItself) {
  const StructureTable table = read_table(kFolder + "plate_modes.json");
  ASSERT_EQ(table.model.sensors.size(), 4u);
  const std::string text = table_text(table);
  write("table.yaml", text);
  EXPECT_EQ(table_text(read_table(path("table.yaml"))), text);
}

TEST_F(TableFile, ColumnsOfACsvFileAreItsModes) {
  write("table.yaml",
        "low: 10\nhigh: 600\nmodes_file: modes.csv\nsensors:\n- {name: a1, kind: acceleration}\n"
        "- {name: d, kind: displacement}\n");
  const auto read = [&](const std::string& csv) {
    write("modes.csv", csv);
    return read_table(path("table.yaml"));
  };
  const StructureTable table = read(
      "# by hand\nd,damping_ratio,frequency [Hz],a1,a1 imaginary,frequency_deviation,contact\n"
      "0.5,0.01,50,1.5,-0.25,1e-4,2\n-0.75,0.02,80,2.5,0.125,0,3\n");
  ASSERT_EQ(table.model.poles.size(), 2u);
  EXPECT_DOUBLE_EQ(table.frequency(1), 80.0);
  EXPECT_EQ(table.model.poles[0].zeta, 0.01);
  EXPECT_THAT(table.model.constants, testing::ElementsAre(1.5, 2.5, 0.5, -0.75));
  EXPECT_THAT(table.model.quadrature, testing::ElementsAre(-0.25, 0.125, 0.0, 0.0));
  EXPECT_THAT(table.frequency_deviations, testing::ElementsAre(1e-4, 0.0));
  EXPECT_THAT(table.contact, testing::ElementsAre(2.0, 3.0));
  write("twice.yaml",
        "low: 10\nhigh: 600\nmodes_file: modes.csv\nsensors:\n- {name: d, kind: acceleration}\n"
        "- {name: d, kind: displacement}\n");
  EXPECT_THAT(refusal_of([&] { read_table(path("twice.yaml")); }),
              HasSubstr("needs a name of its own"));
  EXPECT_THAT(files_named_by_table(path("table.yaml")), testing::ElementsAre(path("modes.csv")));
  const auto said = [&](const std::string& csv) { return refusal_of([&] { read(csv); }); };
  EXPECT_THAT(said("frequency,damping_ratio,a1\n50,0.01,1\n"), HasSubstr("has no column \"d\""));
  EXPECT_THAT(said("frequency,damping_ratio,a1,d,a2\n50,0.01,1,1,1\n"),
              HasSubstr("the column \"a2\" has no meaning"));
  EXPECT_THAT(said("frequency,damping_ratio,a1,d\n50,0.01,1,1\n60,1.5,1,1\n"),
              HasSubstr("modes.csv:3: damping_ratio = 1.5; it must be in (0, 1)"));
  EXPECT_THAT(said("frequency,damping_ratio,a1,d\n50,0.01,1,0\n60,0.01,1,0\n"),
              HasSubstr("the modal constants of d are 0 in every mode"));
  EXPECT_THAT(said("frequency,damping_ratio [%],a1,d\n50,0.5,1,1\n"),
              HasSubstr("\"damping_ratio\" is in \"%\""));
  EXPECT_THAT(said("frequency,damping_ratio,a1 [g/N],d\n50,0.01,1,1\n"), HasSubstr("in \"g/N\""));
  EXPECT_THAT(said("frequency,damping_ratio,a1,d,decay time [s]\n50,0.01,1,1,3\n"),
              HasSubstr("\"decay time\" has no meaning"));
  EXPECT_THAT(said("frequency,damping_ratio,a1,d,contact\n50,0.01,1,1,-3\n"),
              HasSubstr("modes.csv:2: contact = -3"));
  EXPECT_THAT(said("frequency [kHz],damping_ratio,a1,d\n50,0.01,1,1\n"), HasSubstr("in \"kHz\""));
}

TEST_F(TableFile, AListKnowsTheFilesOfATableByTheirContent) {
  write("modes.csv", "frequency,damping_ratio,a1\n50,0.01,1\n");
  write("table.yaml",
        "low: 10\nhigh: 600\nmodes_file: modes.csv\nsensors: [{name: a1, kind: acceleration}]\n");
  write(
      "list.yaml",
      "kind: identify_force\ntable: table.yaml\nrecord: {file: r.csv, responses: [{channel: a1}]}\n"
      "sweep: {product: {shape: [smooth, impacts]}}\n");
  const auto fingerprint = [&] {
    const LoadedExperiment loaded = load_experiment(path("list.yaml"));
    const auto& list = dynamic_cast<const TaskExperiment&>(*loaded.experiment);
    return list.fingerprint(1, loaded.document.folder());
  };
  const std::string before = fingerprint();
  EXPECT_EQ(fingerprint(), before);
  write("modes.csv", "frequency,damping_ratio,a1\n50,0.01,2\n");
  EXPECT_NE(fingerprint(), before);
}

TEST_F(TableFile, IsRefusedWithThePlaceOfAMistake) {
  std::string text = table_text(read_table(kFolder + "plate_modes.json"));
  text.replace(text.find("damping_ratio: 0.0"), 18, "damping_ratio: 1.0");
  write("table.yaml", text);
  try {
    read_table(path("table.yaml"));
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr("it must be in (0, 1)"));
    EXPECT_THAT(error.what(), HasSubstr("table.yaml:"));
  }
}

}  // namespace
}  // namespace modcal::table_file_test
