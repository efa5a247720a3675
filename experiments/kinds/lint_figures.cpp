// Mistakes in the figures that an experiment asks for.
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <span>

#include "experiments/kinds/lint.hpp"

namespace modcal {

std::vector<Finding> lint_figure_windows(const std::vector<FigureOptions>& figures,
                                         double duration) {
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    for (std::size_t j = 0; j < figures[i].windows.size(); ++j) {
      lint_making(findings, fmt::format("figures.{}.windows.{}", i, j),
                  [&] { require_inside(figures[i].id, figures[i].windows[j], duration); });
    }
  }
  return findings;
}

std::vector<Finding> lint_figures(const std::vector<FigureOptions>& figures, FigureContent last,
                                  double duration) {
  std::vector<Finding> findings;
  if (!std::isnan(duration)) findings = lint_figure_windows(figures, duration);
  std::set<std::string> ids;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const FigureOptions& figure = figures[i];
    const std::string place = fmt::format("figures.{}", i);
    if (!report::is_file_stem(figure.id)) {
      add_finding(findings, place,
                  "\"{}\" cannot name a figure's files: use letters, digits, - and _", figure.id);
    }
    if (!ids.insert(figure.id).second) {
      add_finding(findings, place + ".id", "two figures have the id \"{}\": give each its own",
                  figure.id);
    }
    if (figure.quantities.empty()) {
      add_finding(findings, place, "figure {} has no quantities: name one, or leave the key out",
                  figure.id);
    }
    const bool identified = last >= FigureContent::kSpectra;
    for (const std::string& name : figure.quantities) {
      if (!identified || quantity_of(name).identified != nullptr) continue;
      add_finding(findings, place,
                  "figure {} draws {}, which is measured, not identified: use y, v or f_c",
                  figure.id, name);
    }
    if (figure.drawn() > last) {
      const auto contents = std::span(kFigureContents).first(static_cast<std::size_t>(last) + 1);
      add_finding(findings, place + ".content",
                  "figure {}: this kind of experiment has no {}; it has {}", figure.id,
                  figure.content, fmt::join(contents, ", "));
    }
  }
  return findings;
}

}  // namespace modcal
