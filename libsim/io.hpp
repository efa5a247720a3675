// Records in files: CSV, WAV and the other audio formats of libsndfile.
#pragma once

#include "libsim/records/record_file.hpp"
#include "libsim/records/recording.hpp"
