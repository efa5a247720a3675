#include "experiments/kinds/calibrate/calibrate_searches.hpp"

#include <algorithm>
#include <cmath>

#include "libcalib/identifiability/tuning.hpp"

namespace modcal {
namespace {

ModalBasis first_modes(ModalBasis basis, std::size_t count) {
  basis.omega.resize(count);
  basis.zeta.resize(count);
  basis.mass.resize(count);
  return basis;
}

// What is left of a budget after a search; whether that is something.
bool spend(const OptimizationResult& search, Budget& budget) {
  budget.evaluations -= static_cast<std::int64_t>(search.evaluations);
  budget.seconds -= search.seconds;
  return budget.evaluations >= 1 && !(budget.seconds <= 0.0);
}

bool is_cut(const OptimizationResult& search) {
  return search.stop == StopReason::kEvaluationBudget || search.stop == StopReason::kTimeBudget;
}

void count(const OptimizationResult& search, CalibrationOutcome& outcome) {
  outcome.result.search.evaluations += search.evaluations;
  outcome.result.search.seconds += search.seconds;
}

}  // namespace

std::optional<std::size_t> highest_identified(const CalibrationOutcome& outcome) {
  const auto& found = outcome.result.continuation;
  if (!found || !found->frequencies_free) return std::nullopt;
  std::size_t highest = 0;
  for (std::size_t i = 0; i < found->modes.size(); ++i) {
    if (found->modes[i].source == ModeSource::kIdentified) highest = i + 1;
  }
  return highest;
}

std::size_t modes_told(std::size_t highest) {
  constexpr std::size_t kAnyCase = 15;
  return std::max(kAnyCase, 2 * highest);
}

CalibrationOutcome calibrate_as_told(CalibrateOptions options, ObservedRecords& observed,
                                     const StudyContext& context) {
  const auto calibrated = [&] {
    return calibrate_strokes(options, observed.strokes, polling_clock(context), observed.plucks);
  };
  CalibrationOutcome first = calibrated();
  const std::size_t taken = observed.strokes.front().basis.size();
  const auto identified = highest_identified(first);
  const bool is_of_record = !observed.strokes.front().modes_taken.empty();
  if (!is_of_record || !identified || taken <= modes_told(*identified)) return first;
  if (!spend(first.result.search, options.calibration.budget)) return first;
  const std::size_t told = modes_told(*identified);
  for (Observation& stroke : observed.strokes) {
    stroke.basis = first_modes(stroke.basis, told);
    stroke.modes_taken = fmt::format(
        "{} modes taken (modes: auto): none above mode {} is identified of the {} in the band in "
        "which the record stands out of the noise",
        told, *identified, taken);
  }
  CalibrationOutcome outcome = calibrated();
  count(first.result.search, outcome);
  return outcome;
}

std::string another_contact(CalibrateOptions options, const ObservedRecords& observed,
                            const StudyContext& context, CalibrationOutcome& outcome) {
  const ContinuationResult* first = outcome.result.continuation.get();
  const bool is_alone = observed.strokes.size() == 1 && observed.plucks.empty();
  if (!outcome.contact_untold || !is_alone || !first || !first->right) return {};
  Observation stroke = observed.strokes.front();
  const double stated = stroke.contact, length = stroke.basis.length;
  OptimizationResult spent = outcome.result.search;
  for (const double shift : {-kContactShift, kContactShift}) {
    stroke.contact = stated + shift * length;
    if (!(stroke.contact > 0.0 && stroke.contact < length)) continue;
    std::string untried =
        "the ends do not tell x_c, and the budget is spent before another start is tried: raise "
        "calibration.budget";
    if (!spend(spent, options.calibration.budget)) return untried;
    const CalibrationOutcome other = calibrate_observation(options, stroke, polling_clock(context));
    count(spent = other.result.search, outcome);
    if (is_cut(spent)) return untried;
    const ContinuationResult* second = other.result.continuation.get();
    if (!second || !second->right || !held_back(other.result).empty()) continue;
    const double apart = std::abs(other.refined.contact - outcome.refined.contact);
    const double deviation = std::hypot(first->contact_deviation, second->contact_deviation);
    if (apart < kContactsApart * deviation) continue;
    return fmt::format(
        "the ends do not tell x_c in this record, and from {:.4g} mm the search comes to {:.4g} +- "
        "{:.2g} mm, from {:.4g} mm to {:.4g} +- {:.2g} mm, neither of which the data contradict: "
        "hold it where it is known (calibration.parameters.contact: false), or record a stroke "
        "that the string answers between its modes, too",
        1e3 * stated, 1e3 * outcome.refined.contact, 1.96e3 * first->contact_deviation,
        1e3 * stroke.contact, 1e3 * other.refined.contact, 1.96e3 * second->contact_deviation);
  }
  return {};
}

}  // namespace modcal
