#include "libcalib/likelihood/projected_likelihood.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <array>
#include <cmath>
#include <numbers>

#include "libcalib/likelihood/kernels/decay_kernel.hpp"
#include "libcalib/likelihood/kernels/mode_columns.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::projected_likelihood_test {
namespace {

using std::numbers::pi;

constexpr double kBand = 2.0 * pi * 10300.0;

// Columns ln f_1 … ln f_N, x_c, ln ζ (all modes at once).
LikelihoodColumns all_columns(std::size_t modes) {
  LikelihoodColumns columns{.count = modes + 2, .share_begin = {0}, .contact = modes};
  for (std::size_t n = 0; n < modes; ++n) {
    columns.shares.push_back({n, 1.0, 0.0});
    columns.shares.push_back({modes + 1, 0.0, 1.0});
    columns.share_begin.push_back(columns.shares.size());
  }
  return columns;
}

// Columns ln f0, B, x_c, ln ζ of the law at B.
LikelihoodColumns law_columns(std::size_t modes, double inharmonicity) {
  LikelihoodColumns columns{.count = 4, .share_begin = {0}, .contact = 2};
  for (std::size_t i = 0; i < modes; ++i) {
    const double n2 = static_cast<double>((i + 1) * (i + 1));
    columns.shares.push_back({0, 1.0, 0.0});
    columns.shares.push_back({1, 0.5 * n2 / (1.0 + inharmonicity * n2), 0.0});
    columns.shares.push_back({3, 0.0, 1.0});
    columns.share_begin.push_back(columns.shares.size());
  }
  return columns;
}

ModelPoint moved(ModelPoint point, std::size_t column, double step) {
  const std::size_t modes = point.basis.size();
  if (column < modes) point.basis.omega[column] *= std::exp(step);
  if (column == modes) point.contact += step;
  if (column == modes + 1) {
    for (double& zeta : point.basis.zeta) zeta *= std::exp(step);
  }
  return point;
}

TEST(ProjectedLikelihood, LeavesAlmostNothingOfCleanData) {
  // What is left at the truth is what aliases into the band, 1.8e-3 of 1 % noise, and what the end
  // state costs, some tenths: √(2 · 0.3/20500) = 5e-3.
  const BowedCase bowed = bowed_case(0.03, 0.0, 1.0);
  const ProjectedLikelihood clean(WhitenedRecord::of(noisy(bowed, 0.01, 1, false), 0.0, kBand));
  const double freedom = clean.degrees_of_freedom(0, bowed.truth);
  EXPECT_LT(std::sqrt(2.0 * clean.cost(bowed.truth) / freedom), 6e-3);
  // With noise χ² of 2 K_b − 2N degrees of freedom: sd √(2/20500) = 0.0099, four of them allowed.
  const ProjectedLikelihood noisy_one(WhitenedRecord::of(noisy(bowed, 0.01, 1), 0.0, kBand));
  EXPECT_NEAR(2.0 * noisy_one.cost(bowed.truth) / freedom, 1.0, 0.04);
}

TEST(ProjectedLikelihood, TakesNoiseWithASpectrumAndACoherence) {
  const BowedCase bowed = bowed_case(0.03, 0.0, 1.0);
  NoisyRecords records = with_colored_noise(bowed, 0.01, 1);
  records.noise = colored_spectrum();
  const WhitenedRecord record = WhitenedRecord::of(records, 0.0, kBand);
  const ProjectedLikelihood likelihood(record);
  const double freedom = likelihood.degrees_of_freedom(0, bowed.truth);
  // As for white noise.
  EXPECT_NEAR(2.0 * likelihood.cost(bowed.truth) / freedom, 1.0, 0.04);
  // Noise drawn from it has it.
  const WhitenedRecord drawn = record.noise(3);
  double both = 0.0, expected = 0.0;
  for (std::size_t k = 0; k < record.bins; ++k) {
    both += std::real(drawn.left.at(k) * std::conj(drawn.right.at(k)));
    expected += record.noise_at(k).mixed;
  }
  EXPECT_NEAR(both / expected, 1.0, 0.05);
}

class AtShortRecord : public testing::Test {
 protected:
  BowedCase bowed = bowed_case(0.0285, 1.39e-4, 0.1);
  ModelPoint point() const {
    ModelPoint off = moved(bowed.truth, 50, 2e-5);
    for (std::size_t n = 0; n < 50; ++n) off = moved(off, n, n % 3 == 0 ? 1e-4 : -2e-4);
    return off;
  }
};

TEST_F(AtShortRecord, GradientIsTheDifferenceQuotient) {
  NoisyRecords records = noisy(bowed, 0.02, 3);
  for (const double sigma : {0.0, 40.0, 0.0}) {
    // At last under noise that both sensors have in common in part.
    const ProjectedLikelihood likelihood(WhitenedRecord::of(records, sigma, kBand));
    if (sigma > 0.0) records.noise = colored_spectrum();
    const LikelihoodPoint at = likelihood.evaluate(point(), all_columns(50));
    for (const std::size_t column : {0u, 7u, 20u, 33u, 49u, 50u, 51u}) {
      // Central differences err by h² f‴/6 and by rounding/h; the steps are small shares of a
      // resonance's width, 1e-4 of the slopes is left.
      const double step = column == 50 ? 1e-8 : 1e-6;
      const double quotient = (likelihood.cost(moved(point(), column, step)) -
                               likelihood.cost(moved(point(), column, -step))) /
                              (2.0 * step);
      const double slope = 2.0 * at.slope[static_cast<Eigen::Index>(column)];
      const double size = std::sqrt(
          at.information(static_cast<Eigen::Index>(column), static_cast<Eigen::Index>(column)) *
          at.cost);
      EXPECT_NEAR(quotient, slope, 1e-4 * size) << "column " << column << ", sigma " << sigma;
    }
  }
}

// Automatic differentiation of one residual: the model written out once more, term by term.
using Jet = ceres::Jet<double, 3>;  // ln ω_n, x_c, ln ζ
struct Dual {
  Jet re, im;
};
Dual operator+(const Dual& a, const Dual& b) { return {a.re + b.re, a.im + b.im}; }
Dual operator-(const Dual& a, const Dual& b) { return {a.re - b.re, a.im - b.im}; }
Dual operator*(const Dual& a, const Dual& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
Dual operator*(const Jet& s, const Dual& a) { return {s * a.re, s * a.im}; }
Dual conj(const Dual& a) { return {a.re, -a.im}; }
Dual inverse(const Dual& a) { return (Jet(1.0) / (a.re * a.re + a.im * a.im)) * conj(a); }
Dual dual(Complex z) { return {Jet(z.real()), Jet(z.imag())}; }
Complex slope(const Dual& z, int i) { return {z.re.v[i], z.im.v[i]}; }
Complex value(const Dual& z) { return {z.re.a, z.im.a}; }

struct ResidualJet {
  Dual residual;
  Complex turn[3];  // i Im(hᴴ ∂h)/|h|²
};

ResidualJet residual_jet(const ModelPoint& point, const WhitenedRecord& record,
                         const std::vector<Complex>& amplitudes, std::size_t moving,
                         std::size_t k) {
  const double w = record.spacing * static_cast<double>(k + 1);
  const ModalBasis& basis = point.basis;
  const Jet contact(point.contact, 1);
  Dual left = dual(0.0), right = dual(0.0), odd = dual(0.0), even = dual(0.0);
  for (std::size_t i = 0; i < basis.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    const Jet omega = i == moving ? basis.omega[i] * exp(Jet(0.0, 0)) : Jet(basis.omega[i]);
    const Jet zeta = basis.zeta[i] * exp(Jet(0.0, 2));
    const Jet gain = (basis.tension * n * pi / basis.length / basis.mass[i]) *
                     sin((n * pi / basis.length) * contact);
    const Dual term = gain * inverse({omega * omega - w * w, 2.0 * w * zeta * omega});
    const double parity = i % 2 == 1 ? 1.0 : -1.0;
    left = left - term;
    right = right + Jet(parity) * term;
    const Jet turn = omega * sqrt(Jet(1.0) - zeta * zeta) / record.sample_rate;
    const Jet decay = exp(-zeta * omega / record.sample_rate);
    const Dual pole{decay * cos(turn), decay * sin(turn)};
    const Dual delay = dual(record.delay.at(k));
    const Dual free = dual(amplitudes[i]) * inverse(dual(1.0) - pole * delay) +
                      conj(dual(amplitudes[i])) * inverse(dual(1.0) - conj(pole) * delay);
    (i % 2 == 1 ? even : odd) = (i % 2 == 1 ? even : odd) + free;
  }
  left = Jet(1.0 / record.deviation[0]) * left;
  right = Jet(1.0 / record.deviation[1]) * right;
  const Dual from_left = dual(record.left.at(k)) + Jet(1.0 / record.deviation[0]) * (odd + even);
  const Dual from_right = dual(record.right.at(k)) - Jet(1.0 / record.deviation[1]) * (even - odd);
  const Jet norm =
      left.re * left.re + left.im * left.im + right.re * right.re + right.im * right.im;
  ResidualJet result{.residual = (Jet(1.0) / sqrt(norm)) * (right * from_left - left * from_right)};
  for (int i = 0; i < 3; ++i) {
    const double change =
        (std::conj(value(left)) * slope(left, i) + std::conj(value(right)) * slope(right, i))
            .imag();
    result.turn[i] = Complex(0.0, change / norm.a);
  }
  return result;
}

TEST_F(AtShortRecord, JacobianIsThatOfAutomaticDifferentiation) {
  // One bin a block of 256 has its columns compared; the projection is off: fixed amplitudes.
  const WhitenedRecord record = WhitenedRecord::of(noisy(bowed, 0.02, 3), 0.0, kBand);
  const ProjectedLikelihood likelihood(record);
  std::vector<Complex> amplitudes;
  likelihood.evaluate(point(), all_columns(50), {.amplitudes = &amplitudes});
  const std::vector<LikelihoodMode> modes = likelihood_modes(point(), record.sample_rate);
  const LikelihoodColumns columns = all_columns(50);
  const ModeSplits splits(record, modes);
  std::vector<Complex> by_frequency, by_damping;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    by_frequency.push_back(amplitudes[n] * modes[n].pole_by_frequency);
    by_damping.push_back(amplitudes[n] * modes[n].pole_by_damping);
  }
  LikelihoodBlock block;
  AlignedVector own(columns.count * kColumnLength);
  AlignedVector residual(kColumnLength);
  for (std::size_t b = 0; b < record.blocks(); ++b) {
    std::fill(own.begin(), own.end(), 0.0);
    fill_block(record, b, splits.of(b), nullptr, block);
    fill_residual(record, b, block, residual.data());
    fill_decays(record, b, splits.of(b), amplitudes, block);
    finish_residual(record, b, {.decays = true, .residual = residual.data()}, block);
    fill_mode_columns(record, b, modes, block,
                      {.by_frequency = by_frequency,
                       .by_damping = by_damping,
                       .shares = columns.shares,
                       .share_begin = columns.share_begin,
                       .count = columns.count,
                       .contact = 50,
                       .jacobian = own.data()});
    for (const std::size_t at : {3u, 100u, 170u}) {
      const std::size_t k = b * WhitenedRecord::kBlock + at;
      if (k >= record.bins) continue;
      for (const std::size_t moving : {0u, 10u, 29u, 48u}) {
        const ResidualJet jet = residual_jet(point(), record, amplitudes, moving, k);
        const Complex e = value(jet.residual);
        const Complex mine(residual[at], residual[WhitenedRecord::kBlock + at]);
        // Two orders of the same sums of 50 terms with cancellation: 1e-9 of the data.
        EXPECT_LT(std::abs(mine - e), 1e-9 * std::abs(record.left.at(k)) + 1e-9);
        const std::size_t column[3] = {moving, 50, 51};
        for (int i = 0; i < 3; ++i) {
          const double* ours = own.data() + column[i] * kColumnLength + at;
          const Complex expected = slope(jet.residual, i) - e * jet.turn[i];
          EXPECT_LT(std::abs(Complex(ours[0], ours[WhitenedRecord::kBlock]) - expected),
                    1e-7 * (std::abs(expected) + std::abs(e * jet.turn[i])) + 1e-7)
              << "bin " << k << ", column " << column[i];
        }
      }
    }
  }
}

TEST_F(AtShortRecord, InformationIsTheProjectedJacobians) {
  const ProjectedLikelihood likelihood(WhitenedRecord::of(noisy(bowed, 0.02, 3), 0.0, kBand));
  std::vector<double> residuals;
  Eigen::MatrixXd projected;
  const LikelihoodPoint at = likelihood.evaluate(point(), all_columns(50),
                                                 {.residuals = &residuals, .jacobian = &projected});
  const Eigen::Map<const Eigen::VectorXd> r(residuals.data(), static_cast<long>(residuals.size()));
  const Eigen::MatrixXd information = projected.transpose() * projected;
  // One row stands for all that is known of the end state, some 4e-4 of a record of 0.1 s.
  EXPECT_LT((information - at.information).cwiseAbs().maxCoeff(),
            5e-4 * at.information.cwiseAbs().maxCoeff());
  // Sums of 2000 squares of the same numbers in another order.
  EXPECT_LT((projected.transpose() * r - at.slope).cwiseAbs().maxCoeff(),
            1e-6 * at.slope.cwiseAbs().maxCoeff());
  EXPECT_NEAR(r.squaredNorm(), at.cost, 1e-9 * at.cost);
}

// The record with a sensor at x = L, in dual numbers of ln gain, delay and corner, with its own
// least squares for the end state.
class SensorOracle {
 public:
  SensorOracle(const ModelPoint& point, const WhitenedRecord& record)
      : point_(point), record_(record) {
    const auto rows = static_cast<Eigen::Index>(2 * record.bins);
    const auto modes = static_cast<Eigen::Index>(point.basis.size());
    columns_.resize(rows, 2 * modes + 2);
    data_.resize(rows);
    residual_.resize(rows);
    slopes_.resize(rows, 3);
    for (std::size_t k = 0; k < record.bins; ++k) add_bin(k);
    const Eigen::MatrixXd state = fit(-data_);
    for (std::size_t k = 0; k < record.bins; ++k) differentiate(k, state);
    residual_ = data_ + columns_ * state;
    projected_ = slopes_ - columns_ * fit(slopes_);
  }
  const Eigen::VectorXd& residual() const { return residual_; }
  const Eigen::MatrixXd& columns() const { return slopes_; }
  const Eigen::MatrixXd& jacobian() const { return projected_; }  ///< end state projected out

