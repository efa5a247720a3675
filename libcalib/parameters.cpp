#include "libcalib/parameters.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <numbers>

#include "libcalib/stiff_string_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

// Number n of "f_n"; 0 where the name is no such name.
std::size_t mode_number(const std::string& name) {
  if (!name.starts_with("f_")) return 0;
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(name.data() + 2, name.data() + name.size(), number);
  return error == std::errc{} && end == name.data() + name.size() ? number : 0;
}

Variable within_share(std::string name, double initial, double share) {
  return {.name = std::move(name),
          .unit = "Hz",
          .initial = initial,
          .lower = initial * (1.0 - share),
          .upper = initial * (1.0 + share),
          .scale = initial * share};
}

void require_ranges(const ParameterRanges& ranges) {
  MODCAL_REQUIRE(ranges.frequency > 0.0 && ranges.frequency < 1.0,
                 "frequency range {:g} must lie in (0, 1)", ranges.frequency);
  MODCAL_REQUIRE(ranges.inharmonicity > 0.0 && std::isfinite(ranges.inharmonicity),
                 "inharmonicity range {:g} must be > 0", ranges.inharmonicity);
  MODCAL_REQUIRE(ranges.contact > 0.0 && std::isfinite(ranges.contact),
                 "contact range {:g} m must be > 0", ranges.contact);
}

}  // namespace

ParameterSet::ParameterSet(ModelPoint initial, std::span<const std::string> names,
                           const ParameterRanges& ranges)
    : initial_(std::move(initial)), follows_(initial_.basis.size(), false) {
  require_ranges(ranges);
  MODCAL_REQUIRE(!names.empty(), "a calibration needs at least one free parameter");
  MODCAL_REQUIRE(initial_.contact > 0.0 && initial_.contact < initial_.basis.length,
                 "contact {:g} m must lie inside the string, in (0, {:g}) m", initial_.contact,
                 initial_.basis.length);
  const bool law_free = std::any_of(names.begin(), names.end(), [](const std::string& name) {
    return name == "f0" || name == "B";
  });
  if (law_free) {
    std::vector<double> frequencies(initial_.basis.size());
    for (std::size_t n = 0; n < frequencies.size(); ++n) {
      frequencies[n] = initial_.basis.frequency(n);
    }
    const StiffStringFit fit = fit_stiff_string(frequencies);
    law_ = {fit.fundamental, std::max(fit.inharmonicity, 0.0)};
    std::fill(follows_.begin(), follows_.end(), true);
  }
  for (const std::string& name : names) {
    MODCAL_REQUIRE(std::none_of(parameters_.begin(), parameters_.end(),
                                [&](const Parameter& p) { return p.variable.name == name; }),
                   "parameter \"{}\" is named twice", name);
    parameters_.push_back(parameter(name, ranges));
    const Parameter& added = parameters_.back();
    if (added.kind == ParameterKind::kFrequency) follows_[added.mode] = false;
  }
}

Parameter ParameterSet::parameter(const std::string& name, const ParameterRanges& ranges) const {
  if (name == "f0") {
    return {within_share(name, law_.fundamental, ranges.frequency), ParameterKind::kFundamental};
  }
  if (name == "B") {
    // The highest mode moves by 0.5 B N² of its frequency: a step of 1e-5 is sensible for any N up
    // to some hundred.
    return {{name, "1", law_.inharmonicity, 0.0, law_.inharmonicity + ranges.inharmonicity, 1e-5},
            ParameterKind::kInharmonicity};
  }
  if (name == "x_c") {
    const double x = initial_.contact;
    // Ends of the string are no contact: nothing is excited there.
    const double margin = 1e-6 * initial_.basis.length;
    return {{name, "m", x, std::max(margin, x - ranges.contact),
             std::min(initial_.basis.length - margin, x + ranges.contact), ranges.contact},
            ParameterKind::kContact};
  }
  const std::size_t n = mode_number(name);
  MODCAL_REQUIRE(n >= 1 && n <= initial_.basis.size(),
                 "unknown parameter \"{}\": parameters are f_1 ... f_{}, f0, B and x_c", name,
                 initial_.basis.size());
  return {within_share(name, initial_.basis.frequency(n - 1), ranges.frequency),
          ParameterKind::kFrequency, n - 1};
}

std::vector<Variable> ParameterSet::variables() const {
  std::vector<Variable> result;
  for (const Parameter& parameter : parameters_) result.push_back(parameter.variable);
  return result;
}

