#include "libcalib/identifiability/moving_bridge.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

#include "libcalib/identifiability/tuning.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {
namespace {

using Complex = std::complex<double>;

// Amplitudes of a mode of the body itself: 1/m and two of what it has from before.
constexpr Eigen::Index kOwn = 3;

// u/(−R₂), the receptance of the body at x = L.
Complex receptance(std::span<const ScoreTest> body, Complex s) {
  Complex sum;
  for (const ScoreTest& mode : body) {
    const auto add = [&](double amplitude, double place) {
      const double omega = 2.0 * std::numbers::pi * place;
      sum += amplitude / (s * s + 2.0 * kBodyDamping * omega * s + omega * omega);
    };
    add(mode.amplitudes[0], mode.place);
    if (mode.amplitudes.size() <= kOwn) continue;
    const auto [below, above] = places_beside(mode.place);
    add(mode.amplitudes[kOwn], below);
    add(mode.amplitudes[kOwn + 1], above);
  }
  return sum;
}

}  // namespace

void add_to_body(const ScoreTest& further, std::vector<ScoreTest>& body) {
  const auto same = std::ranges::find(body, further.place, &ScoreTest::place);
  if (same == body.end()) {
    body.push_back(further);
    return;
  }
  const Eigen::Index count = std::max(same->amplitudes.size(), further.amplitudes.size());
  same->amplitudes.conservativeResizeLike(Eigen::VectorXd::Zero(count));
  same->amplitudes.head(further.amplitudes.size()) += further.amplitudes;
  same->amplitude = same->amplitudes[0] + same->amplitudes.tail(count - kOwn).sum();
  same->detail = bridge_detail(same->place, same->amplitude);
}

void take_out(std::span<const ScoreTest> body, const ModelPoint& model, double highest,
              NoisyRecords& records) {
  records.on_bridge = records.reactions[1];
  records.body.clear();
  for (const ScoreTest& mode : body) records.body.push_back(mode.place);
  const ProjectedLikelihood whole(WhitenedRecord::of(records, 0.0, highest));
  const std::vector<MisfitCause> causes = bridges_at(whole, model, records.body);
  const RealFft fft(records.samples());
  std::vector<double> samples(fft.length());
  for (std::size_t r = 0; r < 2; ++r) {
    std::vector<Complex> spectrum(fft.bins());
    for (std::size_t i = 0; i < body.size(); ++i) {
      for (Eigen::Index j = 0; j < body[i].amplitudes.size(); ++j) {
        const SignalColumn& column = causes[i].columns[static_cast<std::size_t>(j)];
        const double amplitude = body[i].amplitudes[j];
        for (std::size_t k = 0; k < whole.record().bins; ++k) {
          spectrum[k + 1] += amplitude * (r == 0 ? column.left : column.right).at(k);
        }
      }
    }
    // A whitened spectrum is over s_r √N.
    const double scale = records.deviation[r] * std::sqrt(static_cast<double>(samples.size()));
    fft.inverse(spectrum, samples);
    for (std::size_t j = 0; j < samples.size(); ++j) {
      records.reactions[r][j] -= scale * samples[j];
    }
  }
}

bool put_on_bridge(ModalBasis& basis, std::span<const ScoreTest> body) {
  if (body.empty()) return true;
  ModalBasis found = basis;
  const double per_length = basis.tension / basis.length;
  for (std::size_t n = 0; n < basis.size(); ++n) {
    const double omega = basis.omega[n], zeta = basis.zeta[n];
    const Complex own = omega * Complex(-zeta, std::sqrt(1.0 - zeta * zeta));
    Complex s = own, last = 0.0;
    // Every round leaves a part of the error as large as ScoreTest::coupling.
    for (int round = 0; round < 60 && std::abs(s - last) > 1e-14 * omega; ++round) {
      Complex others = 1.0;
      for (std::size_t m = 0; m < basis.size(); ++m) {
        if (m == n) continue;
        const double other = basis.omega[m];
        others += 2.0 * s * s / (s * s + 2.0 * basis.zeta[m] * other * s + other * other);
      }
      const Complex stiff = per_length * receptance(body, s);
      last = s;
      s = own - 2.0 * s * s * stiff / ((1.0 + stiff * others) * (s - std::conj(own)));
    }
    if (!(std::abs(s - last) < 1e-9 * omega)) return false;
    found.omega[n] = std::abs(s);
    found.zeta[n] = -s.real() / std::abs(s);
  }
  basis = std::move(found);
  return true;
}

}  // namespace modcal
