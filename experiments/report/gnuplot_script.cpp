#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "experiments/report/drawing.hpp"
#include "experiments/report/encoding.hpp"

namespace modcal::report {
namespace {

// Sizes of a sheet of panels [in].
struct Sheet {
  std::size_t columns, rows;
  double width, height, legend;

  explicit Sheet(const DrawnFigure& figure)
      : columns(std::min(figure.source->columns, figure.panels.size())),
        rows((figure.panels.size() + columns - 1) / columns),
        legend(figure.shared_legend ? 0.3 : 0.0) {
    const double panel_width = columns == 1 ? 6.4 : columns == 2 ? 4.4 : 3.3;
    const double panel_height = columns == 1 ? 3.4 : 2.2;
    width = panel_width * static_cast<double>(columns);
    height = panel_height * static_cast<double>(rows) + legend;
  }

  std::string layout() const {
    constexpr double kLeft = 1.0, kRight = 0.2, kTop = 0.32, kBottom = 0.55;
    return fmt::format(
        "set multiplot layout {},{} rowsfirst margins screen {:.4f},{:.4f},{:.4f},{:.4f} "
        "spacing screen {:.4f},{:.4f}\n",
        rows, columns, kLeft / width, 1.0 - kRight / width, kBottom / height,
        1.0 - (kTop + legend) / height, (kLeft + kRight) / width, (kTop + kBottom) / height);
  }
};

// Distance of four to six tics over the window: 1, 2 or 5 times a power of ten.
double tic_step(const std::array<double, 2>& window) {
  const double least = (window[1] - window[0]) / 6.5;
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double multiple : {1.0, 2.0, 5.0}) {
    if (multiple * decade >= least) return multiple * decade;
  }
  return 10.0 * decade;
}

// Tics of a logarithmic axis that holds less than two powers of ten: 1, 2, 5, 10, …
std::string dense_tics(char name, const std::array<double, 2>& window) {
  std::vector<std::string> tics;
  for (double decade = std::pow(10.0, std::floor(std::log10(window[0]))); decade <= window[1];
       decade *= 10.0) {
    for (const double multiple : {1.0, 2.0, 5.0}) {
      const double tic = multiple * decade;
      if (tic >= window[0] * (1.0 - 1e-9) && tic <= window[1] * (1.0 + 1e-9)) {
        tics.push_back(fmt::format("{:.6g}", tic));
      }
    }
  }
  return fmt::format("set logscale {0}; set format {0} '%g'; set {0}tics ({1})\n", name,
                     fmt::join(tics, ","));
}

// f_c as a symbol with a subscript; nothing else in the text is special.
std::string symbols(const std::string& text) {
  static const std::regex special(R"([\\^_{}@&~])");
  static const std::regex subscript(
      R"((^|[^A-Za-z0-9])([A-Za-z]|φ)\\_([A-Za-z0-9]{1,2})(?![A-Za-z0-9_]))");
  const std::string plain = std::regex_replace(text, special, R"(\$&)");
  return std::regex_replace(plain, subscript, "$1$2_{$3}");
}

std::string axis_settings(char name, const Axis& axis, const std::array<double, 2>& window) {
  std::string text =
      fmt::format("set {}label {} offset {}\n", name, gnuplot_quoted(symbols(axis.text())),
                  name == 'x' ? "0,0.5" : "0.5,0");
  const bool dense = axis.logarithmic && window[1] < 30.0 * window[0];
  text += dense ? dense_tics(name, window)
          : axis.logarithmic
              ? fmt::format("set logscale {0}; set format {0} '10^{{%L}}'; set {0}tics autofreq\n",
                            name)
              : fmt::format("unset logscale {0}; set format {0} '%h'; set {0}tics {1:.10g}\n", name,
                            tic_step(window));
  return text + fmt::format("set {}range [{:.10g}:{:.10g}]\n", name, window[0], window[1]);
}

// Share of the window's width at which a value stands.
double place_in(const std::array<double, 2>& window, double value, bool logarithmic) {
  const auto place = [&](double x) { return logarithmic ? std::log(x) : x; };
  return (place(value) - place(window[0])) / (place(window[1]) - place(window[0]));
}

std::string marker_commands(const DrawnPanel& drawn) {
  std::string text;
  for (const Marker& marker : drawn.source->markers) {
    const bool vertical = marker.direction == Marker::Direction::kVertical;
    const std::string_view color = ink_of(marker.color).light;
    const auto at = [&](const char* share) {
      return vertical ? fmt::format("first {:.10g}, graph {}", marker.value, share)
                      : fmt::format("graph {}, first {:.10g}", share, marker.value);
    };
    text += fmt::format("set arrow from {} to {} nohead dashtype 3 linecolor rgb '{}'\n", at("0"),
                        at("1"), color);
    if (marker.label.empty()) continue;
    const bool on_the_right =
        !vertical || place_in(drawn.x_window, marker.value, drawn.source->x.logarithmic) > 0.6;
    text += fmt::format("set label {} at {} {} offset {} noenhanced textcolor rgb '{}' front\n",
                        gnuplot_quoted(marker.label), at(vertical ? "0.94" : "0.99"),
                        on_the_right ? "right" : "left",
                        vertical ? (on_the_right ? "-0.5,0" : "0.5,0") : "0,0.6", color);
  }
  return text;
}

// Plot elements of one series, the data being block `index`.
std::vector<std::string> elements_of(const Figure& figure, const DrawnSeries& drawn,
                                     std::size_t index, bool titled) {
  const Look& look = drawn.look;
  const Ink& ink = *look.ink;
  const std::string& label = drawn.source->label;
  const std::string data = fmt::format("'{}.dat' index {}", figure.id, index);
  const std::string title =
      titled && !label.empty() ? "title " + gnuplot_quoted(label) + " noenhanced" : "notitle";
  std::vector<std::string> elements;
  if (!drawn.low.empty() && !look.line) {
    elements.push_back(fmt::format(
        "{} using 1:2:3:4 with yerrorbars pointtype {} pointsize 0.01 linecolor rgb '{}' notitle",
        data, ink.gnuplot_point, ink.light));
  } else if (!drawn.low.empty()) {
    elements.push_back(
        fmt::format("{} using 1:3:4 with filledcurves fillstyle transparent solid 0.2 noborder "
                    "fillcolor rgb '{}' notitle",
                    data, ink.light));
  }
  std::string style = fmt::format("linecolor rgb '{}'", ink.light);
  if (look.points) style += fmt::format(" pointtype {} pointsize 0.5", ink.gnuplot_point);
  if (look.line) style += " linewidth 1.3";
  if (look.dotted) style += " dashtype 3";
  elements.push_back(fmt::format("{} using 1:2 with {}{} {} {}", data, look.line ? "lines" : "",
                                 look.points ? "points" : "", style, title));
  return elements;
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

bool has_cells(const CategoryMap& map, std::size_t category) {
  return std::count(map.cells.begin(), map.cells.end(), static_cast<int>(category)) > 0;
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
    elements.push_back(
        fmt::format("keyentry with boxes fillstyle solid noborder linecolor rgb '{}' title {} "
                    "noenhanced",
                    color, gnuplot_quoted(map.categories[category].label)));
  }
  return elements;
}

std::string number(double value) {
  return std::isnan(value) ? std::string("NaN") : fmt::format("{:.9g}", value);
}

// Cells of one category, neighbours of a row put together: middle, left, right, low, high.
std::string category_data(const CategoryMap& map, std::size_t category) {
  std::string text;
  const std::size_t columns = map.columns();
  const auto is_here = [&](std::size_t row, std::size_t column) {
    return map.cells[row * columns + column] == static_cast<int>(category);
  };
  for (std::size_t row = 0; row < map.rows(); ++row) {
    for (std::size_t begin = 0; begin < columns; ++begin) {
      if (!is_here(row, begin)) continue;
      std::size_t end = begin + 1;
      while (end < columns && is_here(row, end)) ++end;
      const double left = map.x_edges[begin], right = map.x_edges[end];
      const double low = map.y_edges[row], high = map.y_edges[row + 1];
      text += fmt::format("{} {} {} {} {} {}\n", number(0.5 * (left + right)),
                          number(0.5 * (low + high)), number(left), number(right), number(low),
                          number(high));
      begin = end;
    }
  }
  return text;
}

std::string panel_commands(const DrawnFigure& figure, std::size_t place, std::size_t& index) {
  const DrawnPanel& drawn = figure.panels[place];
  const Panel& panel = *drawn.source;
  const bool shared = figure.shared_legend;
  std::string text = "unset arrow; unset label\n";
  text += fmt::format("set label {} at graph 0, graph 1 left offset 0,0.6 noenhanced\n",
                      gnuplot_quoted(panel.title));
  text += axis_settings('x', panel.x, drawn.x_window);
  text += axis_settings('y', panel.y, drawn.y_window);
  text += shared ? "set key at screen 0.5, screen 0.995 center top horizontal samplen 2\n"
                 : "set key at graph 1, graph 1.02 right bottom horizontal samplen 1.5\n";
  text += marker_commands(drawn);
  if (!drawn.has_values()) {
    // gnuplot refuses to plot nothing: a line along the frame, fully transparent.
    return text + fmt::format(
                      "set label 'no data' at graph 0.5, graph 0.5 center\n"
                      "plot {:.10g} linecolor rgb '#ff000000' notitle\n",
                      drawn.y_window[0]);
  }
  std::vector<std::string> elements;
  if (panel.map) elements = map_elements(*figure.source, *panel.map, index);
  for (const DrawnSeries& series : drawn.series) {
    if (!series.has_values() || series.source->hidden) continue;
    const bool titled = !shared || place == 0;
    for (auto& element : elements_of(*figure.source, series, index, titled)) {
      elements.push_back(std::move(element));
    }
    ++index;
  }
  return text + fmt::format("plot {}\n", fmt::join(elements, ", \\\n     "));
}

}  // namespace

