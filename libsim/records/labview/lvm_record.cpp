#include <cmath>
#include <map>
#include <memory>

#include "libsim/base/error.hpp"
#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/labview/lvm_file.hpp"
#include "libsim/records/labview/lvm_segments.hpp"
#include "libsim/records/quantities.hpp"
#include "libsim/records/stored_channels.hpp"

namespace modcal {
namespace {

double begin_of(const LvmChannel& channel) { return channel.start + channel.origin; }

// The next one goes on where this one ends.
bool goes_on(const LvmChannel& before, const LvmChannel& after) {
  if (before.name != after.name || before.unit != after.unit || before.step != after.step) {
    return false;
  }
  const double end = begin_of(before) + before.step * static_cast<double>(before.samples.size());
  // What is printed in seconds since midnight has more digits than half a sample.
  return std::abs(begin_of(after) - end) < 0.5 * before.step;
}

bool goes_on(const LvmSegment& before, const LvmSegment& after) {
  if (before.channels.size() != after.channels.size()) return false;
  for (std::size_t i = 0; i < before.channels.size(); ++i) {
    if (!goes_on(before.channels[i], after.channels[i])) return false;
  }
  return true;
}

// Appends to what a record has; instants count from its start.
void append(const LvmSegment& segment, double start, LvmSegment& record) {
  for (std::size_t i = 0; i < record.channels.size(); ++i) {
    LvmChannel& to = record.channels[i];
    const LvmChannel& from = segment.channels[i];
    to.samples.insert(to.samples.end(), from.samples.begin(), from.samples.end());
    const double offset = from.start - start;
    for (const double instant : from.instants) to.instants.push_back(offset + instant);
  }
  record.rows += segment.rows;
}

// Segments that follow each other without a gap are one.
std::vector<LvmSegment> joined(std::vector<LvmSegment> segments) {
  std::vector<LvmSegment> records;
  const LvmSegment* before = nullptr;
  double start = 0.0;
  for (LvmSegment& segment : segments) {
    if (before != nullptr && goes_on(*before, segment)) {
      append(segment, start, records.back());
    } else {
      start = segment.channels.front().start;
      records.push_back(segment);
    }
    before = &segment;
  }
  return records;
}

// Of the first sample, after the date of the file [s]; a sum with a date has no room for the digits
// of X0.
double start_of(const LvmChannel& channel, double date) {
  if (std::isnan(channel.start)) return channel.origin;
  return channel.origin + (std::isnan(date) ? channel.start : channel.start - date);
}

StoredChannel stored(const std::shared_ptr<LvmChannel>& channel, const LvmSegment& segment,
                     double date, const std::string& file) {
  StoredChannel result;
  result.head.name = channel->name;
  result.head.unit = channel->unit;
  if (const Quantity* const quantity = quantity_of_unit(channel->unit)) {
    result.head.kind = quantity->kind;
  }
  result.place = fmt::format("{}: segment at line {}", file, segment.line);
  result.size = segment.is_estimated ? segment.rows : channel->samples.size();
  if (!channel->in_time) result.other_than_time = "function of no time";
  if (channel->has_gaps) result.other_than_time = "record with gaps";
  if (channel->is_miscounted) {
    result.other_than_time =
        fmt::format("channel of {} samples, of which the line Samples announces {}: correct it",
                    channel->samples.size(), channel->announced);
  }
  if (result.size == 0) result.other_than_time = "channel without samples";
  if (!result.other_than_time.empty()) return result;
  if (channel->step > 0.0) {
    const PrintedRate rate = rate_of_printed_period(channel->step_text, channel->step, "Delta_X");
    result.sample_rate = rate.hertz;
    result.rate_doubt = rate.doubt;
    result.rate_rounding = rate.rounding;
    result.period = channel->step;
    result.rate_source = fmt::format("Delta_X {:g} s", channel->step);
    result.start = start_of(*channel, date);
  }
  result.read = [channel] { return channel->samples; };
  // Instants that are printed more coarsely than the step tell less than it.
  if (channel->instants.size() > 1 && channel->instant_resolution < 0.25 * channel->step) {
    result.read_times = [channel] { return channel->instants; };
    result.time_resolution =
        channel->instant_resolution / std::max(std::abs(channel->instants.back()), channel->step);
  }
  return result;
}

// A file that modcal wrote has the rate to its last digit, which Delta_X bears out as far as it was
// printed.
void set_exact_rate(double stated, const LvmChannel& channel, StoredChannel& result) {
  PrintedDigits digits;
  digits.add(channel.step_text);
  const double off = std::abs(1.0 / stated - channel.step);
  if (!(off <= 0.5 * digits.resolution(channel.step) + 1e-12 * channel.step)) return;
  result.sample_rate = stated;
  result.rate_doubt.clear();
  result.rate_rounding = 0.0;
}

}  // namespace

Recording read_lvm(const std::filesystem::path& path, const ReadOptions& options) {
  std::vector<LvmSegment> segments = read_lvm_segments(path, options.headers_only);
  std::vector<StoredChannel> channels;
  bool is_estimated = false;
  const double stated = segments.front().stated_rate;
  const double date = segments.front().channels.front().start;
  for (const LvmSegment& segment : joined(std::move(segments))) {
    is_estimated = is_estimated || segment.is_estimated;
    for (const LvmChannel& channel : segment.channels) {
      channels.push_back(
          stored(std::make_shared<LvmChannel>(channel), segment, date, path.string()));
      if (std::isfinite(stated)) set_exact_rate(stated, channel, channels.back());
    }
  }
  const std::size_t count = channels.size();
  Recording recording =
      assemble(fmt::format("LabVIEW measurement file, {} channel{}", count, count == 1 ? "" : "s"),
               std::move(channels), options, path.string());
  if (is_estimated) {
    recording.warnings.push_back(path.string() + std::string(kEstimatedLength));
  }
  return recording;
}

}  // namespace modcal
