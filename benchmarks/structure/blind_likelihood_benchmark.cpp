// Time of the joint likelihood with its Jacobian, K = 4 sensors, 30 modes, 2000 bins, and of the
// force of four responses of 200 000 samples by a table of 30 modes.
#include <benchmark/benchmark.h>

#include <cmath>

#include "libinverse/structure/blind_likelihood.hpp"
#include "libsim/base/turn.hpp"

namespace {

using namespace modcal;

struct Problem {
  ModalModel model;
  ContourSpectra spectra;
  BinVariances variances;
};

Problem problem() {
  Problem p;
  p.model.sensors.assign(4, SensorKind::kAcceleration);
  for (std::size_t n = 0; n < 30; ++n) {
    p.model.poles.push_back({kTurn * (12.0 + 15.0 * static_cast<double>(n)), 0.01});
  }
  for (std::size_t i = 0; i < 120; ++i) {
    p.model.constants.push_back(std::cos(0.7 * static_cast<double>(i)));
    p.model.quadrature.push_back(0.1 * std::sin(1.3 * static_cast<double>(i)));
  }
  p.spectra.sample_rate = 2000.0;
  p.spectra.samples = 8000;
  p.spectra.grid = FrequencyGrid::of_record(8000, 2000.0);
  p.spectra.bins = {20, 2020};
  p.spectra.force.assign(2000, 1.0);
  p.spectra.responses = transfers_of(p.model, p.spectra);
  for (std::size_t k = 0; k < 4; ++k) {
    p.variances.of.emplace_back(2000, 1e-4);
    for (std::size_t m = 0; m < 2000; ++m) {
      p.spectra.responses[k][m] += 0.01 * std::exp(Complex(0.0, 0.1 * static_cast<double>(m * k)));
    }
  }
  return p;
}

void likelihood_with_jacobian(benchmark::State& state) {
  const Problem p = problem();
  const BlindLikelihood likelihood(p.spectra, p.model.sensors, p.variances, state.range(0) != 0);
  for (auto _ : state) {
    const BlindPoint point = likelihood.at(p.model);
    benchmark::DoNotOptimize(likelihood.jacobian(p.model, p.model, point, false).data());
  }
  const BlindPoint point = likelihood.at(p.model);
  state.counters["cost"] = point.cost;
  state.counters["slopes"] = likelihood.jacobian(p.model, p.model, point, false).norm();
}
BENCHMARK(likelihood_with_jacobian)
    ->ArgName("at_rest")
    ->Arg(1)
    ->Arg(0)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// From samples to samples: spectra on a contour, H, F = Σ conj(H) Y/V ÷ (Σ |H|²/V + 1/P).
void joint_inversion(benchmark::State& state) {
  constexpr std::size_t kSamples = 200'000;
  const ModalModel model = problem().model;
  StructureRecord record{.sample_rate = 2000.0};
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<double>& response = record.responses.emplace_back();
    for (std::size_t j = 0; j < kSamples; ++j) {
      response.push_back(std::sin(0.001 * static_cast<double>((k + 3) * j)));
    }
  }
  const RealFft fft(kSamples);
  std::vector<double> force(kSamples);
  for (auto _ : state) {
    const auto spectra = ContourSpectra::of(record, 0.02, 5.0, 480.0);
    const BinVariances variances{
        .of = std::vector(4, std::vector<double>(spectra.count(), spectra.noise_power()))};
    const BinEvidence evidence =
        evidence_of(spectra, transfers_of(model, spectra), variances, kNoSensor);
    std::vector<Complex> whole(fft.bins());
    for (std::size_t m = 0; m < spectra.count(); ++m) {
      whole[spectra.bins.first + m] = evidence.score[m] / (evidence.told[m] + 1e-9);
    }
    fft.inverse(whole, force);
    benchmark::DoNotOptimize(force.data());
  }
  double squares = 0.0;
  for (const double x : force) squares += x * x;
  state.counters["rms"] = std::sqrt(squares / static_cast<double>(kSamples));
}
BENCHMARK(joint_inversion)->MeasureProcessCPUTime()->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