bool ParameterSet::has(ParameterKind kind) const {
  return std::any_of(parameters_.begin(), parameters_.end(),
                     [kind](const Parameter& parameter) { return parameter.kind == kind; });
}

std::vector<double> ParameterSet::start() const {
  std::vector<double> result;
  for (const Parameter& parameter : parameters_) result.push_back(parameter.variable.initial);
  return result;
}

ParameterSet::Law ParameterSet::law_at(std::span<const double> x) const {
  Law law = law_;
  for (std::size_t i = 0; i < size(); ++i) {
    if (parameters_[i].kind == ParameterKind::kFundamental) law.fundamental = x[i];
    if (parameters_[i].kind == ParameterKind::kInharmonicity) law.inharmonicity = x[i];
  }
  return law;
}

ModelPoint ParameterSet::model(std::span<const double> x) const {
  assert(x.size() == size());
  ModelPoint point = initial_;
  const Law law = law_at(x);
  for (std::size_t n = 0; n < follows_.size(); ++n) {
    if (!follows_[n]) continue;
    point.basis.omega[n] =
        2.0 * pi * stiff_string_frequency(law.fundamental, law.inharmonicity, n + 1);
  }
  for (std::size_t i = 0; i < size(); ++i) {
    const Parameter& parameter = parameters_[i];
    if (parameter.kind == ParameterKind::kFrequency) {
      point.basis.omega[parameter.mode] = 2.0 * pi * x[i];
    }
    if (parameter.kind == ParameterKind::kContact) point.contact = x[i];
  }
  return point;
}

std::vector<FrequencySlope> ParameterSet::frequency_slopes(std::span<const double> x,
                                                           std::size_t i) const {
  assert(x.size() == size() && i < size());
  const Parameter& parameter = parameters_[i];
  if (parameter.kind == ParameterKind::kContact) return {};
  if (parameter.kind == ParameterKind::kFrequency) return {{parameter.mode, 2.0 * pi}};
  const Law law = law_at(x);
  std::vector<FrequencySlope> slopes;
  for (std::size_t index = 0; index < follows_.size(); ++index) {
    if (!follows_[index]) continue;
    const double n = static_cast<double>(index + 1);
    const double root = std::sqrt(1.0 + law.inharmonicity * n * n);
    const double slope = parameter.kind == ParameterKind::kFundamental
                             ? n * root
                             : 0.5 * law.fundamental * n * n * n / root;
    slopes.push_back({index, 2.0 * pi * slope});
  }
  return slopes;
}

void ParameterRanges::visit(OptionVisitor& visitor) {
  visitor.number({.key = "frequency_range",
                  .meaning = "how far f_n and f0 may move, relative to their initial values",
                  .unit = "1",
                  .range = Range::open(0.0, 1.0)},
                 frequency);
  visitor.number({.key = "inharmonicity_range",
                  .meaning = "how far B may rise",
                  .unit = "1",
                  .range = Range::positive()},
                 inharmonicity);
  visitor.number({.key = "contact_range",
                  .meaning = "how far x_c may move",
                  .unit = "m",
                  .range = Range::positive()},
                 contact);
}

void ParameterOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "frequencies",
                .meaning = "free modal frequencies: none, all, or those of the listed modes",
                .choices = {"none", "all", "listed"}},
               frequencies);
  visitor.integers({.key = "modes",
                    .meaning = "mode numbers, with frequencies: listed",
                    .range = Range::at_least(1)},
                   modes);
  visitor.flag({.key = "law", .meaning = "free f0 and B of the stiff-string law"}, law);
  visitor.flag({.key = "contact", .meaning = "free contact location x_c"}, contact);
  ranges.visit(visitor);
}

std::vector<std::string> ParameterOptions::names(std::size_t modes_of_model) const {
  const bool listed = frequencies == "listed";
  MODCAL_REQUIRE(listed == !modes.empty(),
                 "modes are listed if and only if frequencies is \"listed\"; it is \"{}\" with {} "
                 "modes",
                 frequencies, modes.size());
  std::vector<std::string> names;
  if (frequencies == "all") {
    for (std::size_t n = 1; n <= modes_of_model; ++n) names.push_back(fmt::format("f_{}", n));
  }
  for (const std::int64_t n : modes) names.push_back(fmt::format("f_{}", n));
  if (law) names.insert(names.end(), {"f0", "B"});
  if (contact) names.emplace_back("x_c");
  MODCAL_REQUIRE(!names.empty(), "no parameter is free: ask for frequencies, law or contact");
  return names;
}

}  // namespace modcal
