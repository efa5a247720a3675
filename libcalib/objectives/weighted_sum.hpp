#pragma once

#include <string_view>
#include <vector>

#include "libcalib/objective.hpp"
#include "libcalib/problem/nested_choice.hpp"

namespace modcal {

/// Σ_j w_j J_j of other objectives on the same data and parameters, w_j > 0. It has a gradient,
/// residuals, √w_j r_j one below the other, and their Jacobian where all its terms have them. Units
/// are the user's: weights turn newtons and ratios into one number.
class WeightedSum final : public Objective {
 public:
  static constexpr std::string_view kName = "weighted_sum";
  static constexpr std::string_view kNested = "write its terms into this one";
  using TermChoice = NestedChoice<Objective, WeightedSum>;
  struct Term {
    double weight = 1.0;
    TermChoice objective;
    void visit(OptionVisitor& visitor);
  };
  struct Options {
    std::vector<Term> terms;
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for a weight that is not positive.
  explicit WeightedSum(const Options& options);
  /// Moved by what moves one of the terms.
  Response response(Moves what) const override;
  /// What all terms have.
  Capabilities capabilities() const override;
  /// All terms are, each with the weight 1.
  bool whitened() const override;
  void require_record(const ModalBasis& basis, double sample_rate,
                      std::size_t samples) const override;

 private:
  /// Throws InvalidInput where there is no term, and what the terms throw.
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override;

  Options options_;
};

}  // namespace modcal
