#include "libcalib/identifiability/law_followers.hpp"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace modcal {
namespace {

using Index = Eigen::Index;

constexpr double kFewest = 4.0, kFewestTested = 8.0;

// The law through some modes, and what is left of all of them.
class LawLine {
 public:
  LawLine(const ModeSight& sight, double inharmonicity)
      : sight_(sight), slopes_(sight.delta.size(), 2), taken_(sight.delta.size(), false) {
    for (Index i = 0; i < size(); ++i) {
      const double n2 = static_cast<double>((i + 1) * (i + 1));
      slopes_.row(i) << 1.0, 0.5 * n2 / (1.0 + inharmonicity * n2);
      taken_[static_cast<std::size_t>(i)] = sight.seen[i] < kWellSeen;
    }
  }

  Index size() const { return sight_.delta.size(); }
  bool taken(Index i) const { return taken_[static_cast<std::size_t>(i)]; }
  void take_followers(const std::vector<LawTie>& ties) {
    for (std::size_t n = 0; n < ties.size(); ++n) {
      taken_[n] = ties[n] != LawTie::kLeaves && sight_.seen[static_cast<Index>(n)] < kWellSeen;
    }
  }
  double count() const {
    return static_cast<double>(std::count(taken_.begin(), taken_.end(), true));
  }
  const Eigen::VectorXd& rest() const { return rest_; }

  // τ² by the median of z² and the law by Huber's weights, then Tukey's, which drop what is far
  // off: a few modes that leave the law move neither.
  double robust_variance(double known) {
    constexpr double kHuber = 1.345, kTukey = 4.685;  // 95 % efficient where all follow
    double variance = std::isnan(known) ? kWidePrior * kWidePrior : known * known;
    rest_ = Eigen::VectorXd::Zero(size());
    for (int round = 0; round < 2 * kRobustRounds; ++round) {
      fit([&](Index i) {
        const double own = error2(i) + variance;
        const double z = std::abs(rest_[i]) / std::sqrt(own);
        if (round < kRobustRounds) return std::min(1.0, kHuber / std::max(z, 1e-300)) / own;
        const double left = 1.0 - z * z / (kTukey * kTukey);
        return left > 0.0 ? left * left / own : 0.0;
      });
      if (std::isnan(known)) variance = median_variance();
    }
    return variance;
  }

  // τ² by Σ w(r² − s²) over Σ w, two degrees of freedom spent on the law.
  double moment_variance(double known) {
    double variance = std::isnan(known) ? 0.0 : known * known;
    for (int round = 0; round < 8; ++round) {
      double sum = 0.0, excess = 0.0;
      fit([&](Index i) { return weight(i, variance); });
      for (Index i = 0; i < size(); ++i) {
        if (!taken(i)) continue;
        const double w = weight(i, variance);
        sum += w;
        excess += w * (rest_[i] * rest_[i] * (count() / (count() - 2.0)) - error2(i));
      }
      if (std::isnan(known)) variance = std::max(0.0, excess / sum);
    }
    return variance;
  }

  // Mean of τ² ≥ 0 under the normal law of its estimate by moments.
  double expected_variance(double variance) const {
    double sum = 0.0, square = 0.0;
    for (Index i = 0; i < size(); ++i) {
      if (!taken(i)) continue;
      sum += weight(i, variance);
      square += 2.0 * std::pow(weight(i, variance) * (error2(i) + variance), 2);
    }
    const double error = std::sqrt(square) / sum;
    if (!(error > 0.0)) return variance;  // every frequency is known exactly
    const double z = variance / error;
    return variance + error * gsl_ran_ugaussian_pdf(z) / gsl_cdf_ugaussian_P(z);
  }

  double score(Index i, double variance) const {
    const double law = slopes_.row(i) * covariance_ * slopes_.row(i).transpose();
    return rest_[i] / std::sqrt(error2(i) + variance + law);
  }

 private:
  double error2(Index i) const { return sight_.error[i] * sight_.error[i]; }
  // A frequency that is known exactly weighs as one known to kTied.
  double weight(Index i, double variance) const {
    return 1.0 / (error2(i) + std::max(variance, kTied * kTied));
  }

  template <class Weight>
  void fit(const Weight& weight_of) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (Index i = 0; i < size(); ++i) {
      if (!taken(i)) continue;
      const double w = weight_of(i);
      normal += w * slopes_.row(i).transpose() * slopes_.row(i);
      right += w * sight_.delta[i] * slopes_.row(i).transpose();
    }
    const Eigen::LDLT<Eigen::Matrix2d> factor(normal);
    rest_ = sight_.delta - slopes_ * factor.solve(right);
    covariance_ = factor.solve(Eigen::Matrix2d::Identity());
  }

