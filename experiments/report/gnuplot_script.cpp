#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "experiments/report/encoding.hpp"
#include "experiments/report/gnuplot_sheet.hpp"

namespace modcal::report {
namespace {

// Tics of a logarithmic axis that holds less than two powers of ten: 1, 2, 5, 10, …
std::string dense_tics(char name, const std::array<double, 2>& window) {
  std::vector<std::string> tics;
  double decade = std::pow(10.0, std::floor(std::log10(window[0])));
  while (decade <= window[1]) {
    for (const double multiple : {1.0, 2.0, 5.0}) {
      const double tic = multiple * decade;
      if (tic >= window[0] * (1.0 - 1e-9) && tic <= window[1] * (1.0 + 1e-9)) {
        tics.push_back(fmt::format("{:.6g}", tic));
      }
    }
    decade *= 10.0;
  }
  const bool is_plain = window[0] >= 1e-3 && window[1] < 1e5;
  return fmt::format("set logscale {0}; set format {0} '{1}'; set {0}tics ({2})\n", name,
                     is_plain ? "%g" : "%.0l×10^{%L}", fmt::join(tics, ","));
}

// f_c and f0 as symbols with subscripts, as the page has them; nothing else in the text is special.
std::string symbols(const std::string& text) {
  static const std::regex special(R"([\\^_{}@&~])");
  static const std::regex subscript(
      R"((^|[^A-Za-z0-9])([A-Za-z]|φ|ζ|σ|ε|ω)\\_([A-Za-z0-9]{1,2})(?![A-Za-z0-9_]))");
  static const std::regex numbered(
      R"((^|[^A-Za-z0-9/._])(f(?=0)|[RH](?=[12]))([012])(?![A-Za-z0-9_]))");
  const std::string plain = std::regex_replace(text, special, R"(\$&)");
  return std::regex_replace(std::regex_replace(plain, subscript, "$1$2_{$3}"), numbered,
                            "$1$2_{$3}");
}

// Every power of ten, or every second, third, … one where there are many.
std::string decade_tics(char name, const std::array<double, 2>& window, double most) {
  const double decades = std::log10(window[1] / window[0]);
  return fmt::format("set logscale {0}; set format {0} '10^{{%L}}'; set {0}tics {1:g}\n", name,
                     std::pow(10.0, std::max(1.0, std::ceil(decades / most))));
}

// Multiples of a step by name: on a logarithmic axis gnuplot takes a step for a factor.
std::string listed_tics(const std::array<double, 2>& window, double step) {
  std::vector<std::string> tics;
  for (double k = std::ceil(window[0] / step); k * step <= window[1]; ++k) {
    tics.push_back(fmt::format("{:.10g}", k * step));
  }
  return fmt::format("({})", fmt::join(tics, ","));
}

std::string axis_settings(char name, const Axis& axis, const std::array<double, 2>& window,
                          double length) {
  const bool upright = name == 'y';
  // What a narrow panel has room for.
  const double most = upright ? 6.5 : length < 3.0 ? 6.0 : 7.0;
  std::string text = fmt::format("set {}label {} offset {}\n", name,
                                 gnuplot_quoted(symbols(axis.text())), upright ? "0.5,0" : "0,0.5");
  const bool powers = axis.logarithmic && window[1] > 30.0 * window[0];
  const bool dense = axis.logarithmic && !powers && window[1] > 4.0 * window[0];
  if (powers) {
    text += decade_tics(name, window, most);
  } else if (dense) {
    text += dense_tics(name, window);
  } else {
    const double step = tic_step(window, length, most, upright);
    text +=
        fmt::format("{} logscale {}; set format {} '%h'; set {}tics {}\n",
                    axis.logarithmic ? "set" : "unset", name, name, name,
                    axis.logarithmic ? listed_tics(window, step) : fmt::format("{:.10g}", step));
  }
  return text + fmt::format("set {}range [{:.10g}:{:.10g}]\n", name, window[0], window[1]);
}

// Colour of a category under 18 % of white, as the page shows it.
std::string softened(std::string_view color) {
  std::string text = "#";
  for (const std::size_t at : {1u, 3u, 5u}) {
    const int part = std::stoi(std::string(color.substr(at, 2)), nullptr, 16);
    text += fmt::format("{:02x}", static_cast<int>(std::lround(0.82 * part + 0.18 * 255)));
  }
  return text;
}

// A reference is thin: what it is compared with, and its band, are to be seen beside it.
double line_width(const Look& look) { return look.dashed ? 1.1 : 1.3; }

// Long enough to be seen where it lies over another line, or over an area of many periods.
constexpr std::string_view kDashes = " dashtype (6,3)";

// A place on the sheet [in] as gnuplot takes it.
std::string at(const PrintSheet& sheet, double x, double y) {
  return fmt::format("screen {:.5f}, screen {:.5f}", x / sheet.width(), y / sheet.height());
}

std::string marker_commands(const DrawnPanel& drawn, const PrintSheet& sheet, std::size_t place) {
  std::string text;
  const std::vector<PlacedText> labels = sheet.marker_labels_of(place);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const Marker& marker = drawn.source->markers[i];
    const bool vertical = marker.direction == Marker::Direction::kVertical;
    if (!is_within(vertical ? drawn.x_window : drawn.y_window, marker.value)) continue;
    const std::string_view color = ink_of(marker.color).light;
    const auto end = [&](int share) {
      return vertical ? fmt::format("first {:.10g}, graph {}", marker.value, share)
                      : fmt::format("graph {}, first {:.10g}", share, marker.value);
    };
    text += fmt::format("set arrow from {} to {} nohead dashtype 3 linecolor rgb '{}'\n", end(0),
                        end(1), color);
    if (labels[i].text.empty()) continue;
    text += fmt::format("set label {} at {} {} textcolor rgb '{}'\n",
                        gnuplot_quoted(symbols(labels[i].text)),
                        at(sheet, labels[i].x, labels[i].y), vertical ? "center" : "left", color);
  }
  return text;
}

// The legend's entries: line, point or cell, and the text after it.
std::string legend_commands(const PrintSheet& sheet, std::size_t place) {
  std::string text;
  for (const auto& [entry, x, y] : sheet.legend_of(place)) {
    const double end = x - PrintSheet::kGap, begin = end - PrintSheet::kSample;
    const std::string middle = at(sheet, 0.5 * (begin + end), y);
    const Look& look = entry.look;
    const std::string_view color = look.ink->light;
    if (entry.is_cell) {
      text += fmt::format(
          "set object rectangle center {} size screen {:.5f}, screen {:.5f} fillcolor rgb '{}' "
          "fillstyle solid noborder\n",
          middle, 0.6 * (end - begin) / sheet.width(), 0.09 / sheet.height(), softened(color));
    } else if (look.line) {
      text += fmt::format("set arrow from {} to {} nohead linewidth {} linecolor rgb '{}'{}\n",
                          at(sheet, begin, y), at(sheet, end, y), line_width(look), color,
                          look.dashed ? kDashes : "");
    }
    if (look.points && !entry.is_cell) {
      text +=
          fmt::format("set label '' at {} point pointtype {} pointsize 0.5 linecolor rgb '{}'\n",
                      middle, look.ink->gnuplot_point, color);
    }
    text += fmt::format("set label {} at {} left\n", gnuplot_quoted(symbols(entry.label)),
                        at(sheet, x, y));
  }
  return text;
}

// Plot elements of one series, the data being block `index`.
std::vector<std::string> elements_of(const Figure& figure, const DrawnSeries& drawn,
                                     std::size_t index) {
  const Look& look = drawn.look;
  const Ink& ink = *look.ink;
  const std::string data = fmt::format("'{}.dat' index {}", figure.id, index);
  std::vector<std::string> elements;
  if (!drawn.low.empty() && !look.line) {
    elements.push_back(fmt::format(
        "{} using 1:2:3:4 with yerrorbars pointtype {} pointsize 0.01 linecolor rgb '{}' notitle",
        data, ink.gnuplot_point, ink.light));
  } else if (!drawn.low.empty()) {
    elements.push_back(
        fmt::format("{} using 1:3:4 with filledcurves fillstyle transparent solid 0.3 noborder "
                    "fillcolor rgb '{}' notitle",
                    data, ink.light));
  }
  std::string style = fmt::format("linecolor rgb '{}'", ink.light);
  if (look.points) style += fmt::format(" pointtype {} pointsize 0.5", ink.gnuplot_point);
  // Thinner within a band, which is often hardly wider.
  const bool banded = look.line && !drawn.low.empty();
  if (look.line) style += fmt::format(" linewidth {}", banded ? 0.9 : line_width(look));
  if (look.dashed) style += kDashes;
  elements.push_back(fmt::format("{} using 1:2 with {}{} {} notitle", data,
                                 look.line ? "lines" : "", look.points ? "points" : "", style));
  return elements;
}

// Plot elements of a map: boxes, one data block a category that has cells.
std::vector<std::string> map_elements(const Figure& figure, const CategoryMap& map,
                                      std::size_t& index) {
  std::vector<std::string> elements;
  for (std::size_t category = 0; category < map.categories.size(); ++category) {
    if (!has_cells(map, category)) continue;
    const std::string color = softened(ink_of(map.categories[category].color).light);
    elements.push_back(fmt::format(
        "'{}.dat' index {} using 1:2:3:4:5:6 with boxxyerror fillstyle solid noborder linecolor "
        "rgb '{}' notitle",
        figure.id, index++, color));
  }
  return elements;
}

// What is drawn of a panel; its data begin at block `index`, which moves on.
std::vector<std::string> panel_elements(const Figure& figure, const DrawnPanel& drawn,
                                        std::size_t& index) {
  std::vector<std::string> references, others;
  const bool banded = std::any_of(drawn.series.begin(), drawn.series.end(), [](const auto& series) {
    return series.look.line && !series.low.empty() && !series.source->hidden;
  });
  if (drawn.source->map) others = map_elements(figure, *drawn.source->map, index);
  for (const DrawnSeries& series : drawn.series) {
    if (!series.has_values() || series.source->hidden) continue;
    // A dashed reference would hide a narrow band about what is compared with it.
    const bool behind =
        banded && series.look.dashed && series.source->color == ColorRole::kReference;
    for (auto& element : elements_of(figure, series, index)) {
      (behind ? references : others).push_back(std::move(element));
    }
    ++index;
  }
  references.insert(references.end(), others.begin(), others.end());
  return references;
}

std::string frame_commands(const PrintSheet& sheet, const Frame& plot) {
  return fmt::format(
      "set lmargin at screen {:.5f}; set rmargin at screen {:.5f}\n"
      "set bmargin at screen {:.5f}; set tmargin at screen {:.5f}\n",
      plot.left / sheet.width(), plot.right / sheet.width(), plot.bottom / sheet.height(),
      plot.top / sheet.height());
}

std::string panel_commands(const DrawnFigure& figure, const PrintSheet& sheet, std::size_t place,
                           std::size_t& index) {
  const DrawnPanel& drawn = figure.panels[place];
  const Panel& panel = *drawn.source;
  const Frame plot = sheet.plot_of(place);
  std::string text = "unset arrow; unset label; unset object\n" + frame_commands(sheet, plot);
  for (const auto& [line, x, y] : sheet.title_of(place)) {
    text += fmt::format("set label {} at {} left font 'DejaVu Sans:Bold'\n",
                        gnuplot_quoted(symbols(line)), at(sheet, x, y));
  }
  text += legend_commands(sheet, place);
  text += axis_settings('x', panel.x, drawn.x_window, plot.width());
  text += axis_settings('y', panel.y, drawn.y_window, plot.height());
  text += marker_commands(drawn, sheet, place);
  if (!drawn.has_values()) {
    // gnuplot refuses to plot nothing: a line along the frame, fully transparent.
    return text + fmt::format(
                      "set label 'no data' at graph 0.5, graph 0.5 center\n"
                      "plot {:.10g} linecolor rgb '#ff000000' notitle\n",
                      drawn.y_window[0]);
  }
  const std::vector<std::string> elements = panel_elements(*figure.source, drawn, index);
  return text + fmt::format("plot {}\n", fmt::join(elements, ", \\\n     "));
}

}  // namespace

