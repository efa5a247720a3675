// Every file of configs/ loads, lints without a finding and runs; the paper's figures of merit
// hold. The reports, with the figures that gnuplot draws, stay in MODCAL_CONFIG_REPORTS for the
// tests that look at them, which find them by its file `pages`, a path a line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/loader.hpp"
#include "experiments/report/report.hpp"
#include "experiments/study/study.hpp"
#include "tests/experiments/kinds/small_config.hpp"

namespace modcal::configs_test {
namespace {

StudyResult run(const LoadedExperiment& loaded) {
  SharedWork work;
  return loaded.experiment->run(
      {.work = work, .folder = loaded.document.folder(), .command = "test"});
}

std::string messages(const LoadedExperiment& loaded) {
  return format_mistakes(loaded.document, loaded.mistakes);
}

// Figures and tables leave files of their names: one name a report.
std::vector<std::string> names_used_twice(const StudyResult& result) {
  std::vector<std::string> names, twice;
  for (const report::Block& block : result.blocks) {
    if (const auto* table = std::get_if<report::Table>(&block)) names.push_back(table->id);
    if (const auto* figure = std::get_if<report::Figure>(&block)) names.push_back(figure->id);
  }
  std::sort(names.begin(), names.end());
  for (std::size_t i = 1; i < names.size(); ++i) {
    if (names[i] == names[i - 1]) twice.push_back(names[i]);
  }
  return twice;
}

// Where the report of `file` was written; its warning fails the test.
std::filesystem::path written_report(const std::string& file, const std::string& title,
                                     const std::string& description, StudyResult result) {
  report::Report report{.title = title, .description = description};
  report.status_text = result.answer;
  result.move_to(report, "Results", "Details");
  std::filesystem::path name = std::filesystem::relative(file, MODCAL_CONFIGS);
  const auto written =
      write_report(report, std::filesystem::path(MODCAL_CONFIG_REPORTS) / name.replace_extension(),
                   {.vector_figures = true});
  EXPECT_EQ(written.warning, "");
  return written.page;
}

class Configs : public testing::TestWithParam<std::string> {
 protected:
  static void SetUpTestSuite() {
    std::filesystem::remove_all(MODCAL_CONFIG_REPORTS);
    std::filesystem::create_directories(MODCAL_CONFIG_REPORTS);
  }
};

TEST_P(Configs, RunsSmall) {
  const LoadedExperiment full = load_experiment(GetParam());
  ASSERT_EQ(messages(full), "");
  const LoadedExperiment small = load_small(GetParam(), full);
  ASSERT_EQ(messages(small), "");
  StudyResult result = run(small);
  EXPECT_EQ(result.status, report::Status::kOk);
  EXPECT_FALSE(result.blocks.empty());
  EXPECT_FALSE(result.summary.empty());
  EXPECT_THAT(names_used_twice(result), testing::IsEmpty());
  std::ofstream pages(std::filesystem::path(MODCAL_CONFIG_REPORTS) / "pages", std::ios::app);
  pages << written_report(GetParam(), small.title, small.description, std::move(result)).string()
        << std::endl;
  EXPECT_TRUE(pages);
}

void expect_resolved_reads_back(const LoadedExperiment& loaded) {
  ASSERT_NE(loaded.experiment, nullptr);
  const std::string resolved = loaded.resolved();
  const LoadedExperiment again = load_experiment(parse_yaml(resolved, loaded.document.file));
  EXPECT_EQ(messages(again), "");
  EXPECT_EQ(again.resolved(), resolved);
}

TEST_P(Configs, ResolvedReadsBackToItself) {
  expect_resolved_reads_back(load_experiment(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(All, Configs, testing::ValuesIn(config_files(MODCAL_CONFIGS)),
                         [](const testing::TestParamInfo<std::string>& parameter) {
                           const std::filesystem::path path(parameter.param);
                           return path.parent_path().filename().string() + "_" +
                                  path.stem().string();
                         });

TEST(PaperTable1, MeetsItsAcceptance) {
  const LoadedExperiment loaded =
      load_experiment(std::string(MODCAL_CONFIGS) + "/paper/table1.yaml");
  ASSERT_NE(loaded.experiment, nullptr);
  const StudyResult result = run(loaded);
  EXPECT_THAT(result.missed, testing::IsEmpty());
  EXPECT_EQ(result.failed_tasks, 0u);
}

TEST(PaperTable1, ResolvedReadsBackWithEveryDifferenceAccepted) {
  YamlDocument document = read_yaml_file(std::string(MODCAL_CONFIGS) + "/paper/table1.yaml");
  std::erase_if(document.root.find("compare_with")->members,
                [](const YamlNode::Member& member) { return member.key == "mean_difference"; });
  expect_resolved_reads_back(load_experiment(std::move(document)));
}

TEST(PaperFigure14, RefinesTheExcitedModesToTwoPerMille) {
  const LoadedExperiment loaded =
      load_experiment(std::string(MODCAL_CONFIGS) + "/paper/fig14.yaml");
  ASSERT_NE(loaded.experiment, nullptr);
  const StudyResult result = run(loaded);
  const auto file = std::find_if(result.files.begin(), result.files.end(),
                                 [](const auto& f) { return f.first == "calibration.json"; });
  ASSERT_NE(file, result.files.end());
  const auto document = nlohmann::json::parse(file->second);
  ASSERT_EQ(document["modes"].size(), 50u);
  std::vector<double> errors;
  for (const auto& mode : document["modes"]) {
    if (!mode["excited"].get<bool>()) continue;
    errors.push_back(std::abs(mode["f_hz"].get<double>() / mode["f_true_hz"].get<double>() - 1.0));
  }
  EXPECT_EQ(errors.size(), 46u);
  std::nth_element(errors.begin(), errors.begin() + 23, errors.end());
  EXPECT_LE(errors[23], 2e-3);
  EXPECT_EQ(document["loops"], 10);
}

TEST(Regularizers, AreComparedInACellEach) {
  YamlDocument document = read_yaml_file(std::string(MODCAL_CONFIGS) + "/beyond/regularizers.yaml");
  for (YamlNode::Member& axis : document.root.find("sweep")->find("product")->members) {
    if (axis.key != "inversion.regularizer") axis.value.items.resize(1);
  }
  const LoadedExperiment loaded = load_experiment(std::move(document));
  ASSERT_NE(loaded.experiment, nullptr);
  const StudyResult result = run(loaded);
  ASSERT_FALSE(result.blocks.empty());
  const auto* table = std::get_if<report::Table>(&result.blocks.back());
  ASSERT_NE(table, nullptr);
  ASSERT_EQ(table->rows.size(), 7u);
  const auto column = std::find_if(table->columns.begin(), table->columns.end(), [](const auto& c) {
    return c.key == "identification.1.correlation";
  });
  ASSERT_NE(column, table->columns.end());
  const auto place = static_cast<std::size_t>(column - table->columns.begin());
  std::map<std::string, double> correlations;
  std::set<double> different;
  for (const auto& row : table->rows) {
    const double correlation = std::get<double>(row[place].value);
    correlations[report::cell_text(row[0], table->columns[0])] = correlation;
    different.insert(correlation);
  }
  EXPECT_EQ(correlations.size(), 7u);
  // One filter under two names: a bin of a spectrum has one singular value, |H|.
  EXPECT_EQ(correlations.at("truncated_svd"), correlations.at("water_level"));
  EXPECT_EQ(different.size(), 6u);
}

}  // namespace
}  // namespace modcal::configs_test
