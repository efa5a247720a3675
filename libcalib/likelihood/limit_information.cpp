#include "libcalib/likelihood/limit_information.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/likelihood/bin_weights.hpp"
#include "libcalib/likelihood/newton_fit.hpp"
#include "libcalib/likelihood/pluck_likelihood.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;
constexpr std::size_t kNoiseRepeats = 4;

// Information under the best weights and the score's variance with the noise in it.
LikelihoodPoint under_best_weights(const ProjectedLikelihood& clean, const ModelPoint& truth,
                                   const LikelihoodColumns& columns) {
  ProjectedLikelihood weighted = clean;
  weighted.set_weights(best_weights(clean, truth, columns));
  LikelihoodPoint point = weighted.evaluate(truth, columns, {.twice_weighted = true});
  for (std::size_t r = 0; r < kNoiseRepeats; ++r) {
    const ProjectedLikelihood noise(weighted.record().noise(r));
    point.twice_weighted +=
        noise.evaluate(truth, columns, {.twice_weighted = true}).twice_weighted / kNoiseRepeats;
  }
  return point;
}

StatedPriors priors_of(const LimitCase& question) {
  ModelPoint stated = question.truth;
  stated.sensors = question.unknowns.sensors();
  return StatedPriors(question.unknowns, stated, question.strokes.size() + question.plucks.size());
}

}  // namespace

double ParameterForm::deviation(const Eigen::MatrixXd& covariance) const {
  return std::sqrt(std::max(slope.dot(covariance * slope), 0.0));
}

Eigen::MatrixXd LimitInformation::covariance(const StringUnknowns& unknowns,
                                             const Eigen::MatrixXd& information,
                                             const Eigen::MatrixXd& prior) const {
  NewtonOptions options;
  options.prior = prior;
  LikelihoodPoint point{.information = information};
  point.twice_weighted = information;
  Eigen::MatrixXd result = fit_covariance(point, options);
  placed(unknowns).clear_held(result);
  return result;
}

LimitInformation::LimitInformation(const LimitCase& question)
    : question_(question), priors_(priors_of(question)) {
  MODCAL_REQUIRE(!question.strokes.empty() && question.contacts.size() == question.strokes.size(),
                 "a limit needs at least one stroke and the contact of each: there are {} strokes "
                 "and {} contacts",
                 question.strokes.size(), question.contacts.size());
  const auto whitened = [&](const NoisyRecords& records) {
    return WhitenedRecord::of(
        records, 0.0,
        likelihood_band(question.truth, question.highest_frequency, records.sample_rate));
  };
  for (const NoisyRecords& stroke : question.strokes) {
    strokes_.emplace_back(whitened(stroke));
    records_.push_back(std::make_shared<StrokeLikelihood>(strokes_.back(), strokes_.back()));
  }
  for (const NoisyRecords& pluck : question.plucks) {
    records_.push_back(std::make_shared<PluckLikelihood>(whitened(pluck)));
  }
}

// As the joint fit places them; a pluck has no contact.
std::vector<Index> LimitInformation::own_places(const StringUnknowns& unknowns,
                                                std::size_t record) const {
  const UnknownsOptions& own = question_.unknowns;
  std::vector<Index> places;
  if (record < strokes_.size() && own.own(UnknownKind::kContact)) {
    places.push_back(unknowns.contact());
  }
  if (own.own(UnknownKind::kDampingFactor)) places.push_back(unknowns.damping());
  const UnknownKind sensors[] = {UnknownKind::kGain, UnknownKind::kDelay, UnknownKind::kCorner};
  for (std::size_t i = 0; i < 3; ++i) {
    if (own.own(sensors[i])) places.push_back(unknowns.sensor(i));
  }
  return places;
}

AllRecords LimitInformation::placed(const StringUnknowns& unknowns) const {
  AllRecords all(unknowns);
  const HeldParameters& held = priors_.held();
  for (std::size_t r = 0; r < records_.size(); ++r) {
    Eigen::VectorXd start = unknowns.start();
    start[unknowns.contact()] = point_of(r).contact - question_.truth.contact;
    const bool known = r < strokes_.size() && held.contact(r);
    all.add(records_[r], start, own_places(unknowns, r),
            known ? std::optional<double>(point_of(r).contact) : std::nullopt);
  }
  return all;
}

ModelPoint LimitInformation::point_of(std::size_t record) const {
  ModelPoint point = question_.truth;
  // Equal sensors that may differ take from the data what those that do differ take.
  point.sensors.free = point.sensors.free || question_.unknowns.sensors().free;
  if (record < strokes_.size()) point.contact = question_.contacts[record];
  return point;
}

