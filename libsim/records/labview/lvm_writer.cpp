#include <fstream>

#include "libsim/base/error.hpp"
#include "libsim/records/labview/lvm_file.hpp"
#include "libsim/records/labview/lvm_segments.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {
namespace {

// One line of a header: a name and a value a channel.
template <typename Value>
std::string line_of(std::string_view name, std::span<const Signal> signals, Value value) {
  std::string line(name);
  for (const Signal& signal : signals) line += fmt::format("\t{}", value(signal));
  return line + "\t\n";
}

std::string header_of(std::span<const Signal> signals, const RecordNotes& notes) {
  std::string text = fmt::format(
      "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n"
      "Decimal_Separator\t.\nMulti_Headings\tYes\nX_Columns\tNo\nTime_Pref\tRelative\n"
      "Operator\tmodcal\nDescription\t{}\nDate\t1970/01/01\nTime\t00:00:00\n"
      "***End_of_Header***\t\n\t\n",
      notes.provenance);
  text += fmt::format("Notes\t{}{}\nChannels\t{}\n", kLvmRate, signals.front().sample_rate,
                      signals.size());
  text += line_of("Samples", signals, [](const Signal& signal) { return signal.size(); });
  text += line_of("Date", signals, [](const Signal&) { return "1970/01/01"; });
  text += line_of("Time", signals, [](const Signal&) { return "00:00:00"; });
  text += line_of("Y_Unit_Label", signals, [](const Signal& signal) { return signal.unit; });
  text += line_of("X_Dimension", signals, [](const Signal&) { return "Time"; });
  // As many digits as tell a double from its neighbors: "0.003" would tell of a rounded step.
  const auto exact = [](double seconds) { return fmt::format("{:.16E}", seconds); };
  text += line_of("X0", signals, [&](const Signal&) { return exact(notes.start); });
  text += line_of("Delta_X", signals,
                  [&](const Signal& signal) { return exact(1.0 / signal.sample_rate); });
  text += "***End_of_Header***\t\nX_Value";
  for (const Signal& signal : signals) text += "\t" + signal.quantity;
  return text + "\tComment\n";
}

}  // namespace

void write_lvm(const std::filesystem::path& path, std::span<const Signal> signals,
               const RecordNotes& notes) {
  const std::string name = path.string();
  require_one_record(signals, name);
  for (const Signal& signal : signals) {
    MODCAL_REQUIRE((signal.quantity + signal.unit).find_first_of("\t\r\n") == std::string::npos,
                   "{}: the name \"{}\" [{}] has a tab or a line end; rename the channel", name,
                   signal.quantity, signal.unit);
  }
  replace_file(path, [&](const std::filesystem::path& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    file << header_of(signals, notes);
    std::string row;
    for (std::size_t i = 0; i < signals.front().size(); ++i) {
      row.clear();
      for (const Signal& signal : signals) {
        fmt::format_to(std::back_inserter(row), "\t{}", signal.samples[i]);
      }
      file << row << '\n';
    }
    file.close();
    MODCAL_REQUIRE(!file.fail(), "{}: writing failed; is the disk full?", name);
  });
}

}  // namespace modcal
