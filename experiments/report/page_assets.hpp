// Files embedded into the program when it is built: nothing is read when it runs.
#pragma once

#include <string_view>

namespace modcal::report {

extern const std::string_view kDygraphsScript;        // dygraph.min.js (MIT licence)
extern const std::string_view kDygraphsStyle;         // dygraph.min.css
extern const std::string_view kDygraphsSynchronizer;  // extras/synchronizer.js
extern const std::string_view kPageValues;            // page/values.js
extern const std::string_view kPageMarks;             // page/marks.js
extern const std::string_view kPageFilters;           // page/filters.js
extern const std::string_view kPageScript;            // page/report.js
extern const std::string_view kPageStyle;             // page/report.css

}  // namespace modcal::report
