#include "libinverse/structure/force/force_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libinverse/structure/force/force_band.hpp"
#include "libinverse/structure/force/relevance.hpp"
#include "libinverse/structure/strikes/strike_weights.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/task_loop.hpp"
#include "libsim/base/turn.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

using Index = Eigen::Index;

ForceSearch::ForceSearch(const StructureTable& table, const StructureRecord& record,
                         const StructureForceOptions& options, double window,
                         std::span<const OtherContact> others)
    : table_(table), options_(options) {
  result_.window = window;
  MODCAL_REQUIRE(result_.window > 0.0 && result_.window <= record.duration(),
                 "a window of {:g} s does not lie in the record's {:g} s", result_.window,
                 record.duration());
  // Functions of an exponential window are known on its contour and to the right of it.
  const double least = table.measured.grid.sigma;
  result_.sigma = std::isnan(options.sigma) ? std::max(2.0 / result_.window, least) : options.sigma;
  MODCAL_REQUIRE(result_.sigma * result_.window <= kLongestWeighted,
                 "contour = {:g} 1/s leaves exp(-{:.3g}) at the end of a window of {:g} s: state a "
                 "window of {:.3g} s or less, or a smaller contour",
                 result_.sigma, result_.sigma * result_.window, result_.window,
                 kLongestWeighted / result_.sigma);
  spectra_ = ContourSpectra::of(record, result_.sigma, table.low, table.high);
  transfers_ = transfers_of(table_, spectra_);
  for (const OtherContact& other : others) {
    contacts_.push_back(other);
    others_.push_back({.transfers = transfers_of(other.table, spectra_),
                       .of_transfer = transfer_variances(other.table, spectra_),
                       .power = other.power});
  }
  result_.forces = 1 + others_.size();
  variances_ = variances();
  const std::span<const double> response = record.responses.front();
  last_rms_ = standard_deviation(response.last(std::max<std::size_t>(1, response.size() / 10)));
  take_state_out();
  samples_ = static_cast<Index>(std::floor(result_.window * record.sample_rate));
  result_.from_zero = spectra_.bins.first == 0;
}

std::optional<std::size_t> ForceSearch::odd_sensor() const {
  // Sensors that hear nothing contradict nobody.
  if (power_told(evidence_of(spectra_, transfers_, variances_, kNoSensor)) < 1.0) return {};
  return odd_of_many(spectra_, transfers_, variances_);
}

double ForceSearch::loud_until(double seen) {
  const BinEvidence evidence = evidence_of(spectra_, transfers_, variances_, kNoSensor);
  find_power(evidence);
  // What lies above the band is as large everywhere and tells nothing of where the force ends.
  lines_outside_ = 0.0;
  const Eigen::VectorXd force = force_of(evidence), variance = variance_of(evidence);
  Index j = std::min(force.size(), static_cast<Index>(seen * rate()));
  // Of several contacts, one without a force has noise alone, of which one in 16 000 independent
  // samples exceeds four deviations.
  const bool is_noise = (force.head(j).array().square() < 16.0 * variance.head(j).array()).all();
  if (!others_.empty() && is_noise) return 0.0;
  const double loud = kLoud * force.head(j).cwiseAbs().maxCoeff();
  const auto is_over = [&](Index i) {
    const double size = std::abs(force[i]);
    return size < loud && size + 2.0 * std::sqrt(variance[i]) < 2.0 * loud;
  };
  while (j > 0 && is_over(j - 1)) --j;
  return static_cast<double>(j) / rate();
}

std::vector<double> ForceSearch::power() {
  find_power(evidence_of(spectra_, transfers_, variances_, kNoSensor));
  return power_;
}

StructureForce ForceSearch::run() {
  result_.misfit = variances_.misfit;
  result_.sensor_misfit = variances_.by_sensor;
  result_.sensor_left = left_of_responses();
  result_.predicted = predictions_of(spectra_, transfers_, variances_);
  const BinEvidence evidence = evidence_of(spectra_, transfers_, variances_, kNoSensor);
  find_power(evidence);
  if (wants_pulses(evidence)) find_pulses(evidence);
  const Eigen::VectorXd best = force_of(evidence);
  const Eigen::VectorXd own = variance_of(evidence);
  const Eigen::VectorXd drawn = by_models(best), left_out = by_sensors();
  result_.force.assign(best.begin(), best.end());
  for (Index j = 0; j < best.size(); ++j) {
    const double model = std::max(drawn[j], left_out.size() > 0 ? left_out[j] : 0.0);
    result_.by_model.push_back(std::sqrt(model));
    result_.deviation.push_back(std::sqrt(own[j] + model));
  }
  return std::move(result_);
}

