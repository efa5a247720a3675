#include "libcalib/likelihood/parameter_forms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace modcal {
namespace {

using Index = Eigen::Index;

Eigen::VectorXd one(double factor) { return Eigen::VectorXd::Constant(1, factor); }

// Forms in the order in which they are added.
class FormList {
 public:
  explicit FormList(const AllRecords& all) : all_(all) {}

  // Unknown i of a record, with what follows it in a sum; nothing of what is held or shared.
  void add(const std::string& name, Index i, std::size_t r, const Eigen::VectorXd& sum) {
    const bool own = r == 0 || all_.place(i, r) != all_.place(i, 0);
    if (!own || (sum.size() == 1 && all_.held(i, r))) return;
    forms.push_back(
        {r == 0 ? name : fmt::format("{} {}", name, r + 1), Eigen::VectorXd::Zero(all_.size())});
    for (Index j = 0; j < sum.size(); ++j) forms.back().slope[all_.place(i + j, r)] += sum[j];
  }

  // The factor of a record, the geometric mean where each ζ_n is free.
  void add_damping(std::size_t r, double factor) {
    const StringUnknowns& unknowns = all_.unknowns();
    Eigen::VectorXd mean(unknowns.damping_count());
    for (Index i = 0; i < mean.size(); ++i) {
      Eigen::VectorXd theta = Eigen::VectorXd::Zero(unknowns.size());
      theta[unknowns.damping() + i] = 1.0;
      mean[i] = factor * std::log(unknowns.damping_factor(theta));
    }
    if (mean.size() > 0 && mean.any()) add("damping", unknowns.damping(), r, mean);
  }

  std::vector<ParameterForm> forms;

 private:
  const AllRecords& all_;
};

}  // namespace

double ParameterForm::deviation(const Eigen::MatrixXd& covariance) const {
  return std::sqrt(std::max(slope.dot(covariance * slope), 0.0));
}

std::vector<ParameterForm> parameter_forms(const AllRecords& all, const UnknownsOptions& options,
                                           const FormPoint& at) {
  const StringUnknowns& unknowns = all.unknowns();
  FormList list(all);
  if (unknowns.is_law()) {
    list.add("f0", 0, 0, one(at.fundamental));
    list.add("B", 1, 0, one(1.0));
  }
  list.add("x_c", unknowns.contact(), 0, one(1.0));
  list.add_damping(0, at.damping[0]);
  for (std::size_t r = 1; r < at.strokes; ++r) list.add("x_c", unknowns.contact(), r, one(1.0));
  for (std::size_t r = 1; r < all.records(); ++r) list.add_damping(r, at.damping[r]);
  if (options.damping == "power") list.add("damping_power", unknowns.damping() + 1, 0, one(1.0));
  constexpr const char* kSensors[] = {"gain", "delay", "corner"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (unknowns.sensor(i) < 0) continue;
    for (std::size_t r = 0; r < all.records(); ++r) {
      const double units[] = {at.models[r].sensors.gain, 1.0, 0.5 / std::numbers::pi};
      list.add(kSensors[i], unknowns.sensor(i), r, one(units[i]));
    }
  }
  const bool each = options.damping == "each" && !unknowns.is_law();
  for (std::size_t n = 0; each && n < unknowns.modes(); ++n) {
    list.add(fmt::format("zeta_{}", n + 1), unknowns.damping() + static_cast<Index>(n), 0,
             one(at.models[0].basis.zeta[n]));
  }
  return std::move(list.forms);
}

std::vector<ParameterForm> frequency_forms(const AllRecords& all, const FormPoint& at) {
  FormList list(all);
  for (std::size_t n = 0; !all.unknowns().is_law() && n < all.unknowns().modes(); ++n) {
    list.add(fmt::format("f_{}", n + 1), static_cast<Index>(n), 0,
             one(at.models[0].basis.frequency(n)));
  }
  return std::move(list.forms);
}

NamedCovariance named_covariance(const AllRecords& all, const UnknownsOptions& options,
                                 const FormPoint& at, const Eigen::MatrixXd& covariance) {
  std::vector<ParameterForm> forms = frequency_forms(all, at);
  const std::vector<ParameterForm> others = parameter_forms(all, options, at);
  const bool each = options.damping == "each" && !all.unknowns().is_law();
  for (const ParameterForm& form : others) {
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

NamedCovariance named_covariance(const StringUnknowns& unknowns, const UnknownsOptions& options,
                                 const Eigen::VectorXd& theta, double damping,
                                 const Eigen::MatrixXd& covariance) {
  AllRecords all(unknowns);
  all.add(nullptr, theta, {});
  return named_covariance(all, options,
                          {.models = {unknowns.model(theta)},
                           .damping = {damping},
                           .fundamental = unknowns.is_law() ? unknowns.fundamental(theta) : 0.0},
                          covariance);
}

}  // namespace modcal
