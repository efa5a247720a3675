// What the shape of a force makes doubtful: blows, pushes, and smooth forces.
#include <algorithm>
#include <cmath>

#include "experiments/kinds/structure/force_doubt_parts.hpp"
#include "libinverse/structure/force/force_band.hpp"
#include "libinverse/structure/force/tuning.hpp"
#include "libinverse/structure/tuning.hpp"

namespace modcal::force_doubts {

bool stands_in_peaks(const StructureForce& found) {
  return peakedness(Eigen::Map<const Eigen::VectorXd>(found.force.data(),
                                                      std::ssize(found.force))) > kPeaked;
}

// A force that pushes one way has most of its power near 0 Hz. That is not told where the table's
// band begins above, nor by velocities and accelerations, which vanish with the frequency. A smooth
// force may have such a part; pulses may be taken for the sharp ends of one.
void doubt_slow_part(const StructureForce& found, const LoadedStructureRecord& loaded, double low,
                     ForceShape stated, StudyResult& result) {
  const bool is_static =
      std::ranges::any_of(loaded.kinds, [](SensorKind kind) { return power_of_s(kind) == 0; });
  const bool are_blows = found.shape == ForceShape::kImpacts;
  if ((is_static && found.from_zero) || (are_blows && found.push_odds < 0.0)) return;
  constexpr double kFromZero = 0.45;   // the bin at 0 Hz reaches up to 0.5/T
  constexpr double kLowerBand = 0.25;  // two octaves more
  const std::string untold =
      is_static ? fmt::format("nothing is told of it below {:g} Hz, where the table begins", low)
                : fmt::format("velocities and accelerations tell nothing of it below {:g} Hz", low);
  const std::string remedy =
      is_static ? fmt::format("fit the modes from a lower frequency on (low: {:.2g} Hz or less)",
                              kFromZero / loaded.record.duration())
                : "record a displacement, force or strain as well";
  const bool is_untold = std::isnan(are_blows ? found.push_odds : found.rise);
  const bool is_push = are_blows ? found.push_odds > kPushOdds : found.rise >= kRise;
  const std::string_view or_stated =
      stated == ForceShape::kAuto ? ", or state shape: impacts for blows" : "";
  if ((is_untold || is_push) && stated != ForceShape::kImpacts) {
    const std::string why =
        is_push ? fmt::format(
                      "the force rises towards {:g} Hz, as one that pushes one way for long", low)
                : "the band begins too high to tell whether the force pushes one way";
    // A slow part shows at the lower end of the band: of blows, whose window is short, there; of a
    // smooth force also where the record is long.
    const std::string longer =
        is_push || is_static ? ""
        : are_blows
            ? fmt::format(", or fit the modes from a lower frequency on (low: {:.2g} Hz or less)",
                          kLowerBand * low)
            : ", or record for longer";
    return reject(fmt::format("rejected: {}: {}, and its band does not hold that; {}{}{}", why,
                              untold, remedy, longer, or_stated),
                  result);
  }
  const std::string_view doubt = is_push     ? "its spectrum is that of a push, not of blows: "
                                 : are_blows ? "it may be a push as well as blows: "
                                             : "";
  result.warn(fmt::format(
      "{}where the force pushes one way, this answer is wrong by that and its band does "
      "not hold it, as {}; {}{}",
      doubt, untold, remedy, or_stated));
}

// Pulses that are stated, of a force that has none: they follow it where they stand, and the band
// is that of their heights alone.
void doubt_pulses(const StructureForce& found, ForceShape stated, StudyResult& result) {
  const double odds = found.evidence_smooth - found.evidence_impacts;
  if (stated != ForceShape::kImpacts || !(odds > kSmoothOdds)) return;
  reject(
      fmt::format("rejected: shape: impacts is stated, but the responses are those of a smooth "
                  "force by odds of exp({:.0f}), and the band of pulses does not hold such a one: "
                  "leave shape out, or state shape: smooth; where these are blows, state a window "
                  "in which they lie",
                  odds),
      result);
}

}  // namespace modcal::force_doubts
