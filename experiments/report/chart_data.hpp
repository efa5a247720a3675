// The numbers of the page's charts, as the JSON text its script reads.
#pragma once

#include <span>
#include <string>

#include "experiments/report/drawing.hpp"

namespace modcal::report {

/// {"arrays": […], "figures": [{"id", "panels": […]}, …]}. Arrays are written once, whoever uses
/// them: short ones as base64 of float64, long ones of float32 about an offset (7 digits of the
/// span). "<" is escaped, so that no text can end the script element that holds it.
std::string chart_data_json(std::span<const DrawnFigure> figures);

/// RFC 4648 with padding.
std::string base64(std::span<const unsigned char> bytes);

}  // namespace modcal::report
