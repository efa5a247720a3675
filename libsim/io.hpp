// Records in files: CSV, WAV and the other audio formats of libsndfile.
#pragma once

#include "libsim/records/csv_reader.hpp"
#include "libsim/records/csv_writer.hpp"
#include "libsim/records/recorded_signals.hpp"
#include "libsim/records/wav_reader.hpp"
#include "libsim/records/wav_writer.hpp"
