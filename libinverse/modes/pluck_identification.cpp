#include "libinverse/modes/pluck_identification.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "libinverse/modes/decay_hum.hpp"
#include "libinverse/modes/decay_record.hpp"
#include "libinverse/modes/mode_numbers.hpp"
#include "libinverse/modes/residual_search.hpp"
#include "libinverse/modes/significant_fit.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/words.hpp"

namespace modcal {
namespace {

DecayRecord after(const DecayRecord& record, double skip) {
  const double skipped = std::ceil(skip * record.sample_rate);
  MODCAL_REQUIRE(skipped < static_cast<double>(record.samples()),
                 "{:g} s are left out of a record of {:g} s", skip,
                 static_cast<double>(record.samples()) / record.sample_rate);
  const auto first = static_cast<std::size_t>(skipped);
  DecayRecord rest{.sample_rate = record.sample_rate, .rounding = record.rounding};
  for (const auto& channel : record.channels) {
    rest.channels.emplace_back(channel.begin() + static_cast<std::ptrdiff_t>(first), channel.end());
  }
  return rest;
}

enum class Method { kRealization, kMaximumLikelihood };
constexpr std::array<std::string_view, 2> kMethods = {"era", "maximum_likelihood"};
Method method_of(const PluckOptions& options) {
  return enum_of<Method>(kMethods, "method", options.method);
}

// A second pole of a mode stands within some bins of it, and nearer than the next mode [Hz].
double reach_of(double fundamental, double duration) {
  const double bins = 10.0 / duration;
  return std::isnan(fundamental) ? bins : std::min(0.25 * fundamental, bins);
}

// Frequencies from `lowest` to `highest` at which the residual is more than noise [Hz].
std::vector<double> left_by(const DampedSinusoidFit& fit, const DecimatedDecay& decay,
                            double lowest, double highest) {
  const double rate = decay.record.sample_rate, variance = decay.in_band_variance();
  const double least =
      2.0 * largest_by_chance(decay.record.samples(), 2 * decay.record.channels.size() + 2);
  std::vector<double> left;
  for (const DecayPole& pole :
       poles_in_residual(fit, ResidualLevels(decay.record, fit, variance), rate, variance, least)) {
    if (pole.frequency > lowest && pole.frequency < highest) left.push_back(pole.frequency);
  }
  return left;
}

// Amplitudes come from the fit for both methods; for era the poles are left where they are.
std::vector<DecayMode> modes_of(const DecimatedDecay& decay, const std::vector<StablePole>& stable,
                                double fundamental, const PluckOptions& options,
                                bool search_residual, PluckIdentification& result) {
  std::vector<DecayPole> start;
  for (const StablePole& pole : stable) start.push_back(pole.pole);
  const bool likelihood = method_of(options) == Method::kMaximumLikelihood;
  const DampedSinusoidOptions how = {.iterations = likelihood ? std::size_t{50} : std::size_t{0},
                                     .in_band_variance = decay.in_band_variance(),
                                     .lines = result.lines};
  const double duration = static_cast<double>(decay.record.samples()) / decay.record.sample_rate;
  const double reach = reach_of(fundamental, duration);
  const DampedSinusoidFit fit =
      likelihood ? fit_significant(decay.record, start, reach, search_residual, how)
                 : fit_damped_sinusoids(decay.record, start, how);
  if (search_residual && likelihood && !fit.modes.empty()) {
    const double lowest = std::isnan(fundamental) ? options.lowest_frequency : 0.5 * fundamental;
    result.left = left_by(fit, decay, lowest, options.highest_frequency);
  }
  result.converged = fit.converged || !likelihood;
  result.full_rank = fit.full_rank && likelihood;
  if (likelihood) {
    for (const double noise : fit.noise) {
      result.noise.push_back(noise * std::sqrt(decay.in_band_variance()));
    }
  }
  std::vector<DecayMode> modes = fit.modes;
  result.poles.clear();
  for (std::size_t k = 0; k < modes.size(); ++k) {
    result.poles.push_back(modes[k]);
    if (!likelihood) modes[k].deviation = stable[k].spread;
    const std::complex<double> gain = decay.gain(modes[k].pole.exponent());
    for (auto& amplitude : modes[k].amplitude) amplitude /= gain;
  }
  return modes;
}

// A weak mode that was not stable leaves a signal that no other explains. It stands where the law
// has it and decays as fast as its neighbor.
std::vector<StablePole> with_missing(std::vector<StablePole> stable, const NumberedModes& numbered,
                                     const LawNumbers& law) {
  for (const std::size_t number : missing_in(numbered)) {
    const DecayPole& neighbor = numbered.upper_bound(number)->second.pole;
    const double frequency = law.frequency(number);
    stable.push_back(
        {.pole = {.frequency = frequency,
                  .damping_ratio = neighbor.damping_ratio * neighbor.frequency / frequency}});
  }
  return stable;
}

DecimatedDecay band_of(const DecayRecord& record, double fundamental, const PluckOptions& options) {
  record.require_valid();
  MODCAL_REQUIRE(std::isnan(fundamental) || (fundamental > 0.0 && std::isfinite(fundamental)),
                 "fundamental {:g} Hz must be > 0: it numbers the modes", fundamental);
  method_of(options);
  return decimate(after(record, options.skip), options.highest_frequency);
}

// Poles over the orders, and those that are stable.
struct Realized {
  Realized(const DecayRecord& decay, const PluckOptions& options) {
    const EigensystemRealization realization(decay, static_cast<std::size_t>(options.block_rows),
                                             static_cast<std::size_t>(options.columns));
    const Eigen::VectorXd& sigma = realization.singular_values();
    singular_values.assign(sigma.begin(), sigma.end());
    diagram = stabilization_diagram(realization, options.stabilization);
    stable = stable_poles(diagram, options.stabilization);
  }

