#include "experiments/report/html_page.hpp"

#include <gmock/gmock.h>

#include "experiments/report/encoding.hpp"
#include "tests/experiments/report/sample_report.hpp"

namespace modcal::report::html_page_test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string page_of(const Report& report, const PageLinks& links = {}) {
  std::vector<DrawnFigure> drawn;
  for (const Section& section : report.sections) {
    for (const Block& block : section.blocks) {
      if (const auto* figure = std::get_if<Figure>(&block)) {
        drawn.push_back(draw_figure(*figure, 500));
      }
    }
  }
  return html_page(report, drawn, chart_data_json(drawn), links);
}

std::size_t occurrences(const std::string& text, std::string_view part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(HtmlPage, HoldsEveryFigurePanelTableAndCommand) {
  const std::string page = page_of(sample_report());
  EXPECT_EQ(occurrences(page, "<figure id="), 6u);
  // 6 waveforms, 2 of noise, 2 curves, 12 objectives, 3 of one figure and one without data; one
  // map.
  EXPECT_EQ(occurrences(page, "class=\"chart\""), 25u);
  EXPECT_EQ(occurrences(page, "class=\"chart map\""), 1u);
  EXPECT_EQ(occurrences(page, "&lt;several&gt;"), 1u);
  EXPECT_EQ(occurrences(page, "class=\"nothing\""), 1u);
  EXPECT_EQ(occurrences(page, "<table>"), 1u);
  EXPECT_EQ(occurrences(page, "class=\"command\""), 8u);
  EXPECT_THAT(page, HasSubstr("style=\"--columns:3\""));
  for (const char* anchor :
       {"fig8", "noise", "table1", "fig9", "fig13", "long", "map", "provenance"}) {
    EXPECT_THAT(page, HasSubstr(std::string("href=\"#") + anchor + "\""));
    EXPECT_THAT(page, HasSubstr(std::string("id=\"") + anchor + "\""));
  }
  EXPECT_THAT(page, HasSubstr("<td class=\"number fail\">NaN"));
  EXPECT_THAT(page, HasSubstr("<td class=\"number pass\">0.81"));
  EXPECT_THAT(page, HasSubstr("3 values ≤ 0 left out"));
}

// The files keep them.
TEST(HtmlPage, LeavesColumnsWithoutAnyValueOut) {
  Table table{.id = "forces", .columns = {{.key = "peak"}, {.key = "error"}, {.key = "task"}}};
  Cell task;
  task.task = 3;
  table.rows = {{1.0, {}, {}}, {2.0, {}, task}};
  const Report report{.sections = {{.blocks = {table}}}};
  const std::string page = page_of(report);
  EXPECT_THAT(page, HasSubstr(">peak"));
  EXPECT_THAT(page, Not(HasSubstr(">error")));
  EXPECT_THAT(page, HasSubstr(">task"));
  EXPECT_EQ(table_csv(table), "peak,error,task\n1,,\n2,,\n");
  table.rows[0][1] = 0.5;
  EXPECT_THAT(page_of({.sections = {{.blocks = {table}}}}), HasSubstr(">error"));
}

TEST(HtmlPage, AsksTheNetworkForNothing) {
  const std::string page = page_of(sample_report());
  EXPECT_THAT(page, HasSubstr("content=\"default-src 'none';"));
  for (const char* request : {" src=", "<link", "@import", "sourceMappingURL"}) {
    EXPECT_THAT(page, Not(HasSubstr(request))) << request;
  }
  // A chart on paper is clipped by a path of its own.
  EXPECT_THAT(page, Not(testing::ContainsRegex("url\\([^#]")));
}

TEST(HtmlPage, EscapesEveryTextItIsGiven) {
  const std::string hostile = "</script><script>evil(\"'&\")</script>";
  Figure figure = objective_figure();
  figure.title = figure.caption = figure.command = hostile;
  figure.panels.resize(1);
  Panel& panel = figure.panels[0];
  panel.title = panel.x.label = panel.x.unit = panel.y.label = panel.y.unit = hostile;
  panel.series[0].label = panel.markers[0].label = hostile;
  Table table = noise_table();
  table.title = table.caption = table.command = hostile;
  table.columns[0].name = table.columns[0].unit = hostile;
  table.rows[0][4] = hostile;
  const Report report{
      .title = hostile,
      .description = hostile,
      .status_text = hostile,
      .sections = {{.title = hostile,
                    .blocks = {Text{hostile}, Text{hostile, Text::Kind::kFailure},
                               Text{hostile, Text::Kind::kPreformatted}, figure, table}}},
      .provenance = {{hostile, hostile}},
      .command = hostile};
  PageLinks links;
  links.warning = hostile;
  const std::string page = page_of(report, links);
  const std::string plain = page_of(Report{});
  EXPECT_EQ(occurrences(page, "<script"), occurrences(plain, "<script"));
  EXPECT_EQ(occurrences(page, "</script"), occurrences(plain, "</script"));
  EXPECT_THAT(page, Not(HasSubstr("evil(\"")));
  EXPECT_THAT(page, HasSubstr("&lt;/script&gt;&lt;script&gt;evil(&quot;&#39;&amp;&quot;)"));
}

TEST(HtmlPage, LinksOnlyFilesThatExist) {
  PageLinks links;
  links.files = {"figures/fig8.csv", "figures/fig8.svg", "table1.json"};
  const std::string page = page_of(sample_report(), links);
  EXPECT_EQ(occurrences(page, "href=\"figures/"), 2u);
  EXPECT_THAT(page, HasSubstr("href=\"table1.json\""));
  EXPECT_THAT(page, Not(HasSubstr("href=\"table1.csv\"")));
}

TEST(HtmlPage, FoldsDetailsAndSaysWhatTheyHold) {
  Report report{.sections = {{.title = "Results", .blocks = {noise_table()}},
                             {.title = "Details",
                              .blocks = {objective_figure(), noise_figure(), noise_table()},
                              .folded = true}}};
  const std::string page = page_of(report);
  EXPECT_THAT(page, HasSubstr("<section id=\"section-1\"><h2>Results</h2>"));
  EXPECT_THAT(page, HasSubstr("<section id=\"section-2\"><details class=\"fold\"><summary>"
                              "<h2>Details</h2> 2 figures, 1 table</summary>"));
  EXPECT_THAT(page, HasSubstr("</details></section>"));
}

TEST(HtmlPage, ShowsFailureInTheHeader) {
  Report report = sample_report();
  EXPECT_THAT(page_of(report), HasSubstr("<header class=\"partial\">"));
  report.status = Status::kFailed;
  EXPECT_THAT(page_of(report), HasSubstr("<header class=\"failed\">"));
  report.status = Status::kOk;
  EXPECT_THAT(page_of(report), HasSubstr("<header class=\"ok\">"));
  report.sections[0].blocks.emplace_back(Text{"doubtful", Text::Kind::kWarning});
  EXPECT_THAT(page_of(report), HasSubstr("<header class=\"partial\">"));
  EXPECT_THAT(page_of(report), HasSubstr("Done, with a warning"));
}

TEST(HtmlParagraphs, AreSeparatedByEmptyLines) {
  EXPECT_EQ(html_paragraphs("a < b\nc\n\n\n\nd"), "<p>a &lt; b\nc</p>\n<p>d</p>\n");
  EXPECT_EQ(html_paragraphs(""), "");
}

}  // namespace
}  // namespace modcal::report::html_page_test
