#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "experiments/report/encoding.hpp"
#include "experiments/report/report.hpp"
#include "libsim/base/error.hpp"
#include "tests/experiments/report/sample_report.hpp"
#include "tests/folder_test.hpp"

namespace modcal::report::write_report_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class WriteReport : public FolderTest {};

TEST_F(WriteReport, LeavesEveryFileItNames) {
  const WrittenReport written = write_report(sample_report(), folder() / "made" / "here");
  EXPECT_EQ(written.warning, "");
  EXPECT_EQ(written.page, folder() / "made" / "here" / "report.html");
  // 6 figures with csv, dat, gp, svg and pdf, a table with csv and json, and the page.
  EXPECT_EQ(written.files.size(), 6u * 5u + 2u + 1u);
  std::size_t found = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder())) {
    if (entry.is_regular_file()) ++found;
  }
  EXPECT_EQ(found, written.files.size()) << "no temporary file is left";
  for (const fs::path& file : written.files) EXPECT_GT(fs::file_size(file), 0u) << file;
  EXPECT_THAT(content_of(written.page), HasSubstr("href=\"figures/fig8.pdf\""));
}

TEST_F(WriteReport, GoesOnWithoutGnuplotAndSaysSo) {
  fs::create_directories(folder() / "figures");
  std::ofstream(folder() / "figures" / "fig9.svg") << "of an earlier report";
  const WrittenReport written =
      write_report(sample_report(), folder(), {.gnuplot = "no-such-gnuplot"});
  EXPECT_THAT(written.warning, HasSubstr("could not be started"));
  const std::string page = content_of(written.page);
  EXPECT_THAT(page, HasSubstr("could not be started"));
  EXPECT_THAT(page, HasSubstr("href=\"figures/fig9.csv\""));
  EXPECT_THAT(page, testing::Not(HasSubstr("fig9.svg"))) << "not the earlier report's figure";
}

TEST_F(WriteReport, VectorFiguresCanBeLeftOut) {
  const WrittenReport written = write_report(sample_report(), folder(), {.vector_figures = false});
  EXPECT_EQ(written.warning, "");
  EXPECT_FALSE(fs::exists(folder() / "figures" / "fig9.gp"));
  EXPECT_TRUE(fs::exists(folder() / "figures" / "fig9.csv"));
}

// So many figures of 3 × 2 panels, no two series alike, and one long record.
Report large_report(int figures) {
  Report report{.title = "large", .sections = {{.title = "s"}}};
  for (int f = 0; f < figures; ++f) {
    Figure figure = waveform_figure();
    figure.id = "fig" + std::to_string(f);
    for (std::size_t p = 0; p < figure.panels.size(); ++p) {
      for (Series& series : figure.panels[p].series) {
        for (double& y : series.y) y += std::sin(static_cast<double>(f) + y);
      }
    }
    report.sections[0].blocks.push_back(std::move(figure));
  }
  report.sections[0].blocks.push_back(long_figure());
  return report;
}

TEST_F(WriteReport, TwentyFiguresKeepTheSamplesOfShortWindowsUnderTwoMegabytes) {
  const WrittenReport written = write_report(large_report(20), folder(), {.vector_figures = false});
  const std::string page = content_of(written.page);
  EXPECT_LT(page.size(), 2'000'000u);
  const std::size_t thinned = page.find("Long series");
  ASSERT_NE(thinned, std::string::npos) << "the long record";
  EXPECT_EQ(page.find("Long series", thinned + 1), std::string::npos) << "no other series";
}

TEST_F(WriteReport, EightyFiguresAreThinnedToStayUnderTwoMegabytes) {
  const WrittenReport written = write_report(large_report(80), folder(), {.vector_figures = false});
  EXPECT_LT(fs::file_size(written.page), 2'000'000u);
}

TEST_F(WriteReport, RefusesTwoFiguresOfOneNameBeforeWriting) {
  Report report = sample_report();
  report.sections[0].blocks.push_back(waveform_figure());
  EXPECT_THROW(write_report(report, path("made")), InvalidInput);
  EXPECT_FALSE(fs::exists(path("made")));
}

TEST_F(WriteReport, SaysWhichFileCannotBeWritten) {
  fs::create_directories(folder());
  std::ofstream(folder() / "file") << "in the way";
  EXPECT_THROW(write_report(sample_report(), folder() / "file"), InvalidInput);
  EXPECT_EQ(content_of(folder() / "file"), "in the way");
}

TEST_F(WriteReport, AnEmptyReportIsAPage) {
  const Report report{.title = "nothing",
                      .description = "",
                      .status = Status::kFailed,
                      .sections = {},
                      .provenance = {},
                      .command = ""};
  const WrittenReport written = write_report(report, folder());
  EXPECT_EQ(written.files.size(), 1u);
  EXPECT_FALSE(fs::exists(folder() / "figures"));
}

TEST_F(WriteReport, FilesAreReplacedAsAWhole) {
  fs::create_directories(folder());
  write_file_atomically(folder() / "a.txt", "first, and longer");
  write_file_atomically(folder() / "a.txt", "second");
  EXPECT_EQ(content_of(folder() / "a.txt"), "second");
  // A folder cannot be replaced by a file: the old one stays and no temporary file is left.
  fs::create_directories(folder() / "b.txt" / "inside");
  EXPECT_THROW(write_file_atomically(folder() / "b.txt", "x"), InvalidInput);
  EXPECT_THROW(write_file_atomically(folder() / "no" / "such" / "folder", "x"), InvalidInput);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder()), fs::directory_iterator()), 2);
}

}  // namespace
}  // namespace modcal::report::write_report_test
