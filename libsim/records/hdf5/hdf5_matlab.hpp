// What MATLAB adds to the datasets of a MAT file of version 7.3.
#pragma once

#include <hdf5.h>

#include <string>
#include <vector>

namespace modcal {

/// The attribute MATLAB_class of an object, however its text was written; empty: it has none.
std::string matlab_class(hid_t object);

/// Whether it stands for an array without values.
bool is_matlab_empty(hid_t object);

/// The texts of a dataset of class char: MATLAB keeps a matrix of UTF-16 units column by column, a
/// text a row. None where it cannot be read.
std::vector<std::string> matlab_letters(hid_t dataset, std::size_t rows);

}  // namespace modcal