 private:
  struct Bin {
    Dual left, right, sensor, held;  // h_1, S h_2, S and the decay that the sensor holds
    Jet scale;                       // 1/|h|
    Complex delay;
  };

  // Roots of what each amplitude costs (EndState).
  Eigen::VectorXd costs() const {
    double energy = 0.0;
    for (std::size_t k = 0; k < record_.bins; ++k) {
      energy += std::norm(record_.left.at(k)) + std::norm(record_.right.at(k));
    }
    const double samples = 2.0 * pi * record_.sample_rate / record_.spacing;
    const double noise = record_.deviation[0] * record_.deviation[1];
    const Eigen::Index plain = columns_.cols() - 2;
    Eigen::VectorXd roots(columns_.cols());
    for (Eigen::Index i = 0; i < plain; ++i) {
      const auto n = static_cast<std::size_t>(i / 2);
      const double kept =
          std::exp(-2.0 * point_.basis.zeta[n] * point_.basis.omega[n] / record_.sample_rate);
      roots[i] = std::sqrt(samples / (1.0 - kept) / (energy * noise));
    }
    roots.tail(2).setConstant(std::sqrt(0.5e-3 * static_cast<double>(record_.bins) / energy));
    return roots;
  }

  // Least squares without normal equations.
  Eigen::MatrixXd fit(const Eigen::MatrixXd& right) const {
    const Eigen::Index rows = columns_.rows(), count = columns_.cols();
    const Eigen::VectorXd norms = columns_.colwise().norm();
    Eigen::MatrixXd all(rows + count, count);
    all.topRows(rows) = columns_ * norms.cwiseInverse().asDiagonal();
    all.bottomRows(count) = costs().cwiseQuotient(norms).asDiagonal();
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(rows + count, right.cols());
    values.topRows(rows) = right;
    return norms.cwiseInverse().asDiagonal() *
           Eigen::MatrixXd(Eigen::HouseholderQR<Eigen::MatrixXd>(all).solve(values));
  }