double ForceSearch::rate() const { return spectra_.sample_rate; }

std::vector<double> ForceSearch::left_of_responses() const {
  std::vector<double> left = variances_.left;
  for (std::size_t k = 0; k < left.size() && !recorded_.empty(); ++k) {
    left[k] *= std::sqrt(mean_power(spectra_.responses[k]) / mean_power(recorded_[k]));
  }
  return left;
}

std::optional<StructureChange> ForceSearch::change_wanted() const {
  if (options_.change) return options_.change;
  if (!options_.may_have_changed || !table_.measured.empty() || !others_.empty()) return {};
  const double left = contradiction_of(left_of_responses());
  if (!(left > kChanged * kChanged && variances_.misfit > kBeyond * kBeyond)) return {};
  if (power_told(evidence_of(spectra_, transfers_, variances_, kNoSensor)) < 1.0) return {};
  // One sensor alone is off, which is said by name.
  const bool is_odd = left >= kContradiction * kContradiction &&
                      odd_one_out(predictions_of(spectra_, transfers_, variances_));
  return is_odd ? std::optional<StructureChange>() : StructureChange::open();
}

bool ForceSearch::refine(const StructureRecord& record) {
  const std::optional<StructureChange> change = change_wanted();
  if (!change) return false;
  // What contradicts the table looks like ringing, too: not of a record that begins quietly.
  const bool at_rest = !result_.rang || options_.rests || options_.quiet > 0.0;
  result_.refined = refined_table(table_, record, result_.sigma, *change, at_rest);
  table_.model = result_.refined->model;
  if (!recorded_.empty()) spectra_.responses = recorded_;
  transfers_ = transfers_of(table_, spectra_);
  of_change_ = spread_of_change();
  variances_ = variances();
  take_state_out();
  return true;
}

bool ForceSearch::wants_pulses(const BinEvidence& evidence) {
  if (options_.shape != ForceShape::kAuto) return options_.shape == ForceShape::kImpacts;
  const double instants = PulseTrain::instants_in(table_, rate(), result_.window);
  if (instants > kMostInstants) result_.untried = instants;
  if (instants <= kFewInstants) return true;
  if (result_.untried > 0.0) return false;
  // Blows of a long window stand out of the smooth force, too: the others are not worth the search.
  if (peakedness(force_of(evidence)) > 0.5 * kPeaked) return true;
  result_.untried = instants;
  return false;
}

void ForceSearch::find_pulses(const BinEvidence& evidence) {
  const bool is_auto = options_.shape == ForceShape::kAuto;
  if (is_auto && result_.told < 1.0) return;
  // What strikes elsewhere is taken for a smooth force beside this one, which costs pulses
  // evidence.
  const bool stands_in_peaks = !others_.empty() && peakedness(force_of(evidence)) > kPeaked;
  train_.emplace(table_, spectra_, result_.window);
  result_.evidence_impacts = -std::numeric_limits<double>::infinity();
  std::vector<Index> chosen;
  for (const double share : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    std::vector<double> background = power_;
    for (double& power : background) power *= share;
    const auto [matrix, score] = train_->normal_of(beside(evidence, background));
    const Relevance found = determine_relevance(matrix, score);
    const double told = found.evidence + evidence_of_power(evidence, background);
    // The less the background explains, the more pulses it takes.
    if (is_auto && !found.are_few()) break;
    const bool wanted = !is_auto || stands_in_peaks || told > result_.evidence_smooth;
    // No force explains more than the one that is free in every bin.
    const double most =
        result_.told * static_cast<double>(spectra_.count()) / spectra_.correlated();
    if (!(told > result_.evidence_impacts && told <= most)) continue;
    result_.evidence_impacts = told;
    if (!wanted) continue;
    result_.shape = ForceShape::kImpacts;
    result_.background = share;
    chosen = found.chosen;
    widths_ = found.widths(chosen);
    background_ = background;
  }
  MODCAL_REQUIRE(is_auto || result_.shape == ForceShape::kImpacts,
                 "the responses tell the {} pulses of the window so unequally that rounding is all "
                 "there is: state a shorter window, or shape: smooth",
                 train_->count());
  if (result_.shape != ForceShape::kImpacts) return;
  train_->keep(chosen);
  pulses_ = train_->columns(samples_);
  result_.push_odds = log_odds_of_push(evidence, spectra_);
}

BinEvidence ForceSearch::beside(const BinEvidence& evidence,
                                const std::vector<double>& power) const {
  BinEvidence result = evidence;
  for (std::size_t m = 0; m < spectra_.count(); ++m) {
    const double share = 1.0 / (1.0 + power[m] * evidence.told[m]);
    result.told[m] *= share;
    result.score[m] *= share;
  }
  return result;
}

