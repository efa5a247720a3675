#include "experiments/report/gnuplot_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace modcal::report {
namespace {

// Lengths in inches of a sheet that a journal prints as it is.
constexpr double kEm =
    10.0 / 72.0;  // of the font, for which pdfcairo wants three quarters of its points
constexpr double kLine = 0.18;  // from one line of text to the next
constexpr double kLeft = 1.0, kRight = 0.2, kTop = 0.1, kBottom = 0.55, kEdge = 0.12;
constexpr double kBetween = 0.2;       // entries of a legend
constexpr double kWidestLabel = 0.35;  // of a marker, as a share of its panel

// Width of a letter of DejaVu Sans in ems; what is not ASCII is taken for a letter of middle width.
double letter_width(char32_t letter) {
  struct Group {
    std::string_view letters;
    double width;
  };
  static constexpr Group kGroups[] = {{"ijl|!.,:;'/-IJ\\ ", 0.34},
                                      {"()[]ftr\"", 0.42},
                                      {"CDGHNOQU&", 0.79},
                                      {"w#+<=>~^", 0.84},
                                      {"mMW@%", 1.0}};
  if (letter >= 128) return 0.7;
  for (const auto& [letters, width] : kGroups) {
    if (letters.find(static_cast<char>(letter)) != std::string_view::npos) return width;
  }
  return letter >= U'A' && letter <= U'Z' ? 0.7 : 0.64;
}

// The text in lines not wider than `width`, broken between words.
std::vector<std::string> lines_of(const std::string& text, double width) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    begin = end + 1;
    if (!lines.empty() && printed_width(lines.back() + ' ' + word) <= width) {
      lines.back() += ' ' + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

double entry_width(const LegendEntry& entry) {
  return PrintSheet::kSample + PrintSheet::kGap + printed_width(entry.label);
}

std::size_t lines_in(const std::vector<PlacedEntry>& entries) {
  return entries.empty() ? 0
                         : 1 + static_cast<std::size_t>(
                                   std::lround((entries.front().y - entries.back().y) / kLine));
}

// Width of the widest label that a horizontal marker has.
double widest_level_label(const DrawnPanel& panel) {
  double widest = 0.0;
  for (const Marker& marker : panel.source->markers) {
    if (marker.direction == Marker::Direction::kVertical || marker.label.empty()) continue;
    if (is_within(panel.y_window, marker.value)) {
      widest = std::max(widest, printed_width(marker.label));
    }
  }
  return widest;
}

}  // namespace

double printed_width(std::string_view text) {
  double ems = 0.0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte & 0xC0u) == 0x80u) continue;  // inside a letter of several bytes
    ems += letter_width(byte);
  }
  return kEm * ems;
}

bool is_within(const std::array<double, 2>& window, double value) {
  return value >= window[0] && value <= window[1];
}

double share_in(const std::array<double, 2>& window, double value, bool logarithmic) {
  const auto place = [&](double x) { return logarithmic ? std::log(x) : x; };
  return (place(value) - place(window[0])) / (place(window[1]) - place(window[0]));
}

double tic_step(const std::array<double, 2>& window, double length, double most, bool upright) {
  const double span = window[1] - window[0];
  double decade = std::pow(10.0, std::floor(std::log10(span / most)));
  for (;; decade *= 10.0) {
    for (const double multiple : {1.0, 2.0, 5.0}) {
      const double step = multiple * decade;
      if (span / step > most) continue;
      const double first = std::ceil(window[0] / step);
      double widest = kLine;
      for (int k = 0; !upright && k <= static_cast<int>(most); ++k) {
        widest = std::max(widest, printed_width(fmt::format("{:.6g}", (first + k) * step)));
      }
      const double needed = upright ? widest : widest + 0.6 * kEm;
      if (needed <= length * step / span || step > span) return step;
    }
  }
}

bool has_cells(const CategoryMap& map, std::size_t category) {
  return std::count(map.cells.begin(), map.cells.end(), static_cast<int>(category)) > 0;
}

std::vector<LegendEntry> printed_legend(const DrawnPanel& panel) {
  std::vector<LegendEntry> entries;
  std::size_t category = 0;
  for (const LegendEntry& entry : panel.legend) {
    if (!entry.is_cell || has_cells(*panel.source->map, category++)) entries.push_back(entry);
  }
  return entries;
}

PrintSheet::PrintSheet(const DrawnFigure& figure)
    : figure_(figure),
      columns_(std::min(figure.source->columns, figure.panels.size())),
      shared_(!figure.legend.empty() && figure.panels.size() > 1) {
  rows_ = (figure.panels.size() + columns_ - 1) / columns_;
  panel_width_ = columns_ == 1 ? 6.4 : columns_ == 2 ? 4.4 : 3.3;
  plot_height_ = columns_ == 1 ? 2.55 : rows_ <= 2 ? 2.0 : 1.4;
  width_ = panel_width_ * static_cast<double>(columns_);
  for (const DrawnPanel& panel : figure.panels) {
    right_margin_ = std::max(right_margin_, widest_level_label(panel));
    // A long label along the axis may reach beyond its lower end, not over the sheet's.
    plot_height_ = std::max(plot_height_, printed_width(panel.source->y.text()) - 0.6 * kBottom);
  }
  right_margin_ = kRight + std::min(right_margin_, kWidestLabel * panel_width_);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    title_lines_ = std::max(title_lines_, title_of(i).size());
    if (!shared_) legend_lines_ = std::max(legend_lines_, lines_in(own_legend(i)));
    const auto labels = upright_labels(i);
    for (const PlacedText& label : labels) {
      if (label.text.empty()) continue;
      const double above = label.y - plot_of(i).top;
      label_lines_ = std::max(label_lines_, static_cast<std::size_t>(std::ceil(above / kLine)));
    }
  }
  if (shared_) {
    const auto entries = flow(figure.legend, kLeft, width_ - kEdge, 0.0);
    shared_legend_ = kLine * static_cast<double>(lines_in(entries)) + kTop;
  }
  panel_height_ = kTop + kLine * static_cast<double>(title_lines_ + legend_lines_ + label_lines_) +
                  kTop + plot_height_ + kBottom;
  height_ = panel_height_ * static_cast<double>(rows_) + shared_legend_;
}