  Bin bin(std::size_t k) const {
    const double w = record_.spacing * static_cast<double>(k + 1);
    const ModalBasis& basis = point_.basis;
    Complex left = 0.0, right = 0.0;
    for (std::size_t i = 0; i < basis.size(); ++i) {
      const double n = static_cast<double>(i + 1), omega = basis.omega[i];
      const double gain = basis.tension * n * pi / basis.length / basis.mass[i] *
                          std::sin(n * pi / basis.length * point_.contact);
      const Complex term = gain / Complex(omega * omega - w * w, 2.0 * w * basis.zeta[i] * omega);
      left -= term / record_.deviation[0];
      right += (i % 2 == 1 ? term : -term) / record_.deviation[1];
    }
    const Jet gain = point_.sensors.gain * exp(Jet(0.0, 0));
    const Jet turn = Jet(point_.sensors.delay, 1) * w;
    const Jet corner(point_.sensors.corner, 2);
    Bin result{.left = dual(left), .delay = record_.delay.at(k)};
    // g e^(−iωτ) iω/(iω + ω_h).
    result.sensor =
        gain * (Dual{cos(turn), -sin(turn)} * Dual{Jet(0.0), Jet(w)} * inverse({corner, Jet(w)}));
    result.right = result.sensor * dual(right);
    const Jet pole = exp(-corner / record_.sample_rate);
    result.held = inverse(dual(1.0) - pole * dual(result.delay));
    const Dual& l = result.left;
    const Dual& r = result.right;
    result.scale = Jet(1.0) / sqrt(l.re * l.re + l.im * l.im + r.re * r.re + r.im * r.im);
    return result;
  }

