#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libinverse/parameter_choice.hpp"
#include "libinverse/regularizer.hpp"
#include "libinverse/spectral/one_sided/force_kernel.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

bool finite(Complex value) { return std::isfinite(value.real()) && std::isfinite(value.imag()); }

// Checks length and values; keeps of the last bin of an even length what sampling shows of it.
std::vector<Complex> sampled_transfer(std::vector<Complex> transfer, std::size_t samples,
                                      const char* what) {
  MODCAL_REQUIRE(transfer.size() == samples / 2 + 1,
                 "{} has {} bins: a record of {} samples needs {}", what, transfer.size(), samples,
                 samples / 2 + 1);
  for (std::size_t k = 0; k < transfer.size(); ++k) {
    MODCAL_REQUIRE(finite(transfer[k]) || k == 0, "{} is {:g}{:+g}i in bin {}: it must be finite",
                   what, transfer[k].real(), transfer[k].imag(), k);
  }
  if (samples % 2 == 0) transfer.back() = transfer.back().real();
  return transfer;
}

std::vector<Complex> mobility_of(std::span<const Complex> receptance, const FrequencyGrid& grid,
                                 std::size_t samples) {
  std::vector<Complex> mobility(receptance.size());
  for (std::size_t k = 0; k < mobility.size(); ++k) {
    mobility[k] = Complex{0.0, grid.omega(k)} * receptance[k];
  }
  return sampled_transfer(std::move(mobility), samples, "mobility");
}

SpectralOperator problem_of(std::span<const Complex> transfer, const FrequencyGrid& grid,
                            std::size_t samples) {
  const std::size_t components = grid.bins - 1;
  std::vector<double> sigma(components), multiplicity(components), weight(components);
  for (std::size_t k = 1; k < grid.bins; ++k) {
    sigma[k - 1] = std::abs(transfer[k]);
    multiplicity[k - 1] = bin_multiplicity(k, samples);
    weight[k - 1] = grid.omega(k) * grid.omega(k);
  }
  return {std::move(sigma), std::move(multiplicity), std::move(weight), samples - 1};
}

std::vector<Complex> inverses_of(std::span<const Complex> transfer,
                                 std::span<const double> sigma_of_bin) {
  std::vector<Complex> inverse(transfer.size());
  for (std::size_t k = 1; k < inverse.size(); ++k) {
    const double sigma = sigma_of_bin[k - 1];
    if (sigma > 0.0) inverse[k] = std::conj(transfer[k] / sigma) / sigma;
  }
  return inverse;
}

}  // namespace

OneSidedInversion::OneSidedInversion(std::vector<std::vector<Complex>> transfer,
                                     std::size_t samples, double sample_rate)
    : OneSidedInversion(std::move(transfer[0]), std::move(transfer[1]), samples, sample_rate) {}

OneSidedInversion::OneSidedInversion(const ModalBasis& basis, double contact, End end,
                                     std::size_t samples, double sample_rate)
    : OneSidedInversion(string_model(basis, contact)
                            .with_sensors({static_cast<std::size_t>(end), 2})
                            .transfer(FrequencyGrid::of_record(samples, sample_rate)),
                        samples, sample_rate) {}

OneSidedInversion::OneSidedInversion(std::vector<Complex> reaction_transfer,
                                     std::vector<Complex> receptance, std::size_t samples,
                                     double sample_rate)
    : fft_(samples), sample_rate_(sample_rate), problem_({}, {}, {}, 0) {
  const FrequencyGrid grid = FrequencyGrid::of_record(samples, sample_rate);
  const std::vector<Complex> transfer =
      sampled_transfer(std::move(reaction_transfer), samples, "transfer function");
  receptance_ = sampled_transfer(receptance, samples, "receptance");
  // From the complex receptance: its imaginary part in bin K/2 is the velocity's real one.
  mobility_ = mobility_of(receptance, grid, samples);
  problem_ = problem_of(transfer, grid, samples);
  inverse_ = inverses_of(transfer, problem_.sigma_as_given());
  power_scale_.resize(problem_.size());
  std::transform(problem_.multiplicity().begin(), problem_.multiplicity().end(),
                 power_scale_.begin(),
                 [samples](double m) { return m / static_cast<double>(samples); });
}

void OneSidedInversion::require_record(std::span<const double> reaction) const {
  MODCAL_REQUIRE(reaction.size() == samples(),
                 "a reaction of {} samples was given to an inversion prepared for {}",
                 reaction.size(), samples());
  for (std::size_t j = 0; j < reaction.size(); ++j) {
    MODCAL_REQUIRE(std::isfinite(reaction[j]),
                   "sample {} of the reaction is {:g}: cut the record before it or repair it", j,
                   reaction[j]);
  }
}

