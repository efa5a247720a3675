#include "libcalib/likelihood/mode_verdict.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace modcal {
namespace {

constexpr double kIdentified = 1e-3;

Eigen::MatrixXd law_slopes(Eigen::Index count, double inharmonicity) {
  Eigen::MatrixXd slopes(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double n2 = static_cast<double>((i + 1) * (i + 1));
    slopes(i, 0) = 1.0;
    slopes(i, 1) = 0.5 * n2 / (1.0 + inharmonicity * n2);
  }
  return slopes;
}

}  // namespace

std::string_view name_of(ModeSource source) {
  switch (source) {
    case ModeSource::kIdentified:
      return "identified";
    case ModeSource::kLaw:
      return "from the law";
    case ModeSource::kPrior:
      return "from the prior";
    case ModeSource::kBlind:
      return "blind";
    case ModeSource::kFixed:
      return "fixed";
  }
  return "";
}

std::string_view name_of(WeakReason reason) {
  switch (reason) {
    case WeakReason::kNone:
      return "";
    case WeakReason::kNode:
      return "node";
    case WeakReason::kAntinode:
      return "antinode";
    case WeakReason::kNoise:
      return "noise";
  }
  return "";
}

double estimate_law_width(const Eigen::VectorXd& delta, const Eigen::VectorXd& seen,
                          double inharmonicity) {
  const Eigen::MatrixXd slopes = law_slopes(delta.size(), inharmonicity);
  double variance = 0.0;
  for (int round = 0; round < 8; ++round) {
    Eigen::VectorXd weight = Eigen::VectorXd::Zero(delta.size());
    double count = 0.0;
    for (Eigen::Index i = 0; i < delta.size(); ++i) {
      if (seen[i] >= 5e-4) continue;
      weight[i] = 1.0 / (seen[i] * seen[i] + variance);
      count += 1.0;
    }
    if (count < 4.0) return kWidePrior;
    const Eigen::MatrixXd normal = slopes.transpose() * weight.asDiagonal() * slopes;
    const Eigen::VectorXd law =
        normal.ldlt().solve(slopes.transpose() * weight.asDiagonal() * delta);
    const Eigen::VectorXd rest = delta - slopes * law;
    // Σ w(r² − s²) over Σ w, two degrees of freedom spent on the law.
    const double excess =
        (weight.array() * (rest.array().square() * (count / (count - 2.0)) -
                           (weight.array() > 0.0).select(seen.array().square(), 0.0)))
            .sum();
    variance = std::max(0.0, excess / weight.sum());
  }
  return std::clamp(std::sqrt(variance), kTied, kWidePrior);
}

std::vector<bool> nodes(const ModalBasis& basis, const std::vector<double>& contacts) {
  constexpr double kNodeShape = 0.05;
  std::vector<bool> node(basis.size(), true);
  for (const double contact : contacts) {
    const std::vector<double> shape = basis.shape_at(contact);
    for (std::size_t n = 0; n < node.size(); ++n) {
      node[n] = node[n] && std::abs(shape[n]) < kNodeShape;
    }
  }
  return node;
}

void deny_noise(const Eigen::MatrixXd& information, const Eigen::MatrixXd& noise,
                const std::vector<bool>& node, Eigen::VectorXd& seen) {
  constexpr double kProof = 3.0, kNodeProof = 10.0;
  for (std::size_t n = 0; n < node.size(); ++n) {
    const auto i = static_cast<Eigen::Index>(n);
    const double proof = node[n] ? kNodeProof : kProof;
    if (information(i, i) < proof * noise(i, i)) seen[i] = std::max(seen[i], kWidePrior);
  }
}

Eigen::VectorXd prior_widths(const Eigen::VectorXd& seen, double width, double estimated) {
  Eigen::VectorXd widths = Eigen::VectorXd::Constant(seen.size(), width);
  for (Eigen::Index i = 0; i < seen.size(); ++i) {
    if (seen[i] > 0.7 * kWidePrior) widths[i] = std::min(width, estimated);
  }
  return widths;
}

WeakReason weak_reason(const ModelPoint& model, std::size_t index) {
  const double turn =
      static_cast<double>(index + 1) * std::numbers::pi * model.contact / model.basis.length;
  if (std::abs(std::sin(turn)) < 0.1) return WeakReason::kNode;
  if (std::abs(std::cos(turn)) < 0.2) return WeakReason::kAntinode;
  return WeakReason::kNoise;
}

std::vector<ModeVerdict> law_verdicts(const ModelPoint& model, double inharmonicity,
                                      const Eigen::Matrix2d& covariance) {
  const auto count = static_cast<Eigen::Index>(model.basis.size());
  const Eigen::MatrixXd slopes = law_slopes(count, inharmonicity);
  std::vector<ModeVerdict> verdicts(model.basis.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    const double variance = slopes.row(i) * covariance * slopes.row(i).transpose();
    ModeVerdict& verdict = verdicts[static_cast<std::size_t>(i)];
    verdict.frequency = model.basis.frequency(static_cast<std::size_t>(i));
    verdict.deviation = std::sqrt(std::max(variance, 0.0));
    verdict.data_deviation = verdict.deviation;
    verdict.source = ModeSource::kLaw;
  }
  return verdicts;
}

std::vector<ModeVerdict> free_verdicts(const ModelPoint& model, const Eigen::VectorXd& deviation,
                                       const Eigen::VectorXd& seen, double law_width) {
  std::vector<ModeVerdict> verdicts(model.basis.size());
  const std::vector<double> shape = model.basis.shape_at(model.contact);
  for (std::size_t n = 0; n < verdicts.size(); ++n) {
    const auto i = static_cast<Eigen::Index>(n);
    ModeVerdict& verdict = verdicts[n];
    verdict.frequency = model.basis.frequency(n);
    verdict.deviation = deviation[i];
    verdict.data_deviation = seen[i];
    if (seen[i] < kIdentified) continue;
    verdict.reason = weak_reason(model, n);
    // The law speaks for a mode where the other modes follow it closer than the mode is needed.
    verdict.deviation = std::max(deviation[i], std::min(law_width, kWidePrior));
    const bool law_holds = law_width < 0.5 * kIdentified;
    if (law_holds) {
      verdict.source = ModeSource::kLaw;
    } else {
      verdict.source = std::abs(shape[n]) < 0.02 ? ModeSource::kBlind : ModeSource::kPrior;
    }
  }
  return verdicts;
}

}  // namespace modcal
