// What the figures of a benchmark have in common: a panel an objective, a look a search, tags.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/kinds/benchmark/benchmark_report.hpp"

namespace modcal {

/// Index of no condition: a series over all of them.
inline constexpr std::size_t kAllConditions = static_cast<std::size_t>(-1);

/// Empty series of a method with its label, look and tags, for one condition or for all. That of
/// one condition is hidden until a filter asks for it.
report::Series method_series(const BenchmarkGrid& grid, std::size_t method, std::size_t condition,
                             report::SeriesStyle style);
report::Tags method_tags(const BenchmarkGrid& grid, std::size_t method);
/// Values of the tag "condition" of what belongs to one condition and is shown among all, too.
report::Tag condition_tag(const BenchmarkGrid& grid, std::size_t condition);

/// One panel an objective, with the series that `add` puts into it for each of its methods; panels
/// without any are left out.
std::vector<report::Panel> objective_panels(
    const BenchmarkGrid& grid, const report::Axis& x, const report::Axis& y,
    const std::function<void(std::size_t method, report::Panel& panel)>& add);

/// Puts the panels side by side.
report::Figure panel_figure(std::string id, std::string title, std::string caption,
                            std::vector<report::Panel> panels);

/// All conditions together, then, where there are several, each.
std::vector<std::size_t> condition_choices(const BenchmarkGrid& grid);

/// `count` indices of [0, size), evenly spread, first and last among them; all where they fit.
std::vector<std::size_t> spread_indices(std::size_t size, std::size_t count);

}  // namespace modcal
