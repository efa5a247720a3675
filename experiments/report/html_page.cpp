#include "experiments/report/html_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

#include "experiments/report/encoding.hpp"

namespace modcal::report {
namespace {

std::string legend_html(const DrawnPanel& panel) {
  std::string html;
  for (const auto& [label, look, is_cell] : panel.legend) {
    const std::string text = html_escaped(label);
    html += fmt::format(
        "<span class=\"key\"{}><span class=\"mark{} ink-{}\" "
        "aria-hidden=\"true\">{}</span>{}</span>",
        is_cell ? "" : " data-label=\"" + text + "\"",
        is_cell       ? " cell"
        : look.dotted ? " dotted"
        : look.line   ? " line"
                      : "",
        look.ink->name, look.points ? look.ink->glyph : "", text);
  }
  return html;
}

std::string links_html(const PageLinks& links, const std::string& stem,
                       std::initializer_list<std::pair<const char*, const char*>> kinds) {
  std::string html;
  for (const auto& [extension, name] : kinds) {
    const std::string file = stem + extension;
    if (!links.files.contains(file)) continue;
    html += fmt::format("<a href=\"{}\">{}</a> ", html_escaped(file), name);
  }
  return html.empty() ? html : "<div class=\"files\">" + html + "</div>\n";
}

std::string tags_attribute(const Tags& tags) {
  if (tags.empty()) return {};
  return fmt::format(" data-tags=\"{}\"", html_escaped(tags_text(tags)));
}

std::string panel_html(const DrawnPanel& drawn, std::size_t place, bool legend_in_panel) {
  const Panel& panel = *drawn.source;
  std::string html = "<div class=\"panel\"><div class=\"head\">";
  html += fmt::format("<span class=\"title\">{}</span>", html_escaped(panel.title));
  if (legend_in_panel) html += fmt::format("<span class=\"keys\">{}</span>", legend_html(drawn));
  html += "<output class=\"values\"></output></div>\n";
  if (!drawn.has_values()) return html + "<div class=\"nothing\">no data</div></div>\n";
  return html + fmt::format(
                    "<div class=\"chart{}\" data-panel=\"{}\" tabindex=\"0\" role=\"img\" "
                    "aria-label=\"{}: {} over {}\"></div></div>\n",
                    panel.map ? " map" : "", place, html_escaped(panel.title),
                    html_escaped(panel.y.text()), html_escaped(panel.x.text()));
}

std::string heading_html(const Column& column, bool is_text) {
  const std::string& name = column.name.empty() ? column.key : column.name;
  const std::string unit = column.unit.empty() || column.unit == "1"
                               ? ""
                               : " <span class=\"unit\">[" + html_escaped(column.unit) + "]</span>";
  return fmt::format("<th scope=\"col\"{}>{}{}</th>", is_text ? " class=\"text\"" : "",
                     html_escaped(name), unit);
}

std::string cell_html(const Cell& cell, const Column& column, bool is_text) {
  const std::string text = cell_text(cell, column);
  std::string kind = is_text ? "text" : "number";
  std::string mark;
  if (cell.highlight == Highlight::kPass) {
    kind += " pass";
    mark = " <span class=\"verdict\" title=\"passed\">✓</span>";
  } else if (cell.highlight == Highlight::kFail || text == "NaN") {
    kind += " fail";
    mark = " <span class=\"verdict\" title=\"failed\">✗</span>";
  }
  std::string more;
  if (cell.heat >= 0.0) {
    kind += " heat";
    more += fmt::format(" style=\"--h:{:.2f}\"", std::min(cell.heat, 1.0));
  }
  if (cell.task >= 0) more += fmt::format(" data-task=\"{}\"", cell.task);
  return fmt::format("<td class=\"{}\"{}>{}{}</td>", kind, more, html_escaped(text), mark);
}

std::string command_html(const std::string& command) {
  if (command.empty()) return {};
  return fmt::format("<div class=\"command\"><span>Regenerate</span><code>{}</code></div>\n",
                     html_escaped(command));
}

std::string box_html(std::string_view kind, std::string_view name, const std::string& text) {
  return fmt::format("<div class=\"box {}\" role=\"note\"><strong>{}</strong>{}</div>\n", kind,
                     name, html_paragraphs(text));
}

// Writes blocks in reading order; figures are taken from the list of drawn ones.
class BlockWriter {
 public:
  BlockWriter(std::span<const DrawnFigure> figures, const PageLinks& links)
      : figures_(figures), links_(links) {}

  std::string operator()(const Text& text) const;
  std::string operator()(const Figure& figure);
  std::string operator()(const Table& table) const;
  std::string operator()(const Audio& audio) const;

