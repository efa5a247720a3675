// Arrays in NumPy's format, wherever their bytes are.
#pragma once

#include "libsim/records/arrays/array_file.hpp"
#include "libsim/records/numpy/npy_header.hpp"

namespace modcal {

class NpyArrays : public ArrayFile {
 public:
  /// An array of `size` bytes with its header; `open` reads them from the first on. Throws
  /// InvalidInput for another number of bytes than the header states.
  void add(const std::vector<std::string>& name, const std::string& place, std::uint64_t size,
           const std::function<NpyBytes()>& open);

  std::vector<double> column(const NamedArray& array, std::size_t j) override;
  std::vector<std::string> texts(const NamedArray& array) override;

 private:
  struct Stored {
    std::string place;
    NpyHeader header;
    NpyField field;
    std::function<NpyBytes()> open;
  };
  std::vector<Stored> stored_;
};

}  // namespace modcal
