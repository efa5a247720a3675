// Mistakes as Python raises them.
#pragma once

#include <vector>

#include "experiments/config/complaint.hpp"
#include "experiments/config/reader.hpp"

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

/// Reads the keys that `visit` names from a text of YAML. Throws Refusal with all mistakes.
template <typename Visit>
void read_keys(const std::string& yaml, const Visit& visit) {
  const YamlDocument document = parse_yaml(yaml, "<options>");
  std::vector<Mistake> mistakes = document.mistakes;
  if (mistakes.empty()) read_options(document.root, visit, mistakes);
  if (!mistakes.empty()) throw Refusal(complaints_of(document, mistakes));
}

/// From now on InvalidInput and Refusal are raised as modcal.InvalidInput, Interrupted as
/// KeyboardInterrupt, LostOutput as OSError.
void translate_errors();

}  // namespace modcal::python
