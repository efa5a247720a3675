#include "libinverse/observer/observer_runs.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "libinverse/observer/tuning.hpp"
#include "libsim/base/stop_scope.hpp"
#include "libsim/base/task_loop.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal::observer {
namespace {

// Values between equally spaced knots, the first and last at the ends of the record.
double between_knots(std::span<const double> knots, std::size_t k, std::size_t samples) {
  if (knots.size() == 1) return knots[0];
  const double place = static_cast<double>(k) * static_cast<double>(knots.size() - 1) /
                       static_cast<double>(std::max<std::size_t>(samples, 2) - 1);
  const auto left = std::min(static_cast<std::size_t>(place), knots.size() - 2);
  const double share = place - static_cast<double>(left);
  return (1.0 - share) * knots[left] + share * knots[left + 1];
}

// z(t + delay)/gain by a linear phase, about the mean.
std::vector<double> corrected(std::span<const double> z, double sample_rate, double delay,
                              double gain) {
  std::vector<double> samples(z.begin(), z.end());
  const double level = mean(samples);
  for (double& value : samples) value -= level;
  const RealFft fft(samples.size());
  std::vector<Complex> spectrum = fft.forward(samples);
  const double turn = 2.0 * std::numbers::pi * sample_rate / static_cast<double>(samples.size());
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    spectrum[k] *= std::polar(1.0, turn * static_cast<double>(k) * delay);
  }
  fft.inverse(spectrum, samples);
  for (double& value : samples) value = (value + level) / gain;
  return samples;
}

ModalBasis detuned(ModalBasis basis, const std::vector<double>& detuning) {
  for (std::size_t n = 0; n < detuning.size(); ++n) basis.omega[n] *= 1.0 + detuning[n];
  return basis;
}

}  // namespace

double huber(double r) {
  const double size = std::abs(r);
  return size <= kHuberCorner ? 0.5 * r * r : kHuberCorner * (size - 0.5 * kHuberCorner);
}

double misfit(const Innovations& innovations) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const auto& scaled : innovations.scaled) {
    for (const double r : scaled) sum += 2.0 * huber(r);
    count += scaled.size();
  }
  return sum / static_cast<double>(count);
}

std::vector<double> block_costs(const Innovations& innovations) {
  const std::size_t samples = innovations.scaled[0].size();
  std::vector<double> blocks;
  for (std::size_t first = 0; first + kGainBlock <= samples; first += kGainBlock) {
    double sum = 0.0;
    for (const auto& scaled : innovations.scaled) {
      for (std::size_t k = first; k < first + kGainBlock; ++k) sum += 2.0 * huber(scaled[k]);
    }
    blocks.push_back(sum);
  }
  return blocks;
}

double steady_misfit(const Innovations& innovations) {
  const std::vector<double> blocks = block_costs(innovations);
  if (blocks.empty()) return misfit(innovations);
  return quantile(blocks, 0.5) / static_cast<double>(2 * kGainBlock);
}

ObserverState PreparedObserver::initial_state() const {
  ObserverState state = ObserverState::at_rest(string_->size());
  state.force = force_scale_[0] * contact_.sliding.at(bow_velocity_[0]).force;
  return state;
}

void PreparedObserver::run(std::size_t gain, std::size_t first, std::size_t last,
                           ObserverState& state, const ObserverSignals& outputs,
                           std::size_t origin) const {
  ObserverSignals signals = outputs;
  for (std::size_t r = 0; r < 2; ++r) signals.reaction[r] = reaction(r) + origin;
  signals.force_scale = force_scale_.data() + origin;
  signals.bow_velocity = bow_velocity_.data() + origin;
  run_observer(*string_, contact_, (*gains_)[gain], signals, first - origin, last - origin, state);
}

ObserverRuns::ObserverRuns(const ObservedRecord& record, std::vector<double> force_noise,
                           Substeps substeps)
    : record_(record), force_noise_(std::move(force_noise)), substeps_(substeps) {
  string_ = std::make_shared<const StringTables>(
      make_string_tables(record.basis, record.contact, record.sample_rate, substeps));
  for (const double q : force_noise_) {
    SteadyGain gain =
        steady_gain(record.basis, record.contact, record.sample_rate, q, record.noise);
    nominal_.push_back(std::move(gain.gain));
    quiet_misfit_.push_back(gain.quiet_misfit);
  }
  gains_ = std::make_shared<const std::vector<GainTable>>(nominal_);
}

std::shared_ptr<const StringTables> ObserverRuns::tables_of(
    const ObserverParameters& parameters) const {
  if (parameters.contact == record_.contact && parameters.detuning.empty()) return string_;
  return std::make_shared<const StringTables>(
      make_string_tables(detuned(record_.basis, parameters.detuning), parameters.contact,
                         record_.sample_rate, substeps_));
}

// The gains of the record's model in Z/φ, applied to the modes of another one.
std::vector<GainTable> ObserverRuns::gains_for(const StringTables& string) const {
  std::vector<GainTable> result;
  for (const GainTable& nominal : nominal_) {
    GainTable table{PlanarVector(string.mode.size()), PlanarVector(string.mode.size())};
    for (std::size_t n = 0, m = 0; n < string.mode.size(); ++n) {
      while (m < string_->mode.size() && string_->mode[m] < string.mode[n]) ++m;
      if (m == string_->mode.size() || string_->mode[m] != string.mode[n]) continue;
      const double scale = string.shape[n] / string_->shape[m];
      for (std::size_t r = 0; r < 2; ++r) table[r].set(n, scale * nominal[r].at(m));
    }
    result.push_back(std::move(table));
  }
  return result;
}

