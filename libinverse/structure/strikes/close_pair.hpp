// Two modes that stand so close together that one pair of poles was fitted to both.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "libinverse/structure/strikes/pole_search.hpp"
#include "libinverse/structure/strikes/strike_weights.hpp"

namespace modcal {

/// What two pairs of poles make of the bins of one.
struct ClosePair {
  std::array<ModalPole, 2> poles;
  std::array<double, 2> shares = {1.0, 0.0};  ///< of their power there, of all sensors
  double gain = 0.0;                          ///< by how much two leave less than one, weighted

  /// How far ln f and ln ζ of both are from those of one, rms, weighted by the square of the share:
  /// of a small pole beside a large one its place says little.
  std::array<double, 2> distance_of(const ModalPole& one) const;
};

/// One pair of poles and two, fitted to the bins about each mode, the other modes taken out as they
/// are.
class ClosePairs {
 public:
  /// All must outlive this; `search` is of these strikes and sensors.
  ClosePairs(const PoleSearch& search, std::span<const SearchedStrike> strikes,
             const std::vector<SensorKind>& kinds, const std::vector<ModalPole>& poles);
  ClosePair of(std::size_t mode) const;
  /// The poles with two of them in the place of that of a mode between low and high [Hz] of which
  /// two take most; empty: of none they do.
  std::vector<ModalPole> parted(double low, double high) const;

 private:
  std::span<const SearchedStrike> strikes_;
  const std::vector<SensorKind>& kinds_;
  const std::vector<ModalPole>& poles_;
  std::vector<SensorFit> fits_;
};

/// The force of a strike and its spectra on a contour that lets what rings late count.
struct LateStrike {
  std::vector<double> force;
  ContourSpectra spectra;
};

/// Pairs by what rings late, by weights of the scatter and noise that a fit found before: the poles
/// of its model, fitted again, and two in the place of each.
class LatePairs {
 public:
  /// `late` and `kinds` must outlive this.
  LatePairs(const std::vector<LateStrike>& late, const std::vector<SensorKind>& kinds,
            const ModalModel& model, const std::vector<SensorScatter>& scatters);
  ClosePair of(std::size_t mode) const { return pairs_->of(mode); }
  /// So many numbers of a further mode pay for what two take more, by BIC (Schwarz, 1978).
  double information(const ClosePair& pair) const {
    return numbers_ * std::log(cost_ / (cost_ - pair.gain)) / std::log(numbers_);
  }

 private:
  std::vector<BinWeights> weights_;
  std::vector<SearchedStrike> strikes_;
  std::vector<ModalPole> poles_;
  std::optional<ClosePairs> pairs_;
  double numbers_ = 0.0, cost_ = 0.0;
};

}  // namespace modcal
