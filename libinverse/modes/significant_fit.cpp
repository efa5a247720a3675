#include "libinverse/modes/significant_fit.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "libinverse/modes/pole_distance.hpp"
#include "libinverse/modes/residual_search.hpp"
#include "libinverse/modes/second_pole.hpp"
#include "libinverse/modes/tuning.hpp"

namespace modcal {
namespace {

class Search {
 public:
  Search(const DecayRecord& record, double reach, const DampedSinusoidOptions& options)
      : record_(record),
        reach_(reach),
        options_(options),
        least_(largest_by_chance(record.samples(), 2 * record.channels.size())),
        least_with_pole_(largest_by_chance(record.samples(), 2 * record.channels.size() + 2)) {}

  DampedSinusoidFit fit(const std::vector<DecayPole>& poles) {
    if (poles.empty()) return {};
    DampedSinusoidFit fit = fit_damped_sinusoids(record_, poles, options_);
    spent_ += work_of(fit);
    return fit;
  }
  ResidualLevels levels(const DampedSinusoidFit& fit) const {
    return {record_, fit, options_.in_band_variance};
  }
  /// What χ² falls by at most for one more pole of noise, anywhere and behind one of the modes.
  double least_with_pole() const { return least_with_pole_; }
  double least_of_second(const DampedSinusoidFit& fit) const {
    return largest_by_chance(std::max<std::size_t>(1, fit.modes.size()),
                             2 * record_.channels.size() + 2);
  }
  /// The fit without poles that may be noise, those beside others where χ² rises by less than
  /// least.
  DampedSinusoidFit pruned(DampedSinusoidFit fit, double least) {
    while (!fit.modes.empty() && (leave_out_weak(fit) || leave_out_neighbor(fit, least))) {
    }
    return fit;
  }
  /// The fit with poles that the residual has, and with two where one leaves what two would.
  DampedSinusoidFit extended(DampedSinusoidFit fit) {
    const std::size_t most = kMostOfFirst * fit.modes.size() + kPolesAdded;
    while (fit.full_rank && fit.modes.size() < most && spent_ < kSearchCost) {
      if (!extend(fit)) break;
    }
    return fit;
  }

  std::vector<DecayPole> poles_of(const DampedSinusoidFit& fit) const {
    return poles_without(fit, std::vector<bool>(fit.modes.size()));
  }

 private:
  double rise(const DampedSinusoidFit& from, const DampedSinusoidFit& to) const {
    return chi_square_rise(from, to, options_.in_band_variance);
  }
  DampedSinusoidFit without(const DampedSinusoidFit& fit, const std::vector<bool>& out) {
    return this->fit(poles_without(fit, out));
  }
  // Poles of a fit but those of `out`.
  std::vector<DecayPole> poles_without(const DampedSinusoidFit& fit,
                                       const std::vector<bool>& out) const {
    std::vector<DecayPole> poles;
    for (std::size_t k = 0; k < fit.modes.size(); ++k) {
      if (!out[k]) poles.push_back(startable(fit.modes[k].pole, record_.sample_rate));
    }
    return poles;
  }
  bool leave_out_weak(DampedSinusoidFit& fit) {
    if (fit.modes.empty()) return false;
    const ResidualLevels noise = levels(fit);
    std::vector<bool> out(fit.modes.size());
    for (std::size_t k = 0; k < out.size(); ++k) {
      const double level = noise.largest(fit.modes[k].pole.frequency);
      // A pole that stood badly may have run out of the band.
      const double frequency = fit.modes[k].pole.frequency;
      const bool is_within = frequency > 0.0 && frequency < 0.5 * record_.sample_rate;
      out[k] = !is_within || fit.modes[k].evidence < level * least_;
    }
    if (std::ranges::find(out, true) == out.end()) return false;
    fit = without(fit, out);
    return true;
  }
  bool leave_out_neighbor(DampedSinusoidFit& fit, double least) {
    const ResidualLevels noise = levels(fit);
    const auto level = [&](std::size_t k) { return noise.largest(fit.modes[k].pole.frequency); };
    for (const std::size_t k : neighbors(fit)) {
      std::vector<bool> one(fit.modes.size());
      one[k] = true;
      DampedSinusoidFit next = without(fit, one);
      if (!next.converged || !(rise(fit, next) < level(k) * least)) continue;
      fit = std::move(next);
      return true;
    }
    return false;
  }
  // Those next to one of more evidence, the least first.
  std::vector<std::size_t> neighbors(const DampedSinusoidFit& fit) const {
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < fit.modes.size(); ++k) {
      for (std::size_t i = 0; i < fit.modes.size(); ++i) {
        const double apart = fit.modes[i].pole.frequency - fit.modes[k].pole.frequency;
        if (!(std::abs(apart) < reach_) || !(fit.modes[i].evidence > fit.modes[k].evidence))
          continue;
        found.push_back(k);
        break;
      }
    }
    std::ranges::sort(found, {}, [&](std::size_t k) { return fit.modes[k].evidence; });
    return found;
  }

