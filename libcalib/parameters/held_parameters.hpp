// What is known exactly and no unknown of a fit.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libcalib/parameters/parameters.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

/// f0, B, x_c, a single f_n or zeta_n, held at a value.
struct FixedParameter {
  std::string parameter;
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the initial value
  void visit(OptionVisitor& visitor);
};

struct UnknownsOptions;

/// Throws InvalidInput for a name that is unknown, repeated or fixed in another place, a value that
/// no string has, and where fewer than two frequencies are left to find a free law by.
void require_fixed(const UnknownsOptions& options, std::size_t modes, std::size_t records = 1);

struct HeldParameters {
  std::optional<double> fundamental, inharmonicity;  ///< [Hz], [1]
  std::vector<std::optional<double>> contacts;       ///< [m], by record
  std::vector<bool> frequencies, ratios;             ///< by mode; empty: none

  bool contact(std::size_t record) const {
    return record < contacts.size() && contacts[record].has_value();
  }
  bool frequency(std::size_t mode) const { return mode < frequencies.size() && frequencies[mode]; }
  bool ratio(std::size_t mode) const { return mode < ratios.size() && ratios[mode]; }
  HeldParameters of_record(std::size_t record) const;
};

HeldParameters held_parameters(const UnknownsOptions& options, std::size_t modes,
                               std::size_t records, double initial_contact,
                               double initial_fundamental, double initial_inharmonicity);

/// The initial model with the values stated: frequencies, damping ratios, the first contact.
ModelPoint with_fixed(ModelPoint initial, const UnknownsOptions& options);

}  // namespace modcal
