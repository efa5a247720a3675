#include "libinverse/structure/strikes/strike_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libinverse/structure/strikes/spectra_fit.hpp"
#include "libinverse/structure/strikes/tuning.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// What comes later has a part of e^−12 in the power, and the columns know of the end.
void end_by(double sigma, StructureRecord& record) {
  const auto count = static_cast<std::size_t>(6.0 / sigma * record.sample_rate);
  if (count >= record.samples()) return;
  record.force.resize(count);
  for (std::vector<double>& response : record.responses) response.resize(count);
}

void require_differing(const std::vector<ContourSpectra>& spectra) {
  for (std::size_t i = 1; i < spectra.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      MODCAL_REQUIRE(spectra[j].responses != spectra[i].responses,
                     "measurement {} is one of those before: state each once", i + 1);
    }
  }
}

}  // namespace

StrikeFit fit_strikes(std::vector<StructureRecord> records, const std::vector<SensorKind>& kinds,
                      const StrikeFitOptions& options) {
  MODCAL_REQUIRE(!records.empty(), "modes need at least {} strike", 1);
  double shortest = std::numeric_limits<double>::infinity();
  for (const StructureRecord& record : records) {
    MODCAL_REQUIRE(!record.force.empty(),
                   "modes from a strike need the force of {} record: name its channel", 1);
    MODCAL_REQUIRE(kinds.size() == record.responses.size(), "{} kinds of sensors for {} responses",
                   kinds.size(), record.responses.size());
    shortest = std::min(shortest, record.duration());
  }
  const double sigma =
      std::isnan(options.sigma) ? std::min(20.0 / shortest, options.high / 50.0) : options.sigma;
  const double late_sigma = std::max(kLateContour * sigma, kLeastLate / shortest);
  std::vector<ContourSpectra> spectra;
  std::vector<LateStrike> late;
  for (StructureRecord& record : records) {
    if (late_sigma < 0.5 * sigma) {
      end_by(late_sigma, record);
      late.push_back(
          {.force = record.force,
           .spectra = ContourSpectra::of(record, late_sigma, options.low, options.high)});
    }
    end_by(sigma, record);
    spectra.push_back(ContourSpectra::of(record, sigma, options.low, options.high));
  }
  require_differing(spectra);
  return fit_spectra(std::move(records), std::move(spectra), std::move(late), kinds, options);
}

StrikeFit fit_response(const MeasuredFunctions& measured, const StrikeFitOptions& options) {
  MODCAL_REQUIRE(!measured.empty(), "modes need at least {} session of response functions", 1);
  std::vector<ContourSpectra> spectra;
  for (std::size_t i = 0; i < measured.sessions.size(); ++i) {
    spectra.push_back(measured.lines(i, options.low, options.high));
  }
  require_differing(spectra);
  return fit_spectra({}, std::move(spectra), {}, measured.sensors, options);
}

}  // namespace modcal
