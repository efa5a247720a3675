// Complex numbers of HDF5 files, which has no type of its own for them.
#pragma once

#include "libsim/records/hdf5/hdf5_content.hpp"

namespace modcal {

/// A pair of r and i, as NumPy has it, or of other words for them: any other pair is no number.
bool is_complex(hid_t type);

/// Two doubles, r and i.
Hdf5Id complex_as_numpy();

/// Two doubles by the names of the stored pair.
Hdf5Id complex_in_memory(hid_t stored);

}  // namespace modcal