std::string gnuplot_script(const DrawnFigure& figure) {
  const Sheet sheet(figure);
  const std::string& id = figure.source->id;
  std::string text = fmt::format(
      "# {0}.svg and {0}.pdf: run \"gnuplot {0}.gp\" in this folder; the data are in {0}.dat.\n"
      "reset\n"
      "if (!exists(\"output_svg\")) output_svg = '{0}.svg'\n"
      "if (!exists(\"output_pdf\")) output_pdf = '{0}.pdf'\n"
      "set encoding utf8\n"
      "set style line 100 linecolor rgb '#d9d9d9' linewidth 0.5\n",
      id);
  const std::pair<std::string_view, std::string> terminals[] = {
      {"svg", fmt::format("svg size {:.0f},{:.0f} dynamic enhanced font 'DejaVu Sans,11' "
                          "background rgb 'white'",
                          96 * sheet.width, 96 * sheet.height)},
      {"pdf", fmt::format("pdfcairo size {:.2f}in,{:.2f}in enhanced fontscale 1 "
                          "font 'DejaVu Sans,7.5'",
                          sheet.width, sheet.height)}};
  for (const auto& [format, terminal] : terminals) {
    text += fmt::format("set terminal {}\n", terminal);
    text += fmt::format("set output output_{}\n", format);
    text += "set grid linestyle 100\n";
    text += "set border 3 linewidth 0.8\nset tics out nomirror scale 0.6\n";
    text += sheet.layout();
    std::size_t index = 0;
    for (std::size_t i = 0; i < figure.panels.size(); ++i) {
      text += panel_commands(figure, i, index);
    }
    text += "unset multiplot\nunset output\n";
  }
  return text;
}

std::string gnuplot_data(const DrawnFigure& figure) {
  std::string text;
  for (const DrawnPanel& panel : figure.panels) {
    const CategoryMap* map = panel.source->map ? &*panel.source->map : nullptr;
    for (std::size_t i = 0; map != nullptr && i < map->categories.size(); ++i) {
      if (!has_cells(*map, i)) continue;
      if (!text.empty()) text += "\n\n";
      text += category_data(*map, i);
    }
    for (const DrawnSeries& drawn : panel.series) {
      if (!drawn.has_values() || drawn.source->hidden) continue;
      if (!text.empty()) text += "\n\n";
      for (std::size_t i = 0; i < drawn.x.size(); ++i) {
        text += number(drawn.x[i]) + ' ' + number(drawn.y[i]);
        if (!drawn.low.empty()) text += ' ' + number(drawn.low[i]) + ' ' + number(drawn.high[i]);
        text += '\n';
      }
    }
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
