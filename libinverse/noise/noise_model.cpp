#include "libinverse/noise/noise_model.hpp"

#include <algorithm>
#include <cmath>

#include "libinverse/noise/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

constexpr std::size_t kNoiseTerms = NoiseRow::kNoise, kTerms = NoiseRow::kTerms;

Index place(std::size_t knot, std::size_t term) { return static_cast<Index>(knot * kTerms + term); }

}  // namespace

NoiseModel::NoiseModel(std::vector<NoiseRow> rows, const NoiseKnots& knots)
    : rows_(std::move(rows)), knots_(knots.count), per_octave_(knots.per_octave) {
  const auto place_of = [&knots](const NoiseRow& row) {
    return static_cast<double>(knots.count - 1) -
           static_cast<double>(knots.per_octave) * row.octaves;
  };
  std::erase_if(rows_, [&](const NoiseRow& row) { return place_of(row) < 0.0; });
  for (NoiseRow& row : rows_) {
    const double place = place_of(row);
    row.knot = std::min(static_cast<std::size_t>(place), knots.count - 2);
    row.next = place - static_cast<double>(row.knot);
  }
}

Eigen::VectorXd NoiseModel::white() const {
  return Eigen::VectorXd::Zero(static_cast<Index>(kNoiseTerms * knots_));
}

double NoiseModel::fit(const NoiseForm& form, Eigen::VectorXd& factors) const {
  const Eigen::MatrixXd tied = ties(form);
  const Eigen::MatrixXd bond = bonds();
  const auto objective = [&](const Eigen::VectorXd& at) {
    return deviance(covariances(at)) + at.dot(bond * at);
  };
  double least = objective(factors), damping = 1e-3;
  for (int step = 0; step < 60 && damping < 1e6; ++step) {
    const Sums sum = sums(covariances(factors));
    const Eigen::MatrixXd by = slopes(factors);
    Eigen::MatrixXd own = tied.transpose() * (by.transpose() * sum.information * by + bond) * tied;
    own.diagonal() *= 1.0 + damping;
    const Eigen::VectorXd change = SemidefiniteSolver(own).solve(
        tied.transpose() * (by.transpose() * sum.excess - bond * factors));
    const Eigen::VectorXd there = factors + tied * change.cwiseMax(-1.0).cwiseMin(1.0);
    const double won = least - objective(there);
    damping *= won > 0.0 ? 0.1 : 10.0;
    if (!(won > 0.0)) continue;
    factors = there;
    least -= won;
    if (won < 1e-2) break;
  }
  return deviance(covariances(factors));
}

NoiseModel::Excess NoiseModel::excess(const NoiseForm& form, const Eigen::VectorXd& factors) const {
  const Sums sum = sums(covariances(factors));
  const Eigen::MatrixXd tied = slopes(factors) * ties(form);
  Eigen::MatrixXd signal = Eigen::MatrixXd::Zero(tied.rows(), static_cast<Index>(knots_));
  for (std::size_t j = 0; j < knots_; ++j) {
    signal(place(j, kNoiseTerms), static_cast<Index>(j)) = 1.0;
  }
  const Eigen::VectorXd excess = signal.transpose() * sum.excess;
  Eigen::MatrixXd information = signal.transpose() * sum.information * signal;
  const Eigen::MatrixXd own = tied.transpose() * sum.information * tied;
  const Eigen::MatrixXd cross = tied.transpose() * sum.information * signal;
  information -= cross.transpose() * SemidefiniteSolver(own).solve(cross);
  Excess result;
  // Knots by themselves: they hardly overlap. Of less information than one bin has nothing is told.
  for (Index j = 0; j < excess.size(); ++j) {
    if (!(information(j, j) > 1.0)) continue;
    const double root = excess[j] / std::sqrt(information(j, j));
    result.statistic += root * root;
    result.above += root;
    result.degrees += 1.0;
  }
  return result;
}

double NoiseModel::largest_run(const Eigen::VectorXd& factors, std::size_t length) const {
  const Eigen::VectorXd theta = covariances(factors);
  double largest = 0.0;
  for (std::size_t first = 0; first + length <= rows_.size(); first += length) {
    double power = 0.0;
    for (std::size_t i = first; i < first + length; ++i) {
      power += rows_[i].power / variance(rows_[i], theta);
    }
    largest = std::max(largest, power);
  }
  return largest;
}