PreparedObserver ObserverRuns::prepare(const ObserverParameters& p) const {
  PreparedObserver observer;
  observer.string_ = tables_of(p);
  observer.gains_ =
      observer.string_ == string_
          ? gains_
          : std::make_shared<const std::vector<GainTable>>(gains_for(*observer.string_));
  observer.contact_.sliding = p.sliding;
  observer.contact_.stiffness = p.stiffness;
  observer.contact_.damping =
      p.damping_ratio * 2.0 * std::sqrt(p.stiffness * observer.string_->effective_mass);
  for (std::size_t r = 0; r < 2; ++r) {
    observer.contact_.offset[r] = p.offset[r];
    observer.recorded_[r] = record_.reaction[r].data();
  }
  const std::size_t samples = record_.samples();
  observer.force_scale_.assign(samples, 1.0);
  observer.bow_velocity_.assign(samples, p.bow_velocity);
  for (std::size_t k = 0; k < samples; ++k) {
    if (!p.force_knots.empty()) {
      observer.force_scale_[k] = std::exp(between_knots(p.force_knots, k, samples));
    }
    if (!p.velocity_knots.empty()) {
      observer.bow_velocity_[k] *= 1.0 + between_knots(p.velocity_knots, k, samples);
    }
  }
  if (p.delay != 0.0 || p.gain != 1.0) {
    observer.changed_[0] = corrected(record_.reaction[0], record_.sample_rate, p.delay, p.gain);
  }
  if (p.level_growth != 0.0) {
    const double slope = p.offset[1] * p.level_growth / record_.sample_rate;
    std::vector<double>& z = observer.changed_[1] = record_.reaction[1];
    for (std::size_t k = 0; k < samples; ++k) z[k] -= slope * static_cast<double>(k);
  }
  return observer;
}

Innovations ObserverRuns::run_schedule(const PreparedObserver& observer,
                                       const GainSchedule& schedule, std::size_t samples,
                                       ObserverMotion* motion) const {
  Innovations innovations;
  ObserverSignals outputs;
  for (std::size_t r = 0; r < 2; ++r) {
    innovations.scaled[r].resize(samples);
    outputs.innovation[r] = innovations.scaled[r].data();
  }
  if (motion) {
    for (auto* signal :
         {&motion->force, &motion->velocity, &motion->displacement, &motion->mean_force}) {
      signal->resize(samples);
    }
    outputs.force = motion->force.data();
    outputs.velocity = motion->velocity.data();
    outputs.displacement = motion->displacement.data();
    outputs.mean_force = motion->mean_force.data();
  }
  ObserverState state = observer.initial_state();
  const std::size_t block = schedule.size() == 1 ? 16 * kGainBlock : kGainBlock;
  for (std::size_t first = 0, i = 0; first < samples; first += block, ++i) {
    throw_if_stopped();
    observer.run(schedule[std::min(i, schedule.size() - 1)], first,
                 std::min(samples, first + block), state, outputs);
  }
  for (int r = 0; r < 2; ++r) {
    const double scale = 1.0 / record_.noise[r];
    for (double& value : innovations.scaled[r]) value *= scale;
  }
  return innovations;
}

PreparedObserver ObserverRuns::disturbed(const ObserverParameters& parameters,
                                         const StreamKey& key) const {
  PreparedObserver observer = prepare(parameters);
  for (int r = 0; r < 2; ++r) {
    std::vector<double>& z = observer.changed_[r];
    if (z.empty()) z = record_.reaction[r];
    std::vector<double> noise(z.size());
    fill_standard_normal(key.with(r == 0 ? "R1" : "R2"), noise);
    for (std::size_t k = 0; k < z.size(); ++k) z[k] += record_.raw_noise[r] * noise[k];
  }
  return observer;
}

MotionDeviation ObserverRuns::deviation(const ObserverParameters& parameters,
                                        const GainSchedule& schedule, std::size_t draws,
                                        const StreamKey& key) const {
  const std::size_t samples = record_.samples();
  ObserverMotion plain;
  innovations(parameters, schedule, samples, &plain);
  std::vector<ObserverMotion> motions(draws);
  for_each_task(draws, [&](std::size_t i) {
    run_schedule(disturbed(parameters, key.with(static_cast<std::uint64_t>(i))), schedule, samples,
                 &motions[i]);
  });
  MotionDeviation result{std::vector<double>(samples, 0.0), std::vector<double>(samples, 0.0)};
  const auto rms = [&](std::vector<double> ObserverMotion::*signal,
                       std::vector<double>& deviation) {
    for (std::size_t k = 0; k < samples; ++k) {
      for (const ObserverMotion& motion : motions) {
        const double change = (motion.*signal)[k] - (plain.*signal)[k];
        deviation[k] += change * change;
      }
      deviation[k] = std::sqrt(deviation[k] / static_cast<double>(draws));
    }
  };
  rms(&ObserverMotion::force, result.force);
  rms(&ObserverMotion::velocity, result.velocity);
  return result;
}

}  // namespace modcal::observer
