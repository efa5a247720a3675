// Contact force and velocity from the waves that leave and reach the contact: shares no code with
// the modal transfer functions.
//
// A wave that leaves the contact towards x = 0 arrives there τ₁ = x_c/c later as R₁ = −2 Z₀ v, Z₀ =
// T/c, and comes back inverted after the same time; likewise at x = L with τ₂ = (L − x_c)/c. So
// v₁ₒ(t) = −R₁(t + τ₁)/2Z₀, v₁ᵢ(t) = R₁(t − τ₁)/2Z₀, v₂ₒ(t) = −R₂(t + τ₂)/2Z₀, v₂ᵢ(t) = R₂(t −
// τ₂)/2Z₀, and the force adds half of itself to each side: f = 2 Z₀ (v₁ₒ − v₂ᵢ) = 2 Z₀ (v₂ₒ − v₁ᵢ),
// v = v₁ₒ + v₁ᵢ.
#pragma once

#include <span>
#include <vector>

#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// Force and velocity at the contact. The last samples need waves that arrive after the end of the
/// record: only the first `valid` ones are reconstructed, the others are 0.
struct WaveReconstruction {
  std::vector<double> force;     ///< f_c [N]
  std::vector<double> velocity;  ///< v(x_c) [m/s]
  std::size_t valid = 0;
};

/// Which outgoing wave is read: f = 2 Z₀ (v₁ₒ − v₂ᵢ), from the wave that arrives at x = 0, or its
/// mirror f = 2 Z₀ (v₂ₒ − v₁ᵢ), from the one that arrives at x = L.
enum class OutgoingWave { kLeft, kRight };

/// Time domain, ideal string: delays by a Kaiser-windowed sine cardinal of 64 samples. For a record
/// that starts at rest; the fundamental of the basis gives c = 2 L f₁. Reactions [N] of equal
/// length, contact x_c in (0, L) [m], sample_rate [Hz]. Throws InvalidInput outside these ranges
/// and for records shorter than the delays.
WaveReconstruction reconstruct_from_waves(const ModalBasis& basis, double contact,
                                          double sample_rate, std::span<const double> left,
                                          std::span<const double> right, OutgoingWave outgoing);

/// Frequency domain, with loss and dispersion: the delays become e^{∓ik(s)x} with the complex
/// wavenumber k = nπ/L of the continuous mode number n that solves ω(n)² + 2ζ(n)ω(n)s + s² = 0, ω
/// and ζ interpolated between the modes, ω like n√(1 + B n²). On the contour s = σ + iω, σ = 2/T,
/// up to the highest mode and 0 above. Near fields of the bending stiffness are left out. Wrapping
/// of the transform disturbs the last part of the record (e^{−2} of what rings on), `valid` is the
/// length.
WaveReconstruction reconstruct_with_loss(const ModalBasis& basis, double contact,
                                         double sample_rate, std::span<const double> left,
                                         std::span<const double> right, OutgoingWave outgoing);

}  // namespace modcal
