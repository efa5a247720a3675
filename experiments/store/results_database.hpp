// One SQLite file with the results of a run, for whoever wants to ask questions of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace modcal {

/// One row of the table `tasks`.
struct ResultRow {
  std::uint64_t task = 0;
  std::vector<std::string> axis_values;
  std::string failure;  ///< empty: none
  std::string outcome;  ///< JSON
  double seconds = 0.0;
};

/// Writes the rows, in their order, as table `tasks` (task, one column an axis, failure, outcome),
/// the times as table `timing` (task, seconds) and the facts as table `run` (name, value). The file
/// is written under another name and put in place when it is complete; equal rows give an equal
/// table `tasks`, whatever made them. Returns the digest of that table. Throws InvalidInput where
/// the file cannot be written.
std::string write_results_database(const std::filesystem::path& file,
                                   const std::vector<std::string>& axes,
                                   const std::vector<ResultRow>& rows,
                                   const std::vector<std::pair<std::string, std::string>>& facts);

/// Digest of the rows without their times.
std::string digest_of_rows(const std::vector<std::string>& axes,
                           const std::vector<ResultRow>& rows);

}  // namespace modcal
