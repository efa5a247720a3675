// Files that hold arrays by names, in structures or groups: MAT, NumPy and HDF5 files.
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "libsim/records/stored_channels.hpp"

namespace modcal {

/// An array with the names that lead to it; a number is one of one value.
struct NamedArray {
  enum class Holds { kReal, kComplex, kText, kOther };

  std::vector<std::string> path;
  std::vector<std::size_t> dims;
  Holds holds = Holds::kOther;
  bool is_single = false;   ///< floats of 32 bits
  bool is_integer = false;  ///< stored as whole numbers
  std::string title = {};   ///< in the place of the names, where the file has one
  std::string unit = {};    ///< where the file states one with it
  bool is_note = false;     ///< tells of another array: no channel
  std::size_t place = 0;    ///< for the file alone

  bool has_numbers() const { return holds == Holds::kReal || holds == Holds::kComplex; }
  bool is_real() const { return holds == Holds::kReal; }
  std::size_t size() const {
    std::size_t product = 1;
    for (const std::size_t dim : dims) product *= dim;
    return product;
  }
  /// Vectors have two dimensions, one of them 1.
  bool is_table() const { return dims.size() == 2 && size() > 1; }
  /// Channels are long: the samples are along the larger dimension.
  std::size_t rows() const { return std::max(dims[0], dims[1]); }
  std::size_t columns() const { return std::min(dims[0], dims[1]); }
  bool is_across() const { return dims[0] < dims[1]; }
  /// The title, else the names with dots between them.
  std::string text() const;
};

/// What reads one; a channel may be asked for from any thread.
class ArrayFile {
 public:
  virtual ~ArrayFile() = default;
  const std::vector<NamedArray>& arrays() const { return arrays_; }

  // Throw InvalidInput where the array is not what its header says.
  /// The j-th channel of a table; of a complex one real and imaginary part of each value in turn.
  virtual std::vector<double> column(const NamedArray& array, std::size_t j) = 0;
  virtual std::vector<std::string> texts(const NamedArray& array) = 0;
  /// The first of its texts.
  std::string text(const NamedArray& array) {
    const std::vector<std::string> all = texts(array);
    return all.empty() ? std::string() : all.front();
  }
  /// Its one real value, or that of its text (NaN: it is none), read once: a rate is that of every
  /// channel.
  double number(const NamedArray& array) {
    const std::lock_guard lock(mutex_);
    const auto known = numbers_.find(array.place);
    if (known != numbers_.end()) return known->second;
    return numbers_[array.place] = array.is_real() ? column(array, 0)[0] : number_of_text(array);
  }

 protected:
  std::vector<NamedArray> arrays_;

 private:
  double number_of_text(const NamedArray& array);

  std::mutex mutex_;
  std::map<std::size_t, double> numbers_;  // by place
};

/// The vectors and the columns of tables as channels. The sample rate [Hz] is a number called
/// sample_rate, fs or the like, or one over a number called dt or increment [s], in the same
/// structure or around it, unless a vector called t or time [s] stands nearer; all must agree. The
/// first instant, a number t0 or start_time, or X0 beside the period tells where a channel begins.
/// Units, of rate and time, too, are those of unit_of(); scale_factor and add_offset are applied,
/// and a channel for which they cannot be told is left out. `kind` of file: "MAT file". Throws
/// InvalidInput for a file without vectors, and as assemble() does.
Recording recording_of(const std::shared_ptr<ArrayFile>& content, std::string_view kind,
                       const std::filesystem::path& path, const ReadOptions& options);

/// The columns of complex tables as response functions, those of real ones as coherences. Their
/// lines [Hz] are a vector called f, freq, frequency or the like, or whole multiples from 0 of a
/// number called df, in the same structure or around it; a text `unit` of either counts.
std::vector<StoredChannel> functions_of(const std::shared_ptr<ArrayFile>& content,
                                        const std::filesystem::path& path);

// What an array called so is taken for; letters in either case.
bool is_name_of_time(const std::string& name);
bool is_name_of_lines(const std::string& name);

}  // namespace modcal
