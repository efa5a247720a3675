// One kind of experiment: what `kind:` names at the top of a file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/study/study.hpp"
#include "libsim/base/registry.hpp"

namespace modcal {

/// Something about the settings that no single option shows.
struct Finding {
  std::string path;  ///< dotted path of the option it concerns
  std::string text;
  bool is_error = true;
};

class Experiment {
 public:
  static constexpr std::string_view kKind = "experiment";
  static Registry<Experiment> registry();

  virtual ~Experiment() = default;
  /// Physics and consistency of the settings; nothing is computed.
  virtual std::vector<Finding> lint() const = 0;
  /// What a run would do and what it would skip, one line each.
  virtual std::vector<std::string> plan() const = 0;
  virtual StudyResult run(const StudyContext& context) const = 0;
};

}  // namespace modcal
