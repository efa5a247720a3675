// One SQLite file with the results of a run, for whoever wants to ask questions of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libsim/base/files.hpp"

namespace modcal {

/// One row of the table `tasks`.
struct ResultRow {
  std::uint64_t task = 0;
  std::vector<std::string> axis_values;
  std::string failure;  ///< empty: none
  std::string outcome;  ///< JSON
  double seconds = 0.0;
};

/// Digest of rows without their times, one after the other: each is chained to those before.
class RowsDigest {
 public:
  explicit RowsDigest(const std::vector<std::string>& axes);
  void add(const ResultRow& row);
  const std::string& text() const { return digest_; }

 private:
  std::string digest_;
};

/// A database that is written row by row: the rows, in their order, as table `tasks` (task, one
/// column an axis, failure, outcome), the times as table `timing` (task, seconds) and facts as
/// table `run` (name, value). What is held does not grow with the rows; equal rows give an equal
/// table `tasks`, whatever made them. Until finish() it has another name; without finish() nothing
/// of it is left.
class ResultsDatabase {
 public:
  /// Throws InvalidInput, as add() and finish() do, where the file cannot be written.
  ResultsDatabase(const std::filesystem::path& file, const std::vector<std::string>& axes);
  ~ResultsDatabase();
  ResultsDatabase(const ResultsDatabase&) = delete;
  ResultsDatabase& operator=(const ResultsDatabase&) = delete;

  void add(const ResultRow& row);
  /// Writes the facts, puts the file in place and gives the digest of the rows.
  std::string finish(std::vector<std::pair<std::string, std::string>> facts);

 private:
  class Writer;
  PartFile part_;
  RowsDigest digest_;
  std::unique_ptr<Writer> writer_;
};

}  // namespace modcal
