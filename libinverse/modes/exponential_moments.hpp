// Sums over damped exponentials in closed form.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstddef>
#include <span>

namespace modcal {

/// Σ_{m<n} (m/n)^p exp(xm), p = 0 … 4, to rounding for any x whose real part is at most some 1/n:
/// by doubling of n, of which every step adds two sums of one length.
std::array<std::complex<double>, 5> exponential_sums(std::complex<double> x, std::size_t count);

/// Inner products over m < n of (m/n)^p times the columns of exponents x per sample, Re exp(xm) and
/// Im exp(xm) in turn: symmetric matrices for p = 0 … 4.
std::array<Eigen::MatrixXd, 5> moments(std::span<const std::complex<double>> exponents,
                                       std::size_t count);

}  // namespace modcal
