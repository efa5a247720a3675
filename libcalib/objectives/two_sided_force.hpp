// The force identified from both reactions, with its derivatives.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "libcalib/problem/calibration_data.hpp"
#include "libcalib/objectives/two_sided_terms.hpp"
#include "libcalib/parameters/parameters.hpp"
#include "libinverse/spectral/regularizers/regularizer.hpp"

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

/// F_r = Φ_r R_r/H_r over a band of bins and ∂F_r/∂x_i, with Φ_r = φ(|H_1|) φ(|H_2|) or φ(|H_r|),
/// φ the filter factors of a regularizer. The slope dφ/d|H| is a central difference of the filter
/// factors over ±1e-5 |H|: right to about 1e-10 where φ is smooth, 0 on the steps of a water level
/// that zeroes.
class TwoSidedForce {
 public:
  using Pair = std::array<std::vector<Complex>, 2>;

  /// Throws InvalidInput where a reaction is missing or the band holds no bin.
  TwoSidedForce(const CalibrationData& data, const ParameterSet& parameters,
                const TwoSidedForceOptions& options);

  std::size_t bins() const { return band_.size(); }
  const ParameterSet& parameters() const { return parameters_; }

  /// Everything known at one point.
  struct State {
    std::vector<double> x;
    std::vector<TwoSidedTerm> terms;
    std::vector<TwoSidedTerm> contact_terms;
    Pair transfer;                                  ///< H_r [N/N]
    Pair force;                                     ///< F_r, as the DFT of a force in N
    std::array<std::vector<double>, 2> kept;        ///< φ(|H_r|)
    std::array<std::vector<double>, 2> kept_slope;  ///< dφ/d|H_r|; empty unless asked for
  };
  State at(std::span<const double> x, bool with_slopes) const;
  /// ∂F_r/∂x_i into `slope`; the state must have been asked for with slopes.
  void force_slope(const State& state, std::size_t i, Pair& slope) const;

 private:
  void filter(State& state, std::size_t r, bool with_slopes) const;
  void identify(State& state) const;
  void transfer_slope(const State& state, std::size_t i, Pair& slope) const;

  ParameterSet parameters_;
  FrequencyGrid grid_;
  BinRange band_;
  Pair reaction_;
  std::shared_ptr<const Regularizer> regularizer_;
  double parameter_;
  bool common_filter_;
};

}  // namespace modcal
