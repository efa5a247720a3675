// The variables of a MAT file, as far as they are numbers and texts.
#pragma once

#include <fmt/ranges.h>
#include <matio.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace modcal {

/// A variable or a field of one, with the names that lead to it.
struct MatlabLeaf {
  std::vector<std::string> path;
  std::vector<std::size_t> fields;  // places of the fields below the variable
  matio_classes type = MAT_C_EMPTY;
  bool is_complex = false;
  std::vector<std::size_t> dims;

  /// Whether it has numbers, complex or not.
  bool has_numbers() const;
  bool is_real() const { return has_numbers() && !is_complex; }
  std::size_t size() const {
    std::size_t product = 1;
    for (const std::size_t dim : dims) product *= dim;
    return product;
  }
  bool is_table() const { return dims.size() == 2 && size() > 1; }
  std::size_t rows() const { return std::max(dims[0], dims[1]); }
  std::size_t columns() const { return std::min(dims[0], dims[1]); }
  std::string text() const;
};

/// Read once each and kept as long as a channel may be asked for; from any thread.
class MatlabContent {
 public:
  /// Throws InvalidInput for what is no whole MAT file.
  explicit MatlabContent(std::filesystem::path path);
  const std::vector<MatlabLeaf>& leaves() const { return leaves_; }

  // Throw InvalidInput where the variable is not what its header says.
  std::vector<double> column(const MatlabLeaf& leaf, std::size_t j);
  double number(const MatlabLeaf& leaf);
  std::string text(const MatlabLeaf& leaf);

 private:
  using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;
  const matvar_t& field(const MatlabLeaf& leaf);
  std::filesystem::path path_;
  std::vector<MatlabLeaf> leaves_;
  std::map<std::string, Variable> read_;
};

}  // namespace modcal