  // τ² for which the median of r²/(s² + τ²) is that of χ²_1.
  double median_variance() const {
    double low = kTied * kTied, high = kWidePrior * kWidePrior;
    if (median_square(low) <= kMedian) return low;
    if (median_square(high) >= kMedian) return high;
    for (int halving = 0; halving < 40; ++halving) {
      const double middle = std::sqrt(low * high);
      (median_square(middle) > kMedian ? low : high) = middle;
    }
    return low;
  }
  double median_square(double variance) const {
    std::vector<double> squares;
    for (Index i = 0; i < size(); ++i) {
      if (taken(i)) squares.push_back(rest_[i] * rest_[i] / (error2(i) + variance));
    }
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), middle, squares.end());
    return *middle;
  }

  // Fixed by: the median of χ²_1, which is .4549.
  static constexpr double kMedian = 0.4549;
  const ModeSight& sight_;
  Eigen::MatrixXd slopes_;
  std::vector<bool> taken_;
  Eigen::VectorXd rest_;
  Eigen::Matrix2d covariance_ = Eigen::Matrix2d::Zero();
};

std::vector<LawTie> ties_of(const LawLine& line, double variance) {
  const double share = 0.5 * 0.0027 / static_cast<double>(line.size());
  const double leave = gsl_cdf_tdist_Qinv(share, std::max(1.0, line.count() - 2.0));
  std::vector<LawTie> ties;
  for (Index i = 0; i < line.size(); ++i) {
    const double score = std::abs(line.score(i, variance));
    ties.push_back(score > leave       ? LawTie::kLeaves
                   : score > kLawDoubt ? LawTie::kDoubtful
                                       : LawTie::kFollows);
  }
  return ties;
}

// Modes that leave the law, τ known or found.
LawFollowers followers_of(LawLine line, double width) {
  LawFollowers found = LawFollowers::all(line.size(), kWidePrior);
  if (line.count() < kFewest) return found;
  double variance = 0.0;
  if (line.count() < kFewestTested) {
    variance = line.moment_variance(width);
  } else {
    found.ties = ties_of(line, line.robust_variance(width));
    for (int round = 0; round < 8; ++round) {
      line.take_followers(found.ties);
      variance = line.moment_variance(width);
      std::vector<LawTie> ties = ties_of(line, std::max(variance, kTied * kTied));
      if (ties == found.ties) break;
      found.ties = std::move(ties);
    }
    found.rest = line.rest();
  }
  found.width = std::clamp(std::sqrt(variance), kTied, kWidePrior);
  found.scatter = std::sqrt(line.expected_variance(variance));
  return found;
}

// Most that a pole nearer to mode m than to any other moves mode n by, over what it moves m by:
// |c² − m²|/|c² − n²| grows with the distance from m on either side.
double reach(Index m, Index n) {
  const auto squared = [](double x) { return x * x; };
  const double own = squared(static_cast<double>(m + 1)),
               other = squared(static_cast<double>(n + 1));
  double most = 0.0;
  for (const double side : {-0.5, 0.5}) {
    const double pole = squared(static_cast<double>(m + 1) + side);
    most = std::max(most, std::abs(pole - own) / std::abs(pole - other));
  }
  return most;
}

}  // namespace

std::string_view name_of(LawTie tie) {
  constexpr std::string_view kNames[] = {"follows", "doubtful", "leaves"};
  return kNames[static_cast<std::size_t>(tie)];
}

LawFollowers LawFollowers::all(Eigen::Index modes, double width) {
  return {.width = width,
          .prior_width = width,
          .scatter = width,
          .ties = std::vector(static_cast<std::size_t>(modes), LawTie::kFollows),
          .rest = Eigen::VectorXd::Zero(modes)};
}

Eigen::VectorXd LawFollowers::scatters() const {
  Eigen::VectorXd widths = disturbances();
  for (Eigen::Index i = 0; i < widths.size(); ++i) {
    const LawTie tie = ties[static_cast<std::size_t>(i)];
    widths[i] = tie == LawTie::kLeaves     ? kDeparted
                : tie == LawTie::kDoubtful ? std::max(scatter, kWidePrior)
                                           : std::hypot(std::max(scatter, 1e-3 * kTied), widths[i]);
  }
  return widths;
}

Eigen::VectorXd LawFollowers::disturbances() const {
  const auto size = static_cast<Index>(ties.size());
  Eigen::VectorXd most = Eigen::VectorXd::Zero(size);
  const auto leaves = [this](Index n) {
    return ties[static_cast<std::size_t>(n)] == LawTie::kLeaves;
  };
  for (Index m = 0; m < size; ++m) {
    for (Index n = 0; leaves(m) && n < size; ++n) {
      if (leaves(n)) continue;
      most[n] = std::max(most[n], std::abs(rest[m]) * reach(m, n));
    }
  }
  return most;
}

std::size_t LawFollowers::leaving() const {
  return static_cast<std::size_t>(std::count(ties.begin(), ties.end(), LawTie::kLeaves));
}

LawFollowers find_followers(const ModeSight& sight, double inharmonicity, double width) {
  const LawLine line(sight, inharmonicity);
  const LawFollowers estimated = followers_of(line, std::numeric_limits<double>::quiet_NaN());
  if (std::isnan(width)) {
    LawFollowers found = estimated;
    found.prior_width = found.width;
    return found;
  }
  LawFollowers found = followers_of(line, width);
  found.width = estimated.width;
  found.scatter = estimated.scatter;
  found.prior_width = width;
  return found;
}

}  // namespace modcal
