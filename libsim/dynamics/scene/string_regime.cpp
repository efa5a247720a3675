#include "libsim/dynamics/scene/string_regime.hpp"

#include <array>

#include "libsim/dynamics/scene/contact_modes.hpp"
#include "libsim/dynamics/scene/tuning.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// μ_S − μ at the slip speed.
double friction_fall(const FrictionLaw& law, double slip_speed) {
  return law.static_limit(1.0) - sliding_force(law.sliding(1.0), slip_speed);
}

// Σ ζ_n/n over the odd modes that Helmholtz motion needs: 1/β of them shape its slip.
double loss_sum(const ModalBasis& basis, double beta) {
  double sum = 0.0;
  for (std::size_t n = 1; n <= basis.size() && static_cast<double>(n) * beta <= 1.0; n += 2) {
    sum += basis.zeta[n - 1] / static_cast<double>(n);
  }
  return sum;
}

// The signal against itself `lag` samples later, both about the mean of the whole.
double lagged_correlation(std::span<const double> x, std::size_t lag) {
  double product = 0.0, early = 0.0, late = 0.0;
  for (std::size_t k = 0; k + lag < x.size(); ++k) {
    product += x[k] * x[k + lag];
    early += x[k] * x[k];
    late += x[k + lag] * x[k + lag];
  }
  const double scale = std::sqrt(early * late);
  return scale > 0.0 ? product / scale : 0.0;
}

// Largest correlation over a period near `period` samples, and that period.
struct Period {
  double correlation = 0.0;
  double samples = 0.0;
};

Period find_period(std::span<const double> x, double period) {
  const auto first = static_cast<std::size_t>(kShortestPeriod * period);
  const auto last = static_cast<std::size_t>(std::ceil(kLongestPeriod * period));
  std::vector<double> values;
  for (std::size_t lag = first; lag <= last; ++lag) values.push_back(lagged_correlation(x, lag));
  const double largest = *std::max_element(values.begin(), values.end());
  if (largest <= 0.0) return {0.0, period};
  Period best{0.0, 0.0};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double left = i > 0 ? values[i - 1] : values[i];
    const double right = i + 1 < values.size() ? values[i + 1] : values[i];
    if (values[i] < largest - kEqualCorrelation || values[i] < left || values[i] < right) continue;
    const double bend = left - 2.0 * values[i] + right;
    const double lag =
        static_cast<double>(first + i) + (bend < 0.0 ? 0.5 * (left - right) / bend : 0.0);
    if (best.samples == 0.0 || std::abs(lag - period) < std::abs(best.samples - period)) {
      best = {values[i], lag};
    }
  }
  return best;
}

struct SlipCount {
  double slips = 0.0;
  double sticking_time = 0.0;  // [s]
};

// Slips that begin in [start, end), and the time in it for which the string sticks.
SlipCount count_slips(std::span<const Switch> switches, double start, double end,
                      double bow_velocity, double least_distance) {
  SlipCount count;
  for (std::size_t i = 0; i < switches.size(); ++i) {
    const Switch& now = switches[i];
    const bool is_last = i + 1 == switches.size();
    const double until = is_last ? end : switches[i + 1].time;
    if (i == 0 && !now.attaches) count.sticking_time += std::max(0.0, now.time - start);
    if (now.attaches) {
      count.sticking_time += std::max(0.0, std::min(until, end) - std::max(now.time, start));
    } else if (now.time >= start && now.time < end && !is_last) {
      const double slid =
          (switches[i + 1].displacement - now.displacement) - bow_velocity * (until - now.time);
      if (-slid * (bow_velocity < 0.0 ? -1.0 : 1.0) >= least_distance) count.slips += 1.0;
    }
  }
  return count;
}

}  // namespace

double relative_bow_position(double contact, double length) {
  MODCAL_REQUIRE(contact > 0.0 && contact < length,
                 "bow position {:g} m is not inside the string: it must lie in (0, {:g}) m",
                 contact, length);
  return std::min(contact, length - contact) / length;
}

double helmholtz_velocity_rms(double relative_position, double bow_velocity) {
  return std::abs(bow_velocity) * std::sqrt((1.0 - relative_position) / relative_position);
}

ModalState helmholtz_motion(const ModalBasis& basis, double contact, double bow_velocity) {
  const double beta = relative_bow_position(contact, basis.length);
  const bool near_left = contact <= 0.5 * basis.length;
  const std::vector<double> shape = basis.shape_at(contact);
  ModalState state{std::vector<double>(basis.size()), std::vector<double>(basis.size())};
  for (std::size_t n = 1; n <= basis.size(); ++n) {
    if (is_node(shape[n - 1])) continue;
    const double sign = near_left && n % 2 == 0 ? -1.0 : 1.0;
    state.velocity[n - 1] =
        sign * 2.0 * bow_velocity / (beta * static_cast<double>(n) * std::numbers::pi);
  }
  return state;
}

