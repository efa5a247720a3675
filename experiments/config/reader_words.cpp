#include "experiments/config/reader_words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "experiments/config/reader.hpp"
#include "libsim/base/nearest_name.hpp"

namespace modcal {

std::vector<std::string> strings_of(const std::vector<std::string_view>& views) {
  return {views.begin(), views.end()};
}

std::string_view kind_name(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kMap:
      return "a map";
    case YamlNode::Kind::kSequence:
      return "a list";
    default:
      return node.text.empty() && !node.quoted ? "nothing" : "a single value";
  }
}

std::string_view moved_key(std::string_view key) {
  if (key != "continuation") return {};
  return "is now the optimizer \"staged\": write objective: {type: joint_likelihood, left_noise, "
         "right_noise, highest_frequency}, optimizer: {type: staged, restarts}, and what is free "
         "or "
         "known under parameters: {frequencies: all, law: true, contact: true, damping: factor, "
         "law_width, sensors: [gain, ...], per_record, fixed, priors, correlations}";
}

std::string suggestion(std::string_view text, const std::vector<std::string>& names) {
  const std::string nearest = nearest_name(text, names);
  if (!nearest.empty()) return fmt::format("; did you mean \"{}\"?", nearest);
  return names.empty() ? std::string() : fmt::format("; known: {}", fmt::join(names, ", "));
}

}  // namespace modcal