Frame PrintSheet::panel_of(std::size_t panel) const {
  const std::size_t row = panel / columns_, column = panel % columns_;
  const double left = panel_width_ * static_cast<double>(column);
  const double top = height_ - shared_legend_ - panel_height_ * static_cast<double>(row);
  return {left, left + panel_width_, top - panel_height_, top};
}

Frame PrintSheet::plot_of(std::size_t panel) const {
  const Frame all = panel_of(panel);
  const double bottom = all.bottom + kBottom;
  return {all.left + kLeft, all.right - right_margin_, bottom, bottom + plot_height_};
}

double PrintSheet::text_right(std::size_t panel) const { return panel_of(panel).right - kEdge; }

std::vector<PlacedText> PrintSheet::title_of(std::size_t panel) const {
  const double left = plot_of(panel).left;
  // A little above the legend.
  double y = panel_of(panel).top - kTop - 0.35 * kLine;
  std::vector<PlacedText> lines;
  // A bold letter is a tenth wider.
  for (std::string& line :
       lines_of(figure_.panels[panel].source->title, (text_right(panel) - left) / 1.12)) {
    lines.push_back({std::move(line), left, y});
    y -= kLine;
  }
  return lines;
}

std::vector<PlacedEntry> PrintSheet::flow(const std::vector<LegendEntry>& entries, double left,
                                          double right, double top) const {
  std::vector<PlacedEntry> placed;
  double x = left, y = top - 0.5 * kLine;
  for (const LegendEntry& entry : entries) {
    const double wide = entry_width(entry);
    if (x > left && x + wide > right) {
      x = left;
      y -= kLine;
    }
    placed.push_back({entry, x + kSample + kGap, y});
    x += wide + kBetween;
  }
  return placed;
}

std::vector<PlacedEntry> PrintSheet::own_legend(std::size_t panel) const {
  const std::vector<LegendEntry> entries = printed_legend(figure_.panels[panel]);
  double widest = 0.0;
  for (const LegendEntry& entry : entries) widest = std::max(widest, entry_width(entry));
  const double right = text_right(panel);
  const double left =
      plot_of(panel).left + widest <= right ? plot_of(panel).left : panel_of(panel).left + kEdge;
  const double titles = kLine * static_cast<double>(title_lines_);
  return flow(entries, left, right, panel_of(panel).top - kTop - titles);
}

std::vector<PlacedEntry> PrintSheet::legend_of(std::size_t panel) const {
  if (!shared_) return own_legend(panel);
  if (panel > 0) return {};
  return flow(figure_.legend, kLeft, width_ - kEdge, height_ - kTop);
}

std::vector<PlacedText> PrintSheet::upright_labels(std::size_t panel) const {
  const DrawnPanel& drawn = figure_.panels[panel];
  const Frame plot = plot_of(panel);
  std::vector<PlacedText> labels(drawn.source->markers.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const Marker& marker = drawn.source->markers[i];
    if (marker.direction == Marker::Direction::kHorizontal || marker.label.empty()) continue;
    if (!is_within(drawn.x_window, marker.value)) continue;
    const double half = 0.5 * printed_width(marker.label);
    const double share = share_in(drawn.x_window, marker.value, drawn.source->x.logarithmic);
    const double x = std::min(plot.left + share * plot.width(), text_right(panel) - half);
    double y = plot.top + 0.5 * kLine;
    const auto in_the_way = [&](const PlacedText& other) {
      return !other.text.empty() && std::abs(other.y - y) < 0.5 * kLine &&
             std::abs(other.x - x) < half + 0.5 * printed_width(other.text) + kEm;
    };
    while (std::any_of(labels.begin(), labels.end(), in_the_way)) y += kLine;
    labels[i] = {marker.label, x, y};
  }
  return labels;
}

std::vector<PlacedText> PrintSheet::level_labels(std::size_t panel) const {
  const DrawnPanel& drawn = figure_.panels[panel];
  const Frame plot = plot_of(panel);
  std::vector<PlacedText> labels(drawn.source->markers.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const Marker& marker = drawn.source->markers[i];
    if (marker.direction == Marker::Direction::kVertical || marker.label.empty()) continue;
    if (!is_within(drawn.y_window, marker.value)) continue;
    double y = plot.bottom +
               plot.height() * share_in(drawn.y_window, marker.value, drawn.source->y.logarithmic);
    const auto in_the_way = [&](const PlacedText& other) {
      return !other.text.empty() && std::abs(other.y - y) < 0.9 * kLine;
    };
    while (std::any_of(labels.begin(), labels.end(), in_the_way)) y -= 0.9 * kLine;
    labels[i] = {marker.label, plot.right + 0.5 * kGap, y};
  }
  return labels;
}

std::vector<PlacedText> PrintSheet::marker_labels_of(std::size_t panel) const {
  std::vector<PlacedText> labels = upright_labels(panel);
  const std::vector<PlacedText> level = level_labels(panel);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!level[i].text.empty()) labels[i] = level[i];
  }
  return labels;
}

}  // namespace modcal::report
