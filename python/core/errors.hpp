// Mistakes as Python raises them.
#pragma once

#include <vector>

#include "experiments/config/complaint.hpp"

namespace modcal::python {

/// Several mistakes at once.
class Refusal : public std::runtime_error {
 public:
  explicit Refusal(std::vector<Complaint> complaints)
      : std::runtime_error("refused"), complaints_(std::move(complaints)) {}
  const std::vector<Complaint>& complaints() const { return complaints_; }

 private:
  std::vector<Complaint> complaints_;
};

/// From now on InvalidInput and Refusal are raised as modcal.InvalidInput, Interrupted as
/// KeyboardInterrupt, LostOutput as OSError.
void translate_errors();

}  // namespace modcal::python
