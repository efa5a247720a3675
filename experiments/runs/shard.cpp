#include "experiments/runs/shard.hpp"

#include <fmt/format.h>

#include <charconv>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// 0 where the text is not a whole positive number.
std::size_t count_of(std::string_view text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : 0;
}

}  // namespace

std::string Shard::text() const { return fmt::format("{}/{}", index, count); }

Shard parse_shard(std::string_view text) {
  const std::size_t slash = text.find('/');
  Shard shard{0, 0};
  if (slash != std::string_view::npos) {
    shard = {count_of(text.substr(0, slash)), count_of(text.substr(slash + 1))};
  }
  MODCAL_REQUIRE(shard.count >= 1 && shard.index >= 1 && shard.index <= shard.count,
                 "shard \"{}\" is not K/N with 1 <= K <= N, such as 2/7", text);
  return shard;
}

}  // namespace modcal
