#include "libsim/records/wav_comment.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace modcal {
namespace {

std::vector<RecordedChannel> numbered_channels(std::size_t count) {
  std::vector<RecordedChannel> channels(count);
  for (std::size_t i = 0; i < count; ++i) {
    channels[i].name = std::to_string(i + 1);
    channels[i].full_scale = std::numeric_limits<double>::quiet_NaN();
  }
  return channels;
}

}  // namespace

std::string wav_comment(std::span<const Signal> signals, double full_scale) {
  nlohmann::ordered_json content;
  content["full_scale"] = full_scale;
  content["channels"] = nlohmann::ordered_json::array();
  for (const Signal& signal : signals) {
    content["channels"].push_back(nlohmann::ordered_json::array({signal.quantity, signal.unit}));
  }
  nlohmann::ordered_json comment;
  comment["modcal"] = content;
  return comment.dump();
}

std::vector<RecordedChannel> channels_of_comment(std::string_view comment, std::size_t count) {
  try {
    const auto content = nlohmann::json::parse(comment).at("modcal");
    const double full_scale = content.at("full_scale").get<double>();
    const auto& stated = content.at("channels");
    if (stated.size() != count || !(full_scale > 0.0) || !std::isfinite(full_scale)) {
      return numbered_channels(count);
    }
    std::vector<RecordedChannel> channels;
    for (const auto& channel : stated) {
      channels.push_back(
          {channel.at(0).get<std::string>(), channel.at(1).get<std::string>(), full_scale, {}});
    }
    return channels;
  } catch (const nlohmann::json::exception&) {
    // Somebody else's comment: a description, a recorder's settings.
    return numbered_channels(count);
  }
}

}  // namespace modcal
