// An objective over some of its variables.
#pragma once

#include <vector>

#include "libcalib/problem/objective_function.hpp"

namespace modcal {

/// The function over the variables at `free`, all others held at `held` (user units). `function`
/// must outlive it.
class RestrictedFunction final : public ObjectiveFunction {
 public:
  RestrictedFunction(const ObjectiveFunction& function, std::vector<double> held,
                     std::vector<std::size_t> free)
      : function_(function), held_(std::move(held)), free_(std::move(free)) {}
  std::string_view name() const override { return function_.name(); }
  std::size_t dimension() const override { return free_.size(); }
  std::size_t residual_count() const override { return function_.residual_count(); }
  Capabilities capabilities() const override { return function_.capabilities(); }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override;

  const ObjectiveFunction& function_;
  std::vector<double> held_;
  std::vector<std::size_t> free_;
};

}  // namespace modcal
