#include "libsim/records/labview/lvm_segments.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/records/labview/lvm_reader.hpp"

namespace modcal {
std::vector<LvmSegment> LvmReader::read() {
  read_file_header();
  while (next_filled()) read_segment();
  MODCAL_REQUIRE(!segments_.empty(),
                 "{}: byte {}: no segment stands behind the file's header; "
                 "it was cut off",
                 file_.name(), file_.size());
  return std::move(segments_);
}

// False: the segment has ended.
bool LvmReader::read_row(LvmSegment& segment) {
  if (!next()) return false;
  split();
  if (is_blank()) return false;
  const std::size_t last = column(segment.channels.size() - 1);
  MODCAL_REQUIRE(fields_.size() > last || headers_only_,
                 "{}: {} fields stand for {} columns; it was "
                 "cut off",
                 here(), fields_.size(), last + 1);
  for (std::size_t i = 0; i < segment.channels.size(); ++i) {
    LvmChannel& channel = segment.channels[i];
    const std::string_view value = field(column(i)), x = field(x_column(i));
    if (value.empty()) continue;
    channel.samples.push_back(number(value, column(i)));
    if (!has_x_) continue;
    channel.instants.push_back(number(x, x_column(i)));
    digits_[i].add(number_);
  }
  ++segment.rows;
  return true;
}

void LvmReader::estimate_rows(LvmSegment& segment) {
  constexpr std::size_t kTried = 1 << 8;
  const std::uint64_t begin = file_.place().byte, left = file_.left();
  std::size_t rows = 0;
  while (rows < kTried && read_row(segment)) ++rows;
  const std::uint64_t taken = file_.place().byte - begin;
  segment.is_estimated = rows == kTried;
  if (segment.is_estimated) {
    segment.rows = static_cast<std::size_t>(static_cast<double>(left) / static_cast<double>(taken) *
                                            static_cast<double>(rows));
  }
}

void LvmReader::check_counts(const LvmSegment& segment) const {
  for (const LvmChannel& channel : segment.channels) {
    MODCAL_REQUIRE(channel.samples.size() >= channel.announced,
                   "{}: byte {}: {} samples of {} are announced in line {}, {} are there; the file "
                   "was cut off: copy it again, or correct the line Samples",
                   here(), file_.place().byte, channel.announced, channel.name, segment.line,
                   channel.samples.size());
  }
}

void LvmReader::read_segment() {
  LvmSegment segment;
  read_segment_header(segment);
  read_names(segment);
  digits_.assign(segment.channels.size(), {});
  if (headers_only_) {
    estimate_rows(segment);
    segments_.push_back(std::move(segment));
    file_.go_to({file_.size(), file_.place().line});
    return;
  }
  while (read_row(segment)) {
  }
  check_counts(segment);
  const std::size_t announced =
      std::ranges::max(segment.channels, {}, &LvmChannel::announced).announced;
  for (std::size_t i = 0; i < segment.channels.size(); ++i) {
    LvmChannel& channel = segment.channels[i];
    // A slower channel has its share of the rows of every packet.
    channel.has_gaps = channel.samples.size() != segment.rows &&
                       channel.samples.size() != channel.announced &&
                       channel.samples.size() * announced != segment.rows * channel.announced;
    channel.is_miscounted = channel.samples.size() > channel.announced && channel.announced > 0 &&
                            channel.samples.size() * announced > segment.rows * channel.announced;
    if (channel.instants.empty()) continue;
    channel.instant_resolution = digits_[i].resolution(std::abs(channel.instants.back()));
  }
  segments_.push_back(std::move(segment));
}

std::vector<LvmSegment> read_lvm_segments(const std::filesystem::path& path, bool headers_only) {
  return LvmReader(path, headers_only).read();
}

}  // namespace modcal