  std::vector<double> singular_values;
  std::vector<StabilizationPoint> diagram;
  std::vector<StablePole> stable;
};

// Lines that stand apart from the poles are taken out before the realization, which has too few
// orders for both. Of one that is left the realization has a pole, which the fit would have twice;
// the fit before tells that it is a line's.
Realized beside_hum(const DecayRecord& decay, const PluckIdentification& known, double fundamental,
                    const PluckOptions& options) {
  Realized realized(without_hum(decay, known.lines, known.poles, fundamental), options);
  const double duration = static_cast<double>(decay.samples()) / decay.sample_rate;
  std::erase_if(realized.stable, [&](const StablePole& stable) {
    const auto distance = [&](const DecayMode& other) {
      return std::abs(other.pole.frequency - stable.pole.frequency);
    };
    const auto nearest = std::ranges::min_element(known.poles, {}, distance);
    return is_line({.pole = stable.pole, .deviation = stable.spread}, known.lines, duration) ||
           (nearest != known.poles.end() && is_line(*nearest, known.lines, duration) &&
            distance(*nearest) < 3.0 / duration);
  });
  return realized;
}

PluckIdentification identified(const DecimatedDecay& decay, Realized realized, double fundamental,
                               const PluckOptions& options, bool search_residual,
                               std::vector<double> lines) {
  PluckIdentification result{.diagram = std::move(realized.diagram),
                             .singular_values = std::move(realized.singular_values),
                             .lines = std::move(lines)};
  const std::vector<StablePole>& stable = realized.stable;
  if (stable.empty()) return result;
  const double duration = static_cast<double>(decay.record.samples()) / decay.record.sample_rate;
  std::vector<DecayMode> others;
  const auto number = [&](std::vector<DecayMode> modes, LawNumbers& law) {
    std::erase_if(modes, [&](const DecayMode& mode) {
      return is_line(mode, result.lines, duration) ||
             mode.pole.damping_ratio > options.stabilization.highest_damping;
    });
    others.clear();
    if (std::isnan(fundamental)) {
      return modes_in_order(std::move(modes), options.lowest_frequency, options.highest_frequency);
    }
    return numbered_modes(std::move(modes), options.highest_frequency, law, others);
  };
  LawNumbers law(fundamental);
  NumberedModes numbered =
      number(modes_of(decay, stable, fundamental, options, search_residual, result), law);
  if (!result.converged && !missing_in(numbered).empty()) {
    PluckIdentification again = result;
    again.noise.clear();
    std::vector<DecayMode> modes = modes_of(decay, with_missing(stable, numbered, law), fundamental,
                                            options, search_residual, again);
    if (again.converged && again.full_rank) {
      result = std::move(again);
      law = LawNumbers(fundamental);
      numbered = number(std::move(modes), law);
    }
  }
  result.missing = missing_in(numbered);
  result.duration = duration;
  const auto seconds = seconds_of(others, numbered, reach_of(fundamental, duration));
  result.others = heard_of(std::move(others), numbered);
  const double least = least_departure(result.poles.size(), decay.record.channels.size());
  if (result.full_rank) widen_by_seconds(numbered, seconds, least, duration);
  const std::set<std::size_t> changing = changing_of(numbered, seconds);
  for (auto& [n, mode] : numbered) {
    if (result.full_rank && (changing.contains(n) || mode.departure > 2.0 * least)) {
      result.departing.push_back(n);
    }
    result.modes.push_back({n, std::move(mode)});
  }
  for (const auto& [n, mode] : seconds) result.seconds.push_back({n, mode});
  return result;
}

}  // namespace

void PluckOptions::visit(OptionVisitor& visitor) {
  visitor("lowest_frequency", "lower end of the band in which modes are looked for",
          {.unit = "Hz", .range = Range::non_negative()}, lowest_frequency);
  visitor("highest_frequency", "upper end of the band in which modes are looked for",
          {.unit = "Hz", .range = Range::positive()}, highest_frequency);
  visitor("method", "realization alone, or followed by a fit of all damped sinusoids",
          {.choices = choices_of(kMethods)}, method);
  visitor("skip", "time left out after the pluck", {.unit = "s", .range = Range::non_negative()},
          skip);
  visitor("block_rows", "samples in a column of the Hankel matrix",
          {.range = Range::closed(2, 5000)}, block_rows);
  visitor("columns", "columns of the Hankel matrix, spread over the record",
          {.range = Range::closed(2, 5000)}, columns);
  visitor("stabilization", "which poles count as modes", stabilization);
}

PluckIdentification identify_pluck(const DecayRecord& record, double fundamental,
                                   const PluckOptions& options) {
  const DecimatedDecay decay = band_of(record, fundamental, options);
  const Realized realized(decay.record, options);
  // Hum is looked for beside the modes first: in the residual it would be so many poles.
  PluckIdentification found = identified(decay, realized, fundamental, options, false, {});
  const std::vector<double> lines = hum_in(decay.record, found.poles, fundamental);
  if (lines.empty()) return identified(decay, realized, fundamental, options, true, {});
  found.lines = lines;
  return identified(decay, beside_hum(decay.record, found, fundamental, options), fundamental,
                    options, true, lines);
}

double unseen_shift(const PluckIdentification& found, const PluckedMode& plucked) {
  const DecayMode& mode = plucked.mode;
  if (!found.full_rank || std::ranges::find(found.seconds, plucked.number, &PluckedMode::number) !=
                              found.seconds.end()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  constexpr double kThird = 1.0 / 3.0;
  const double least = least_departure(found.poles.size(), mode.amplitude.size());
  const double distance = unseen_distance(mode, kThird, least, found.duration);
  return kThird / (1.0 + kThird) * mode.pole.frequency * distance;
}

void require_decay_length(std::size_t samples, double sample_rate, const PluckOptions& options) {
  const double skipped = std::ceil(options.skip * sample_rate);
  const double duration = static_cast<double>(samples) / sample_rate;
  MODCAL_REQUIRE(skipped < static_cast<double>(samples),
                 "the first {:g} s are left out of a decay of {:.3g} s: record a longer one, or "
                 "skip less",
                 options.skip, duration);
  const Decimation left = decimation_of(samples - static_cast<std::size_t>(skipped), sample_rate,
                                        options.highest_frequency);
  const std::size_t least = 2 * static_cast<std::size_t>(options.block_rows) + 1;
  const std::size_t kept = left.kept;
  MODCAL_REQUIRE(
      kept >= least,
      "a decay of {:.3g} s leaves {} samples at {:g} Hz, too few for {} block rows: record "
      "{:.3g} s more, or take fewer block rows",
      duration, kept, left.rate, options.block_rows,
      static_cast<double>(least - std::min(kept, least)) / left.rate);
}

}  // namespace modcal
