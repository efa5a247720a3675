// Records in files: CSV, WAV and the other audio formats of libsndfile.
#pragma once

#include "libsim/records/csv.hpp"
#include "libsim/records/recording.hpp"
#include "libsim/records/wav.hpp"
