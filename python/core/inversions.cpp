// An inversion with its model prepared: arrays in, arrays out, nothing judged.
#include <pybind11/stl.h>

#include "experiments/study/observation.hpp"
#include "libinverse/invert.hpp"
#include "libsim/records/levels.hpp"
#include "libsim/records/recording.hpp"
#include "python/core/arrays.hpp"
#include "python/core/errors.hpp"
#include "python/core/module.hpp"
#include "python/core/watched.hpp"

namespace modcal::python {
namespace {

/// Keys of an experiment on a record that the model and the method are made of.
struct InverterOptions {
  StringModel string;
  ContactOptions contact;
  InversionOptions inversion;

  static InverterOptions read(const std::string& yaml) {
    InverterOptions options;
    read_keys(yaml, [&options](OptionVisitor& visitor) {
      visitor("string", "the string", options.string);
      visitor("bow", "where the force acts", options.contact);
      visitor("inversion", "how the reactions are inverted", options.inversion);
    });
    return options;
  }
};

py::dict described_estimate(Estimate estimate) {
  py::dict told;
  const auto deviations = [](std::vector<double>& each, double all) -> py::object {
    if (each.empty()) return py::float_(all);
    return array_of(std::move(each));
  };
  told["side"] = estimate.side;
  told["force"] = array_of(std::move(estimate.result.force));
  told["displacement"] = array_of(std::move(estimate.result.displacement));
  told["velocity"] = array_of(std::move(estimate.result.velocity));
  told["force_deviation"] = deviations(estimate.force_deviations, estimate.force_deviation);
  told["velocity_deviation"] =
      deviations(estimate.velocity_deviations, estimate.velocity_deviation);
  told["displacement_deviation"] = estimate.displacement_deviation;
  told["parameter"] = estimate.result.choice.parameter();
  told["band_limit"] = estimate.band_limit;
  told["warnings"] = estimate.warnings;
  return told;
}

// Silence is none of the extremes here: its force is 0.
void require_squares(const char* side, std::span<const double> samples) {
  if (samples.empty()) return;
  const auto extreme = find_extreme_magnitude(samples);
  if (!extreme) return;
  const double value = samples[extreme->first];
  if (value == 0.0 || !std::isfinite(value)) return;  // the estimator names what is not finite
  throw_invalid_input("{}, sample {}: {}", side, extreme->first, extreme->text);
}

class Inverter {
 public:
  Inverter(const std::string& yaml, std::size_t samples, double sample_rate, bool recorded)
      : options_(InverterOptions::read(yaml)),
        recipe_(options_.inversion),
        basis_(make_modal_basis(options_.string)) {
    // More memory than the record has is taken for what a rate far too high would show.
    require_periods("Inverter", options_.string.fundamental, samples, sample_rate);
    const std::string hidden = explain_hidden_modes(basis_, sample_rate);
    MODCAL_REQUIRE(hidden.empty(), "{}", hidden);
    do_watched(py::none(), [&](const Watch&) {
      prepared_ = recipe_.estimator().prepare({.basis = basis_,
                                               .contact = options_.contact.position,
                                               .samples = samples,
                                               .sample_rate = sample_rate,
                                               .recorded = recorded});
    });
  }

  py::list estimate(const std::optional<Numbers>& left, const std::optional<Numbers>& right,
                    bool motion) const {
    EstimationRecord record;
    if (left) record.reactions[0] = span_of(*left);
    if (right) record.reactions[1] = span_of(*right);
    require_squares("left", record.reactions[0]);
    require_squares("right", record.reactions[1]);
    std::vector<Estimate> found;
    const auto invert = [&] {
      found = prepared_->estimate(
          record, recipe_.method({.force = true, .displacement = motion, .velocity = motion}));
    };
    constexpr std::size_t kShort = 500'000;  // samples: 30 ms, against 0.1 ms for a thread
    if (std::max(record.reactions[0].size(), record.reactions[1].size()) > kShort) {
      do_watched(py::none(), [&](const Watch&) { invert(); });
    } else {
      const py::gil_scoped_release unlocked;
      invert();
    }
    py::list told;
    for (Estimate& one : found) told.append(described_estimate(std::move(one)));
    return told;
  }

 private:
  InverterOptions options_;
  InversionRecipe recipe_;
  ModalBasis basis_;
  std::shared_ptr<const PreparedEstimator> prepared_;
};

}  // namespace

void add_inversions(py::module_& module) {
  py::class_<Inverter>(module, "Inverter")
      .def(py::init<const std::string&, std::size_t, double, bool>(), py::arg("options"),
           py::arg("samples"), py::arg("sample_rate"), py::arg("recorded"))
      .def("estimate", &Inverter::estimate, py::arg("left"), py::arg("right"), py::arg("motion"));
}

}  // namespace modcal::python