double ForceSearch::evidence_of_power(const BinEvidence& evidence,
                                      const std::vector<double>& power) const {
  double sum = 0.0;
  for (std::size_t m = 0; m < spectra_.count(); ++m) {
    const double gain = power[m] * evidence.told[m];
    sum += power[m] * std::norm(evidence.score[m]) / (1.0 + gain) - std::log1p(gain);
  }
  return sum / spectra_.correlated();
}

void ForceSearch::find_power(const BinEvidence& evidence) {
  const double spacing = spectra_.grid.spacing / kTurn;
  std::vector<double> found = power_found(evidence);
  result_.told = power_told(evidence);
  result_.rise = rise_towards_zero(found, spectra_.bins.first);
  lines_outside_ = power_of_lines_outside(spectra_, found);
  for (double& power : found) power = std::max(power, 0.0);
  power_ = smoothed(found, spacing, kReach);
  const std::vector<double> hidden = hidden_power(evidence, spectra_);
  for (std::size_t m = 0; m < power_.size(); ++m) power_[m] = std::max(power_[m], hidden[m]);
  background_ = power_;
  result_.evidence_smooth = evidence_of_power(evidence, power_);
}

Eigen::VectorXd ForceSearch::force_of(const BinEvidence& evidence) const {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(samples_);
  std::vector<Complex> sum(spectra_.count());
  if (result_.shape == ForceShape::kImpacts) {
    const auto [matrix, score] = train_->normal_of(beside(evidence, background_));
    const Eigen::VectorXd amplitudes = options_.non_negative
                                           ? non_negative_mean(matrix, score, widths_)
                                           : posterior_of(matrix, score, widths_).mean;
    sum = train_->spectrum(amplitudes);
    force = pulses_ * amplitudes;
  }
  for (std::size_t m = 0; m < spectra_.count(); ++m) {
    sum[m] =
        (evidence.score[m] - evidence.told[m] * sum[m]) / (evidence.told[m] + 1.0 / background_[m]);
  }
  return force + signal_of(sum);
}

Eigen::VectorXd ForceSearch::signal_of(const std::vector<Complex>& bins) const {
  const RealFft fft(spectra_.samples);
  std::vector<Complex> spectrum(fft.bins());
  std::ranges::copy(bins, spectrum.begin() + static_cast<std::ptrdiff_t>(spectra_.bins.first));
  std::vector<double> samples(spectra_.samples);
  fft.inverse(spectrum, samples);
  Eigen::VectorXd signal(samples_);
  for (Index j = 0; j < samples_; ++j) {
    signal[j] = samples[static_cast<std::size_t>(j)] *
                std::exp(result_.sigma * static_cast<double>(j) / rate());
  }
  return signal;
}

Eigen::MatrixXd ForceSearch::pulses_beside_background(const BinEvidence& evidence) const {
  Eigen::MatrixXd beside = pulses_;
  for_each_task(train_->count(), [&](std::size_t i) {
    const auto column = static_cast<Index>(i);
    std::vector<Complex> bins = train_->spectrum(Eigen::VectorXd::Unit(pulses_.cols(), column));
    for (std::size_t m = 0; m < spectra_.count(); ++m) {
      bins[m] *= evidence.told[m] / (evidence.told[m] + 1.0 / background_[m]);
    }
    beside.col(column) -= signal_of(bins);
  });
  return beside;
}

Eigen::VectorXd ForceSearch::variance_of(const BinEvidence& evidence) const {
  double bins = power_outside(spectra_, background_);
  if (result_.shape == ForceShape::kSmooth) bins = std::max(bins, lines_outside_);
  for (std::size_t m = 0; m < spectra_.count(); ++m) {
    bins += 1.0 / (evidence.told[m] + 1.0 / background_[m]);
  }
  // White noise of variance v has v Σ_j exp(−2σt_j) in every bin.
  const double share = 2.0 / (static_cast<double>(spectra_.samples) * spectra_.noise_power());
  Eigen::VectorXd variance = Eigen::VectorXd::Constant(samples_, share * bins);
  if (result_.shape == ForceShape::kSmooth) return variance;
  const auto [matrix, score] = train_->normal_of(beside(evidence, background_));
  const Relevance found = posterior_of(matrix, score, widths_);
  variance += (pulses_beside_background(evidence) * found.root.transpose()).rowwise().squaredNorm();
  const Eigen::VectorXd force = pulses_ * found.mean;
  if (!table_.pulse.empty()) return variance + variance_of_shape(force, rate(), table_.high);
  return variance + variance_about(force, spectra_, share * power_outside(spectra_, power_));
}

}  // namespace modcal
