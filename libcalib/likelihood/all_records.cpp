#include "libcalib/likelihood/all_records.hpp"

#include <cmath>
#include <numeric>

#include "libcalib/likelihood/tuning.hpp"

namespace modcal {

Eigen::MatrixXd StrokeLikelihood::noise_information(const ModelPoint& point,
                                                    const LikelihoodColumns& columns) const {
  return weighted_.noise_information(point, columns, kNoiseRepeats);
}

LikelihoodPoint StrokeLikelihood::unweighted(const ModelPoint& point,
                                             const LikelihoodColumns& columns) const {
  return whole_.evaluate(point, columns);
}

double StrokeLikelihood::degrees_of_freedom(const ModelPoint& point) const {
  return whole_.degrees_of_freedom(0, point);
}

void AllRecords::add(std::shared_ptr<const RecordLikelihood> record, const Eigen::VectorXd& start,
                     const std::vector<Index>& own, std::optional<double> held_contact) {
  held_contacts_.push_back(held_contact);
  std::vector<Index> places(static_cast<std::size_t>(unknowns_.size()));
  std::iota(places.begin(), places.end(), Index{0});
  if (records_.empty()) {
    start_ = start;
  } else {
    for (const Index i : own) {
      places[static_cast<std::size_t>(i)] = size_++;
      start_.conservativeResize(size_);
      start_[size_ - 1] = start[i];
    }
  }
  places_.push_back(std::move(places));
  records_.push_back(std::move(record));
}

Eigen::VectorXd AllRecords::own(const Eigen::VectorXd& theta, std::size_t record) const {
  Eigen::VectorXd part(unknowns_.size());
  for (Index i = 0; i < part.size(); ++i) part[i] = theta[place(i, record)];
  return part;
}

ModelPoint AllRecords::model(const Eigen::VectorXd& theta, std::size_t record) const {
  ModelPoint point = unknowns_.model(own(theta, record));
  if (held_contacts_[record]) point.contact = *held_contacts_[record];
  return point;
}

std::vector<AllRecords::Index> AllRecords::held_places() const {
  std::vector<Index> result;
  for (Index i = 0; i < unknowns_.size(); ++i) {
    for (std::size_t r = 0; r < records(); ++r) {
      const bool first = r == 0 || place(i, r) != place(i, 0);
      if (first && unknowns_.held(i, r)) result.push_back(place(i, r));
    }
  }
  return result;
}

void AllRecords::hold(PriorEquations& equations) const {
  unknowns_.hold(equations);
  for (const Index i : held_places()) equations.hold(i, start_[i]);
}

void AllRecords::clear_held(Eigen::MatrixXd& covariance) const {
  for (const Index i : held_places()) {
    covariance.row(i).setZero();
    covariance.col(i).setZero();
  }
}

bool AllRecords::admits(const Eigen::VectorXd& theta) const {
  for (std::size_t r = 0; r < records(); ++r) {
    if (!unknowns_.admits(own(theta, r))) return false;
  }
  return true;
}

std::optional<LinearForm> AllRecords::coordinate(const ParameterName& name,
                                                 const Eigen::VectorXd& theta) const {
  std::optional<LinearForm> of_record = unknowns_.coordinate(name, own(theta, name.record));
  if (!of_record) return of_record;
  LinearForm form{.slope = Eigen::VectorXd::Zero(size() + 2), .offset = of_record->offset};
  for (Index i = 0; i < unknowns_.size(); ++i) {
    form.slope[place(i, name.record)] = of_record->slope[i];
  }
  form.slope.tail(2) = of_record->slope.tail(2);
  return form;
}

template <typename EvaluateRecord>
LikelihoodPoint AllRecords::sum_of(const Eigen::VectorXd& theta,
                                   EvaluateRecord evaluate_record) const {
  LikelihoodPoint sum{.slope = Eigen::VectorXd::Zero(size()),
                      .information = Eigen::MatrixXd::Zero(size(), size())};
  for (std::size_t r = 0; r < records(); ++r) {
    const LikelihoodPoint point =
        evaluate_record(*records_[r], model(theta, r), unknowns_.columns(own(theta, r), r));
    sum.cost += point.cost;
    for (Index i = 0; i < unknowns_.size(); ++i) sum.slope[place(i, r)] += point.slope[i];
    add_to(sum.information, point.information, r);
    if (point.twice_weighted.size() == 0) continue;
    if (r == 0) sum.twice_weighted = Eigen::MatrixXd::Zero(size(), size());
    add_to(sum.twice_weighted, point.twice_weighted, r);
  }
  return sum;
}

LikelihoodPoint AllRecords::evaluate(const Eigen::VectorXd& theta, bool twice_weighted) const {
  return sum_of(theta, [&](const RecordLikelihood& record, const ModelPoint& point,
                           const LikelihoodColumns& columns) {
    return record.evaluate(point, columns, {.twice_weighted = twice_weighted});
  });
}

LikelihoodPoint AllRecords::unweighted(const Eigen::VectorXd& theta) const {
  return sum_of(theta,
                [](const RecordLikelihood& record, const ModelPoint& point,
                   const LikelihoodColumns& columns) { return record.unweighted(point, columns); });
}

Eigen::MatrixXd AllRecords::noise(const Eigen::VectorXd& theta) const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size(), size());
  for (std::size_t r = 0; r < records(); ++r) {
    add_to(sum,
           records_[r]->noise_information(model(theta, r), unknowns_.columns(own(theta, r), r)), r);
  }
  return sum;
}

AllRecords::Misfit AllRecords::misfit(const Eigen::VectorXd& theta, double cost,
                                      std::span<const double> noise_errors, double taken) const {
  double freedom = -taken, variance = 0.0;
  for (std::size_t r = 0; r < records(); ++r) {
    const double own_freedom = records_[r]->degrees_of_freedom(model(theta, r));
    freedom += own_freedom;
    variance += std::pow(own_freedom * noise_errors[r], 2);
  }
  return {.chi2 = 2.0 * cost / freedom,
          .deviation = std::hypot(std::sqrt(2.0 / freedom), std::sqrt(variance) / freedom)};
}

void AllRecords::add_to(Eigen::MatrixXd& sum, const Eigen::MatrixXd& part,
                        std::size_t record) const {
  for (Index i = 0; i < part.rows(); ++i) {
    for (Index j = 0; j < part.cols(); ++j) sum(place(i, record), place(j, record)) += part(i, j);
  }
}

}  // namespace modcal
