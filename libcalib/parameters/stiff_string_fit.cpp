#include "libcalib/parameters/stiff_string_fit.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "libcalib/parameters/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/result_visitor.hpp"
#include "libsim/model/string_model.hpp"

namespace modcal {
namespace {

// Modes that take part: number n, frequency, square root of the weight.
struct Lines {
  Eigen::ArrayXd n, frequency, root_weight;
};

Lines lines_of(std::span<const double> frequencies, std::span<const double> weights) {
  MODCAL_REQUIRE(weights.empty() || weights.size() == frequencies.size(),
                 "{} weights were given for {} frequencies", weights.size(), frequencies.size());
  std::vector<double> n, f, w;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    const double weight = weights.empty() ? 1.0 : weights[i];
    MODCAL_REQUIRE(weight >= 0.0 && std::isfinite(weight),
                   "weight {:g} of mode {} must be finite and >= 0", weight, i + 1);
    if (weight == 0.0) continue;
    MODCAL_REQUIRE(frequencies[i] > 0.0 && std::isfinite(frequencies[i]),
                   "frequency {:g} Hz of mode {} must be > 0", frequencies[i], i + 1);
    n.push_back(static_cast<double>(i + 1));
    f.push_back(frequencies[i]);
    w.push_back(std::sqrt(weight));
  }
  MODCAL_REQUIRE(n.size() >= 2,
                 "the law has two constants, {} modes have weight: at least two are needed",
                 n.size());
  const auto array = [](const std::vector<double>& values) {
    return Eigen::ArrayXd(
        Eigen::Map<const Eigen::ArrayXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  return {array(n), array(f), array(w)};
}

using Law = Eigen::Vector2d;  // f₀, B

void require_law(const Law& law, double highest) {
  MODCAL_REQUIRE(law[0] > 0.0 && 1.0 + law[1] * highest * highest > 0.0,
                 "the frequencies follow no stiff-string law: the fit gives f0^2 or 1 + B n^2 <= 0 "
                 "(f0 = {:g} Hz, B = {:g}); check the numbering of the modes",
                 law[0], law[1]);
}

// f_n²/n² is linear in (f₀², f₀² B); its error is 2 f_n/n² times that of f_n.
Law linear_start(const Lines& lines) {
  const Eigen::ArrayXd square = lines.n * lines.n;
  const Eigen::ArrayXd weight = lines.root_weight * square / (2.0 * lines.frequency);
  Eigen::MatrixX2d matrix(square.size(), 2);
  matrix.col(0) = weight;
  matrix.col(1) = weight * square;
  const Eigen::VectorXd right = weight * lines.frequency.square() / square;
  const Law solution = matrix.colPivHouseholderQr().solve(right);
  Law law{std::sqrt(solution[0]), solution[1] / solution[0]};
  require_law(law, lines.n.maxCoeff());
  return law;
}

Eigen::VectorXd residuals(const Lines& lines, const Law& law) {
  const Eigen::ArrayXd root = (1.0 + law[1] * lines.n.square()).sqrt();
  return lines.root_weight * (lines.frequency - lines.n * law[0] * root);
}

// Derivatives of the law, weighted. The second column is per unit of B.
Eigen::MatrixX2d jacobian(const Lines& lines, const Law& law) {
  const Eigen::ArrayXd root = (1.0 + law[1] * lines.n.square()).sqrt();
  Eigen::MatrixX2d result(lines.n.size(), 2);
  result.col(0) = lines.root_weight * lines.n * root;
  result.col(1) = lines.root_weight * 0.5 * law[0] * lines.n.cube() / root;
  return result;
}

void refine(const Lines& lines, Law& law, StiffStringFit& fit) {
  double cost = residuals(lines, law).squaredNorm();
  while (fit.iterations < kLineFitSteps && !fit.converged) {
    ++fit.iterations;
    const Law step = jacobian(lines, law).colPivHouseholderQr().solve(residuals(lines, law)).eval();
    double share = 1.0;
    Law next = law + step;
    double next_cost = residuals(lines, next).squaredNorm();
    // Halved until the cost does not rise; NaN (1 + B n² < 0) counts as a rise.
    for (; !(next_cost <= cost) && share > 1e-12;
         next_cost = residuals(lines, next).squaredNorm()) {
      share *= 0.5;
      next = law + share * step;
    }
    const double n_top = lines.n.maxCoeff();
    const double change = std::abs(step[0]) / law[0] + std::abs(step[1]) * n_top * n_top;
    fit.converged = change < 1e-13 || !(next_cost < cost);
    if (next_cost <= cost) {
      law = next;
      cost = next_cost;
    }
  }
}

}  // namespace

double StiffStringFit::frequency(std::size_t n) const {
  return stiff_string_frequency(fundamental, inharmonicity, n);
}

StiffStringFit fit_stiff_string(std::span<const double> frequencies,
                                std::span<const double> weights) {
  const Lines lines = lines_of(frequencies, weights);
  StiffStringFit fit;
  fit.modes = static_cast<std::size_t>(lines.n.size());
  Law law = linear_start(lines);
  refine(lines, law, fit);
  fit.fundamental = law[0];
  fit.inharmonicity = law[1];
  const double cost = residuals(lines, law).squaredNorm();
  fit.rms_residual = std::sqrt(cost / lines.root_weight.square().sum());
  if (fit.modes > 2) {
    const Eigen::MatrixX2d slopes = jacobian(lines, law);
    const Eigen::Matrix2d information = slopes.transpose() * slopes;
    const Eigen::Matrix2d covariance =
        information.inverse() * (cost / static_cast<double>(fit.modes - 2));
    fit.fundamental_deviation = std::sqrt(covariance(0, 0));
    fit.inharmonicity_deviation = std::sqrt(covariance(1, 1));
  }
  return fit;
}

std::vector<double> fill_unexcited_modes(std::span<const double> frequencies,
                                         const std::vector<bool>& excited,
                                         const StiffStringFit& fit) {
  MODCAL_REQUIRE(frequencies.size() == excited.size(),
                 "{} frequencies and {} excitation marks do not belong together",
                 frequencies.size(), excited.size());
  std::vector<double> filled(frequencies.begin(), frequencies.end());
  for (std::size_t i = 0; i < filled.size(); ++i) {
    if (!excited[i]) filled[i] = fit.frequency(i + 1);
  }
  return filled;
}

double without_rounding(double inharmonicity) {
  return std::abs(inharmonicity) < 1e-12 ? 0.0 : inharmonicity;
}

std::string inharmonicity_text(double inharmonicity, double deviation) {
  if (without_rounding(inharmonicity) == 0.0) return "0";
  const bool near_zero = std::abs(inharmonicity) < 3.0 * deviation;
  return fmt::format("{:.4g}{}", inharmonicity,
                     near_zero ? fmt::format(" (sd {:.2g})", deviation) : std::string());
}

void StiffStringFit::visit(ResultVisitor& visitor) const {
  visitor({.key = "f0_hz", .name = "f_0", .unit = "Hz", .format = "{:.4f}"}, fundamental);
  visitor({.key = "f0_sd_hz", .name = "its deviation", .unit = "Hz", .format = "{:.2g}"},
          known(fundamental_deviation));
  visitor({.key = "B", .format = "{:.4e}"}, inharmonicity);
  visitor({.key = "B_sd", .name = "its deviation ", .format = "{:.2g}"},
          known(inharmonicity_deviation));
}

}  // namespace modcal