  // The next of two fits where it is better by more than a pole of noise would make it. One that
  // has not come to its end goes on with the poles of the next round.
  bool take(DampedSinusoidFit& fit, DampedSinusoidFit next, double least) const {
    const bool better =
        next.full_rank && next.modes.size() >= fit.modes.size() && rise(next, fit) > least;
    if (better) fit = std::move(next);
    return better;
  }
  bool attempt(DampedSinusoidFit& fit, const std::vector<DecayPole>& poles, double least) {
    // Of eight samples for every pole there are two for every unknown of a single channel.
    const double cost = static_cast<double>(options_.iterations * poles.size() * record_.samples() *
                                            record_.channels.size());
    if (poles.empty() || 8 * poles.size() > record_.samples() || spent_ + cost > kSearchCost) {
      return false;
    }
    DampedSinusoidFit next = this->fit(poles);
    while (leave_out_weak(next)) {
    }
    return take(fit, std::move(next), least);
  }

  // Modes that depart from one damped sinusoid, those that do most first.
  std::vector<std::size_t> departing(const DampedSinusoidFit& fit) const {
    const ResidualLevels noise = levels(fit);
    const double least = least_departure(fit.modes.size(), record_.channels.size());
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < fit.modes.size(); ++k) {
      const double level = noise.largest(fit.modes[k].pole.frequency);
      if (fit.modes[k].departure > level * least) found.push_back(k);
    }
    std::ranges::sort(found, std::greater(), [&](std::size_t k) { return fit.modes[k].departure; });
    return found;
  }
  // Where one of the residual's poles or a second one of a mode that departs stands beside modes,
  // these are fitted with it alone first: from there the fit of all comes to its end in a few
  // steps. Then all of them at once, or the first alone.
  bool extend(DampedSinusoidFit& fit) {
    Extension all{.whole = poles_of(fit), .changed = std::vector<bool>(fit.modes.size())};
    Extension first = all;
    for (const DecayPole& pole : in_residual(fit)) {
      const std::size_t k = nearest_to(pole, fit);
      if (k == fit.modes.size()) {
        all.poles.push_back(startable(pole, record_.sample_rate));
      } else {
        all.take(fit_beside(fit, k, pole, least_with_pole_));
      }
      if (first.poles.empty()) first = all;
    }
    // There are as many places for a second pole as modes.
    for (const std::size_t k : departing(fit)) {
      if (all.changed[k]) continue;
      all.take(fit_beside(fit, k, {}, least_of_second(fit)));
      if (first.poles.empty()) first = all;
    }
    const double least = least_of_second(fit);
    return !all.poles.empty() &&
           (attempt(fit, all.start(), least) ||
            (first.poles.size() < all.poles.size() && attempt(fit, first.start(), least)));
  }

  // Poles in the place of some of those there are.
  struct Extension {
    std::vector<DecayPole> whole;
    std::vector<bool> changed;
    std::vector<DecayPole> poles = {};

    // A neighbor that is in other poles already waits for the next round, or it would be there
    // twice.
    void take(const SecondPole& found) {
      const auto is_changed = [&](std::size_t i) { return changed[i]; };
      if (found.poles.empty() || std::ranges::any_of(found.replaced, is_changed)) return;
      poles.insert(poles.end(), found.poles.begin(), found.poles.end());
      for (const std::size_t i : found.replaced) changed[i] = true;
    }
    std::vector<DecayPole> start() const {
      std::vector<DecayPole> result = poles;
      for (std::size_t k = 0; k < whole.size(); ++k) {
        if (!changed[k]) result.push_back(whole[k]);
      }
      return result;
    }
  };

