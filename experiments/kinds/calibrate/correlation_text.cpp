#include "experiments/kinds/calibrate/correlation_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libcalib/parameters/parameter_table.hpp"

namespace modcal {

std::string shown_unit(const std::string& parameter) {
  if (parameter == "damping") return "(factor)";
  const std::string unit(unit_of_parameter(parameter));
  return unit == "1" ? "" : unit;
}

std::string correlations_with(const std::vector<std::string>& names,
                              const std::vector<double>& correlations) {
  std::string text = "correlations";
  for (std::size_t j = 0; j < correlations.size(); ++j) {
    text += fmt::format(" {} {:+.2f}", names[j], correlations[j]);
  }
  return text;
}

std::string correlation_lines(const NamedCovariance& covariance) {
  std::size_t width = 8;
  for (const std::string& name : covariance.names) width = std::max(width, name.size());
  const Eigen::MatrixXd correlations = covariance.correlations();
  std::string text;
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    std::vector<double> before;
    for (std::size_t j = 0; j < i; ++j) {
      before.push_back(correlations(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
    text += fmt::format("  {:<{}} sd {:<9.3g} {:<9} {}\n", covariance.names[i], width,
                        covariance.deviation(i), shown_unit(covariance.names[i]),
                        correlations_with(covariance.names, before));
  }
  return text;
}

}  // namespace modcal
