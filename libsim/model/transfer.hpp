// Transfer functions of the modal model from the contact force.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libsim/model/modal_basis.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {

/// Bins of a record's half spectrum: s_k = σ + i 2π k f_s/K, k = 0 … K/2.
struct FrequencyGrid {
  double spacing = 0.0;  ///< angular frequency step 2π f_s/K [rad/s]
  std::size_t bins = 0;  ///< K/2 + 1
  double sigma = 0.0;    ///< real part of s [1/s]; 0 on the frequency axis

  static FrequencyGrid of_record(std::size_t samples, double sample_rate);
  double omega(std::size_t k) const { return spacing * static_cast<double>(k); }
};

/// The end of the string whose reaction is meant.
enum class End { kLeft = 0, kRight = 1 };  // x = 0, x = L

/// Reaction per modal amplitude: g₁ₙ = −T nπ/L at x = 0, g₂ₙ = (−1)ⁿ T nπ/L at x = L [N/m]
/// (Debut, Delaune and Antunes, 2010, eq. 9).
std::vector<double> reaction_gains(const ModalBasis& basis, End end);

/// Σ_n numerator_n / (m_n (ω_n² + s² + 2 ζ_n ω_n s)) on the grid. numerator: N values, out: bins.
void modal_sum(const ModalBasis& basis, std::span<const double> numerator,
               const FrequencyGrid& grid, std::span<Complex> out);

/// Force-to-reaction transfer function H_r(s) = Σ_n g_rn φ_n(x_c)/(m_n (ω_n² + s² + 2 ζ_n ω_n s))
/// [N/N], x_c in [0, L] (Debut, Delaune and Antunes, 2010, eq. 11).
std::vector<Complex> reaction_transfer(const ModalBasis& basis, double contact, End end,
                                       const FrequencyGrid& grid);

/// Receptance at the contact Y/F = Σ_n φ_n(x_c)²/(m_n (ω_n² + s² + 2 ζ_n ω_n s)) [m/N]; the paper's
/// eq. 13. The mobility is s times this.
std::vector<Complex> contact_receptance(const ModalBasis& basis, double contact,
                                        const FrequencyGrid& grid);

}  // namespace modcal
