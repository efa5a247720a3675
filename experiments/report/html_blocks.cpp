#include "experiments/report/html_blocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "experiments/report/encoding.hpp"
#include "experiments/report/typeset.hpp"

namespace modcal::report {
namespace {

std::string legend_html(const std::vector<LegendEntry>& legend) {
  std::string html;
  for (const auto& [label, look, is_cell] : legend) {
    const std::string text = html_escaped(label);
    html += fmt::format(
        "<span class=\"key\"{}><span class=\"mark{} ink-{}\" "
        "aria-hidden=\"true\">{}</span>{}</span>",
        is_cell ? "" : " data-label=\"" + text + "\"",
        is_cell       ? " cell"
        : look.dashed ? " dashed"
        : look.line   ? " line"
                      : "",
        look.ink->name, look.points ? look.ink->glyph : "", typeset_html(label));
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
  html += fmt::format("<span class=\"title\">{}</span>", typeset_html(panel.title));
  if (legend_in_panel)
    html += fmt::format("<span class=\"keys\">{}</span>", legend_html(drawn.legend));
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
                     typeset_html(name), unit);
}

std::string cell_html(const Cell& cell, const Column& column, bool is_text) {
  const std::string text = cell_text(cell, column);
  const auto* const number = std::get_if<double>(&cell.value);
  const bool is_undefined = cell.shown.empty() && number != nullptr && std::isnan(*number);
  std::string kind = is_text ? "text" : "number";
  std::string mark;
  if (cell.highlight == Highlight::kPass) {
    kind += " pass";
    mark = " <span class=\"verdict\" title=\"passed\">✓</span>";
  } else if (cell.highlight == Highlight::kFail || is_undefined) {
    kind += " fail";
    mark = " <span class=\"verdict\" title=\"failed\">✗</span>";
  }
  std::string more;
  if (cell.heat >= 0.0) {
    kind += " heat";
    more += fmt::format(" style=\"--h:{:.2f}\"", std::min(cell.heat, 1.0));
  }
  if (cell.task >= 0) more += fmt::format(" data-task=\"{}\"", cell.task);
  return fmt::format("<td class=\"{}\"{}>{}{}</td>", kind, more, typeset_html(text), mark);
}

// Whether a figure has room beside another one.
bool is_narrow(const Block& block) {
  const auto* figure = std::get_if<Figure>(&block);
  return figure && figure->columns == 1 &&
         std::ranges::none_of(figure->panels,
                              [](const Panel& panel) { return panel.map.has_value(); });
}

}  // namespace

std::string command_html(const std::string& command) {
  if (command.empty()) return {};
  return fmt::format(
      "<details class=\"command\"><summary>Reproduce this</summary><code>{}</code></details>\n",
      html_escaped(command));
}

std::string box_html(std::string_view kind, std::string_view name, const std::string& text) {
  return fmt::format("<div class=\"box {}\" role=\"note\"><strong>{}</strong>{}</div>\n", kind,
                     name, html_paragraphs(text));
}

std::string BlockWriter::section(const Section& section, bool is_answer) {
  is_answer_ = is_answer;
  std::string html;
  bool in_row = false;
  for (const Block& block : section.blocks) {
    if (in_row != is_narrow(block)) html += in_row ? "</div>\n" : "<div class=\"row\">\n";
    in_row = is_narrow(block);
    html += std::visit(*this, block);
  }
  return html + (in_row ? "</div>\n" : "");
}

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
      figure.id, figure.columns, typeset_html(figure.title),
      drawn.legend.empty() ? "" : "<span class=\"keys\">" + legend_html(drawn.legend) + "</span>");
  for (std::size_t i = 0; i < drawn.panels.size(); ++i) {
    html += panel_html(drawn.panels[i], i, drawn.legend.empty());
  }
  html += "</div>\n<figcaption>" + html_paragraphs(figure.caption);
  for (const std::string& note : drawn.notes) {
    html += "<p class=\"remark\">" + html_escaped(note) + "</p>\n";
  }
  html += links_html(links_, links_.figures + "/" + figure.id,
                     {{".svg", "SVG"}, {".pdf", "PDF"}, {".csv", "CSV"}, {".gp", "gnuplot"}});
  return html + command_html(figure.command) + "</figcaption></figure>\n";
}

namespace {

// Of rows that have none of what only some results have: the files keep such columns.
std::vector<bool> columns_without_values(const Table& table) {
  std::vector<bool> is_empty(table.columns.size(), !table.rows.empty());
  for (const auto& row : table.rows) {
    for (std::size_t j = 0; j < row.size(); ++j) {
      const bool none = std::holds_alternative<std::monostate>(row[j].value);
      if (!none || !row[j].shown.empty() || row[j].task >= 0) is_empty[j] = false;
    }
  }
  return is_empty;
}

}  // namespace

std::string BlockWriter::operator()(const Table& table) const {
  constexpr std::size_t kShownRows = 12;
  const bool folded = !is_answer_ && table.rows.size() > kShownRows;
  std::string html = fmt::format("<div class=\"table\" id=\"{}\">", table.id);
  html += folded ? fmt::format("<details class=\"fold\"><summary><h3>{}</h3> {} rows</summary>\n",
                               typeset_html(table.title), table.rows.size())
                 : fmt::format("<h3>{}</h3>\n", typeset_html(table.title));
  html += "<div class=\"scroll\"><table><thead><tr>";
  const std::vector<bool> is_empty = columns_without_values(table);
  std::vector<bool> is_text(table.columns.size());
  for (std::size_t j = 0; j < table.columns.size(); ++j) {
    if (is_empty[j]) continue;
    is_text[j] = std::any_of(table.rows.begin(), table.rows.end(), [j](const auto& row) {
      return std::holds_alternative<std::string>(row[j].value);
    });
    html += heading_html(table.columns[j], is_text[j]);
  }
  html += "</tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto& row = table.rows[i];
    html += "<tr" + (table.row_tags.empty() ? "" : tags_attribute(table.row_tags[i])) + ">";
    for (std::size_t j = 0; j < row.size(); ++j) {
      if (!is_empty[j]) html += cell_html(row[j], table.columns[j], is_text[j]);
    }
    html += "</tr>\n";
  }
  html += "</tbody></table></div>\n<div class=\"about\">" + html_paragraphs(table.caption);
  html += links_html(links_, table.id, {{".csv", "CSV"}, {".json", "JSON"}});
  return html + command_html(table.command) +
         (folded ? "</div></details></div>\n" : "</div></div>\n");
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

}  // namespace modcal::report
