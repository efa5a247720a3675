#include "libsim/model/transfer.hpp"

#include <cassert>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/model/transfer_kernel.hpp"

namespace modcal {

FrequencyGrid FrequencyGrid::of_record(std::size_t samples, double sample_rate) {
  MODCAL_REQUIRE(samples >= 1 && sample_rate > 0.0,
                 "a record of {} samples at {:g} Hz has no frequency grid", samples, sample_rate);
  return {.spacing = 2.0 * std::numbers::pi * sample_rate / static_cast<double>(samples),
          .bins = samples / 2 + 1,
          .sigma = 0.0};
}

std::vector<double> reaction_gains(const ModalBasis& basis, End end) {
  std::vector<double> gains(basis.size());
  for (std::size_t i = 0; i < gains.size(); ++i) {
    const double slope =
        basis.tension * static_cast<double>(i + 1) * std::numbers::pi / basis.length;
    const bool odd = i % 2 == 0;  // mode number n = i + 1
    gains[i] = end == End::kLeft || odd ? -slope : slope;
  }
  return gains;
}

void modal_sum(const ModalBasis& basis, std::span<const double> numerator,
               const FrequencyGrid& grid, std::span<Complex> out) {
  assert(numerator.size() == basis.size() && out.size() == grid.bins);
  std::vector<ModalTerm> terms;
  terms.reserve(basis.size());
  for (std::size_t i = 0; i < basis.size(); ++i) {
    if (numerator[i] == 0.0) continue;
    terms.push_back({.residue = numerator[i] / basis.mass[i],
                     .omega_squared = basis.omega[i] * basis.omega[i],
                     .two_zeta_omega = 2.0 * basis.zeta[i] * basis.omega[i]});
  }
  sum_modal_terms(terms, grid.spacing, grid.sigma, out);
}

std::vector<Complex> reaction_transfer(const ModalBasis& basis, double contact, End end,
                                       const FrequencyGrid& grid) {
  std::vector<double> numerator = reaction_gains(basis, end);
  const std::vector<double> shape = basis.shape_at(contact);
  for (std::size_t i = 0; i < numerator.size(); ++i) numerator[i] *= shape[i];
  std::vector<Complex> transfer(grid.bins);
  modal_sum(basis, numerator, grid, transfer);
  return transfer;
}

std::vector<Complex> contact_receptance(const ModalBasis& basis, double contact,
                                        const FrequencyGrid& grid) {
  std::vector<double> numerator = basis.shape_at(contact);
  for (double& value : numerator) value *= value;
  std::vector<Complex> receptance(grid.bins);
  modal_sum(basis, numerator, grid, receptance);
  return receptance;
}

}  // namespace modcal
