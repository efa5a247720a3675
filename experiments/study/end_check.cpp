#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>

#include "experiments/study/observation.hpp"
#include "experiments/study/whole_record.hpp"
#include "libinverse/waves/end_relation.hpp"
#include "libinverse/waves/saturation.hpp"
#include "libsim/base/error.hpp"
#include "libsim/records/levels.hpp"

namespace modcal {
namespace {

EndRecord ends_of(const Signal& left_reaction, const Signal& right_reaction) {
  const std::span<const double> left = left_reaction.samples, right = right_reaction.samples;
  return {.left = left,
          .right = right,
          .sample_rate = left_reaction.sample_rate,
          .noise = {white_noise_rms(left), white_noise_rms(right)}};
}

StatedString string_of(const ObservationOptions& options) {
  return {.length = options.string.length,
          .fundamental = options.string.fundamental,
          .inharmonicity = options.string.inharmonicity,
          .contact = options.contact.position};
}

constexpr std::string_view kSign =
    "state turned: true for one of them and leave it at that where the force at the contact then "
    "has "
    "the right sign, else for the other one (a force > 0 pushes both reactions below 0)";

std::string remedy_of(EndRelation relation, const ObservationOptions& options,
                      const EndRelationFit& fit) {
  const RecordOptions& record = options.record;
  const std::string exchange = fmt::format(
      "state record.left: {{channel: {}}}, record.right: {{channel: {}}}, or bow.position {:.4g} "
      "mm, from the other end",
      record.right.channel, record.left.channel,
      1e3 * (options.string.length - options.contact.position));
  switch (relation) {
    case EndRelation::kString:
      return "";
    case EndRelation::kSignTurned:
      return fmt::format(
          "would be those of the string stated if one of them had the other sign: {}", kSign);
    case EndRelation::kSwapped:
      return fmt::format("would be those of the string stated if the ends were exchanged: {}",
                         exchange);
    case EndRelation::kSwappedSignTurned:
      return fmt::format(
          "would be those of the string stated if the ends were exchanged and one of them had the "
          "other sign: {}; and {}",
          exchange, kSign);
    case EndRelation::kCopies:
      return fmt::format(
          "are one signal, x = L reading {:.4g} times x = 0: give each end a sensor and a channel "
          "of its own",
          fit.copy_gain);
  }
  return "";
}

// Of a contact in the middle both reactions are one signal, whatever f0, B and damping are.
bool is_in_the_middle(const EndRelationFit& fit, const ObservationOptions& options) {
  constexpr double kContactError = 0.02;  // as far as a stated contact may be off
  const double place = options.contact.position / options.string.length;
  const double as_copies = fit.misfit_of(EndRelation::kCopies);
  const double as_string = fit.misfit_of(EndRelation::kString);
  return std::abs(place - 0.5) < kContactError && std::abs(fit.copy_gain - 1.0) < 0.05 &&
         as_copies < 0.5 && as_copies < std::max(0.05, 1.02 * as_string);
}

std::string remedy_of(double gain) {
  return fmt::format(
      "would be those of the string stated if the one at {} read {:.4g} times as much: check the "
      "units and the sensitivity of both sensors (record.left.calibration, "
      "record.right.calibration)",
      label_of(gain > 1.0 ? End::kRight : End::kLeft), std::max(gain, 1.0 / gain));
}

// Where a string explains the reactions once both are raised to what their sensors lacked.
void require_linear_sensors(const EndRecord& ends, const ObservationOptions& options,
                            const EndRelationFit& fit, std::string_view pair) {
  StatedString string = string_of(options);
  if (fit.fundamental > 0.0) {
    string.fundamental = fit.fundamental;
    string.contact = fit.contact;
  }
  const std::optional<Saturation> saturation = saturation_of(ends, string);
  if (!saturation) return;
  std::string lacking;
  for (const End end : kEnds) {
    const double missing = saturation->missing[static_cast<std::size_t>(end)];
    if (missing == 0.0) continue;
    lacking += fmt::format("{}that at {} reads {:.0f} % too little at its peaks",
                           lacking.empty() ? "" : ", ", label_of(end), 100.0 * missing);
  }
  throw_invalid_input(
      "{} are those of one string but for sensors or amplifiers that saturate: {}. A string as it "
      "was read leaves {:.2g} % of their power, raised to what is missing {:.2g} %. Record with "
      "less gain or play softer, or use sensors of a wider range",
      pair, lacking, 100.0 * saturation->unexplained, 100.0 * saturation->mended);
}

// Whether the reactions tell the string.
bool check_one_string(const ObservationOptions& options, const RecordedSignals& signals) {
  const RecordOptions& record = options.record;
  require_periods(record.file, options.string.fundamental, signals.size(), signals.sample_rate);
  require_whole_beginning(options, signals);
  require_whole_band(record, signals);
  const EndRecord ends = ends_of(*signals.left, *signals.right);
  const EndRelationFit fit = fit_end_relations(ends, string_of(options));
  for (const End end : kEnds) {
    MODCAL_REQUIRE(!fit.noise_alone(static_cast<std::size_t>(end)),
                   "{}: channel {}, the reaction at {}, holds nothing but noise between half and "
                   "ten times f0 = {:g} Hz: check its sensor, or leave record.{} out where the "
                   "method works with one reaction",
                   record.file, end == End::kLeft ? record.left.channel : record.right.channel,
                   label_of(end), options.string.fundamental, end == End::kLeft ? "left" : "right");
  }
  if (is_in_the_middle(fit, options)) return false;
  const std::string pair = fmt::format("{}: channels {} and {}, the reactions at x = 0 and x = L,",
                                       record.file, record.left.channel, record.right.channel);
  const EndRelation best = fit.best();
  MODCAL_REQUIRE(best == EndRelation::kString, "{} {}", pair, remedy_of(best, options, fit));
  require_linear_sensors(ends, options, fit, pair);
  if (!fit.explained()) {
    const std::optional<double> gain = gain_of_right(ends, string_of(options));
    MODCAL_REQUIRE(!gain, "{} {}", pair, remedy_of(*gain));
  }
  MODCAL_REQUIRE(!fit.explained_at_edge(),
                 "{} tell no f0 within 3 % of {:g} Hz: the best, {:.5g} Hz, stands at the edge of "
                 "that; check f0 and the sample rate, and where the string hardly stands above the "
                 "noise take a louder part of the record, or a longer one",
                 pair, options.string.fundamental, fit.fundamental);
  MODCAL_REQUIRE(fit.explained(),
                 "{} are not those of one string with f0 within 3 % of {:g} Hz and the contact "
                 "within 2 % of L of {:g} mm: the best, with f0 = {:.5g} Hz, leaves {:.3g} % of "
                 "their power unexplained; check channels, sample rate, f0, B and bow.position",
                 pair, options.string.fundamental, 1e3 * options.contact.position, fit.fundamental,
                 100.0 * fit.unexplained);
  MODCAL_REQUIRE(!fit.disturbance,
                 "{} contradict each other near {:.4g} s {:.3g} times more than elsewhere: samples "
                 "are missing or something else was recorded there; crop to the part before or "
                 "behind (record.start, record.stop)",
                 pair, record.start + fit.disturbance->time, fit.disturbance->ratio);
  return true;
}

/// Hash of all that the check of two reactions depends on.
std::size_t key_of_check(const ObservationOptions& options, const RecordedSignals& signals) {
  std::string key = fingerprint([&](OptionVisitor& visitor) {
    ObservationOptions read = options;
    read.record.visit(visitor);
    read.string.visit(visitor);
    read.contact.visit(visitor);
  });
  for (const Signal* reaction : {&*signals.left, &*signals.right}) {
    const std::vector<double>& samples = reaction->samples;
    const std::string_view bytes(reinterpret_cast<const char*>(samples.data()),
                                 samples.size() * sizeof(double));
    key += fmt::format(" {:x}", std::hash<std::string_view>{}(bytes));
  }
  key += fmt::format(" {:x}", std::bit_cast<std::uint64_t>(signals.sample_rate));
  return std::hash<std::string>{}(key);
}

}  // namespace

void require_periods(std::string_view name, double fundamental, std::size_t samples,
                     double sample_rate) {
  MODCAL_REQUIRE(sample_rate > 2.0 * fundamental,
                 "{}: a sample rate of {:g} Hz does not show a string of f0 = {:g} Hz: check the "
                 "units of the rate or of the time column (a bare number is in Hz or s), and f0",
                 name, sample_rate, fundamental);
  const double duration = static_cast<double>(samples) / sample_rate;
  MODCAL_REQUIRE(
      duration * fundamental >= 2.0,
      "{}: {} samples at {:g} Hz are {:.3g} s, less than two periods of the string of "
      "{:g} Hz: its modes cannot be told apart; record for longer, or check the rate's unit",
      name, samples, sample_rate, duration, fundamental);
}

bool require_one_string(const ObservationOptions& options, const RecordedSignals& signals) {
  // A record is checked before a run, by the run, and by every task of a list: what passed once
  // does not need the third of a second again.
  static std::mutex mutex;
  static std::map<std::size_t, bool> passed;
  const std::size_t key = key_of_check(options, signals);
  {
    const std::lock_guard lock(mutex);
    if (const auto known = passed.find(key); known != passed.end()) return known->second;
  }
  const bool is_told = check_one_string(options, signals);
  const std::lock_guard lock(mutex);
  return passed[key] = is_told;
}

void require_told_fundamental(const ObservationOptions& options, const Observation& observation) {
  if (observation.truth || !observation.reaction(End::kLeft) ||
      !observation.reaction(End::kRight) || observation.is_one_signal) {
    return;
  }
  const EndRelationFit fit = fit_end_relations(
      ends_of(*observation.reaction(End::kLeft), *observation.reaction(End::kRight)),
      string_of(options));
  const double told = fit.fundamental;
  const double difference = told / options.string.fundamental - 1.0;
  if (std::abs(difference) < 3e-3) return;
  const std::optional<ToldString> alone = told_string(observation);
  const double contact = options.contact.position / options.string.length;
  if (alone && std::abs(alone->fundamental / options.string.fundamental - 1.0) < 3e-3) {
    // Forty modes tell f0 in a short record where ten do not.
    if (std::abs(alone->contact - contact) < 0.02) return;
    throw WrongKey(
        "bow.position",
        fmt::format("{}: the reactions are those of a string with the f0 stated, but with the "
                    "contact at {:.4g} of its length, {:.4g} mm, and not at {:.4g}: state "
                    "bow.position, or calibrate the string first (kind: calibrate)",
                    options.record.file, alone->contact,
                    1e3 * alone->contact * options.string.length, contact));
  }
  // Told to 0.23 % where B is stated 20 % wrong.
  MODCAL_REQUIRE(!fit.tells_fundamental(),
                 "{}: the reactions are those of a string with f0 near {:.5g} Hz, {:+.2g} % from "
                 "the {:g} Hz stated, which an inversion takes for granted: calibrate the string "
                 "first (kind: calibrate), or check the sample rate",
                 options.record.file, told, 100.0 * difference, options.string.fundamental);
}

std::optional<ToldString> told_string(const Observation& observation) {
  const auto& left = observation.reaction(End::kLeft);
  const auto& right = observation.reaction(End::kRight);
  if (observation.truth || !left || !right) return std::nullopt;
  try {
    const double contact = observation.contact / observation.basis.length;
    const ToldString told = find_string(ends_of(*left, *right), contact);
    return told.explained ? std::optional(told) : std::nullopt;
  } catch (const InvalidInput&) {
    return std::nullopt;  // no note of a string: the calibration says so
  }
}

}  // namespace modcal
