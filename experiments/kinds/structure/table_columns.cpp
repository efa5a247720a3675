#include "experiments/kinds/structure/table_columns.hpp"

#include <algorithm>
#include <array>

#include "libsim/base/error.hpp"
#include "libsim/records/record_file.hpp"

namespace modcal {
namespace {

// The columns that were asked for so far; what is left at the end has no meaning.
class Columns {
 public:
  explicit Columns(const std::filesystem::path& path)
      : name_(path.string()), recording_(read_csv(path, {.sample_rate = 1.0, .has_time = false})) {}

  std::size_t rows() const { return recording_.frames(); }
  std::size_t line(std::size_t row) const { return recording_.lines.line(row); }
  const std::string& name() const { return name_; }

  /// The values, or none where there is no such column. unit: the only one it may state.
  const std::vector<double>* find(const std::string& name, std::string_view unit = "1") {
    known_.push_back(name);
    const auto at = std::ranges::find(recording_.channels, name, &RecordedChannel::name);
    if (at == recording_.channels.end()) return nullptr;
    MODCAL_REQUIRE(at->unit.empty() || at->unit == unit,
                   "{}: the column \"{}\" is in \"{}\"; state it in {}, as a table's own modes "
                   "have it",
                   name_, name, at->unit, unit == "1" ? "SI and without a unit" : unit);
    return &at->samples;
  }
  const std::vector<double>& get(const std::string& name, std::string_view unit = "1") {
    const std::vector<double>* values = find(name, unit);
    MODCAL_REQUIRE(values != nullptr,
                   "{}: has no column \"{}\"; a row a mode is wanted, with the columns frequency "
                   "[Hz], damping_ratio and one for each sensor by its name",
                   name_, name);
    return *values;
  }
  void refuse_others() const {
    for (const RecordedChannel& channel : recording_.channels) {
      MODCAL_REQUIRE(std::ranges::count(known_, channel.name) > 0,
                     "{}: the column \"{}\" has no meaning; known: {}", name_, channel.name,
                     fmt::join(known_, ", "));
    }
  }

 private:
  std::string name_;
  Recording recording_;
  std::vector<std::string> known_;
};

// Columns of these names are not a sensor's, and a column is one sensor's.
void require_apart(const Columns& columns, std::span<const std::string> sensors) {
  constexpr std::array<std::string_view, 5> kTaken = {
      "frequency", "damping_ratio", "frequency_deviation", "damping_deviation", "contact"};
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    MODCAL_REQUIRE(!sensors[k].empty() && std::ranges::count(kTaken, sensors[k]) == 0 &&
                       std::ranges::count(sensors, sensors[k]) == 1,
                   "{}: sensor {} of the table has the name \"{}\": its column needs a name of its "
                   "own",
                   columns.name(), k + 1, sensors[k]);
  }
}

void require_in(const Columns& columns, const std::vector<double>& values, std::string_view name,
                const Range& range) {
  for (std::size_t n = 0; n < values.size(); ++n) {
    MODCAL_REQUIRE(range.contains(values[n]), "{}:{}: {} = {:g}; it must be {}", columns.name(),
                   columns.line(n), name, values[n], range.text());
  }
}

}  // namespace

void ModeOptions::visit(OptionVisitor& visitor) {
  visitor("frequency", "of the pair of poles",
          {.unit = "Hz", .range = Range::positive(), .required = true}, frequency);
  visitor("damping_ratio", "of the pair of poles",
          {.range = Range::open(0.0, 1.0), .required = true}, ratio);
  visitor("constants", "real parts of the modal constants, one a sensor", {.required = true},
          constants);
  visitor("quadrature", "their imaginary parts; none: proportional damping", quadrature);
  visitor("frequency_deviation", "relative standard deviation", {.range = Range::non_negative()},
          frequency_sd);
  visitor("damping_deviation", "relative standard deviation", {.range = Range::non_negative()},
          ratio_sd);
}

ModeColumns read_mode_columns(const std::filesystem::path& path,
                              std::span<const std::string> sensors) {
  Columns columns(path);
  require_apart(columns, sensors);
  ModeColumns result{.modes = std::vector<ModeOptions>(columns.rows())};
  const auto take = [&](const std::vector<double>* values, std::string_view name,
                        const Range& range, double ModeOptions::*to) {
    if (values == nullptr) return;
    require_in(columns, *values, name, range);
    for (std::size_t n = 0; n < result.modes.size(); ++n) result.modes[n].*to = (*values)[n];
  };
  take(&columns.get("frequency", "Hz"), "frequency", Range::positive(), &ModeOptions::frequency);
  take(&columns.get("damping_ratio"), "damping_ratio", Range::open(0.0, 1.0), &ModeOptions::ratio);
  take(columns.find("frequency_deviation"), "frequency_deviation", Range::non_negative(),
       &ModeOptions::frequency_sd);
  take(columns.find("damping_deviation"), "damping_deviation", Range::non_negative(),
       &ModeOptions::ratio_sd);
  if (const std::vector<double>* contact = columns.find("contact")) {
    require_in(columns, *contact, "contact", Range::non_negative());
    result.contact = *contact;
  }
  for (const std::string& sensor : sensors) {
    const std::vector<double>& real = columns.get(sensor);
    const std::vector<double>* imaginary = columns.find(sensor + " imaginary");
    for (std::size_t n = 0; n < result.modes.size(); ++n) {
      result.modes[n].constants.push_back(real[n]);
      result.modes[n].quadrature.push_back(imaginary == nullptr ? 0.0 : (*imaginary)[n]);
    }
  }
  columns.refuse_others();
  return result;
}

}  // namespace modcal
