// Columns of the blind likelihood's Jacobian, bin by bin in the vectors of the machine.
#pragma once

#include "libsim/base/aligned_vector.hpp"
#include "libsim/model/modal_model.hpp"

namespace modcal {

/// What all columns share. A column has the real parts of all sensors, padded() numbers each, then
/// their imaginary parts; the padding holds zeros.
struct BlindBins {
  struct Sensor {
    bool low;               ///< p = 0
    PlanarVector weighted;  ///< h = H/√V
    PlanarVector told;      ///< conj(h)/|h|² of all sensors
    PlanarVector made;      ///< s^p F/√V
  };
  PlanarVector s, turned;  ///< s and −1/s
  std::vector<Sensor> sensors;

  std::size_t padded() const { return s.size(); }
};

/// Of one mode: what stands beside Re A and Im A in the slopes of its H/s^p by ln ω and ln ζ, and
/// in H/s^p itself. The numerator's q is s/ω for p = 0 (low) and −ω/s else (high).
struct ModeShapes {
  PlanarVector inverse;                      ///< 1/D
  PlanarVector by_omega, by_zeta;            ///< beside Re A
  PlanarVector low_omega, low_zeta, low;     ///< beside Im A, p = 0
  PlanarVector high_omega, high_zeta, high;  ///< beside Im A, p = 1 and 2

  explicit ModeShapes(std::size_t bins);
};

/// `out` must have the size of the bins.
void shape_mode(const BlindBins& bins, const ModalPole& pole, ModeShapes& out);

/// v_k = made_k (a_k x + b_k y_k) + extra_k, y_k = low or high by the sensor's kind.
struct ColumnTerms {
  const PlanarVector* x;
  const PlanarVector* low;
  const PlanarVector* high;
  const double* a;                         ///< K
  const double* b;                         ///< K
  const std::vector<PlanarVector>* extra;  ///< K; null: none
};

/// What rings of a state at the record's ends: U = 1/(1 − exp((λ − s)/f_s)), U' with conj(λ).
struct EndShapes {
  PlanarVector own, other;

  explicit EndShapes(std::size_t bins) : own(bins), other(bins) {}
};

/// delay: exp(−s/f_s); step: exp(λ/f_s).
void shape_ends(const PlanarVector& delay, Complex step, EndShapes& out);

/// root (r U + conj(r) U' + t U (U − 1) + conj(t) U' (U' − 1)): a state r, and what moves with λ by
/// t = r dλ/f_s.
void add_ends(const EndShapes& shapes, const AlignedVector& root, Complex r, Complex t,
              PlanarVector& to);

/// −P v, P = I − h hᴴ/|h|², to 2 K padded() numbers.
void project_column(const BlindBins& bins, const ColumnTerms& terms, double* column);

}  // namespace modcal
