// Which mode of a free decay has which number of a string.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "libinverse/modes/decay_record.hpp"

namespace modcal {

/// The law f² = n² (a + b n²) through the modes numbered so far, with equal errors of all f: its
/// first modes number the next.
class LawNumbers {
 public:
  explicit LawNumbers(double fundamental) : square_(fundamental * fundamental) {}

  /// n of the law at f, n²(a + b n²) = f².
  double place(double frequency) const {
    const double ratio = frequency * frequency / square_;
    return std::sqrt(2.0 * ratio / (1.0 + std::sqrt(1.0 + 4.0 * bend_ / square_ * ratio)));
  }
  double frequency(std::size_t number) const {
    const double n = static_cast<double>(number);
    return n * std::sqrt(square_ + bend_ * n * n);
  }
  bool is_near(std::size_t number, double frequency) const {
    const double n = static_cast<double>(number);
    return std::abs(place(frequency) - n) <= std::min(0.25, 0.03 * n);
  }
  bool tells() const { return count_ >= 3; }  ///< two tell a law, but not how wrong it is
  /// What lies farther from the law than the fundamental stated may, or half way to the middle
  /// between two modes, numbers no others. Stiffness is never negative.
  void add(std::size_t number, double frequency) {
    const double n = static_cast<double>(number), weight = std::pow(n * n / frequency, 2);
    if (!is_near(number, frequency)) return;
    const double y = frequency * frequency / (n * n), x = n * n;
    sums_ += Eigen::Matrix2d{{weight, weight * x}, {weight * x, weight * x * x}};
    right_ += Eigen::Vector2d{weight * y, weight * x * y};
    ++count_;
    if (!tells()) return;
    const Eigen::Vector2d law = sums_.ldlt().solve(right_);
    const bool stiff = law[1] > 0.0;
    square_ = stiff ? law[0] : right_[0] / sums_(0, 0);
    bend_ = stiff ? law[1] : 0.0;
  }

 private:
  double square_, bend_ = 0.0;  // f₀², f₀² B
  Eigen::Matrix2d sums_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right_ = Eigen::Vector2d::Zero();
  int count_ = 0;
};

using NumberedModes = std::map<std::size_t, DecayMode>;

/// One mode a number, those above `highest` [Hz] aside, along the law, which they move. Of several
/// the one near the law, within 1 % as the nearest is; of several there, as of two planes, the
/// largest. What a law of three modes is far from has no number: it is left in `others`.
NumberedModes numbered_modes(std::vector<DecayMode> modes, double highest, LawNumbers& law,
                             std::vector<DecayMode>& others);

/// Every mode that decays, from `lowest` to `highest` [Hz], upwards: of a structure without a law.
NumberedModes modes_in_order(std::vector<DecayMode> modes, double lowest, double highest);

/// Of modes without a number those that are heard: of a tenth of the largest amplitude at least.
std::vector<DecayMode> heard_of(std::vector<DecayMode> others, const NumberedModes& numbered);

/// Numbers below the highest that no mode has.
std::vector<std::size_t> missing_in(const NumberedModes& numbered);

/// Takes from `others` those within `reach` [Hz] of a mode with a number: its second pole, as of a
/// string that moves in two planes.
std::multimap<std::size_t, DecayMode> seconds_of(std::vector<DecayMode>& others,
                                                 const NumberedModes& numbered, double reach);

/// Numbers of modes that are rather one whose frequency or damping changes along the decay than two
/// poles, as of a string in two planes. Such a one is a sum of poles of one frequency with ever
/// faster decays, of which the second may be the larger: they differ by decay more than by
/// frequency, and the second is above a third. Or it has a third, above kThirdPole. Where no mode
/// has that, and more than twice as many are sure to have two poles, by kTurnOfTwo, the string
/// moves in two planes, and so do those.
std::set<std::size_t> changing_of(const NumberedModes& numbered,
                                  const std::multimap<std::size_t, DecayMode>& seconds);

/// |Δ|/ω up to which a second pole of the share s of a mode's amplitude is not seen: about their
/// mean both have the second moment Δ² s/(1 + s)² of an amplitude 1 + t²/2 Δ² s/(1 + s)², and χ²
/// falls by less than `least` with it. Of t² exp(−dt) over the record's `duration` [s] counts what
/// exp(−dt) and t exp(−dt) leave: of a long one 4/(2d)⁵ beside 1/(2d) of exp(−dt), which the
/// evidence is of. The larger one is off the mean by Δ s/(1 + s).
double unseen_distance(const DecayMode& mode, double share, double least, double duration);

/// Deviations of modes that are one pole hold that they may be two as others are: s and |Δ|/ω are
/// the largest that are told, |Δ| no more than what is not seen. Second poles farther away than 1 %
/// are of something else.
void widen_by_seconds(NumberedModes& numbered, const std::multimap<std::size_t, DecayMode>& seconds,
                      double least, double duration);

}  // namespace modcal
