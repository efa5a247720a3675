#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "experiments/kinds/benchmark/benchmark_study.hpp"
#include "experiments/kinds/calibrate/limit_source.hpp"
#include "experiments/study/fingerprint.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Unknowns of the law in the order of ExpectedLimit::law.
enum Unknown : std::size_t { kFundamental, kInharmonicity, kContact, kDamping, kUnknowns };
using Covariance = std::array<std::array<double, kUnknowns>, kUnknowns>;

// Covariance of the others where one unknown is known after all.
void know(Unknown known, Covariance& c) {
  if (!(c[known][known] > 0.0)) return;  // fixed already
  const Covariance before = c;
  for (std::size_t i = 0; i < kUnknowns; ++i) {
    for (std::size_t j = 0; j < kUnknowns; ++j) {
      c[i][j] -= before[i][known] * before[known][j] / before[known][known];
    }
  }
}

std::vector<double> law_bounds(const ExpectedLimit& limit, const CalibrateOptions& options,
                               const ModalBasis& basis) {
  std::vector<double> frequencies(basis.size());
  for (std::size_t n = 0; n < basis.size(); ++n) frequencies[n] = basis.frequency(n);
  const StiffStringFit law = fit_stiff_string(frequencies);
  std::array<double, kUnknowns> deviation = limit.law;
  deviation[kFundamental] /= law.fundamental;
  Covariance c{};
  for (std::size_t i = 0; i < kUnknowns; ++i) {
    for (std::size_t j = 0; j < kUnknowns; ++j) {
      c[i][j] = limit.law_correlation[i][j] * deviation[i] * deviation[j];
    }
  }
  if (!options.calibration.parameters.contact) {
    know(kContact, c);
  }
  std::vector<double> bounds;
  for (std::size_t n = 1; n <= basis.size(); ++n) {
    // ln f_n = ln f_0 + ln n + ln(1 + B n²)/2
    const auto square = static_cast<double>(n * n);
    const double slope = 0.5 * square / (1.0 + law.inharmonicity * square);
    const double variance = c[kFundamental][kFundamental] +
                            2.0 * slope * c[kFundamental][kInharmonicity] +
                            slope * slope * c[kInharmonicity][kInharmonicity];
    bounds.push_back(std::sqrt(std::max(variance, 0.0)));
  }
  return bounds;
}

std::vector<double> bounds_of(const CalibrateOptions& options, TruthCache& truths) {
  const ObservationOptions& observation = options.inversion.observation;
  LimitQuestion question{.observation = observation,
                         .noise_level = observation.measurement.noise_level};
  question.calibrate_by(options.calibration);
  // The outputs of the task's own truth, so that both share one simulation.
  const LimitCase records = limit_case(question, truths, {.force = true});
  const ExpectedLimit limit = expected_limit(records);
  if (options.calibration.parameters.frequencies == "none") {
    return law_bounds(limit, options, records.truth.basis);
  }
  std::vector<double> bounds;
  for (const ModeVerdict& mode : limit.modes) bounds.push_back(mode.deviation);
  return bounds;
}

std::string key_of(const CalibrateOptions& options) {
  const ObservationOptions& observation = options.inversion.observation;
  const CalibrationOptions& calibration = options.calibration;
  LimitQuestion question;
  question.calibrate_by(calibration);
  const std::string unknowns =
      fingerprint([&](OptionVisitor& visitor) { question.unknowns.visit(visitor); });
  return fmt::format("{} {:a} {} {} {} {:a} {:a} {}",
                     truth_key(observation.truth, observation.measurement.sample_rate, {}),
                     observation.measurement.noise_level, calibration.parameters.frequencies,
                     calibration.parameters.contact, calibration.by_schedule(),
                     question.highest_frequency, question.law_width, unknowns);
}

}  // namespace

FrequencyBounds::Bounds FrequencyBounds::of(const CalibrateOptions& options, TruthCache& truths) {
  const ParameterOptions& parameters = options.calibration.parameters;
  const bool searched = parameters.law || parameters.frequencies != "none";
  if (!searched || options.inversion.observation.measurement.noise_level <= 0.0) return nullptr;
  return known_.get(key_of(options), [&] {
    return std::make_shared<const std::vector<double>>(bounds_of(options, truths));
  });
}

double rms_bound(const FrequencyBounds::Bounds& bounds, const std::vector<std::size_t>& modes) {
  if (bounds == nullptr || modes.empty()) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0.0;
  for (const std::size_t n : modes) sum += (*bounds)[n - 1] * (*bounds)[n - 1];
  return std::sqrt(sum / static_cast<double>(modes.size()));
}

}  // namespace modcal
