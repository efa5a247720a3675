// The report as one self-contained HTML page.
#pragma once

#include <set>
#include <span>
#include <string>

#include "experiments/report/drawing.hpp"
#include "experiments/report/report.hpp"

namespace modcal::report {

/// What the page links to beside itself.
struct PageLinks {
  /// Names, relative to the page, of the files that exist; only those are linked.
  std::set<std::string> files = {};
  /// Folder of the figures' files, relative to the page.
  std::string figures = "figures";
  /// Said at the top of the page as a warning, e.g. that no vector figures could be drawn.
  std::string warning = {};
};

/// Page without any outside resource (its policy forbids them). `figures`: the report's figures in
/// reading order, `data`: chart_data_json() of them.
std::string html_page(const Report& report, std::span<const DrawnFigure> figures,
                      const std::string& data, const PageLinks& links);

}  // namespace modcal::report
