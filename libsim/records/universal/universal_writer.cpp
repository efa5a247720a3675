#include <bit>
#include <fstream>

#include "libsim/base/error.hpp"
#include "libsim/records/quantities.hpp"
#include "libsim/records/signal_file.hpp"
#include "libsim/records/universal/universal_file.hpp"

namespace modcal {
namespace {

std::string axis_line(int code, std::string_view label, std::string_view unit) {
  return fmt::format("{:10}{:5}{:5}{:5} {:20.20} {:20.20}\n", code, 0, 0, 0, label,
                     unit.empty() ? "NONE" : unit);
}

std::string header_of(const Signal& signal, const std::string& provenance) {
  const Quantity* const quantity = quantity_of_unit(signal.unit);
  std::string text = fmt::format("    -1\n    58b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}\n",
                                 std::endian::native == std::endian::little ? 1 : 2, 2, 11,
                                 8 * signal.size(), 0, 0, 0, 0);
  text += fmt::format("{:.80}\n{:.80}\nNONE\nNONE\nsample_rate: {}\n", signal.quantity, provenance,
                      signal.sample_rate);
  // The full name stands in ID line 1: the entity has ten characters.
  text += fmt::format("{:5}{:10}{:5}{:10} {:10}{:10}{:4} {:10}{:10}{:4}\n", 1, 0, 0, 0, "NONE", 0,
                      0, "NONE", 0, 0);
  text += fmt::format("{:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}\n", 4, signal.size(), 1, 0.0,
                      1.0 / signal.sample_rate, 0.0);
  text += axis_line(17, "Time", "s");
  text += axis_line(quantity == nullptr ? 0 : quantity->code,
                    quantity == nullptr ? "NONE" : quantity->kind, signal.unit);
  return text + axis_line(0, "NONE", "") + axis_line(0, "NONE", "");
}

}  // namespace

void write_universal(const std::filesystem::path& path, std::span<const Signal> signals,
                     const std::string& provenance) {
  const std::string name = path.string();
  require_one_record(signals, name);
  for (const Signal& signal : signals) {
    MODCAL_REQUIRE(signal.quantity.size() <= 80 && signal.unit.size() <= 20 &&
                       signal.quantity.find_first_of("\r\n") == std::string::npos,
                   "{}: the name \"{}\" [{}] does not fit into a universal file", name,
                   signal.quantity, signal.unit);
  }
  replace_file(path, [&](const std::filesystem::path& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    for (const Signal& signal : signals) {
      file << header_of(signal, provenance);
      file.write(reinterpret_cast<const char*>(signal.samples.data()),
                 static_cast<std::streamsize>(8 * signal.size()));
      file << "\n    -1\n";
    }
    file.close();
    MODCAL_REQUIRE(!file.fail(), "{}: writing failed; is the disk full?", name);
  });
}

}  // namespace modcal
