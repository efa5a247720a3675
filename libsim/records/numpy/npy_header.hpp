// The header of an array in NumPy's format (NEP 1): what stands behind it, and where.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace modcal {

/// One kind of value: 'f' float, 'i' integer, 'u' unsigned, 'b' bool, 'c' complex, 'U' UTF-32 text,
/// 'S' bytes, 'O' an object, 'V' anything else.
struct NpyType {
  char kind = 'V';
  std::size_t size = 0;  ///< bytes
  bool is_swapped = false;
};

struct NpyField {
  std::string name;  ///< empty: the array has no fields
  NpyType type;
  std::size_t offset = 0;  ///< in an item
};

struct NpyHeader {
  std::vector<NpyField> fields;
  std::size_t item_size = 0;  ///< bytes
  bool is_fortran = false;
  std::vector<std::size_t> shape;
  std::size_t data_begin = 0;  ///< byte

  /// Throws InvalidInput where that is no number of bytes.
  std::uint64_t count(const std::string& place) const;
};

/// Takes as many bytes as asked for from what follows. Throws InvalidInput where there are fewer.
using NpyBytes = std::function<void(char* bytes, std::size_t size)>;

/// `place` opens messages. Throws InvalidInput with the byte for what is no such header.
NpyHeader read_npy_header(const NpyBytes& bytes, const std::string& place);

/// The header of items of a type, both as Python writes them: "'<f8'" and "(3,)".
std::string npy_header_text(const std::string& type, std::string_view shape);

}  // namespace modcal