  // Decays of mode i from the amplitudes 1 and i.
  std::array<Complex, 2> decays(std::size_t i, Complex delay) const {
    const double omega = point_.basis.omega[i], zeta = point_.basis.zeta[i];
    const Complex pole =
        std::exp(Complex(-zeta, std::sqrt(1.0 - zeta * zeta)) * omega / record_.sample_rate);
    const Complex one = 1.0 / (1.0 - pole * delay), two = 1.0 / (1.0 - std::conj(pole) * delay);
    return {one + two, Complex(0.0, 1.0) * (one - two)};
  }

  void set(Eigen::Index column, std::size_t k, Complex number) {
    columns_(static_cast<Eigen::Index>(2 * k), column) = number.real();
    columns_(static_cast<Eigen::Index>(2 * k + 1), column) = number.imag();
  }

  void add_bin(std::size_t k) {
    const Bin at = bin(k);
    const Complex left = value(at.left), right = value(at.right), sensor = value(at.sensor);
    const double scale = at.scale.a;
    const Complex data = scale * (right * record_.left.at(k) - left * record_.right.at(k));
    data_[static_cast<Eigen::Index>(2 * k)] = data.real();
    data_[static_cast<Eigen::Index>(2 * k + 1)] = data.imag();
    const Eigen::Index plain = columns_.cols() - 2;
    for (std::size_t i = 0; i < point_.basis.size(); ++i) {
      const double parity = i % 2 == 1 ? 1.0 : -1.0;
      const Complex both =
          right / record_.deviation[0] + parity * left * sensor / record_.deviation[1];
      const auto pair = decays(i, at.delay);
      for (int j = 0; j < 2; ++j) {
        set(static_cast<Eigen::Index>(2 * i) + j, k,
            scale * both * pair[static_cast<std::size_t>(j)]);
      }
    }
    set(plain, k, scale * left);
    set(plain + 1, k, scale * left * value(at.held));
  }

