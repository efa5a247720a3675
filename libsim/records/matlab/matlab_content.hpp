// The variables of a MAT file, as far as they are numbers and texts.
#pragma once

#include <matio.h>

#include <map>
#include <set>

#include "libsim/records/arrays/array_file.hpp"

namespace modcal {

/// Read once each and kept as long as a channel may be asked for; from any thread.
class MatlabContent final : public ArrayFile {
 public:
  /// Throws InvalidInput for what is no whole MAT file.
  explicit MatlabContent(std::filesystem::path path);

  std::vector<double> column(const NamedArray& array, std::size_t j) override;
  std::vector<std::string> texts(const NamedArray& array) override;

  /// Whether libmatio has told what each variable of numbers is. It passes over those of
  /// version 7.3 whose class stands there in another form than MATLAB's, as h5py writes it.
  bool is_complete() const { return is_complete_; }

 private:
  using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;
  /// What an array is in the file.
  struct Leaf {
    std::vector<std::size_t> fields;  // places of the fields below the variable
    matio_classes type = MAT_C_EMPTY;
  };
  void add_arrays(matvar_t* variable, std::vector<std::string> path, Leaf at);
  void read_heads();
  bool passes_over_numbers(const std::set<std::string>& variables) const;
  const matvar_t& field(const NamedArray& array);

  std::filesystem::path path_;
  bool is_complete_ = true;
  std::vector<Leaf> leaves_;
  std::map<std::string, Variable> read_;
};

}  // namespace modcal
