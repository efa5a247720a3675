#pragma once

#include <string_view>
#include <vector>

#include "libcalib/objective.hpp"

namespace modcal {

/// Σ_j w_j J_j of other objectives on the same data and parameters, w_j > 0. It has a gradient,
/// residuals, √w_j r_j one below the other, and their Jacobian where all its terms have them. Units
/// are the user's: weights turn newtons and ratios into one number.
class WeightedSum final : public Objective {
 public:
  /// An objective that is no sum itself: a sum of sums is one longer sum.
  class TermChoice final : public PluginSlot {
   public:
    std::string_view kind() const override { return choice_.kind(); }
    std::vector<std::string_view> names() const override;
    std::string_view summary(std::string_view name) const override { return choice_.summary(name); }
    std::string_view selected() const override { return choice_.selected(); }
    void select(std::string_view name) override;
    void visit_options(OptionVisitor& visitor) override { choice_.visit_options(visitor); }
    std::shared_ptr<const Objective> make() const { return choice_.make(); }
    /// A term whose options are given in code. Throws InvalidInput for a weighted_sum.
    void assign(Choice<Objective> choice);

   private:
    Choice<Objective> choice_;
  };
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
  Response response(ParameterKind kind) const override;
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
