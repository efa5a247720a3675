#include "experiments/kinds/identify/identify_record.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "experiments/kinds/identify/identify.hpp"
#include "experiments/kinds/invert/invert.hpp"
#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/structure/structure_kinds.hpp"
#include "libinverse/modes/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/records/levels.hpp"

namespace modcal {
namespace {

// First sample of the period in which the channels change most; each counts alike.
std::size_t liveliest(const std::vector<std::vector<double>>& channels, std::size_t period) {
  const std::size_t periods = channels.front().size() / period;
  std::vector<double> changes(periods, 0.0);
  for (const std::vector<double>& channel : channels) {
    std::vector<double> own(periods, 0.0);
    for (std::size_t j = 1; j < periods * period; ++j) {
      own[j / period] += std::pow(channel[j] - channel[j - 1], 2);
    }
    const double whole = std::accumulate(own.begin(), own.end(), 0.0);
    for (std::size_t i = 0; i < periods && whole > 0.0; ++i) changes[i] += own[i] / whole;
  }
  return period * static_cast<std::size_t>(std::ranges::max_element(changes) - changes.begin());
}

// The step of a signal all of whose values are multiples of it; 0: there is none.
double step_of(const std::vector<double>& samples) {
  const double step = resolution_of(samples);
  const bool all = std::isfinite(step) && std::ranges::all_of(samples, [&](double x) {
                     const double place = (x - samples.front()) / step;
                     return std::abs(place - std::round(place)) < 0.1;
                   });
  return all ? step : 0.0;
}

// Where the last period ends in which the signal's rms is four steps: what is rounded off below is
// no noise, it follows the signal. The number of samples where there is no step.
std::size_t resolved_until(const std::vector<double>& samples, std::size_t period) {
  const double step = step_of(samples);
  const std::size_t periods = samples.size() / period;
  if (!(step > 0.0)) return samples.size();
  for (std::size_t i = periods; i > 0; --i) {
    const auto first = samples.begin() + static_cast<std::ptrdiff_t>((i - 1) * period);
    double sum = 0.0, squares = 0.0;
    for (auto x = first; x != first + static_cast<std::ptrdiff_t>(period); ++x) {
      sum += *x - *first;
      squares += (*x - *first) * (*x - *first);
    }
    const double n = static_cast<double>(period);
    if (squares / n - sum * sum / (n * n) < 16.0 * step * step) continue;
    return i == periods ? samples.size() : i * period;
  }
  return 0;
}

// All of what was recorded.
PluckedRecord recorded(const IdentifyOptions& options, const std::filesystem::path& folder,
                       const StopToken& stop) {
  if (options.has_structure) {
    LoadedStructureRecord loaded = load_structure_record(options.structure.record, folder, stop);
    return {.decay = {.sample_rate = loaded.record.sample_rate,
                      .channels = std::move(loaded.record.responses)},
            .names = std::move(loaded.names),
            .warnings = std::move(loaded.warnings)};
  }
  RecordedSignals signals = load_record(options.record, folder, stop);
  PluckedRecord result{.decay = {.sample_rate = signals.sample_rate},
                       .warnings = std::move(signals.warnings)};
  for (std::optional<Signal>* reaction : {&signals.left, &signals.right}) {
    if (*reaction) result.decay.channels.push_back(std::move((*reaction)->samples));
  }
  return result;
}

// Of the lowest mode, in samples.
std::size_t longest_period(const IdentifyOptions& options, std::size_t samples, double rate) {
  const double lowest =
      options.has_structure ? options.identification.lowest_frequency : options.fundamental;
  constexpr std::size_t kParts = 50;
  if (!(lowest > 0.0)) return std::max<std::size_t>(1, samples / kParts);
  const double period = std::ceil(rate / lowest);
  MODCAL_REQUIRE(static_cast<double>(samples) >= 3.0 * period,
                 "{} samples are less than three periods of {:g} Hz: state a longer part of the "
                 "record",
                 samples, lowest);
  return static_cast<std::size_t>(period);
}

}  // namespace

PluckedRecord load_decay(const IdentifyOptions& options, const std::filesystem::path& folder,
                         const StopToken& stop) {
  PluckedRecord result = recorded(options, folder, stop);
  const double rate = result.decay.sample_rate;
  const std::vector<std::vector<double>> channels = std::exchange(result.decay.channels, {});
  const std::size_t period = longest_period(options, channels.front().size(), rate);
  const std::size_t first = liveliest(channels, period) + period;
  result.begin = static_cast<double>(first) / rate;
  std::size_t end = channels.front().size();
  for (const std::vector<double>& channel : channels) {
    end = std::min(
        end,
        first + resolved_until(
                    {channel.begin() + static_cast<std::ptrdiff_t>(first), channel.end()}, period));
  }
  result.end = static_cast<double>(end) / rate;
  MODCAL_REQUIRE(channels.front().size() >= first + 3 * period,
                 "the record changes most before {:.3g} s, and less than three periods of the "
                 "lowest mode are left behind: record it for longer, or state record.stop before",
                 result.begin);
  MODCAL_REQUIRE(end >= first + 3 * period,
                 "the decay has an rms of less than four of the record's steps from {:.3g} s on: "
                 "record it with more gain or more bits",
                 result.end);
  if (end < channels.front().size()) {
    result.warnings.push_back(fmt::format(
        "the decay is used up to {:.3g} s: from there on its rms is less than four of the record's "
        "steps, and what they round off is no noise; more gain or more bits make use of the rest",
        result.end));
  }
  for (const std::vector<double>& channel : channels) {
    std::vector<double>& samples =
        result.decay.channels.emplace_back(channel.begin() + static_cast<std::ptrdiff_t>(first),
                                           channel.begin() + static_cast<std::ptrdiff_t>(end));
    const double mean = std::accumulate(samples.begin(), samples.end(), 0.0) /
                        std::max(1.0, static_cast<double>(samples.size()));
    for (double& x : samples) x -= mean;
    result.decay.rounding.push_back(rounding_level(white_noise_rms(samples), step_of(samples)));
  }
  return result;
}

namespace {

std::string numbers_text(const std::vector<std::size_t>& numbers) {
  return fmt::format("{} {}", numbers.size() > 1 ? "modes" : "mode", fmt::join(numbers, ", "));
}

}  // namespace

std::vector<double> shares_left(const PluckIdentification& found, const DecayRecord& decay) {
  std::vector<double> shares;
  for (std::size_t k = 0; k < found.noise.size(); ++k) {
    double power = 0.0;
    for (const double x : decay.channels[k]) power += x * x;
    const double rms = std::sqrt(power / static_cast<double>(decay.channels[k].size()));
    shares.push_back(found.noise[k] / rms);
  }
  return shares;
}

std::string rejection_of(const PluckIdentification& found, const PluckedRecord& record,
                         double fundamental, const std::optional<StiffStringFit>& law) {
  std::size_t damped = 0;
  for (const auto& [number, mode] : found.modes) {
    if (mode.pole.damping_ratio > 3.0 * mode.deviation.damping_ratio) ++damped;
  }
  if (2 * damped < found.modes.size()) {
    return fmt::format(
        "rejected: {} of {} modes decay by more than what noise makes of them: this is no free "
        "decay; state record.start and record.stop of one, behind the pluck",
        damped, found.modes.size());
  }
  const std::vector<double> unexplained = shares_left(found, record.decay);
  const auto worst = std::ranges::max_element(unexplained);
  // A sensor at a node of all modes reads noise; that of a string reads all of them.
  const bool is_string = record.names.empty();
  const auto least = std::ranges::min_element(unexplained);
  if (worst != unexplained.end() && (is_string ? *worst : *least) > 0.5) {
    const auto k = static_cast<std::size_t>(worst - unexplained.begin());
    return fmt::format(
        "rejected: the modes leave {:.0f} % of {}: the record holds more than one free decay in "
        "the band; lower identification.highest_frequency or state another part, and high-pass the "
        "record below the first mode where its sensor drifts",
        100.0 * *worst, is_string ? fmt::format("reaction {}", k + 1) : record.names[k]);
  }
  if (!found.left.empty()) {
    return fmt::format(
        "rejected: damped sinusoids leave more than noise of the record, most at {:.4g} Hz: it "
        "holds more than one free decay, as where something still moves the {} or the sensor; "
        "state record.start behind that and record.stop before it, or lower "
        "identification.highest_frequency",
        found.left.front(), record.names.empty() ? "string" : "structure");
  }
  if (!found.departing.empty()) {
    return fmt::format(
        "rejected: {} {} neither one damped sinusoid nor two: the frequency or the damping changes "
        "along the decay, as where it is strong, or something else moves the {}; state another "
        "part "
        "of the record, or excite it less",
        numbers_text(found.departing), found.departing.size() > 1 ? "are" : "is",
        record.names.empty() ? "string" : "structure");
  }
  if (std::isnan(fundamental)) return {};
  std::size_t divisor = 0;
  for (const auto& [number, mode] : found.modes) divisor = std::gcd(divisor, number);
  if (found.modes.size() > 2 && divisor > 1) {
    return fmt::format(
        "rejected: the number of every mode is a multiple of {0}, as of a string {0} times as "
        "high: "
        "state fundamental: {1:g} Hz",
        divisor, static_cast<double>(divisor) * fundamental);
  }
  if (law && !(std::abs(law->fundamental / fundamental - 1.0) < 0.03)) {
    return fmt::format(
        "rejected: the modes tell f0 = {:.5g} Hz, not the {:g} Hz that number them: state the "
        "string's own fundamental",
        law->fundamental, fundamental);
  }
  return {};
}

std::string why_nothing(const IdentifyOutcome& outcome) {
  if (outcome.record && !outcome.found.diagram.empty()) {
    return "rejected: no pole that is stable over the orders decays as a mode of this string, or "
           "structure, does: state record.start and record.stop of a free decay, behind the pluck, "
           "or record a longer one with less noise";
  }
  return "no pole is stable over the orders: nothing was identified; record a longer decay with "
         "less noise, or raise identification's orders";
}

std::vector<Finding> IdentifyOptions::lint_records(const std::filesystem::path& folder) const {
  std::vector<Finding> findings;
  const std::string file = has_structure ? "structure.record.file" : "record.file";
  if (!has_structure && (!has_record || std::isnan(fundamental))) return findings;
  lint_making(findings, file, [&] {
    PluckedRecord pluck;
    try {
      pluck = load_decay(*this, folder);
    } catch (const WrongRecordKey& error) {
      throw WrongKey("record." + error.key(), error.what());
    }
    const DecayRecord& decay = pluck.decay;
    MODCAL_REQUIRE(identification.highest_frequency < 0.5 * decay.sample_rate,
                   "half the record's sample rate, {:g} Hz, is not above "
                   "identification.highest_frequency, {:g} Hz: lower that",
                   0.5 * decay.sample_rate, identification.highest_frequency);
    require_decay_length(decay.channels.front().size(), decay.sample_rate, identification);
    for (const std::string& warning : pluck.warnings) {
      findings.push_back({file, warning, false});
    }
  });
  return findings;
}

std::vector<FileRead> IdentifyOptions::files_read() const {
  if (has_scene || !(has_record || has_structure)) return {};
  // The record, its decay and what is left of the band, each filtered and whitened.
  FileRead file =
      has_structure ? file_read(structure.record) : file_read(record, "record.file", 12.0);
  const bool is_cropped = structure.record.start > 0.0 || !std::isnan(structure.record.stop);
  if (has_structure) {
    file.key = "structure.record.file";
    file.numbers_per_sample = is_cropped ? 0.0 : 12.0;
  }
  // A fit has the columns of a state, of a trial and of their sums for what is left of the band,
  // two for every pole: two poles for each mode of the string, half as many as the realization has
  // orders, and those that are added.
  const double orders = static_cast<double>(identification.stabilization.highest_order);
  const double poles =
      (has_structure ? 0.5 * orders : 2.0 * identification.highest_frequency / fundamental) +
      kPolesAdded;
  const bool is_whole = file.numbers_per_sample > 0.0;
  file.numbers_per_second = is_whole ? 6.0 * poles * 2.6 * identification.highest_frequency : 0.0;
  return {file};
}

}  // namespace modcal
