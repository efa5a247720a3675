// The keys that every section `record` has, whatever its channels are.
#pragma once

#include "libsim/base/options.hpp"
#include "libsim/records/formats.hpp"

namespace modcal {

/// The members `file`, `format` and `sample_rate` [Hz].
template <typename Options>
void visit_record_file(OptionVisitor& visitor, Options& options) {
  visitor("file", "recorded file, relative to the folder of the experiment's file",
          {.required = true}, options.file);
  visitor("format", "format of the file; auto: by its extension",
          {.choices = record_format_choices()}, options.format);
  visitor("sample_rate", "sample rate; \"file\": the file states it",
          {.unit = "Hz", .range = Range::positive(), .word = "file"}, options.sample_rate);
}

/// The members `start` and `stop` [s].
template <typename Options>
void visit_record_part(OptionVisitor& visitor, Options& options) {
  visitor("start", "begin of the part that is used, after the first sample",
          {.unit = "s", .range = Range::non_negative()}, options.start);
  visitor("stop", "end of the part that is used, after the first sample",
          {.unit = "s", .range = Range::positive(), .word = "end"}, options.stop);
}

}  // namespace modcal
