#include "libsim/records/signal_file.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"

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

void require_one_record(std::span<const Signal> signals, std::string_view file) {
  MODCAL_REQUIRE(!signals.empty(), "{}: there is no signal to write", file);
  const Signal& first = signals.front();
  MODCAL_REQUIRE(first.sample_rate > 0.0 && std::isfinite(first.sample_rate),
                 "{}: a sample rate of {} Hz cannot be written: it must be > 0", file,
                 first.sample_rate);
  MODCAL_REQUIRE(first.size() > 0, "{}: signal {} has no samples to write", file, first.quantity);
  for (std::size_t i = 0; i < signals.size(); ++i) {
    const Signal& signal = signals[i];
    MODCAL_REQUIRE(!signal.quantity.empty(), "{}: signal {} has no name", file, i + 1);
    MODCAL_REQUIRE(signal.sample_rate == first.sample_rate && signal.size() == first.size(),
                   "{}: {} has {} samples at {} Hz, {} has {} at {} Hz: signals of one file need "
                   "one rate and one length; write them to separate files",
                   file, first.quantity, first.size(), first.sample_rate, signal.quantity,
                   signal.size(), signal.sample_rate);
    for (std::size_t j = 0; j < i; ++j) {
      MODCAL_REQUIRE(signals[j].quantity != signal.quantity,
                     "{}: two signals are named {}; give them different names", file,
                     signal.quantity);
    }
    const auto bad = std::find_if_not(signal.samples.begin(), signal.samples.end(),
                                      [](double value) { return std::isfinite(value); });
    MODCAL_REQUIRE(bad == signal.samples.end(),
                   "{}: sample {} of {} is {}; only numbers are written", file,
                   bad - signal.samples.begin(), signal.quantity, *bad);
  }
}

void require_functions(std::span<const FileFunction> functions, std::string_view file) {
  MODCAL_REQUIRE(!functions.empty(), "{}: there is no function of frequency to write", file);
  std::set<std::string_view> names;
  for (const FileFunction& function : functions) {
    const std::string& name = function.name;
    MODCAL_REQUIRE(!name.empty() && names.insert(name).second,
                   "{}: the name \"{}\" of a function is empty or stands there twice; give "
                   "different names",
                   file, name);
    MODCAL_REQUIRE(function.values.size() == function.hertz.size() && function.hertz.size() > 1,
                   "{}: {} has {} values at {} frequencies; a function needs one value at each of "
                   "two or more",
                   file, name, function.values.size(), function.hertz.size());
    for (std::size_t m = 0; m < function.hertz.size(); ++m) {
      const double line = function.hertz[m];
      MODCAL_REQUIRE(std::isfinite(line) && (m == 0 || line > function.hertz[m - 1]),
                     "{}: frequency {} of {} is {} Hz; frequencies must increase", file, m + 1,
                     name, line);
      const Complex& value = function.values[m];
      MODCAL_REQUIRE(std::isfinite(value.real()) && std::isfinite(value.imag()),
                     "{}: the value of {} at {} Hz is {} + {}i; only numbers are written: repair "
                     "it, or leave this frequency out",
                     file, name, line, value.real(), value.imag());
    }
  }
}

void replace_file(const std::filesystem::path& path,
                  const std::function<void(const std::filesystem::path&)>& write) {
  remove_abandoned_parts(path.has_parent_path() ? path.parent_path() : ".",
                         path.filename().string());
  PartFile part(path);
  write(part.path());
  part.put_in_place();
}

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
