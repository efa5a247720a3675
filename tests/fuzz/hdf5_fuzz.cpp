#include "tests/fuzz/record_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  modcal::fuzz::read_as("hdf5", modcal::fuzz::text_of(data, size));
  return 0;
}
