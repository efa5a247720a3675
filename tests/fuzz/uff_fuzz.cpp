#include "libsim/records/universal/universal_modes.hpp"
#include "tests/fuzz/record_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = modcal::fuzz::text_of(data, size);
  modcal::fuzz::read_as("uff", text);
  const modcal::fuzz::MemoryFile file(text);
  modcal::fuzz::accepted([&] { modcal::read_universal_modes(file.path()); });
  return 0;
}
