// NIST's certified problems of nonlinear regression as objectives.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libcalib/problem/objective_function.hpp"

namespace modcal {

struct NistModel;

/// One problem of NIST's Statistical Reference Datasets, ½ Σ_j (y_j − f(x_j; b))² in its parameters
/// b, with derivatives by automatic differentiation. Start, certified parameters (11 digits) and
/// sum of squares as published.
class NistProblem final : public ObjectiveFunction {
 public:
  /// Reads FOLDER/NAME.txt. Throws InvalidInput for a name that is none of nist_names() and for a
  /// file that cannot be read.
  NistProblem(const std::string& folder, std::string_view name);

  std::string_view name() const override { return name_; }
  std::size_t dimension() const override { return certified_.size(); }
  std::size_t residual_count() const override { return y_.size(); }
  Capabilities capabilities() const override { return {.gradient = true, .least_squares = true}; }

  std::span<const double> certified() const { return certified_; }
  double certified_sum_of_squares() const { return sum_of_squares_; }
  /// Start 1 is far from the certified parameters, start 2 near. In a box of ±1000 times the start,
  /// scaled by it.
  std::vector<Variable> variables(int start) const;
  /// Digits in which the worst parameter agrees with the certified one, at most 11.
  double digits(std::span<const double> b) const;

 private:
  void do_evaluate(std::span<const double> b, const ObjectiveOutputs& outputs) const override;

  std::string name_;
  const NistModel* model_;
  std::vector<double> starts_[2], certified_, y_, x_;
  std::size_t predictors_ = 1;
  double sum_of_squares_ = 0.0;
};

/// The 27 problems, from NIST's lower to its higher level of difficulty.
std::span<const std::string_view> nist_names();

}  // namespace modcal
