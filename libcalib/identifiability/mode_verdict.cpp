#include "libcalib/identifiability/mode_verdict.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/identifiability/tuning.hpp"

namespace modcal {
namespace {

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
    case WeakReason::kDoubt:
      return "data and law disagree";
  }
  return "";
}

std::vector<bool> nodes(const ModalBasis& basis, const std::vector<double>& contacts) {
  std::vector<bool> node(basis.size(), true);
  for (const double contact : contacts) {
    const std::vector<double> shape = basis.shape_at(contact);
    for (std::size_t n = 0; n < node.size(); ++n) {
      node[n] = node[n] && std::abs(shape[n]) < kNodeShape;
    }
  }
  return node;
}

ModeSight sight_of(const Eigen::VectorXd& delta, const Eigen::VectorXd& deviation,
                   const Eigen::MatrixXd& information, const Eigen::MatrixXd& noise,
                   const std::vector<bool>& node) {
  constexpr double kProof = 3.0, kNodeProof = 10.0, kSurprise = 100.0;
  ModeSight sight{.delta = delta,
                  .seen = deviation,
                  .error = deviation,
                  .surprise = std::vector<bool>(node.size())};
  for (std::size_t n = 0; n < node.size(); ++n) {
    const auto i = static_cast<Eigen::Index>(n);
    const double proof = node[n] ? kNodeProof : kProof;
    const bool proven = information(i, i) >= proof * noise(i, i);
    if (!proven) sight.seen[i] = std::max(deviation[i], kWidePrior);
    if (!proven || node[n]) sight.error[i] = 2.0 * deviation[i];
    sight.surprise[n] = node[n] && information(i, i) < kSurprise * noise(i, i);
  }
  return sight;
}

void deny_surprises(LawFollowers& followers, ModeSight& sight) {
  for (std::size_t n = 0; n < sight.surprise.size(); ++n) {
    if (!sight.surprise[n] || followers.ties[n] == LawTie::kFollows) continue;
    const auto i = static_cast<Eigen::Index>(n);
    followers.ties[n] = LawTie::kFollows;
    sight.seen[i] = std::max(sight.seen[i], kWidePrior);
  }
}

void leave_out_of_band(const ModelPoint& model, double highest, ModeSight& sight) {
  for (std::size_t n = 0; model.higher && n < model.basis.size(); ++n) {
    if (model.basis.omega[n] < highest) continue;
    const auto i = static_cast<Eigen::Index>(n);
    sight.seen[i] = std::max(sight.seen[i], kWidePrior);
    sight.error[i] = std::max(sight.error[i], kWidePrior);
  }
}

void doubt_rivals(const std::vector<Neighbor>& neighbors, ModeSight& sight) {
  for (std::size_t n = 0; n < neighbors.size(); ++n) {
    if (!neighbors[n].is_rival()) continue;
    const auto i = static_cast<Eigen::Index>(n);
    sight.seen[i] = std::max(sight.seen[i], kWidePrior);
    sight.error[i] = std::max(sight.error[i], std::abs(neighbors[n].shift));
  }
}

Eigen::VectorXd prior_widths(const Eigen::VectorXd& seen, double width, double estimated) {
  Eigen::VectorXd widths = Eigen::VectorXd::Constant(seen.size(), width);
  for (Eigen::Index i = 0; i < seen.size(); ++i) {
    if (seen[i] > 0.7 * kWidePrior) widths[i] = std::min(width, estimated);
  }
  return widths;
}

void release(const LawFollowers& followers, ModeSight& sight, Eigen::VectorXd& widths) {
  const Eigen::VectorXd disturbances = followers.disturbances();
  for (Eigen::Index i = 0; i < widths.size(); ++i) {
    const LawTie tie = followers.ties[static_cast<std::size_t>(i)];
    widths[i] = std::hypot(widths[i], disturbances[i]);
    if (tie == LawTie::kFollows) continue;
    widths[i] = std::max(widths[i], tie == LawTie::kLeaves ? kDeparted : kWidePrior);
    if (tie == LawTie::kLeaves) sight.seen[i] = std::min(sight.seen[i], sight.error[i]);
  }
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
                                       const Eigen::VectorXd& seen, const LawFollowers& followers) {
  std::vector<ModeVerdict> verdicts(model.basis.size());
  const std::vector<double> shape = model.basis.shape_at(model.contact);
  const double law_width = followers.width;
  for (std::size_t n = 0; n < verdicts.size(); ++n) {
    const auto i = static_cast<Eigen::Index>(n);
    ModeVerdict& verdict = verdicts[n];
    verdict.frequency = model.basis.frequency(n);
    verdict.deviation = deviation[i];
    verdict.data_deviation = seen[i];
    verdict.tie = followers.ties[n];
    if (verdict.tie == LawTie::kDoubtful) {
      verdict.reason = WeakReason::kDoubt;
      verdict.deviation = std::hypot(deviation[i], followers.rest[i]);
    }
    if (seen[i] < kIdentifiedSight) continue;
    if (verdict.tie != LawTie::kDoubtful) {
      verdict.reason = weak_reason(model, n);
      // Where neither law nor data have it, it is anywhere that its prior admits.
      const double width =
          verdict.tie == LawTie::kLeaves ? kDeparted : std::min(law_width, kWidePrior);
      verdict.deviation = std::max(deviation[i], width);
    }
    // The law speaks for a mode where the other modes follow it closer than the mode is needed.
    if (verdict.tie == LawTie::kFollows && law_width < 0.5 * kIdentifiedSight) {
      verdict.source = ModeSource::kLaw;
    } else {
      verdict.source = std::abs(shape[n]) < 0.02 ? ModeSource::kBlind : ModeSource::kPrior;
    }
  }
  return verdicts;
}

