// What is wrong with the priors of a calibration.
#include <set>

#include "experiments/kinds/lint.hpp"

namespace modcal {

std::vector<Finding> lint_priors(const std::string& path, const UnknownsOptions& unknowns,
                                 const StringModel& string, std::size_t records) {
  // Which modes there are, a record may have to tell.
  const std::size_t modes =
      string.modes_of_record() ? 5000 : static_cast<std::size_t>(string.modes);
  std::vector<Finding> findings;
  UnknownsOptions sound = unknowns;  // what has passed so far
  sound.fixed.clear();
  sound.priors.clear();
  sound.correlations.clear();
  std::set<std::string> wrong;
  const auto passes = [&](const std::string& place) {
    const std::size_t before = findings.size();
    lint_making(findings, path + place,
                [&] { require_priors(sound, modes, records, string.length); });
    return findings.size() == before;
  };
  for (std::size_t i = 0; i < unknowns.fixed.size(); ++i) {
    sound.fixed.push_back(unknowns.fixed[i]);
    if (!passes(fmt::format(".fixed.{}", i))) sound.fixed.pop_back();
  }
  for (std::size_t i = 0; i < unknowns.priors.size(); ++i) {
    sound.priors.push_back(unknowns.priors[i]);
    if (passes(fmt::format(".priors.{}", i))) continue;
    wrong.insert(unknowns.priors[i].parameter);
    sound.priors.pop_back();
  }
  const auto is_wrong = [&](const std::string& name) { return wrong.contains(name); };
  for (std::size_t i = 0; i < unknowns.correlations.size(); ++i) {
    const PriorCorrelation& correlation = unknowns.correlations[i];
    // What is wrong with a prior is said there.
    if (std::ranges::any_of(correlation.between, is_wrong)) continue;
    sound.correlations.push_back(correlation);
    if (!passes(fmt::format(".correlations.{}", i))) sound.correlations.pop_back();
  }
  return findings;
}

}  // namespace modcal
