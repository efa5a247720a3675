#include "libcalib/likelihood/parameter_forms.hpp"

#include <algorithm>
#include <cmath>

namespace modcal {
namespace {

using Index = Eigen::Index;

// Forms in the order in which they are added.
class FormList {
 public:
  FormList(const AllRecords& all, const FormPoint& at) : all_(all), at_(at) {}

  // All of one kind; nothing of what is held or shared.
  void add(ParameterKind kind, std::size_t r) {
    const FreeParameters& free = all_.unknowns().parameters();
    for (std::size_t i = 0; i < free.size(); ++i) {
      if (free[i].kind == kind) add(i, r);
    }
  }

  void add(std::size_t i, std::size_t r) {
    const ParameterName& name = all_.unknowns().parameters()[i];
    if (all_.held(static_cast<Index>(i), r)) return;
    const bool f0 = name.kind == ParameterKind::kFundamental;
    const double value = f0 ? at_.fundamental : value_of(name, at_.models[r]);
    add(name, static_cast<Index>(i), r, Eigen::VectorXd::Constant(1, type_of(name).slope(value)));
  }

  // The factor of a record, the geometric mean where each ζ_n is free.
  void add_damping(std::size_t r) {
    const StringUnknowns& unknowns = all_.unknowns();
    Eigen::VectorXd mean(unknowns.damping_count());
    for (Index i = 0; i < mean.size(); ++i) {
      Eigen::VectorXd theta = Eigen::VectorXd::Zero(unknowns.size());
      theta[unknowns.damping() + i] = 1.0;
      mean[i] = at_.damping[r] * std::log(unknowns.damping_factor(theta));
    }
    if (mean.size() == 0 || !mean.any()) return;
    if (mean.size() == 1 && all_.held(unknowns.damping(), r)) return;
    add({ParameterKind::kDampingFactor}, unknowns.damping(), r, mean);
  }

  std::vector<ParameterForm> forms;

 private:
  // Unknown i of a record, with what follows it in a sum.
  void add(ParameterName name, Index i, std::size_t r, const Eigen::VectorXd& sum) {
    if (r > 0 && all_.place(i, r) == all_.place(i, 0)) return;
    name.record = r;
    forms.push_back({text_of(name), Eigen::VectorXd::Zero(all_.size())});
    for (Index j = 0; j < sum.size(); ++j) forms.back().slope[all_.place(i + j, r)] += sum[j];
  }

  const AllRecords& all_;
  const FormPoint& at_;
};

}  // namespace

double ParameterForm::deviation(const Eigen::MatrixXd& covariance) const {
  return std::sqrt(slope.dot(covariance * slope));
}

std::vector<ParameterForm> parameter_forms(const AllRecords& all, const FormPoint& at) {
  FormList list(all, at);
  using Kind = ParameterKind;
  for (const Kind kind : {Kind::kFundamental, Kind::kInharmonicity, Kind::kContact}) {
    list.add(kind, 0);
  }
  list.add_damping(0);
  for (std::size_t r = 1; r < at.strokes; ++r) list.add(Kind::kContact, r);
  for (std::size_t r = 1; r < all.records(); ++r) list.add_damping(r);
  list.add(Kind::kDampingPower, 0);
  const FreeParameters& free = all.unknowns().parameters();
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (free[i].kind != Kind::kSensor) continue;
    for (std::size_t r = 0; r < all.records(); ++r) list.add(i, r);
  }
  list.add(Kind::kDampingRatio, 0);
  return std::move(list.forms);
}

NamedCovariance named_covariance(const AllRecords& all, const FormPoint& at,
                                 const Eigen::MatrixXd& covariance) {
  FormList frequencies(all, at);
  frequencies.add(ParameterKind::kFrequency, 0);
  std::vector<ParameterForm> forms = std::move(frequencies.forms);
  const bool each = all.unknowns().parameters().has(ParameterKind::kDampingRatio);
  for (const ParameterForm& form : parameter_forms(all, at)) {
    if (!each || !form.parameter.starts_with("damping")) forms.push_back(form);
  }
  NamedCovariance result;
  Eigen::MatrixXd slopes(static_cast<Index>(forms.size()), all.size());
  for (std::size_t i = 0; i < forms.size(); ++i) {
    result.names.push_back(forms[i].parameter);
    slopes.row(static_cast<Index>(i)) = forms[i].slope;
  }
  result.matrix = slopes * covariance * slopes.transpose();
  return result;
}

NamedCovariance named_covariance(const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                                 double damping, const Eigen::MatrixXd& covariance) {
  AllRecords all(unknowns);
  all.add(nullptr, theta, {});
  return named_covariance(all,
                          {.models = {unknowns.model(theta)},
                           .damping = {damping},
                           .fundamental = unknowns.is_law() ? unknowns.fundamental(theta) : 0.0},
                          covariance);
}

}  // namespace modcal