void raise_to_verdicts(const std::vector<ModeVerdict>& modes, NamedCovariance& covariance) {
  for (std::size_t n = 0; n < modes.size(); ++n) {
    covariance.raise(fmt::format("f_{}", n + 1), modes[n].frequency * modes[n].deviation);
  }
}

std::vector<std::size_t> not_following(const std::vector<ModeVerdict>& modes) {
  std::vector<std::size_t> found;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    if (modes[n].tie != LawTie::kFollows) found.push_back(n);
  }
  return found.size() + 2 > modes.size() ? std::vector<std::size_t>{} : found;
}

void report_departures(std::span<const ScoreTest> tests, ContinuationResult& result) {
  double suspicion = 0.0;
  for (const ScoreTest& test : tests) {
    if (test.moves_modes_off_law()) suspicion = std::max(suspicion, test.suspicion());
  }
  const FoundLaw& law = result.found_law;
  for (std::size_t n = 0; n < result.modes.size(); ++n) {
    ModeVerdict& mode = result.modes[n];
    mode.departure =
        mode.frequency / stiff_string_frequency(law.fundamental, law.inharmonicity, n + 1) - 1.0;
    if (mode.tie == LawTie::kFollows) continue;
    mode.deviation = std::hypot(mode.deviation, suspicion * mode.departure);
  }
  raise_to_verdicts(result.modes, result.covariance);
}

FoundLaw FoundLaw::of(const LawPosterior& posterior, const StatedPriors& priors) {
  const double fundamental =
      priors.fixed({ParameterKind::kFundamental}).value_or(std::exp(posterior.mean[0]));
  return {
      fundamental,
      priors.fixed({ParameterKind::kInharmonicity}).value_or(posterior.mean[1]),
      {fundamental * std::sqrt(posterior.covariance(0, 0)), std::sqrt(posterior.covariance(1, 1))}};
}

double ContinuationResult::farthest_follower() const {
  double farthest = 0.0;
  for (std::size_t i = 0; frequencies_free && i < modes.size(); ++i) {
    const ModeVerdict& mode = modes[i];
    if (mode.source != ModeSource::kIdentified || mode.tie != LawTie::kFollows) continue;
    const auto n = static_cast<double>(i + 1);
    const double stiff = std::sqrt(1.0 + found_law.inharmonicity * n * n);
    const double expected = std::hypot(mode.deviation, law_width);
    farthest = std::max(
        farthest,
        std::abs(std::log(mode.frequency / (n * found_law.fundamental * stiff))) / expected);
  }
  return farthest;
}

bool ContinuationResult::contradicts_itself() const { return farthest_follower() > kFarFollower; }

void trust_stated_frequencies(const StatedPriors& priors, const Eigen::VectorXd& deviation,
                              std::vector<ModeVerdict>& modes) {
  for (std::size_t n = 0; n < modes.size(); ++n) {
    ModeVerdict& verdict = modes[n];
    if (priors.fixes_frequency(n)) {
      verdict.source = ModeSource::kFixed;
      verdict.reason = WeakReason::kNone;
      verdict.deviation = verdict.data_deviation = 0.0;
    }
    if (verdict.source == ModeSource::kIdentified || deviation.size() == 0) continue;
    if (!priors.has({.kind = ParameterKind::kFrequency, .index = n})) continue;
    verdict.source = ModeSource::kPrior;
    verdict.deviation = deviation[static_cast<Eigen::Index>(n)];
  }
}

void widen_stated(const StatedPriors& priors, double width, Eigen::VectorXd& widths) {
  for (Eigen::Index i = 0; i < widths.size(); ++i) {
    const auto n = static_cast<std::size_t>(i);
    const bool stated = priors.has({.kind = ParameterKind::kFrequency, .index = n});
    if (stated || priors.fixes_frequency(n)) widths[i] = width;
  }
}

}  // namespace modcal