std::string gnuplot_script(const DrawnFigure& figure) {
  const PrintSheet sheet(figure);
  const std::string& id = figure.source->id;
  std::string text = fmt::format(
      "# {0}.svg and {0}.pdf: run \"gnuplot {0}.gp\" in this folder; the data are in {0}.dat.\n"
      "reset\n"
      "if (!exists(\"output_svg\")) output_svg = '{0}.svg'\n"
      "if (!exists(\"output_pdf\")) output_pdf = '{0}.pdf'\n"
      "set encoding utf8\nset minussign\n"
      "set style line 100 linecolor rgb '#d9d9d9' linewidth 0.5\n",
      id);
  const std::pair<std::string_view, std::string> terminals[] = {
      {"svg", fmt::format("svg size {:.0f},{:.0f} dynamic enhanced font 'DejaVu Sans,13' "
                          "background rgb 'white'",
                          96 * sheet.width(), 96 * sheet.height())},
      {"pdf", fmt::format("pdfcairo size {:.2f}in,{:.2f}in enhanced fontscale 1 "
                          "font 'DejaVu Sans,7.5'",
                          sheet.width(), sheet.height())}};
  for (const auto& [format, terminal] : terminals) {
    text += fmt::format("set terminal {}\n", terminal);
    text += fmt::format("set output output_{}\n", format);
    text += "set grid linestyle 100\n";
    text += "set border 3 linewidth 0.8\nset tics out nomirror scale 0.6\n";
    text += "unset key\nset multiplot\n";
    std::size_t index = 0;
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
      text += panel_commands(figure, sheet, i, index);
    }
    text += "unset multiplot\nunset output\n";
  }
  return text;
}

std::string gnuplot_quoted(std::string_view text) {
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return quoted(line, '\'', "''");
}

}  // namespace modcal::report
