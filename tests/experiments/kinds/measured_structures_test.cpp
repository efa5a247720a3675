// Structures that were measured: the force of a strike by the modes of that strike, no window
// stated.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/experiments/kinds/structure_config.hpp"
#include "tests/folder_test.hpp"

namespace modcal::measured_structures_test {
namespace {

class Measured : public FolderTest {
 protected:
  void SetUp() override {
    const char* const data = std::getenv("MODCAL_REAL_DATA");
    if (data == nullptr) GTEST_SKIP() << "MODCAL_REAL_DATA names no folder";
    data_ = data;
  }

  /// The row `force` of force.json: what is found of the file by the modes that are fitted to it.
  nlohmann::json force_of(const std::string& file, const std::string& record,
                          const std::string& fit) const {
    const std::filesystem::path csv = path("record.csv"), packed = data_ / (file + ".csv.xz");
    const std::string unpack = fmt::format("xz -dc '{}' > '{}'", packed.string(), csv.string());
    if (std::system(unpack.c_str()) != 0) throw std::runtime_error("cannot run: " + unpack);
    const StudyResult modes = run("kind: fit_modes\n" + record + fit);
    for (const auto& [name, text] : modes.files) write(name, text);
    const StudyResult found = run("kind: identify_force\ntable: table.yaml\n" + record);
    EXPECT_EQ(found.status, report::Status::kOk) << found.answer;
    return structure_config::file_of(found, "force.json")["force"][0];
  }

 private:
  StudyResult run(const std::string& text) const {
    return run_document(read_yaml_file(write("experiment.yaml", text)));
  }

  std::filesystem::path data_;
};

// By all of the 2 s, .1 with half of it in the band; by the best sensor alone and division, .178.
TEST_F(Measured, PlateIsStruck) {
  const nlohmann::json force =
      force_of("plate_train",
               "record:\n  file: record.csv\n  force: {channel: f}\n"
               "  responses: [{channel: a1}, {channel: a2}, {channel: a3}, {channel: a4}]\n",
               "low: 5 Hz\nhigh: 500 Hz\ncontour: 10\n");
  EXPECT_EQ(force["shape"], "impacts");
  EXPECT_LT(force["relative_error"].get<double>(), 0.04);
  EXPECT_GT(force["coverage"].get<double>(), 0.98);
}

// By all of the 8 s it was rejected, .27.
TEST_F(Measured, BeamIsStruck) {
  const nlohmann::json force =
      force_of("beam_train",
               "record:\n  file: record.csv\n  force: {channel: F, turned: true, calibration: 1}\n"
               "  responses: [{channel: m_1}, {channel: m_2}]\n",
               "low: 3 Hz\nhigh: 490 Hz\ncontour: 3\n");
  EXPECT_LT(force["relative_error"].get<double>(), 0.06);
  EXPECT_GT(force["coverage"].get<double>(), 0.9);
}

}  // namespace
}  // namespace modcal::measured_structures_test
