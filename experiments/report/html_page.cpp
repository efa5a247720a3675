#include "experiments/report/html_page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "experiments/report/encoding.hpp"
#include "experiments/report/html_blocks.hpp"
#include "experiments/report/typeset.hpp"

namespace modcal::report {
namespace {

// Filled by the script where the page has something to filter.
constexpr std::string_view kFilterBar =
    "<div id=\"filters\" role=\"search\" aria-label=\"Filters\" "
    "hidden><strong>Show</strong></div>\n";
constexpr std::string_view kReplayBar =
    "<div id=\"replay\" role=\"status\" hidden><span class=\"what\"></span><code></code><button "
    "type=\"button\" class=\"copy\">Copy</button><button type=\"button\" class=\"close\" "
    "aria-label=\"Close\">×</button></div>\n";

std::string palette_style() {
  std::string light, dark, classes;
  for (std::size_t i = 0; i < kColorRoles; ++i) {
    const Ink& ink = ink_of(static_cast<ColorRole>(i));
    light += fmt::format("--{}:{};", ink.name, ink.light);
    dark += fmt::format("--{}:{};", ink.name, ink.dark);
    classes += fmt::format(".ink-{0}{{color:var(--{0})}}\n", ink.name);
  }
  return fmt::format(
      ":root{{{0}}}\n@media screen and "
      "(prefers-color-scheme:dark){{:root:not(.printing){{{1}}}}}\n{2}",
      light, dark, classes);
}

std::string contents_html(const Report& report) {
  std::string html = "<nav aria-label=\"Contents\"><h2>Contents</h2><ol>\n";
  const auto entry = [](const std::string& anchor, const std::string& title) {
    return fmt::format("<li><a href=\"#{}\">{}</a></li>\n", anchor, typeset_html(title));
  };
  for (std::size_t i = 0; i < report.sections.size(); ++i) {
    const Section& section = report.sections[i];
    html +=
        fmt::format("<li><a href=\"#section-{}\">{}</a><ul>\n", i + 1, html_escaped(section.title));
    for (const Block& block : section.blocks) {
      if (const auto* figure = std::get_if<Figure>(&block)) {
        html += entry(figure->id, figure->title);
      } else if (const auto* table = std::get_if<Table>(&block)) {
        html += entry(table->id, table->title);
      } else if (const auto* audio = std::get_if<Audio>(&block)) {
        html += entry(audio->id, audio->title);
      }
    }
    html += "</ul></li>\n";
  }
  return html + "<li><a href=\"#provenance\">Where the numbers come from</a></li></ol></nav>\n";
}

// "5 figures, 1 table": what a folded section holds.
std::string counts_text(const Section& section) {
  std::string text;
  const auto count = [&](auto is_one, std::string_view one, std::string_view many) {
    const auto found = std::ranges::count_if(section.blocks, is_one);
    if (found == 0) return;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", found, found == 1 ? one : many);
  };
  count([](const Block& block) { return std::holds_alternative<Figure>(block); }, "figure",
        "figures");
  count([](const Block& block) { return std::holds_alternative<Table>(block); }, "table", "tables");
  count([](const Block& block) { return std::holds_alternative<Audio>(block); }, "set of sounds",
        "sets of sounds");
  return text;
}

// Whether the answer comes with a warning.
bool is_warned(const Report& report) {
  return !report.sections.empty() &&
         std::ranges::any_of(report.sections.front().blocks, [](const Block& block) {
           const auto* text = std::get_if<Text>(&block);
           return text != nullptr && text->kind == Text::Kind::kWarning;
         });
}

std::string header_html(const Report& report, const PageLinks& links) {
  struct Look {
    std::string_view kind, word;
  };
  const Look look = report.status == Status::kFailed       ? Look{"failed", "Failed"}
                    : report.status == Status::kSomeFailed ? Look{"partial", "Partly failed"}
                    : is_warned(report)                    ? Look{"partial", "Done, with a warning"}
                                                           : Look{"ok", "All done"};
  std::string html = fmt::format(
      "<header class=\"{}\"><h1>{}</h1>\n<p class=\"status\"><strong>{}</strong> {}</p>\n",
      look.kind, html_escaped(report.title), look.word, typeset_html(report.status_text));
  html += html_paragraphs(report.description) + command_html(report.command);
  if (!links.warning.empty()) html += box_html("warning", "Warning", links.warning);
  html +=
      "<noscript><div class=\"box warning\"><p>The charts need JavaScript; the tables do "
      "not, and the SVG files are linked below each figure.</p></div></noscript>\n";
  return html + "</header>\n";
}

std::string provenance_html(const Report& report) {
  std::string html = "<footer id=\"provenance\"><h2>Where the numbers come from</h2>\n<dl>\n";
  for (const ProvenanceLine& line : report.provenance) {
    html +=
        fmt::format("<dt>{}</dt><dd>{}</dd>\n", html_escaped(line.name), html_escaped(line.value));
  }
  return html +
         "</dl>\n<p class=\"remark\">Drag in a chart to zoom (sideways: x, up or down: y), "
         "shift-drag to move, double-click to reset; with the keyboard: arrows, + and −, 0. "
         "Charts: dygraphs, © 2006–2023 Dan Vanderkam and contributors, MIT "
         "licence.</p></footer>\n";
}

}  // namespace

std::string html_page(const Report& report, std::span<const DrawnFigure> figures,
                      const std::string& data, const PageLinks& links) {
  std::string body;
  BlockWriter writer(figures, links);
  for (std::size_t i = 0; i < report.sections.size(); ++i) {
    const Section& section = report.sections[i];
    const std::string heading = fmt::format("<h2>{}</h2>", html_escaped(section.title));
    body += fmt::format("<section id=\"section-{}\">", i + 1);
    body += section.folded ? fmt::format("<details class=\"fold\"><summary>{} {}</summary>\n",
                                         heading, counts_text(section))
                           : heading + "\n";
    body += writer.section(section, i == 0) +
            (section.folded ? "</details></section>\n" : "</section>\n");
    // The answer first, then what else there is.
    if (i == 0) body += contents_html(report);
  }
  if (report.sections.empty()) body += contents_html(report);
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta "
      "http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
      "'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; "
      "media-src data:\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" "
      "content=\"light dark\">\n<title>{}</title>\n",
      html_escaped(report.title));
  page += fmt::format("<style>{}\n{}\n{}</style></head>\n<body>\n", kDygraphsStyle, palette_style(),
                      kPageStyle);
  page += "<main>\n" + header_html(report, links) + std::string(kFilterBar) + body +
          provenance_html(report) + "</main>\n" + std::string(kReplayBar);
  page += fmt::format("<script type=\"application/json\" id=\"modcal-data\">{}</script>\n", data);
  page += fmt::format("<script>{}</script>\n<script>{}</script>\n", kDygraphsScript,
                      kDygraphsSynchronizer);
  page +=
      fmt::format("<script>(function () {{\n'use strict';\n{}\n{}\n{}\n{}\n{}\n{}}})();</script>\n",
                  kPageValues, kPageMarks, kPageFilters, kPagePrint, kPageScript, kPageStart);
  return page + "</body></html>\n";
}

}  // namespace modcal::report