  // ∂e/∂θ at this end state, less the turn of the residual's phase.
  void differentiate(std::size_t k, const Eigen::VectorXd& state) {
    const Bin at = bin(k);
    Complex odd = 0.0, even = 0.0;
    for (std::size_t i = 0; i < point_.basis.size(); ++i) {
      const auto pair = decays(i, at.delay);
      const auto column = static_cast<Eigen::Index>(2 * i);
      (i % 2 == 1 ? even : odd) += state[column] * pair[0] + state[column + 1] * pair[1];
    }
    const Eigen::Index plain = columns_.cols() - 2;
    const Dual from_left = dual(record_.left.at(k) + (odd + even) / record_.deviation[0]);
    const Dual from_right = dual(record_.right.at(k)) +
                            at.sensor * dual((odd - even) / record_.deviation[1]) -
                            dual(state[plain]) - Jet(state[plain + 1]) * at.held;
    const Dual e = at.scale * (at.right * from_left - at.left * from_right);
    for (int i = 0; i < 3; ++i) {
      const double turn = (std::conj(value(at.left)) * slope(at.left, i) +
                           std::conj(value(at.right)) * slope(at.right, i))
                              .imag() *
                          at.scale.a * at.scale.a;
      const Complex own = slope(e, i) - value(e) * Complex(0.0, turn);
      slopes_(static_cast<Eigen::Index>(2 * k), i) = own.real();
      slopes_(static_cast<Eigen::Index>(2 * k + 1), i) = own.imag();
    }
  }

