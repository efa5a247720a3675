#include "libinverse/waves/saturation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "libinverse/waves/end_residual.hpp"
#include "libinverse/waves/tuning.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr std::size_t kDrives = std::size(kSaturationDrives);
using Drives = std::array<std::size_t, 2>;

double missing_share(double drive) { return drive > 0.0 ? 1.0 - std::tanh(drive) / drive : 0.0; }

// What a sensor of this drive read, before it saturated.
std::vector<double> raised(std::span<const double> samples, double drive) {
  std::vector<double> result(samples.begin(), samples.end());
  const double peak = largest_magnitude(samples);
  if (drive == 0.0 || peak == 0.0) return result;
  const double most = std::tanh(drive);
  for (double& x : result) x = peak / drive * std::atanh(most * x / peak);
  return result;
}

/// The reactions at the strongest bins, raised by every drive.
class RaisedRecord {
 public:
  RaisedRecord(const EndRecord& record, double fundamental) {
    // Some hundred periods tell it as well as all.
    const auto most =
        static_cast<std::size_t>(kSaturationPeriods * record.sample_rate / fundamental);
    const std::size_t count = std::min(record.left.size(), most);
    const std::size_t first = (record.left.size() - count) / 2;
    const std::span<const double> parts[] = {record.left.subspan(first, count),
                                             record.right.subspan(first, count)};
    std::array<std::array<std::vector<Complex>, kDrives>, 2> spectra;
    for (std::size_t r = 0; r < 2; ++r) {
      for (std::size_t d = 0; d < kDrives; ++d) {
        spectra[r][d] = hann_spectrum(raised(parts[r], kSaturationDrives[d]));
      }
    }
    const double width = record.sample_rate / static_cast<double>(count);
    const std::vector<std::size_t> bins =
        strongest(spectra[0][0], spectra[1][0], kRelationBottom * fundamental / width,
                  std::min(kRelationTop * fundamental, 0.4 * record.sample_rate) / width);
    for (const std::size_t k : bins) frequency_.push_back(static_cast<double>(k) * width);
    for (std::size_t r = 0; r < 2; ++r) {
      for (std::size_t d = 0; d < kDrives; ++d) {
        for (const std::size_t k : bins) reactions_[r][d].push_back(spectra[r][d][k]);
      }
    }
  }

  // Share of the power that no string near this one explains, at any gain; `string` becomes it.
  double unexplained(const Drives& drives, StatedString& string) const {
    double least = left_by(drives, string);
    double f_step = 2.0 * kFundamentalStep, x_step = kContactStep;
    for (int round = 0; round < kRefinements; ++round) {
      for (int move = 0; move < kFundamentalSteps && step(drives, f_step, x_step, string, least);
           ++move) {
      }
      f_step *= 0.5;
      x_step *= 0.5;
    }
    return least;
  }

 private:
  static std::vector<std::size_t> strongest(const std::vector<Complex>& left,
                                            const std::vector<Complex>& right, double from,
                                            double to) {
    const auto first = static_cast<std::size_t>(std::ceil(from));
    const auto last = std::min(static_cast<std::size_t>(to), left.size() - 1);
    std::vector<std::size_t> bins(last > first ? last - first : 0);
    std::iota(bins.begin(), bins.end(), first);
    double power[2] = {0.0, 0.0};
    for (const std::size_t k : bins) {
      power[0] += std::norm(left[k]);
      power[1] += std::norm(right[k]);
    }
    const auto weight = [&](std::size_t k) {
      return std::norm(left[k]) / power[0] + std::norm(right[k]) / power[1];
    };
    std::ranges::sort(bins, [&](std::size_t a, std::size_t b) { return weight(a) > weight(b); });
    bins.resize(std::min(bins.size(), kSaturationBins));
    return bins;
  }

  // Drives are tried from the same string, in the same steps: most strings come again.
  const std::vector<EndFactors>& factors_of(const StatedString& string) const {
    std::vector<EndFactors>& factors = factors_[{string.fundamental, string.contact}];
    if (factors.empty()) {
      factors.reserve(frequency_.size());
      for (const double frequency : frequency_) factors.push_back(end_factors(frequency, string));
    }
    return factors;
  }

  // 1 − Re Σ x y*/√(Σ|x|² Σ|y|²) of x = R₁ sin kx_c and y = R₂ sin k(L − x_c).
  double left_by(const Drives& drives, const StatedString& string) const {
    const auto &left = reactions_[0][drives[0]], &right = reactions_[1][drives[1]];
    const std::vector<EndFactors>& factors = factors_of(string);
    double powers[2] = {0.0, 0.0}, product = 0.0;
    for (std::size_t i = 0; i < frequency_.size(); ++i) {
      const Complex x = factors[i].left * left[i], y = factors[i].right * right[i];
      powers[0] += std::norm(x);
      powers[1] += std::norm(y);
      product += x.real() * y.real() + x.imag() * y.imag();
    }
    const double scale = std::sqrt(powers[0] * powers[1]);
    return scale > 0.0 ? 1.0 - product / scale : 1.0;
  }

  // To the best of the eight strings around, if it is better.
  bool step(const Drives& drives, double f_step, double x_step, StatedString& string,
            double& least) const {
    const StatedString from = string;
    bool better = false;
    for (int f = -1; f <= 1; ++f) {
      for (int x = -1; x <= 1; ++x) {
        if (f == 0 && x == 0) continue;
        StatedString other = from;
        other.fundamental *= 1.0 + f_step * f;
        other.contact += x_step * from.length * x;
        if (!(other.contact > 0.0 && other.contact < from.length)) continue;
        const double left = left_by(drives, other);
        if (!(left < least)) continue;
        least = left;
        string = other;
        better = true;
      }
    }
    return better;
  }

  std::vector<double> frequency_;
  std::array<std::array<std::vector<Complex>, kDrives>, 2> reactions_;
  mutable std::map<std::pair<double, double>, std::vector<EndFactors>> factors_;  // of f0, x_c
};

}  // namespace

std::optional<Saturation> saturation_of(const EndRecord& record, StatedString string) {
  const RaisedRecord reactions(record, string.fundamental);
  Saturation found;
  found.unexplained = found.mended = reactions.unexplained({0, 0}, string);
  Drives best = {0, 0};
  StatedString nearest = string;
  const auto try_drives = [&](const Drives& drives) {
    if (drives == best) return;
    StatedString other = nearest;
    const double left = reactions.unexplained(drives, other);
    if (!(left < found.mended)) return;
    found.mended = left;
    best = drives;
    nearest = other;
  };
  for (std::size_t d = 1; d < kDrives; ++d) try_drives({d, d});
  // A round that finds no better drives would find none again, from the same string.
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 2 && found.mended < before; ++round) {
    before = found.mended;
    for (std::size_t d = 0; d < kDrives; ++d) try_drives({d, best[1]});
    for (std::size_t d = 0; d < kDrives; ++d) try_drives({best[0], d});
  }
  // The search began from a string that may be the wrong one: as it was read, from the best, too.
  found.unexplained = std::min(found.unexplained, reactions.unexplained({0, 0}, nearest));
  if (!(kSaturationEvidence * found.mended < found.unexplained)) return std::nullopt;
  for (std::size_t r = 0; r < 2; ++r) found.missing[r] = missing_share(kSaturationDrives[best[r]]);
  return found;
}

}  // namespace modcal
