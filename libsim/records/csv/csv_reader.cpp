#include <algorithm>
#include <cmath>
#include <functional>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/csv/rows.hpp"
#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/tuning.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kUnknownRate =
    "the sample rate is not known; state sample_rate, add a comment line \"# sample_rate: 51200 "
    "Hz\", or a column t [s] with two instants or more";
constexpr std::uint64_t kHeadBytes = 1 << 20, kWholeFile = ~std::uint64_t{0};

class CsvReader final : public CsvHandler {
 public:
  CsvReader(const std::filesystem::path& path, const ReadOptions& options)
      : file_(path), options_(options) {}

  Recording read() {
    file_.parse(*this, options_.headers_only ? kHeadBytes : kWholeFile);
    MODCAL_REQUIRE(!columns_.empty(),
                   "{}: no header; the first row must name the columns, such as t [s],R1 [N]",
                   file_.name());
    MODCAL_REQUIRE(rows_ > 0, "{}: there is a header but no row of samples", file_.name());
    if (std::string text = mark_.doubt(); !text.empty() && !options_.headers_only) {
      record_.add_problem(fmt::format("{}: {}", file_.name(), text));
    }
    leave_index_out();
    settle_sample_rate();
    record_.format = "CSV, separated by " + file_.separator_name();
    for (const std::size_t index : kept_) {
      record_.channels.push_back(std::move(columns_[index].channel));
    }
    if (options_.headers_only) forget_samples();
    if (!options_.survey) record_.refuse_problems();
    return std::move(record_);
  }

  void comment(std::string_view text) override;
  void field(std::size_t index, std::string_view text) override;
  void end_row(std::size_t fields) override;

 private:
  struct Column {
    RecordedChannel channel;
    bool read = false;
    PrintedDigits digits = {};  ///< of instants
  };

  void forget_samples();
  void settle_columns();
  void choose_columns();
  void leave_index_out();
  void settle_sample_rate();
  double to_seconds(Column& column) const;
  void use_time_axis(double stated);
  void compare_instants(double step);
  void settle_first_row();

  CsvFile file_;
  const ReadOptions& options_;
  Recording record_;
  std::vector<std::string> headings_, first_row_;
  std::string unnamed_;  // where a first column without a name is
  std::vector<Column> columns_;
  std::vector<std::size_t> kept_;
  TimeColumns instants_;
  DecimalMark mark_;
  std::optional<std::size_t> time_;
  bool in_first_row_ = true;
  std::size_t rows_ = 0;
  CommentedRate commented_;
};

// Their number follows from the size of the file where it was not read to its end.
void CsvReader::forget_samples() {
  const auto size = static_cast<double>(std::filesystem::file_size(file_.name()));
  const auto taken = static_cast<double>(file_.taken());
  record_.stated_frames =
      static_cast<std::size_t>(static_cast<double>(rows_) * std::max(1.0, size / taken));
  if (taken < size) record_.warnings.push_back(file_.name() + std::string(kEstimatedLength));
  for (RecordedChannel& channel : record_.channels) channel.samples.clear();
}

void CsvReader::comment(std::string_view text) {
  if (rows_ > 0) {
    std::string hidden = hidden_row_text(file_, text, columns_.size());
    if (!hidden.empty()) record_.add_problem(std::move(hidden));
  }
  commented_.read(text, file_);
}

void CsvReader::field(std::size_t index, std::string_view text) {
  if (columns_.empty()) {
    headings_.push_back(utf8_or_latin1(text));
    return;
  }
  if (in_first_row_) return first_row_.push_back(utf8_or_latin1(text));
  if (index >= columns_.size() || !columns_[index].read) return;
  const ParsedNumber number = mark_.parse(text, file_.separator());
  const bool is_named = !columns_[index].channel.name.empty();
  if (number.kind != NumberKind::kNumber && is_named) {
    record_.add_problem(fmt::format("{}: sample {} of {}: {}", file_.place(index), rows_,
                                    columns_[index].channel.name,
                                    describe_bad_number(number.kind, text)));
  }
  if (instants_.contains(index)) columns_[index].digits.add(text);
  columns_[index].channel.samples.push_back(number.value);
}

