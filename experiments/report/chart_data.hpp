// The numbers of the page's charts, as the JSON text its script reads.
#pragma once

#include <span>
#include <string>

#include "experiments/report/drawing.hpp"

namespace modcal::report {

/// {"arrays": […], "figures": [{"id", "panels": […]}, …], "replay": …}. Arrays are written once,
/// whoever uses them: short ones as base64 of float64, long ones of float32 about an offset (7
/// digits of the span). "<" is escaped, so that no text can end the script element that holds it.
/// `replay`: the command that replays a task, without its number.
std::string chart_data_json(std::span<const DrawnFigure> figures, const std::string& replay = {});

/// Tags as a JSON object: {"noise": ["all", "5 %"]}.
std::string tags_text(const Tags& tags);

}  // namespace modcal::report
