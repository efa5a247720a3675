// Objectives that compare the forces identified from the two ends.
#pragma once

#include <limits>
#include <string>

#include "libcalib/objective.hpp"
#include "libinverse/regularizer.hpp"

namespace modcal {

/// How objectives that compare the two identified forces invert.
struct TwoSidedForceOptions {
  Choice<Regularizer> regularizer{"tikhonov"};
  double parameter = 0.3;  ///< of the regularizer, in the unit of H [N/N]
  /// Both forces are filtered by φ(|H_1|) φ(|H_2|), so that their difference vanishes for the true
  /// model; else each by its own filter, as one-sided inversions do.
  bool common_filter = true;
  /// Band [Hz]; NaN: from half the lowest modal frequency to 4 % above the highest.
  double lowest = std::numeric_limits<double>::quiet_NaN();
  double highest = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
};

/// Two-sided force mismatch: both reactions carry one force, so
/// r = w_k (F_1 − F_2)(ω_k)/√(½ Σ w_k² (|F_1|² + |F_2|²)), real and imaginary part of every bin in
/// turn, value ½ ‖r‖² [1]; the denominator and the weights are those of the initial parameters.
/// Weights: uniform, or transfer: w_k = (|H_1|^−2 + |H_2|^−2)^−½, under which equal noise in both
/// reactions gives equal noise in all residuals.
class ForceMismatch final : public Objective {
 public:
  struct Options {
    TwoSidedForceOptions inversion;
    std::string weights = "uniform";
    void visit(OptionVisitor& visitor);
  };
  explicit ForceMismatch(const Options& options);

 private:
  /// Throws InvalidInput where a reaction is missing or holds nothing in the band.
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override;

  Options options_;
};

/// Smooth variant of contact_location, half its square, as residuals: r_k = √2 (F_1 −
/// F_2)(ω_k)/√(‖F_1‖² + ‖F_2‖²), real and imaginary part of every bin in turn, value ½ ‖r‖² [1].
/// Its minimum is that of contact_location, where that has a kink (for data the model explains
/// exactly) and this has none.
class ContactLocationSquares final : public Objective {
 public:
  struct Options {
    TwoSidedForceOptions inversion;
    void visit(OptionVisitor& visitor) { inversion.visit(visitor); }
  };
  explicit ContactLocationSquares(const Options& options) : options_(options) {}

 private:
  /// Throws InvalidInput where a reaction is missing or x_c is not free.
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override;

  Options options_;
};

/// Relative difference of the two identified force waveforms,
/// ‖f_1 − f_2‖/√(½ (‖f_1‖² + ‖f_2‖²)) [1], as a function of x_c (Debut, Delaune and Antunes, 2010,
/// section 7.2: the contact location "has been adjusted to minimize the difference between the two
/// identified force waveforms"). By Parseval's theorem the norms of the waveforms are sums over
/// bins, so that no waveform is computed. The waveforms are those of the band; with common_filter
/// off they are what two one-sided inversions give. Other parameters may be free beside x_c. The
/// gradient is set to 0 where the waveforms are equal, which is the smallest value there is.
class ContactLocation final : public Objective {
 public:
  using Options = ContactLocationSquares::Options;
  explicit ContactLocation(const Options& options) : options_(options) {}

  /// A norm, not its square: no residuals. contact_location_squares has them.
  Capabilities capabilities() const override { return {.gradient = true}; }

 private:
  /// Throws InvalidInput where a reaction is missing or x_c is not free.
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override;

  Options options_;
};

}  // namespace modcal
