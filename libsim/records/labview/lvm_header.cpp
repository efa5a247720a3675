#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "libsim/base/error.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/labview/lvm_reader.hpp"

namespace modcal {
namespace {

constexpr std::string_view kEnd = "***End_of_Header***";
constexpr std::size_t kMostChannels = 1 << 12;

}  // namespace

bool LvmReader::next() {
  const std::uint64_t begin = file_.place().byte;
  if (!file_.next(line_)) return false;
  // A number that was cut off may look like a shorter one.
  const std::uint64_t taken = file_.place().byte - begin;
  MODCAL_REQUIRE(taken > line_.size() || line_.empty(),
                 "{}: byte {}: the last line has no end: the file was cut off; add a line end if "
                 "it is whole",
                 here(), file_.size());
  return true;
}

void LvmReader::split() {
  fields_.clear();
  std::string_view rest = line_;
  for (;;) {
    const std::size_t at = rest.find(separator_);
    fields_.push_back(trimmed(rest.substr(0, at)));
    if (at == std::string_view::npos) break;
    rest.remove_prefix(at + 1);
  }
}

bool LvmReader::next_filled() {
  while (next()) {
    split();
    if (!is_blank()) return true;
  }
  return false;
}

double LvmReader::number(std::string_view text, std::size_t column) {
  number_.assign(text);
  if (comma_) std::replace(number_.begin(), number_.end(), ',', '.');
  const ParsedNumber parsed = parse_number(number_);
  MODCAL_REQUIRE(parsed.kind == NumberKind::kNumber || parsed.kind == NumberKind::kNotFinite,
                 "{}: field {}: {}", here(), column + 1, describe_bad_number(parsed.kind, text));
  return parsed.value;
}

void LvmReader::read_file_header() {
  MODCAL_REQUIRE(next(), "{}: byte 0: it has no line", file_.name());
  MODCAL_REQUIRE(line_.starts_with("LabVIEW Measurement"),
                 "{}:1: a LabVIEW measurement file begins with \"LabVIEW Measurement\"; state "
                 "another format (csv, for numbers without a header)",
                 file_.name());
  constexpr std::size_t kName = std::string_view("LabVIEW Measurement").size();
  if (line_.size() > kName && line_[kName] != '\t') separator_ = line_[kName];
  for (;;) {
    MODCAL_REQUIRE(next(), "{}: byte {}: the file ends within its header; it was cut off",
                   file_.name(), file_.size());
    // The separator stands behind its name.
    if (line_.starts_with("Separator") && line_.size() > 9) separator_ = line_[9];
    split();
    if (begins_with(kEnd)) return;
    if (begins_with("Decimal_Separator")) comma_ = line_.size() > 18 && line_[18] == ',';
    if (begins_with("X_Columns")) {
      multi_ = field(1) == "Multi";
      has_x_ = field(1) != "No";
    }
  }
}

void LvmReader::skip_special() {
  const std::string begin = here();
  do {
    MODCAL_REQUIRE(next(), "{}: a special header has no end up to byte {}; the file was cut off",
                   begin, file_.size());
  } while (!line_.starts_with("***End_Special***"));
}

void LvmReader::take_tag(LvmSegment& segment) {
  const auto each = [&](auto set) {
    for (std::size_t i = 0; i < segment.channels.size(); ++i) {
      const std::string_view text = field(column(i));
      if (!text.empty()) set(segment.channels[i], text, column(i));
    }
  };
  if (begins_with("Notes") && field(1).starts_with(kLvmRate)) {
    segment.stated_rate = parse_number(field(1).substr(kLvmRate.size())).value;
  } else if (begins_with("Channels")) {
    const double count = number(field(1), 1);
    MODCAL_REQUIRE(count >= 1.0 && count <= kMostChannels && count == std::floor(count),
                   "{}: field 2: {} channels cannot be read, 1 to {} can", here(), field(1),
                   kMostChannels);
    segment.channels.resize(static_cast<std::size_t>(count));
    dates_.assign(segment.channels.size(), {});
    times_ = dates_;
  } else if (begins_with("Samples")) {
    each([this](LvmChannel& channel, std::string_view text, std::size_t at) {
      const double count = number(text, at);
      MODCAL_REQUIRE(count >= 0.0 && count < 1e15, "{}: field {}: {} samples are announced", here(),
                     at + 1, text);
      channel.announced = static_cast<std::size_t>(count);
    });
  } else if (begins_with("Date") || begins_with("Time")) {
    std::vector<std::string>& texts = begins_with("Date") ? dates_ : times_;
    for (std::size_t i = 0; i < texts.size(); ++i) texts[i] = field(column(i));
  } else if (begins_with("Y_Unit_Label")) {
    each([](LvmChannel& channel, std::string_view text, std::size_t) {
      channel.unit = utf8_or_latin1(text);
    });
  } else if (begins_with("X_Dimension")) {
    each([](LvmChannel& channel, std::string_view text, std::size_t) {
      channel.in_time = text == "Time";
    });
  } else if (begins_with("X0")) {
    each([this](LvmChannel& channel, std::string_view text, std::size_t at) {
      channel.origin = number(text, at);
    });
  } else if (begins_with("Delta_X")) {
    each([this](LvmChannel& channel, std::string_view text, std::size_t at) {
      channel.step = number(text, at);
      channel.step_text = number_;
    });
  }
}

// Date and time as seconds since 1970, without a time zone; NaN where they are written otherwise.
void LvmReader::give_starts(LvmSegment& segment) const {
  for (std::size_t i = 0; i < segment.channels.size(); ++i) {
    int year = 0, hour = 0, minute = 0;
    unsigned month = 0, day = 0;
    double second = 0.0;
    std::string time = times_[i];
    std::replace(time.begin(), time.end(), ',', '.');
    if (std::sscanf(dates_[i].c_str(), "%d/%u/%u", &year, &month, &day) != 3 ||
        std::sscanf(time.c_str(), "%d:%d:%lf", &hour, &minute, &second) != 3) {
      continue;
    }
    const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month),
                                           std::chrono::day(day)};
    if (!date.ok()) continue;
    const auto days = std::chrono::sys_days(date).time_since_epoch().count();
    segment.channels[i].start =
        86400.0 * static_cast<double>(days) + 3600.0 * hour + 60.0 * minute + second;
  }
}

void LvmReader::read_segment_header(LvmSegment& segment) {
  segment.line = file_.place().line - 1;
  while (!begins_with(kEnd)) {
    if (line_.starts_with("***Start_Special***")) {
      skip_special();
    } else {
      take_tag(segment);
    }
    MODCAL_REQUIRE(next(),
                   "{}:{}: byte {}: the file ends within the header of a segment; it was "
                   "cut off",
                   file_.name(), segment.line, file_.size());
    split();
  }
  MODCAL_REQUIRE(!segment.channels.empty(), "{}:{}: the header of a segment states no Channels",
                 file_.name(), segment.line);
  give_starts(segment);
}

void LvmReader::read_names(LvmSegment& segment) {
  MODCAL_REQUIRE(next(), "{}: byte {}: the names of the channels are expected; it was cut off",
                 file_.name(), file_.size());
  split();
  for (std::size_t i = 0; i < segment.channels.size(); ++i) {
    MODCAL_REQUIRE(column(i) < fields_.size(), "{}: {} names for {} channels", here(), i,
                   segment.channels.size());
    segment.channels[i].name = utf8_or_latin1(fields_[column(i)]);
  }
}

}  // namespace modcal