 private:
  std::span<const DrawnFigure> figures_;
  const PageLinks& links_;
  std::size_t next_ = 0;
};

std::string BlockWriter::operator()(const Text& text) const {
  switch (text.kind) {
    case Text::Kind::kPreformatted:
      return "<pre>" + html_escaped(text.text) + "</pre>\n";
    case Text::Kind::kNote:
      return box_html("note", "Note", text.text);
    case Text::Kind::kWarning:
      return box_html("warning", "Warning", text.text);
    case Text::Kind::kFailure:
      return box_html("failure", "Failed", text.text);
    case Text::Kind::kParagraph:
      break;
  }
  return html_paragraphs(text.text);
}

std::string BlockWriter::operator()(const Figure& figure) {
  const DrawnFigure& drawn = figures_[next_++];
  std::string html = fmt::format(
      "<figure id=\"{0}\" class=\"columns-{1}\" style=\"--columns:{1}\">\n<div "
      "class=\"caption-head\"><h3>{2}</h3>{3}<button type=\"button\" class=\"reset\" "
      "hidden>Reset zoom</button></div>\n<div class=\"grid\">\n",
      figure.id, figure.columns, html_escaped(figure.title),
      drawn.shared_legend ? "<span class=\"keys\">" + legend_html(drawn.panels.front()) + "</span>"
                          : "");
  for (std::size_t i = 0; i < drawn.panels.size(); ++i) {
    html += panel_html(drawn.panels[i], i, !drawn.shared_legend);
  }
  html += "</div>\n<figcaption>" + html_paragraphs(figure.caption);
  for (const std::string& note : drawn.notes) {
    html += "<p class=\"remark\">" + html_escaped(note) + "</p>\n";
  }
  html += links_html(links_, links_.figures + "/" + figure.id,
                     {{".svg", "SVG"}, {".pdf", "PDF"}, {".csv", "CSV"}, {".gp", "gnuplot"}});
  return html + command_html(figure.command) + "</figcaption></figure>\n";
}

std::string BlockWriter::operator()(const Table& table) const {
  std::string html = fmt::format(
      "<div class=\"table\" id=\"{}\"><h3>{}</h3>\n<div class=\"scroll\"><table><thead><tr>",
      table.id, html_escaped(table.title));
  std::vector<bool> is_text(table.columns.size());
  for (std::size_t j = 0; j < table.columns.size(); ++j) {
    is_text[j] = std::any_of(table.rows.begin(), table.rows.end(), [j](const auto& row) {
      return std::holds_alternative<std::string>(row[j].value);
    });
    html += heading_html(table.columns[j], is_text[j]);
  }
  html += "</tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto& row = table.rows[i];
    html += "<tr" + (table.row_tags.empty() ? "" : tags_attribute(table.row_tags[i])) + ">";
    for (std::size_t j = 0; j < row.size(); ++j)
      html += cell_html(row[j], table.columns[j], is_text[j]);
    html += "</tr>\n";
  }
  html += "</tbody></table></div>\n<div class=\"about\">" + html_paragraphs(table.caption);
  html += links_html(links_, table.id, {{".csv", "CSV"}, {".json", "JSON"}});
  return html + command_html(table.command) + "</div></div>\n";
}

std::string BlockWriter::operator()(const Audio& audio) const {
  std::string html = fmt::format("<div class=\"sound\" id=\"{}\"><h3>{}</h3>\n<ul>\n", audio.id,
                                 html_escaped(audio.title));
  for (const Track& track : audio.tracks) {
    html += fmt::format(
        "<li><span>{0}</span><audio controls preload=\"metadata\" aria-label=\"{0}\" "
        "src=\"{1}\"></audio></li>\n",
        html_escaped(track.label), wav_data_uri(track.samples, audio.sample_rate));
  }
  return html + "</ul>\n" + html_paragraphs(audio.caption) + "</div>\n";
}

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
    return fmt::format("<li><a href=\"#{}\">{}</a></li>\n", anchor, html_escaped(title));
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

std::string header_html(const Report& report, const PageLinks& links) {
  struct Look {
    std::string_view kind, word;
  };
  const Look look = report.status == Status::kOk       ? Look{"ok", "All done"}
                    : report.status == Status::kFailed ? Look{"failed", "Failed"}
                                                       : Look{"partial", "Partly failed"};
  std::string html = fmt::format(
      "<header class=\"{}\"><h1>{}</h1>\n<p class=\"status\"><strong>{}</strong> {}</p>\n",
      look.kind, html_escaped(report.title), look.word, html_escaped(report.status_text));
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
    body += fmt::format("<section id=\"section-{}\"><h2>{}</h2>\n", i + 1,
                        html_escaped(report.sections[i].title));
    for (const Block& block : report.sections[i].blocks) body += std::visit(writer, block);
    body += "</section>\n";
  }
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
  page += "<main>\n" + header_html(report, links) + contents_html(report) +
          std::string(kFilterBar) + body + provenance_html(report) + "</main>\n" +
          std::string(kReplayBar);
  page += fmt::format("<script type=\"application/json\" id=\"modcal-data\">{}</script>\n", data);
  page += fmt::format("<script>{}</script>\n<script>{}</script>\n", kDygraphsScript,
                      kDygraphsSynchronizer);
  page += fmt::format("<script>(function () {{\n'use strict';\n{}\n{}\n{}\n{}}})();</script>\n",
                      kPageValues, kPageMarks, kPageFilters, kPageScript);
  return page + "</body></html>\n";
}

}  // namespace modcal::report