void CsvReader::end_row(std::size_t fields) {
  if (columns_.empty()) {
    settle_columns();
    return;
  }
  if (in_first_row_) {
    settle_first_row();
    if (first_row_.empty()) return;
  }
  record_.lines.add(rows_, file_.line());
  options_.stop.throw_if_requested();
  ++rows_;
  if (fields == columns_.size()) return;
  record_.add_problem(ragged_row_text(file_, fields, columns_.size()));
  for (std::size_t i = fields; i < columns_.size(); ++i) {
    if (columns_[i].read) columns_[i].channel.samples.push_back(kNaN);
  }
}

// Units below the names, or samples like all others.
void CsvReader::settle_first_row() {
  in_first_row_ = false;
  const std::vector<std::string> units = units_of_row(first_row_);
  for (std::size_t i = 0; i < first_row_.size() && units.empty(); ++i) field(i, first_row_[i]);
  if (units.empty()) return;
  if (units.size() != columns_.size()) {
    record_.add_problem(ragged_row_text(file_, units.size(), columns_.size()));
  }
  for (std::size_t i = 0; i < std::min(units.size(), columns_.size()); ++i) {
    if (columns_[i].channel.unit.empty()) columns_[i].channel.unit = units[i];
  }
  first_row_.clear();
}

void CsvReader::settle_columns() {
  const std::vector<ColumnHeading> headings = headings_of_row(headings_, file_);
  columns_.resize(headings.size());
  for (std::size_t i = 0; i < headings.size(); ++i) {
    columns_[i].channel.name = headings[i].name;
    columns_[i].channel.unit = headings[i].unit;
  }
  if (headings[0].name.empty()) unnamed_ = file_.place(0);
  if (options_.has_time) instants_ = TimeColumns(headings);
  choose_columns();
}

void CsvReader::choose_columns() {
  std::vector<std::string> names;
  for (const Column& column : columns_) names.push_back(column.channel.name);
  require_apart(headings_, options_.channels, file_.place(0));
  kept_ = find_channels(names, options_.channels, fmt::format("{}:{}", file_.name(), file_.line()));
  for (std::size_t i = 0; options_.channels.empty() && i < columns_.size(); ++i) {
    if (!instants_.contains(i) && !names[i].empty()) kept_.push_back(i);
  }
  columns_[0].read = names[0].empty();
  MODCAL_REQUIRE(!kept_.empty(), "{}: there is a time column but no channel", file_.place(0));
  time_ = instants_.instants_of(kept_.front());
  for (const std::size_t index : kept_) {
    MODCAL_REQUIRE(!instants_.contains(index),
                   "{}: column \"{}\" is the time column, not a channel", file_.place(index),
                   names[index]);
    MODCAL_REQUIRE(!names[index].empty(), "{}", unnamed_text(file_.place(index), index + 1));
    columns_[index].read = true;
    if (time_) columns_[*instants_.instants_of(index)].read = true;
  }
}

// What numbers the rows, as pandas writes it, or has their instants once more.
void CsvReader::leave_index_out() {
  if (unnamed_.empty()) return;
  const std::vector<double>& index = columns_[0].channel.samples;
  if (numbers_rows(index) || (time_ && index == columns_[*time_].channel.samples)) {
    record_.warnings.push_back(
        fmt::format("{}: column 1 has no name and numbers the rows: it is left out", unnamed_));
  } else {
    record_.add_problem(unnamed_text(unnamed_, 1));
  }
}

void CsvReader::settle_sample_rate() {
  const bool given = std::isfinite(options_.sample_rate);
  const PrintedRate& told = commented_.rate;
  record_.sample_rate = told.hertz;
  if (given) {
    record_.compare_rate(options_.sample_rate, told.rounding, file_.name());
  } else if (commented_.is_known()) {
    record_.rate_source = fmt::format("comment on line {}", commented_.line);
  }
  if (time_) use_time_axis(record_.sample_rate);
  if (!std::isfinite(record_.sample_rate) && record_.problem_count == 0) {
    record_.add_problem(fmt::format("{}: {}", file_.name(),
                                    told.doubt.empty() ? kUnknownRate : told.doubt.c_str()));
  } else if (!time_ && !given && !told.doubt.empty()) {
    record_.warnings.push_back(fmt::format("{}: {}", file_.name(), told.doubt));
  }
}