SpectralData OneSidedInversion::data_of(std::span<const Complex> spectrum,
                                        std::vector<double>& power) const {
  power.resize(problem_.size());
  const std::span<const std::uint32_t> order = problem_.order();
  double total = 0.0;
  for (std::size_t i = 0; i < power.size(); ++i) {
    const Complex value = spectrum[order[i] + 1];
    const double square = value.real() * value.real() + value.imag() * value.imag();
    power[i] = power_scale_[i] * square;
    total += power[i];
  }
  MODCAL_REQUIRE(std::isfinite(total),
                 "the square of the reaction overflows: check the calibration factor of its "
                 "channel");
  SpectralData data;
  data.problem = &problem_;
  data.power = power;
  return data;
}

void OneSidedInversion::apply_filter(const Regularizer& regularizer, double parameter,
                                     InversionWorkspace& workspace) const {
  workspace.factors.resize(problem_.size());
  if (regularizer.has_penalty()) {
    regularizer.filter_factors(penalized_sigma_as_given(regularizer, problem_), parameter,
                               workspace.factors);
  } else {
    regularizer.filter_factors(problem_.sigma_as_given(), parameter, workspace.factors);
  }
  workspace.force[0] = 0.0;
  identify_force(workspace.factors, std::span(inverse_).subspan(1),
                 std::span(workspace.force).subspan(1));
  // The transform of a real record is real there, up to the library's rounding.
  if (samples() % 2 == 0) workspace.force.back() = workspace.force.back().real();
}

void OneSidedInversion::write_contact_signal(std::span<const Complex> transfer,
                                             InversionWorkspace& workspace,
                                             std::vector<double>& signal) const {
  workspace.contact.resize(transfer.size());
  workspace.contact[0] = 0.0;
  for (std::size_t k = 1; k < transfer.size(); ++k) {
    workspace.contact[k] = transfer[k] * workspace.force[k];
  }
  signal.resize(samples());
  fft_.inverse(workspace.contact, signal);
}

void OneSidedInversion::write_outputs(const InversionOutputs& outputs,
                                      InversionWorkspace& workspace,
                                      InversionResult& result) const {
  result.force.clear();
  result.displacement.clear();
  result.velocity.clear();
  result.force_spectrum.clear();
  if (outputs.displacement) write_contact_signal(receptance_, workspace, result.displacement);
  if (outputs.velocity) write_contact_signal(mobility_, workspace, result.velocity);
  if (outputs.force_spectrum) result.force_spectrum = workspace.force;
  if (outputs.force) {
    result.force.resize(samples());
    fft_.inverse(workspace.force, result.force);
  }
}

void OneSidedInversion::invert(std::span<const double> reaction, const InversionMethod& method,
                               InversionWorkspace& workspace, InversionResult& result) const {
  require_record(reaction);
  workspace.force.resize(fft_.bins());
  fft_.forward(reaction, workspace.force);
  SpectralData data = data_of(workspace.force, workspace.power);
  data.noise_rms = method.noise_rms;
  result.bins = problem_.size();
  result.blind_bins = problem_.zeros();
  result.choice = method.choice.choose(method.regularizer, data);
  apply_filter(method.regularizer, result.choice.parameter(), workspace);
  write_outputs(method.outputs, workspace, result);
}

InversionResult OneSidedInversion::invert(std::span<const double> reaction,
                                          const InversionMethod& method) const {
  InversionWorkspace workspace;
  InversionResult result;
  invert(reaction, method, workspace, result);
  return result;
}

namespace {

class PreparedOneSided final : public PreparedEstimator {
 public:
  explicit PreparedOneSided(const EstimationModel& model) {
    const FrequencyGrid grid = FrequencyGrid::of_record(model.samples, model.sample_rate);
    const auto transfer = string_model(model.basis, model.contact).transfer(grid);
    for (std::size_t r = 0; r < 2; ++r) {
      sides_.emplace_back(transfer[r], transfer[2], model.samples, model.sample_rate);
    }
  }

  std::vector<Estimate> estimate(const EstimationRecord& record,
                                 const InversionMethod& method) const override {
    static constexpr const char* kNames[] = {"1", "2"};
    static constexpr const char* kLabels[] = {"from R1 (x = 0)", "from R2 (x = L)"};
    std::vector<Estimate> estimates;
    for (std::size_t r = 0; r < 2; ++r) {
      if (record.reactions[r].empty()) continue;
      InversionMethod of_side = method;
      of_side.noise_rms = record.stated_noise[r];
      Estimate estimate;
      estimate.side = kNames[r];
      estimate.label = kLabels[r];
      estimate.result = sides_[r].invert(record.reactions[r], of_side);
      const auto sigma = sides_[r].problem().sigma();
      estimate.largest_transfer = sigma.empty() ? 0.0 : sigma[0];
      estimate.warnings = estimate.result.choice.warnings;
      estimates.push_back(std::move(estimate));
    }
    return estimates;
  }

 private:
  std::vector<OneSidedInversion> sides_;
};

}  // namespace

std::shared_ptr<const PreparedEstimator> OneSidedEstimator::do_prepare(
    const EstimationModel& model) const {
  return std::make_shared<const PreparedOneSided>(model);
}

}  // namespace modcal
