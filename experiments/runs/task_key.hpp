// Names of tasks and digests of results.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace modcal {

/// 32 hexadecimal digits (XXH3, 128 bits) that are equal for equal texts.
std::string digest_of(std::string_view text);

/// The same of a text that comes in parts.
class Digest {
 public:
  Digest();
  ~Digest();
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;
  void add(std::string_view part);
  std::string text() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// 16 hexadecimal digits (XXH3, 64 bits) that tell a damaged line.
std::string checksum_of(std::string_view text);

}  // namespace modcal