BowForceLimits schelleng_limits(const Scene& scene) {
  const StringModel& string = scene.string;
  const double beta = relative_bow_position(scene.bow.position, string.length);
  const double speed = std::abs(scene.bow.velocity);
  const double impedance = std::sqrt(string.tension() * string.linear_density);
  const double fall = friction_fall(*scene.friction.make(), speed * (1.0 - beta) / beta);
  const double loss = loss_sum(make_modal_basis(string), beta);
  return {.lowest = 4.0 * impedance * speed * loss / (std::numbers::pi * beta * beta * fall),
          .highest = 2.0 * impedance * speed / (beta * fall)};
}

void RegimeCriteria::visit(OptionVisitor& visitor) {
  visitor("periods", "periods at the end of the record in which the motion is judged",
          {.range = Range::at_least(3.0)}, periods);
  visitor("slip_share",
          "a stretch of sliding over less than this share of the bow's way in a "
          "period is no slip",
          {.range = Range::open(0.0, 1.0)}, slip_share);
  visitor("periodicity", "least autocorrelation, one period later, of a periodic motion",
          {.range = Range::open(0.0, 1.0)}, periodicity);
  visitor("adherence", "least share of the time for which a sounding string sticks",
          {.range = Range::open(0.0, 1.0)}, adherence);
}

std::string_view name_of(StringRegime regime) {
  static constexpr std::array<std::string_view, kStringRegimes> kNames = {
      "helmholtz", "multiple_slip", "raucous", "silent"};
  return kNames.at(static_cast<std::size_t>(regime));
}

double judged_from(const Scene& scene, const RegimeCriteria& criteria) {
  const double period = 1.0 / scene.string.fundamental;
  return scene.duration - (criteria.periods * kLongestPeriod + kSparePeriods + 1.0) * period;
}

RegimeFeatures regime_features(const Scene& scene, const Simulation& simulation,
                               const RegimeCriteria& criteria) {
  const Signal& velocity = simulation.velocity;
  const double nominal = 1.0 / scene.string.fundamental;
  const double bow_velocity = scene.bow.velocity;
  MODCAL_REQUIRE(
      judged_from(scene, criteria) >= 0.0 && velocity.duration() > 0.0,
      "{:g} s of velocity are too short to judge {:g} periods of {:g} s: it takes {:g} s",
      velocity.duration(), criteria.periods, nominal,
      scene.duration - judged_from(scene, criteria));
  MODCAL_REQUIRE(bow_velocity != 0.0 && std::isfinite(bow_velocity),
                 "a bow velocity of {:g} m/s keeps no motion up", bow_velocity);

  const double rate = velocity.sample_rate;
  const auto judged = static_cast<std::size_t>((criteria.periods + 1.0) * nominal * rate);
  std::vector<double> tail(velocity.samples.end() - static_cast<std::ptrdiff_t>(judged),
                           velocity.samples.end());
  const double level = standard_deviation(tail);
  remove_mean(tail);
  const Period period = find_period(tail, nominal * rate);

  RegimeFeatures features;
  features.periodicity = period.correlation;
  features.period = period.samples / (rate * nominal);
  const double beta = relative_bow_position(scene.bow.position, scene.string.length);
  features.amplitude = level / helmholtz_velocity_rms(beta, bow_velocity);

  const double length = criteria.periods * features.period * nominal;
  const double end = scene.duration - kSparePeriods * nominal;
  const SlipCount count = count_slips(simulation.switches, end - length, end, bow_velocity,
                                      criteria.slip_share * std::abs(bow_velocity) * nominal);
  features.slips_per_period = count.slips / criteria.periods;
  features.adherence = count.sticking_time / length;
  return features;
}

StringRegime classify(const RegimeFeatures& features, const RegimeCriteria& criteria) {
  if (features.slips_per_period == 0.0 || features.adherence < criteria.adherence) {
    return StringRegime::kSilent;
  }
  if (features.periodicity < criteria.periodicity) return StringRegime::kRaucous;
  const double tolerance = 1.5 / criteria.periods;
  if (features.slips_per_period < 1.0 - tolerance) return StringRegime::kRaucous;
  return features.slips_per_period <= 1.0 + tolerance ? StringRegime::kHelmholtz
                                                      : StringRegime::kMultipleSlip;
}

}  // namespace modcal