  const ModelPoint& point_;
  const WhitenedRecord& record_;
  Eigen::MatrixXd columns_, slopes_, projected_;
  Eigen::VectorXd data_, residual_;
};

TEST_F(AtShortRecord, SensorsColumnsAreThoseOfAutomaticDifferentiation) {
  ModelPoint off = point();
  off.sensors = {.gain = 1.04, .delay = 7e-6, .corner = 2.0 * pi * 6.0, .free = true};
  const WhitenedRecord record = WhitenedRecord::of(noisy(bowed, 0.02, 3), 0.0, kBand);
  const ProjectedLikelihood likelihood(record);
  const LikelihoodColumns columns{
      .count = 3, .share_begin = std::vector<std::size_t>(51, 0), .sensors = {0, 1, 2}};
  std::vector<double> residuals;
  Eigen::MatrixXd jacobian;
  const LikelihoodPoint at =
      likelihood.evaluate(off, columns, {.residuals = &residuals, .jacobian = &jacobian});
  const SensorOracle oracle(off, record);
  ASSERT_EQ(residuals.size(), 2 * record.bins + 1);
  const Eigen::Map<const Eigen::VectorXd> r(residuals.data(), oracle.residual().size());
  jacobian.conservativeResize(r.size(), Eigen::NoChange);
  // Normal equations of condition up to 1e9 against none: 1e-7 and some of the whole.
  EXPECT_LT((r - oracle.residual()).norm(), 1e-6 * r.norm());
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double size = oracle.jacobian().col(i).norm();
    EXPECT_GT(size, 0.0);
    EXPECT_LT((jacobian.col(i) - oracle.jacobian().col(i)).norm(), 1e-6 * size) << i;
    EXPECT_NEAR(at.slope[i], oracle.columns().col(i).dot(oracle.residual()),
                1e-6 * oracle.columns().col(i).norm() * r.norm())
        << i;
  }
}

TEST_F(AtShortRecord, NoiseAddsItsOwnInformation) {
  // E JᵀJ = A + N̄, both means over 40 records; J = J_clean + J_noise has cross terms of mean 0.
  const LikelihoodColumns columns = law_columns(50, 1.39e-4);
  const auto information = [&](std::uint64_t seed, bool draw) {
    const ProjectedLikelihood likelihood(
        WhitenedRecord::of(noisy(bowed, 0.1, seed, draw), 0.0, kBand));
    return likelihood.evaluate(bowed.truth, columns).information;
  };
  const ProjectedLikelihood clean(WhitenedRecord::of(noisy(bowed, 0.1, 0, false), 0.0, kBand));
  const Eigen::MatrixXd noise = clean.noise_information(bowed.truth, columns, 40);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(4, 4);
  for (std::uint64_t seed = 0; seed < 40; ++seed) mean += information(seed, true) / 40.0;
  const Eigen::MatrixXd expected = information(0, false) + noise;
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_GT(noise(i, i), 0.0);
    for (Eigen::Index j = 0; j < 4; ++j) {
      // Each mean has about √(2/(2 K_b 40)) of N̄'s size and cross terms of √(A N̄/40).
      const double size = std::sqrt(expected(i, i) * expected(j, j));
      EXPECT_NEAR(mean(i, j) / size, expected(i, j) / size, 0.04) << i << ", " << j;
    }
  }
}

}  // namespace
}  // namespace modcal::projected_likelihood_test
