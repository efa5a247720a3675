// The box of a search, seen by back ends that know no bounds.
#pragma once

#include <span>
#include <vector>

#include "libcalib/problem/evaluator.hpp"

namespace modcal {

/// Maps unbounded variables u into the box, z_i = c_i + h_i sin(a_i + u_i/(h_i cos a_i)), c_i and
/// h_i the middle and half the width of the box: smooth, so that an optimum on a bound is a smooth
/// optimum in u (James and Roos, MINUIT, 1975). u = 0 is the initial point, where dz_i/du_i = 1; a
/// variable that starts on a bound starts 0.1 % of the width inside, or it could not leave.
class UnboundedSearch {
 public:
  explicit UnboundedSearch(Evaluator& evaluator);

  std::size_t dimension() const { return phase_.size(); }
  std::size_t residual_count() const { return evaluator_.residual_count(); }
  bool stopped() const { return evaluator_.stopped(); }
  /// Evaluator::try_evaluate at u, slopes with respect to u.
  Evaluator::Trial try_evaluate(std::span<const double> u,
                                const ObjectiveOutputs& outputs) noexcept;

 private:
  Evaluator& evaluator_;
  std::vector<double> center_;
  std::vector<double> half_width_;
  std::vector<double> phase_;  // a_i
  std::vector<double> rate_;   // 1/(h_i cos a_i)
  std::vector<double> z_;      // point of the current evaluation
  std::vector<double> slope_;  // dz_i/du_i there
};

}  // namespace modcal