NoiseSpectrum NoiseModel::spectrum(const NoiseForm& form, const Eigen::VectorXd& factors,
                                   double top) const {
  NoiseSpectrum result;
  const Eigen::VectorXd theta = covariances(factors);
  for (std::size_t j = form.levels > 1 ? 0 : knots_ - 1; j < knots_; ++j) {
    const double* at = theta.data() + place(j, 0);
    const double octaves = static_cast<double>(knots_ - 1 - j) / static_cast<double>(per_octave_);
    result.knots.push_back({top * std::exp2(-octaves), {at[0], at[1], at[2]}});
  }
  return result;
}

double NoiseModel::variance(const NoiseRow& row, const Eigen::VectorXd& theta) const {
  const double* at = theta.data() + place(row.knot, 0);
  double sum = 0.0;
  for (std::size_t t = 0; t < kNoiseTerms; ++t) {
    sum += row.by[t] * (at[t] + row.next * (at[kTerms + t] - at[t]));
  }
  return sum;
}

double NoiseModel::deviance(const Eigen::VectorXd& theta) const {
  double sum = 0.0;
  for (const NoiseRow& row : rows_) {
    const double v = variance(row, theta);
    sum += 2.0 * (std::log(v) + row.power / v);
  }
  return sum;
}

NoiseModel::Sums NoiseModel::sums(const Eigen::VectorXd& theta) const {
  Sums sum{Eigen::VectorXd::Zero(theta.size()), Eigen::MatrixXd::Zero(theta.size(), theta.size())};
  Eigen::Matrix<double, 2 * kTerms, 1> slope;
  for (const NoiseRow& row : rows_) {
    const double v = variance(row, theta);
    for (std::size_t t = 0; t < kTerms; ++t) {
      const auto i = static_cast<Index>(t);
      slope[i] = (1.0 - row.next) * row.by[t] / v;
      slope[i + static_cast<Index>(kTerms)] = row.next * row.by[t] / v;
    }
    const Index first = place(row.knot, 0);
    sum.excess.segment<2 * kTerms>(first) += (row.power / v - 1.0) * slope;
    sum.information.block<2 * kTerms, 2 * kTerms>(first, first) += slope * slope.transpose();
  }
  return sum;
}

// The factors by what a form has free.
Eigen::MatrixXd NoiseModel::ties(const NoiseForm& form) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(static_cast<Index>(kNoiseTerms * knots_),
                                                 static_cast<Index>(form.parameters()));
  Index column = 0;
  for (std::size_t t = 0; t < kNoiseTerms; ++t) {
    const std::size_t count = t < 2 ? form.levels : form.coherence;
    for (std::size_t j = 0; j < knots_ && count > 0; ++j) {
      result(static_cast<Index>(j * kNoiseTerms + t),
             column + static_cast<Index>(count == 1 ? 0 : j)) = 1.0;
    }
    column += static_cast<Index>(count);
  }
  return result;
}

Eigen::VectorXd NoiseModel::covariances(const Eigen::VectorXd& factors) const {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(static_cast<Index>(kTerms * knots_));
  for (std::size_t j = 0; j < knots_; ++j) {
    const double* of = factors.data() + j * kNoiseTerms;
    double* at = theta.data() + place(j, 0);
    at[0] = std::exp(2.0 * of[0]);
    at[1] = std::exp(2.0 * of[1]) * (1.0 + of[2] * of[2]);
    at[2] = std::exp(of[0] + of[1]) * of[2];
  }
  return theta;
}

// ∂θ by the factors.
Eigen::MatrixXd NoiseModel::slopes(const Eigen::VectorXd& factors) const {
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(static_cast<Index>(kTerms * knots_), factors.size());
  for (std::size_t j = 0; j < knots_; ++j) {
    const double* of = factors.data() + j * kNoiseTerms;
    const double a = std::exp(of[0]), d = std::exp(of[1]), mixed = a * d * of[2];
    by.block<kNoiseTerms, kNoiseTerms>(place(j, 0), static_cast<Index>(j * kNoiseTerms))
        << 2.0 * a * a,
        0.0, 0.0, 0.0, 2.0 * d * d * (1.0 + of[2] * of[2]), 2.0 * d * d * of[2], mixed, mixed,
        a * d;
  }
  return by;
}

// Squares of the differences between the factors of neighboring knots over what is usual.
Eigen::MatrixXd NoiseModel::bonds() const {
  constexpr double kStiffness = 1.0 / (kOctave * kOctave);
  const auto size = static_cast<Index>(kNoiseTerms * knots_);
  const auto next = static_cast<Index>(kNoiseTerms);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  for (Index i = 0; i + next < size; ++i) {
    result(i, i) += kStiffness, result(i + next, i + next) += kStiffness;
    result(i, i + next) -= kStiffness, result(i + next, i) -= kStiffness;
  }
  return result;
}

}  // namespace modcal