// Turns instants into seconds; the resolution they were printed to.
double CsvReader::to_seconds(Column& column) const {
  std::vector<double>& t = column.channel.samples;
  const std::string& unit = column.channel.unit;
  const double second = unit.empty() ? 1.0 : to_si(1.0, unit, "s");
  const double resolution = column.digits.resolution(largest_magnitude(t)) * second;
  for (double& value : t) value *= second;
  return resolution;
}

// Channels that have other instants than the first were not sampled with it.
void CsvReader::compare_instants(double step) {
  const Column& first = columns_[*time_];
  const std::vector<double>& t = first.channel.samples;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    Column& column = columns_[i];
    if (i == time_ || !instants_.contains(i) || !column.read) continue;
    const std::size_t channel = *std::ranges::find(
        kept_, i, [&](std::size_t kept) { return *instants_.instants_of(kept); });
    const double same = to_seconds(column) + kSameInstant * step;
    const std::vector<double>& others = column.channel.samples;
    const auto apart = [same](double a, double b) { return !(std::abs(a - b) <= same); };
    const auto [mine, other] = std::ranges::mismatch(t, others, std::not_fn(apart));
    if (mine == t.end()) continue;
    const auto sample = static_cast<std::size_t>(mine - t.begin());
    record_.add_problem(fmt::format(
        "{}:{}: sample {}: {} is sampled at {:.9g} s ({}), {} at {:.9g} s ({}); resample both to "
        "the same instants, or delete the time column that is wrong",
        file_.name(), record_.lines.line(sample), sample, columns_[kept_.front()].channel.name,
        *mine, first.channel.name, columns_[channel].channel.name, *other, column.channel.name));
  }
}

void CsvReader::use_time_axis(double stated) {
  Column& column = columns_[*time_];
  std::vector<double>& t = column.channel.samples;
  if (!std::ranges::all_of(t, [](double x) { return std::isfinite(x); })) return;  // reported
  const double resolution = to_seconds(column);
  const TimeAxis axis = examine_time_axis(t, resolution);
  record_.time_jitter = axis.jitter;
  record_.start = t.front();
  if (std::isfinite(axis.sample_rate)) compare_instants(1.0 / axis.sample_rate);
  const double rounding = std::min(axis.rate_error, kCalibratedClock);
  const bool given = std::isfinite(options_.sample_rate);
  if (axis.coarse && !std::isfinite(stated)) {
    record_.add_problem(fmt::format("{}: {}", file_.name(),
                                    too_coarse_text("column " + column.channel.name, resolution)));
  }
  for (const TimeFinding& finding : axis.findings) {
    std::string text =
        fmt::format("{}:{}: sample {}: {}", file_.name(), record_.lines.line(finding.sample),
                    finding.sample, finding.text);
    record_.tell_of_instants(std::move(text), finding.breaks, given);
  }
  if (given) {
    record_.sample_rate = axis.sample_rate;
    record_.compare_rate(options_.sample_rate, rounding, file_.name());
  } else if (std::isfinite(stated) && axis.findings.empty() &&
             std::abs(axis.sample_rate / stated - 1.0) > rounding + commented_.rate.rounding) {
    record_.add_problem(fmt::format(
        "{}:{}: the comment says {:.9g} Hz, column {} says {:.9g} Hz; correct one of them or state "
        "sample_rate",
        file_.name(), commented_.line, stated, column.channel.name, axis.sample_rate));
  } else if (!std::isfinite(stated) ||
             (commented_.rate.rounding > rounding && std::isfinite(axis.sample_rate))) {
    record_.sample_rate = axis.sample_rate;
    record_.rate_source = fmt::format("column {}", column.channel.name);
  }
}

}  // namespace

Recording read_csv(const std::filesystem::path& path, const ReadOptions& options) {
  const bool usable = std::isnan(options.sample_rate) ||
                      (options.sample_rate > 0.0 && std::isfinite(options.sample_rate));
  MODCAL_REQUIRE(usable, "sample_rate = {} Hz cannot be used: it must be > 0", options.sample_rate);
  if (!options.headers_only) require_memory(path, "csv", options.memory);
  return CsvReader(path, options).read();
}

}  // namespace modcal
