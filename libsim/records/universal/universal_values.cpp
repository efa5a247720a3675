#include <bit>
#include <charconv>
#include <cstring>

#include "libsim/base/error.hpp"
#include "libsim/records/universal/universal_file.hpp"

namespace modcal {
namespace {

double binary_number(const char* bytes, bool is_double, bool little_endian) {
  std::array<char, 8> copy{};
  const std::size_t size = is_double ? 8 : 4;
  std::memcpy(copy.data(), bytes, size);
  if (little_endian != (std::endian::native == std::endian::little)) {
    std::reverse(copy.begin(), copy.begin() + static_cast<std::ptrdiff_t>(size));
  }
  if (is_double) return std::bit_cast<double>(copy);
  float value = 0.0f;
  std::memcpy(&value, copy.data(), sizeof value);
  return static_cast<double>(value);
}

// The numbers of a block, one after the other.
class BinaryNumbers {
 public:
  BinaryNumbers(LineFile& file, const UniversalFunction& function)
      : function_(function), block_(file.bytes(function.byte_count)) {}
  double next(bool is_abscissa) {
    const bool is_double = function_.is_double && !(is_abscissa && function_.abscissa_is_single);
    const double value = binary_number(block_.data() + at_, is_double, function_.little_endian);
    at_ += is_double ? 8 : 4;
    return value;
  }

 private:
  const UniversalFunction& function_;
  std::string block_;
  std::size_t at_ = 0;
};

// Lines of numbers that may touch each other ("-1.0E+00-2.0E+00"); D is an exponent, too.
class TextNumbers {
 public:
  TextNumbers(LineFile& file, const UniversalFunction& function)
      : file_(file), function_(function) {}

  double next(bool) {
    std::size_t at = line_.find_first_not_of(" \t", at_);
    while (at == std::string::npos) {
      MODCAL_REQUIRE(file_.next(line_), "{}: the file ends within the values", where());
      std::replace(line_.begin(), line_.end(), 'D', 'E');
      std::replace(line_.begin(), line_.end(), 'd', 'e');
      at = line_.find_first_not_of(" \t");
    }
    if (line_[at] == '+') ++at;
    double value = 0.0;
    const char* const begin = line_.data() + at;
    const auto [end, error] = std::from_chars(begin, line_.data() + line_.size(), value);
    MODCAL_REQUIRE(error == std::errc(), "{}: column {}: a number is expected", where(), at + 1);
    at_ = static_cast<std::size_t>(end - line_.data());
    const bool is_last = line_.find_first_not_of(" \t", 0) == at && at_ == line_.size();
    MODCAL_REQUIRE(!(is_last && std::string_view(begin, end) == "-1"),
                   "{}: the values end before the {} announced", where(), function_.size);
    return value;
  }
  void finish() {
    std::string rest = line_.substr(std::min(at_, line_.size()));
    while (rest.find_first_not_of(" \t") == std::string::npos && file_.next(rest)) {
    }
    const std::size_t at = rest.find_first_not_of(" \t");
    MODCAL_REQUIRE(at != std::string::npos && rest.substr(at, 2) == "-1" &&
                       rest.find_first_not_of(" \t", at + 2) == std::string::npos,
                   "{}: more values than the {} announced", where(), function_.size);
  }

 private:
  std::string where() const {
    return fmt::format("{}:{}: dataset 58 at line {}", file_.name(), file_.place().line - 1,
                       function_.header.line);
  }
  LineFile& file_;
  const UniversalFunction& function_;
  std::string line_;
  std::size_t at_ = 0;
};

template <typename Numbers>
UniversalValues values_of(Numbers& numbers, const UniversalFunction& function,
                          const StopToken& stop) {
  UniversalValues result;
  for (std::uint64_t i = 0; i < function.size; ++i) {
    stop.throw_if_requested();
    if (!function.is_even) result.abscissa.push_back(numbers.next(true));
    const double real = numbers.next(false);
    result.values.emplace_back(real, function.is_complex ? numbers.next(false) : 0.0);
  }
  return result;
}

}  // namespace

UniversalValues read_universal_values(const std::filesystem::path& path,
                                      const UniversalFunction& function, const StopToken& stop) {
  LineFile file(path);
  file.go_to(function.values);
  if (function.binary) {
    BinaryNumbers numbers(file, function);
    return values_of(numbers, function, stop);
  }
  TextNumbers numbers(file, function);
  UniversalValues result = values_of(numbers, function, stop);
  numbers.finish();
  return result;
}

}  // namespace modcal
