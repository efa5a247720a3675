#include "libcalib/problem/restricted_function.hpp"

namespace modcal {

void RestrictedFunction::do_evaluate(std::span<const double> x,
                                     const ObjectiveOutputs& outputs) const {
  const std::size_t all = held_.size(), free = free_.size(), residuals = residual_count();
  std::vector<double> at = held_;
  for (std::size_t i = 0; i < free; ++i) at[free_[i]] = x[i];
  std::vector<double> gradient(outputs.gradient ? all : 0);
  std::vector<double> jacobian(outputs.jacobian ? all * residuals : 0);
  ObjectiveOutputs asked = outputs;
  if (asked.gradient) asked.gradient = gradient.data();
  if (asked.jacobian) asked.jacobian = jacobian.data();
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; outputs.rows && i < outputs.rows->size(); ++i) {
    rows.push_back(free_[(*outputs.rows)[i]]);
  }
  if (outputs.rows) asked.rows = &rows;
  function_.evaluate(at, asked);
  for (std::size_t i = 0; i < free; ++i) {
    if (outputs.gradient) outputs.gradient[i] = gradient[free_[i]];
    for (std::size_t j = 0; outputs.jacobian && j < residuals; ++j) {
      outputs.jacobian[j * free + i] = jacobian[j * all + free_[i]];
    }
  }
  for (Eigen::MatrixXd* matrix : {outputs.information, outputs.noise, outputs.prior}) {
    if (!matrix) continue;
    const Eigen::MatrixXd columns = (*matrix)(Eigen::all, free_);
    if (static_cast<std::size_t>(columns.rows()) == all) {
      *matrix = columns(free_, Eigen::all);
    } else {
      *matrix = columns;
    }
  }
}

}  // namespace modcal