// At the truth itself, which need not follow the law to the last digit.
template <typename Evaluate>
LikelihoodPoint LimitInformation::sum(const StringUnknowns& unknowns,
                                      const Evaluate& evaluate) const {
  const AllRecords all = placed(unknowns);
  LikelihoodPoint total{.information = Eigen::MatrixXd::Zero(all.size(), all.size())};
  total.twice_weighted = total.information;
  for (std::size_t r = 0; r < records_.size(); ++r) {
    const LikelihoodPoint part =
        evaluate(r, point_of(r), unknowns.columns(all.own(all.start(), r), r));
    for (Index i = 0; i < unknowns.size(); ++i) {
      for (Index j = 0; j < unknowns.size(); ++j) {
        const Index row = all.place(i, r), column = all.place(j, r);
        total.information(row, column) += part.information(i, j);
        total.twice_weighted(row, column) += part.twice_weighted(i, j);
      }
    }
  }
  return total;
}

Eigen::MatrixXd LimitInformation::information(const StringUnknowns& unknowns) const {
  const auto evaluate = [this](std::size_t r, const ModelPoint& point,
                               const LikelihoodColumns& columns) {
    LikelihoodPoint part = records_[r]->evaluate(point, columns, false);
    part.twice_weighted = part.information;
    return part;
  };
  return sum(unknowns, evaluate).information;
}

Eigen::MatrixXd LimitInformation::attainable(const StringUnknowns& unknowns,
                                             const Eigen::MatrixXd& prior) const {
  const auto evaluate = [this](std::size_t r, const ModelPoint& point,
                               const LikelihoodColumns& columns) {
    if (r < strokes_.size()) return under_best_weights(strokes_[r], point, columns);
    LikelihoodPoint part = records_[r]->evaluate(point, columns, true);
    part.twice_weighted += records_[r]->noise_information(point, columns);
    return part;
  };
  NewtonOptions options;
  options.prior = prior;
  Eigen::MatrixXd result = fit_covariance(sum(unknowns, evaluate), options);
  placed(unknowns).clear_held(result);
  return result;
}

Eigen::MatrixXd LimitInformation::prior(const StringUnknowns& unknowns, const StatedPriors& priors,
                                        const LawScatter* scatter) const {
  const AllRecords all = placed(unknowns);
  PriorEquations equations(all.size());
  priors.state([&](const UnknownName& name) { return all.coordinate(name, all.start()); },
               equations);
  unknowns.state_damping_ratios(question_.truth.basis.zeta, equations);
  if (scatter) equations.add_scatter(*scatter, unknowns.log_frequencies());
  all.hold(equations);
  return equations.solve().precision;
}

std::vector<ParameterForm> LimitInformation::forms(const StringUnknowns& unknowns) const {
  const AllRecords all = placed(unknowns);
  const std::string& damping = question_.unknowns.damping;
  std::vector<ParameterForm> forms;
  // Unknown i of a record, with what follows it in a sum; nothing of what is held or shared.
  const auto add = [&](const std::string& name, Index i, std::size_t r,
                       const Eigen::VectorXd& sum) {
    const bool own = r == 0 || all.place(i, r) != all.place(i, 0);
    if (!own || (sum.size() == 1 && all.held(i, r))) return;
    forms.push_back(
        {r == 0 ? name : fmt::format("{} {}", name, r + 1), Eigen::VectorXd::Zero(all.size())});
    for (Index j = 0; j < sum.size(); ++j) forms.back().slope[all.place(i + j, r)] += sum[j];
  };
  const auto one = [](double factor) { return Eigen::VectorXd::Constant(1, factor); };
  const auto add_damping = [&](std::size_t r) {
    Eigen::VectorXd mean(unknowns.damping_count());
    for (Index i = 0; i < mean.size(); ++i) {
      Eigen::VectorXd theta = Eigen::VectorXd::Zero(unknowns.size());
      theta[unknowns.damping() + i] = 1.0;
      mean[i] = std::log(unknowns.damping_factor(theta));
    }
    if (mean.size() > 0 && mean.any()) add("damping", unknowns.damping(), r, mean);
  };
  if (unknowns.is_law()) {
    add("f0", 0, 0, one(unknowns.fundamental(unknowns.start())));
    add("B", 1, 0, one(1.0));
  }
  add("x_c", unknowns.contact(), 0, one(1.0));
  add_damping(0);
  for (std::size_t r = 1; r < strokes_.size(); ++r) add("x_c", unknowns.contact(), r, one(1.0));
  for (std::size_t r = 1; r < records_.size(); ++r) add_damping(r);
  if (damping == "power") add("damping_power", unknowns.damping() + 1, 0, one(1.0));
  constexpr const char* kSensors[] = {"gain", "delay", "corner"};
  const double units[] = {question_.truth.sensors.gain, 1.0, 0.5 / std::numbers::pi};
  for (std::size_t i = 0; i < 3; ++i) {
    if (unknowns.sensor(i) < 0) continue;
    for (std::size_t r = 0; r < records_.size(); ++r) {
      add(kSensors[i], unknowns.sensor(i), r, one(units[i]));
    }
  }
  for (std::size_t n = 0; damping == "each" && !unknowns.is_law() && n < unknowns.modes(); ++n) {
    add(fmt::format("zeta_{}", n + 1), unknowns.damping() + static_cast<Index>(n), 0,
        one(question_.truth.basis.zeta[n]));
  }
  return forms;
}

}  // namespace modcal
