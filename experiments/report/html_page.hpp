// The report as one self-contained HTML page.
#pragma once

#include <set>

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

// The numbers of the page's charts, as the JSON text its script reads.

/// {"arrays": […], "figures": [{"id", "panels": […]}, …], "replay": …}. Arrays are written once,
/// whoever uses them: short ones as base64 of float64, long ones of float32 about an offset (7
/// digits of the span). "<" is escaped, so that no text can end the script element that holds it.
/// `replay`: the command that replays a task, without its number.
std::string chart_data_json(std::span<const DrawnFigure> figures, const std::string& replay = {});

/// Tags as a JSON object: {"noise": ["all", "5 %"]}.
std::string tags_text(const Tags& tags);

// Files embedded into the program when it is built: nothing is read when it runs.

extern const std::string_view kDygraphsScript;        // dygraph.min.js (MIT licence)
extern const std::string_view kDygraphsStyle;         // dygraph.min.css
extern const std::string_view kDygraphsSynchronizer;  // extras/synchronizer.js
extern const std::string_view kPageValues;            // page/values.js
extern const std::string_view kPageMarks;             // page/marks.js
extern const std::string_view kPageFilters;           // page/filters.js
extern const std::string_view kPagePrint;             // page/print.js
extern const std::string_view kPageScript;            // page/report.js
extern const std::string_view kPageStart;             // page/start.js
extern const std::string_view kPageStyle;             // page/report.css

}  // namespace modcal::report
