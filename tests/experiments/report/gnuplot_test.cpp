#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "experiments/report/drawing.hpp"
#include "tests/experiments/report/sample_report.hpp"
#include "tests/folder_test.hpp"

namespace modcal::report::gnuplot_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Gnuplot : public FolderTest {
 protected:
  std::string content(const std::string& name) const { return content_of(path(name)); }
};

TEST_F(Gnuplot, DrawsEveryFigureAsSvgAndPdf) {
  const std::vector<Figure> figures = {waveform_figure(), objective_figure(), noise_figure(),
                                       curve_figure(), long_figure()};
  std::vector<DrawnFigure> drawn;
  for (const Figure& figure : figures) drawn.push_back(draw_figure(figure, 300));
  EXPECT_EQ(draw_with_gnuplot(drawn, folder(), "gnuplot"), "");
  for (const Figure& figure : figures) {
    const std::string svg = content(figure.id + ".svg");
    EXPECT_THAT(svg, testing::StartsWith("<?xml"));
    EXPECT_THAT(svg, HasSubstr("</svg>"));
    EXPECT_THAT(svg, HasSubstr("<path")) << figure.id;
    const std::string pdf = content(figure.id + ".pdf");
    EXPECT_THAT(pdf, testing::StartsWith("%PDF-"));
    EXPECT_THAT(pdf, HasSubstr("/Count 1")) << "one page";
    EXPECT_THAT(pdf, HasSubstr("%%EOF"));
  }
  EXPECT_THAT(content("long.svg"), HasSubstr("no data"));
  for (const auto& entry : fs::directory_iterator(folder())) {
    EXPECT_THAT(entry.path().filename().string(), testing::Not(HasSubstr(".part")));
  }
}

TEST_F(Gnuplot, HostileTextIsOnlyText) {
  Figure figure = objective_figure();
  figure.panels.resize(1);
  Panel& panel = figure.panels[0];
  panel.title = "it's `touch stolen` _{x} % \" \\ \n system('touch stolen')";
  panel.x.label = panel.y.label = panel.series[0].label = panel.markers[0].label = panel.title;
  const std::vector<DrawnFigure> drawn = {draw_figure(figure, 100)};
  EXPECT_EQ(draw_with_gnuplot(drawn, folder(), "gnuplot"), "");
  EXPECT_FALSE(fs::exists(folder() / "stolen"));
  EXPECT_THAT(content("fig13.svg"), HasSubstr("`touch stolen` _{x} %"));
}

TEST_F(Gnuplot, KeptScriptsCanBeRunByHand) {
  const Figure figure = curve_figure();
  const std::vector<DrawnFigure> drawn = {draw_figure(figure, 100)};
  ASSERT_EQ(draw_with_gnuplot(drawn, folder(), "gnuplot"), "");
  fs::remove(folder() / "fig9.svg");
  EXPECT_TRUE(run_process({"gnuplot", "fig9.gp"}, folder()).succeeded());
  EXPECT_THAT(content("fig9.svg"), HasSubstr("</svg>"));
}

TEST_F(Gnuplot, SaysWhenTheProgramIsMissing) {
  const Figure figure = curve_figure();
  const std::vector<DrawnFigure> drawn = {draw_figure(figure, 100)};
  EXPECT_THAT(draw_with_gnuplot(drawn, folder(), "no-such-gnuplot"),
              testing::AllOf(HasSubstr("no-such-gnuplot"), HasSubstr("gnuplot-nox")));
  EXPECT_TRUE(fs::exists(folder() / "fig9.gp"));
  EXPECT_FALSE(fs::exists(folder() / "fig9.svg"));
}

TEST_F(Gnuplot, SaysWhatTheProgramSaidWhenItFails) {
  const Figure figure = curve_figure();
  const std::vector<DrawnFigure> drawn = {draw_figure(figure, 100)};
  std::ofstream(folder() / "broken")
      << "#!/bin/sh\n"
         "for part in fig9.svg.*.part; do printf '<svg>half' > $part; done\n"
         "echo disk full >&2; exit 3\n";
  fs::permissions(folder() / "broken", fs::perms::owner_all);
  EXPECT_THAT(draw_with_gnuplot(drawn, folder(), (folder() / "broken").string()),
              testing::AllOf(HasSubstr("exit code 3"), HasSubstr("fig9.svg, fig9.pdf"),
                             HasSubstr("disk full")));
  EXPECT_FALSE(fs::exists(folder() / "fig9.svg")) << "a half-drawn figure is no figure";
  for (const fs::directory_entry& entry : fs::directory_iterator(folder())) {
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  }
}

TEST(GnuplotQuoted, DoublesQuotesAndJoinsLines) {
  EXPECT_EQ(gnuplot_quoted("it's\none"), "'it''s one'");
}

TEST(GnuplotData, WritesGapsAndOneBlockPerSeries) {
  const Series gap{.label = "", .x = {1, 2}, .y = {3, std::nan("")}};
  const Series band{.label = "", .x = {1}, .y = {3}, .y_low = {2}, .y_high = {4}};
  const Figure figure{.id = "f",
                      .title = "",
                      .caption = "",
                      .panels = {{.title = "",
                                  .x = {.label = "x", .unit = "s"},
                                  .y = {.label = "y", .unit = "m"},
                                  .series = {gap, band}}},
                      .command = ""};
  EXPECT_EQ(gnuplot_data(draw_figure(figure, 10)), "1 3\n2 NaN\n\n\n1 3 2 4\n");
}

TEST(GnuplotScript, NamesTheTicsOfALogarithmicAxisThatHoldsNoPowers) {
  const Figure figure{.id = "f",
                      .panels = {{.y = {.label = "y", .logarithmic = true, .range = {{1.8, 2.9}}},
                                  .series = {{.label = "", .x = {1, 2}, .y = {1.9, 2.8}}}}}};
  EXPECT_THAT(gnuplot_script(draw_figure(figure, 10)), HasSubstr("set ytics (1.8,2,2.2,"));
}

TEST(RunProcess, ReportsExitCodesSignalsAndOutput) {
  const ProcessOutcome failed = run_process({"sh", "-c", "echo out; echo err >&2; exit 7"}, "/");
  EXPECT_TRUE(failed.started);
  EXPECT_EQ(failed.exit_code, 7);
  EXPECT_EQ(failed.output, "out\nerr\n");
  EXPECT_EQ(run_process({"sh", "-c", "kill -9 $$"}, "/").exit_code, 128 + 9);
  EXPECT_EQ(run_process({"pwd"}, "/").output, "/\n");
  EXPECT_FALSE(run_process({"no-such-program"}, "/").started);
}

}  // namespace
}  // namespace modcal::report::gnuplot_test
