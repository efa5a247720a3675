#include "experiments/runs/task_key.hpp"

#include <fmt/format.h>
#include <xxhash.h>

namespace modcal {

namespace {

std::string text_of(const XXH128_hash_t& hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

std::string digest_of(std::string_view text) {
  return text_of(XXH3_128bits(text.data(), text.size()));
}

struct Digest::State {
  State() { XXH3_128bits_reset(handle); }
  ~State() { XXH3_freeState(handle); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  XXH3_state_t* handle = XXH3_createState();
};

Digest::Digest() : state_(std::make_unique<State>()) {}
Digest::~Digest() = default;

void Digest::add(std::string_view part) {
  XXH3_128bits_update(state_->handle, part.data(), part.size());
}

std::string Digest::text() const { return text_of(XXH3_128bits_digest(state_->handle)); }

std::string checksum_of(std::string_view text) {
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

}  // namespace modcal
