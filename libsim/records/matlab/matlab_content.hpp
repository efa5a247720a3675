// The variables of a MAT file, as far as they are numbers and texts.
#pragma once

#include <matio.h>

#include <map>

#include "libsim/records/arrays/array_file.hpp"

namespace modcal {

/// Read once each and kept as long as a channel may be asked for; from any thread.
class MatlabContent final : public ArrayFile {
 public:
  /// Throws InvalidInput for what is no whole MAT file.
  explicit MatlabContent(std::filesystem::path path);

  std::vector<double> column(const NamedArray& array, std::size_t j) override;
  std::string text(const NamedArray& array) override;

 private:
  using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;
  /// What an array is in the file.
  struct Leaf {
    std::vector<std::size_t> fields;  // places of the fields below the variable
    matio_classes type = MAT_C_EMPTY;
  };
  void add_arrays(matvar_t* variable, std::vector<std::string> path, Leaf at);
  void read_heads();
  const matvar_t& field(const NamedArray& array);

  std::filesystem::path path_;
  std::vector<Leaf> leaves_;
  std::map<std::string, Variable> read_;
};

}  // namespace modcal
