#include "libcalib/identifiability/limit_information.hpp"

#include "libcalib/identifiability/tuning.hpp"
#include "libcalib/likelihood/bin_weights.hpp"
#include "libcalib/likelihood/newton_step.hpp"
#include "libcalib/likelihood/pluck/pluck_likelihood.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

// Information under the best weights and the score's variance with the noise in it.
LikelihoodPoint under_best_weights(const ProjectedLikelihood& clean, const ModelPoint& truth,
                                   const LikelihoodColumns& columns) {
  ProjectedLikelihood weighted = clean;
  weighted.set_weights(best_weights(clean, truth, columns));
  LikelihoodPoint point = weighted.evaluate(truth, columns, {.twice_weighted = true});
  for (std::size_t r = 0; r < kLimitRepeats; ++r) {
    const ProjectedLikelihood noise(weighted.record().noise(r));
    point.twice_weighted +=
        noise.evaluate(truth, columns, {.twice_weighted = true}).twice_weighted / kLimitRepeats;
  }
  return point;
}

StatedPriors priors_of(const LimitCase& question) {
  ModelPoint stated = question.truth;
  stated.sensors = question.unknowns.sensors();
  return StatedPriors(question.unknowns, stated, question.strokes.size() + question.plucks.size());
}

}  // namespace

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

AllRecords LimitInformation::placed(const StringUnknowns& unknowns) const {
  AllRecords all(unknowns);
  for (std::size_t r = 0; r < records_.size(); ++r) {
    Eigen::VectorXd start = unknowns.start();
    start[unknowns.contact()] = point_of(r).contact - question_.truth.contact;
    const bool known = r < strokes_.size() && priors_.fixed_contact(r);
    all.add(records_[r], start, unknowns.own_places(r < strokes_.size()),
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
    LikelihoodPoint part = records_[r]->evaluate(point, columns, {});
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
    LikelihoodPoint part = records_[r]->evaluate(point, columns, {.twice_weighted = true});
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
  priors.state([&](const ParameterName& name) { return all.coordinate(name, all.start()); },
               equations);
  unknowns.state_widths(question_.truth.basis.zeta, equations);
  if (scatter) equations.add_scatter(*scatter, unknowns.log_frequencies());
  all.hold(equations);
  return equations.solve().precision;
}

std::vector<ParameterForm> LimitInformation::forms(const StringUnknowns& unknowns) const {
  FormPoint at{.models = {},
               .damping = std::vector<double>(records_.size(), 1.0),
               .fundamental = unknowns.fundamental(unknowns.start()),
               .strokes = strokes_.size()};
  for (std::size_t r = 0; r < records_.size(); ++r) at.models.push_back(point_of(r));
  return parameter_forms(placed(unknowns), at);
}

}  // namespace modcal