  SecondPole fit_beside(const DampedSinusoidFit& fit, std::size_t k,
                        const std::optional<DecayPole>& start, double least) {
    SecondPole found = fit_one_more(fit, k, record_.sample_rate, reach_, least, options_, start);
    spent_ += found.work;
    return found;
  }
  std::vector<DecayPole> in_residual(const DampedSinusoidFit& fit) const {
    std::vector<DecayPole> poles = poles_in_residual(fit, levels(fit), record_.sample_rate,
                                                     options_.in_band_variance, least_with_pole_);
    poles.resize(std::min(poles.size(), kPolesAdded));
    return poles;
  }
  // The mode beside which a pole stands; none: as many as there are.
  std::size_t nearest_to(const DecayPole& pole, const DampedSinusoidFit& fit) const {
    std::size_t nearest = fit.modes.size();
    double least = reach_;
    for (std::size_t k = 0; k < fit.modes.size(); ++k) {
      const double apart = std::abs(fit.modes[k].pole.frequency - pole.frequency);
      if (apart < least) least = apart, nearest = k;
    }
    return nearest;
  }

  const DecayRecord& record_;
  double reach_;
  const DampedSinusoidOptions& options_;
  double least_, least_with_pole_;
  double spent_ = 0.0;
};

// Error bars and departures of the noise that is about a mode.
void scale(DampedSinusoidFit& fit, const ResidualLevels& levels) {
  for (std::size_t k = 0; k < fit.modes.size(); ++k) {
    DecayMode& mode = fit.modes[k];
    double sum = 0.0, weights = 0.0;
    for (std::size_t c = 0; c < mode.amplitude.size(); ++c) {
      const double weight = std::norm(mode.amplitude[c]) / (fit.noise[c] * fit.noise[c]);
      sum += weight * levels.at(c, mode.pole.frequency);
      weights += weight;
    }
    const double factor = weights > 0.0 ? std::sqrt(sum / weights) : 1.0;
    mode.deviation.frequency *= factor;
    mode.deviation.damping_ratio *= factor;
    mode.departure /= levels.largest(mode.pole.frequency);
    mode.evidence /= levels.largest(mode.pole.frequency);
  }
}

}  // namespace

double largest_by_chance(std::size_t places, std::size_t degrees) {
  const double allowed = 1e-3 / static_cast<double>(places);
  for (double half = 1.0;; half += 0.25) {
    // P(χ² > x) = exp(−x/2) Σ (x/2)^i/i!
    double term = std::exp(-half), sum = 0.0;
    for (std::size_t i = 0; 2 * i < degrees; ++i) {
      sum += term;
      term *= half / static_cast<double>(i + 1);
    }
    if (sum < allowed) return 2.0 * half;
  }
}

double least_departure(std::size_t modes, std::size_t channels) {
  return largest_by_chance(modes, 4 * channels - 2);
}

DampedSinusoidFit fit_significant(const DecayRecord& record, const std::vector<DecayPole>& start,
                                  double reach, bool search_residual,
                                  const DampedSinusoidOptions& options) {
  // Which poles there are is told by fits that end within a hundredth of a deviation.
  DampedSinusoidOptions rough = options;
  rough.tolerance = std::max(rough.tolerance, 1e-2);
  rough.iterations = std::min(rough.iterations, std::size_t{20});
  Search search(record, reach, rough);
  DampedSinusoidFit fit = search.pruned(search.fit(start), search.least_with_pole());
  if (search_residual) {
    fit = search.extended(std::move(fit));
    const double least = search.least_of_second(fit);
    fit = search.pruned(std::move(fit), least);
  }
  if (fit.modes.empty()) return fit;
  // Of roundings of the record the last steps may go on for ever; a hundredth is enough.
  DampedSinusoidFit fine = fit_damped_sinusoids(record, search.poles_of(fit), options);
  if (fine.converged || !fit.converged) fit = std::move(fine);
  const ResidualLevels levels = search.levels(fit);
  scale(fit, levels);
  if (fit.full_rank) {
    widen_by_distance(fit, record.sample_rate, reach, options.in_band_variance, levels);
  }
  return fit;
}

}  // namespace modcal
