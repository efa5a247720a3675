// The reader of a LabVIEW measurement file: its lines, its headers and its rows.
#pragma once

#include <string>
#include <string_view>

#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/labview/lvm_segments.hpp"

namespace modcal {

/// Goes through a file once.
class LvmReader {
 public:
  LvmReader(const std::filesystem::path& path, bool headers_only)
      : file_(path), headers_only_(headers_only) {}

  std::vector<LvmSegment> read();

 private:
  std::string here() const { return fmt::format("{}:{}", file_.name(), file_.place().line - 1); }
  bool next();
  void split();
  bool is_blank() const {
    return std::ranges::all_of(fields_, [](std::string_view field) { return field.empty(); });
  }
  // Goes to the next line that holds anything.
  bool next_filled();
  bool begins_with(std::string_view tag) const { return fields_[0] == tag; }
  std::string_view field(std::size_t i) const {
    return i < fields_.size() ? fields_[i] : std::string_view();
  }
  // Decimal commas become points.
  double number(std::string_view text, std::size_t column);

  void read_file_header();
  void read_segment();
  void read_segment_header(LvmSegment& segment);
  void take_tag(LvmSegment& segment);
  void read_names(LvmSegment& segment);
  bool read_row(LvmSegment& segment);
  void estimate_rows(LvmSegment& segment);
  void check_counts(const LvmSegment& segment) const;
  void skip_special();
  void give_starts(LvmSegment& segment) const;
  // The column of a channel's values, of its X, and of its entries in a header.
  std::size_t column(std::size_t i) const { return multi_ ? 2 * i + 1 : i + 1; }
  std::size_t x_column(std::size_t i) const { return multi_ ? 2 * i : 0; }

  LineFile file_;
  bool headers_only_ = false;
  std::string line_, number_;
  std::vector<std::string_view> fields_;
  char separator_ = '\t';
  bool comma_ = false, has_x_ = true, multi_ = false;
  std::vector<PrintedDigits> digits_;  // of the instants
  std::vector<std::string> dates_, times_;
  std::vector<LvmSegment> segments_;
};

}  // namespace modcal
