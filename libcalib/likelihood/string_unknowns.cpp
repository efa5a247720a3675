#include "libcalib/likelihood/string_unknowns.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace modcal {

StringUnknowns StringUnknowns::law(const ModelPoint& reference, double fundamental,
                                   double inharmonicity) {
  StringUnknowns unknowns;
  unknowns.reference_ = reference;
  unknowns.fundamental_ = fundamental;
  unknowns.inharmonicity_ = inharmonicity;
  unknowns.law_ = true;
  return unknowns;
}

StringUnknowns StringUnknowns::frequencies(const ModelPoint& reference) {
  StringUnknowns unknowns;
  unknowns.reference_ = reference;
  return unknowns;
}

StringUnknowns StringUnknowns::with_fixed_damping() const {
  StringUnknowns unknowns = *this;
  unknowns.damping_ = false;
  return unknowns;
}

Eigen::VectorXd StringUnknowns::start() const {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(size());
  if (law_) theta[1] = inharmonicity_;
  return theta;
}

double StringUnknowns::fundamental(const Eigen::VectorXd& theta) const {
  return fundamental_ * std::exp(theta[0]);
}

bool StringUnknowns::admits(const Eigen::VectorXd& theta) const {
  if (!theta.allFinite()) return false;
  const double x = reference_.contact + theta[contact()];
  const double top = static_cast<double>(modes());
  // The damping may change fiftyfold, f_0 by a third: beyond that it is another string.
  return x > 1e-4 * reference_.basis.length && x < (1.0 - 1e-4) * reference_.basis.length &&
         (!damping_ || std::abs(theta[damping()]) < 4.0) &&
         (!law_ || (1.0 + theta[1] * top * top > 0.25 && std::abs(theta[0]) < 0.3));
}

ModelPoint StringUnknowns::model(const Eigen::VectorXd& theta) const {
  ModelPoint point = reference_;
  for (std::size_t i = 0; i < modes(); ++i) {
    const double n = static_cast<double>(i + 1);
    point.basis.omega[i] =
        law_ ? 2.0 * std::numbers::pi * n * fundamental(theta) * std::sqrt(1.0 + theta[1] * n * n)
             : reference_.basis.omega[i] * std::exp(theta[static_cast<Eigen::Index>(i)]);
    if (damping_) point.basis.zeta[i] = reference_.basis.zeta[i] * std::exp(theta[damping()]);
  }
  point.contact += theta[contact()];
  return point;
}

LikelihoodColumns StringUnknowns::columns(const Eigen::VectorXd& theta) const {
  LikelihoodColumns columns{.count = static_cast<std::size_t>(size()),
                            .share_begin = {0},
                            .contact = static_cast<std::size_t>(contact())};
  for (std::size_t i = 0; i < modes(); ++i) {
    const double n2 = static_cast<double>((i + 1) * (i + 1));
    if (law_) {
      columns.shares.push_back({0, 1.0, 0.0});
      columns.shares.push_back({1, 0.5 * n2 / (1.0 + theta[1] * n2), 0.0});
    } else {
      columns.shares.push_back({i, 1.0, 0.0});
    }
    if (damping_) columns.shares.push_back({static_cast<std::size_t>(damping()), 0.0, 1.0});
    columns.share_begin.push_back(columns.shares.size());
  }
  return columns;
}

Eigen::MatrixXd law_prior(const Eigen::VectorXd& widths, double inharmonicity) {
  const Eigen::VectorXd weight = widths.cwiseAbs2().cwiseInverse();
  Eigen::MatrixXd law(widths.size(), 2);
  for (Eigen::Index i = 0; i < widths.size(); ++i) {
    const double n2 = static_cast<double>((i + 1) * (i + 1));
    law(i, 0) = 1.0;
    // Scaled: B of order 1/N² moves the top mode by a sensible share.
    law(i, 1) =
        n2 / (1.0 + inharmonicity * n2) / static_cast<double>(widths.size() * widths.size());
  }
  const Eigen::MatrixXd weighted = weight.asDiagonal() * law;
  Eigen::MatrixXd precision = weight.asDiagonal();
  precision -= weighted * (law.transpose() * weighted).inverse() * weighted.transpose();
  return precision;
}

}  // namespace modcal
