#include "libsim/records/recording.hpp"

#include <charconv>
#include <cmath>

#include "libsim/base/words.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/tuning.hpp"

namespace modcal {

namespace {

std::size_t find_channel(const std::vector<std::string>& names, std::string_view text,
                         std::string_view where) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  if (is_number && number >= 1 && number <= names.size()) return number - 1;
  const std::string nearest = nearest_name(text, names);
  throw_invalid_input("{}: there is no channel \"{}\"{}; the file has {} channel{}: {}", where,
                      text, nearest.empty() ? "" : fmt::format(", did you mean \"{}\"?", nearest),
                      names.size(), names.size() == 1 ? "" : "s", fmt::join(names, ", "));
}

}  // namespace

void Recording::add_problem(std::string text) {
  if (problem_count++ < kMaxProblems) problems.push_back(std::move(text));
}

void Recording::contradict(std::string text) {
  contradictions.push_back(text);
  warnings.push_back(std::move(text));
}

void Recording::tell_of_instants(std::string text, bool breaks, bool is_rate_stated) {
  if (!is_rate_stated) {
    add_problem(std::move(text));
  } else if (breaks) {
    contradict(std::move(text));
  } else {
    warnings.push_back(std::move(text));
  }
}

void Recording::compare_rate(double stated, double rounding, std::string_view file) {
  const double difference = std::abs(sample_rate / stated - 1.0);
  if (difference > kCalibratedClock && difference > rounding) {
    contradict(fmt::format("{}: the file says {:.9g} Hz, not the stated {:.9g} Hz", file,
                           sample_rate, stated));
  } else if (difference > rounding) {
    warnings.push_back(fmt::format("{}: the file says {:.9g} Hz, the stated {:.9g} Hz is used",
                                   file, sample_rate, stated));
  }
  sample_rate = stated;
  rate_source = "as stated by the user";
}

void SampleLines::add(std::size_t sample, std::size_t line) {
  if (starts_.empty() || line - sample != starts_.back().second - starts_.back().first) {
    starts_.emplace_back(sample, line);
  }
}

std::size_t SampleLines::line(std::size_t sample) const {
  auto after = std::upper_bound(starts_.begin(), starts_.end(), sample,
                                [](std::size_t s, const auto& start) { return s < start.first; });
  --after;
  return after->second + sample - after->first;
}

void Recording::refuse_problems() const {
  if (problem_count == 0) return;
  std::string text = fmt::format("{}", fmt::join(problems, "\n"));
  if (problem_count > problems.size()) {
    text += fmt::format("\n… and {} more of this file", problem_count - problems.size());
  }
  throw InvalidInput(text);
}

std::vector<std::size_t> find_channels(const std::vector<std::string>& names,
                                       const std::vector<std::string>& wanted,
                                       std::string_view where) {
  std::vector<std::size_t> result;
  for (const std::string& text : wanted) try {
      const std::size_t index = find_channel(names, text, where);
      MODCAL_REQUIRE(std::find(result.begin(), result.end(), index) == result.end(),
                     "{}: channel \"{}\" is asked for twice; give every role a channel of its own",
                     where, names[index]);
      result.push_back(index);
    } catch (const InvalidInput& error) {
      throw WrongChannel(result.size(), error.what());
    }
  return result;
}

}  // namespace modcal
