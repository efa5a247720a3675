#include "libsim/base/random.hpp"

#include <Random123/philox.h>

#include <Random123/boxmuller.hpp>
#include <Random123/uniform.hpp>
#include <bit>

namespace modcal {
namespace {

using Philox = r123::Philox4x64;

enum class Kind : std::uint64_t { kNumber, kLetter, kEndOfWord };

// Mixing by the function that makes the numbers; letters, ends of words and numbers are kept apart.
std::uint64_t mix(std::uint64_t state, std::uint64_t input, Kind kind) {
  const Philox::ctr_type counter = {
      {state, input, 0x6d6f6463616cULL, static_cast<std::uint64_t>(kind)}};
  const Philox::key_type key = {{0, 0}};
  return Philox{}(counter, key)[0];
}

template <typename Transform>
void fill_pairs(const StreamKey& key, std::span<double> out, Transform transform) {
  const Philox::key_type philox_key = {{key.value(), 0}};
  for (std::size_t i = 0; i < out.size(); i += 4) {
    const Philox::ctr_type counter = {{i / 4, 0, 0, 0}};
    const Philox::ctr_type bits = Philox{}(counter, philox_key);
    double values[4];
    transform(bits[0], bits[1], values);
    transform(bits[2], bits[3], values + 2);
    for (std::size_t j = 0; j < 4 && i + j < out.size(); ++j) out[i + j] = values[j];
  }
}

}  // namespace

StreamKey::StreamKey(std::uint64_t seed) : value_(mix(0, seed, Kind::kNumber)) {}

StreamKey StreamKey::with(std::string_view word) const {
  StreamKey result = *this;
  for (const char letter : word) {
    result.value_ = mix(result.value_, static_cast<unsigned char>(letter), Kind::kLetter);
  }
  result.value_ = mix(result.value_, word.size(), Kind::kEndOfWord);
  return result;
}

StreamKey StreamKey::with(std::uint64_t number) const {
  StreamKey result = *this;
  result.value_ = mix(value_, number, Kind::kNumber);
  return result;
}

StreamKey StreamKey::with(double number) const {
  // +0.0 so that -0.0 and 0.0 give one stream.
  return with(std::bit_cast<std::uint64_t>(number + 0.0));
}

void fill_standard_normal(const StreamKey& key, std::span<double> out) {
  fill_pairs(key, out, [](std::uint64_t a, std::uint64_t b, double* values) {
    const r123::double2 pair = r123::boxmuller(a, b);
    values[0] = pair.x;
    values[1] = pair.y;
  });
}

void fill_uniform(const StreamKey& key, std::span<double> out) {
  fill_pairs(key, out, [](std::uint64_t a, std::uint64_t b, double* values) {
    values[0] = r123::u01<double>(a);
    values[1] = r123::u01<double>(b);
  });
}

}  // namespace modcal
