#include "libsim/records/recording.hpp"

namespace modcal {

void RecordedForceOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "channel",
                .meaning = "column or channel of the file, by name or by number from 1",
                .required = true},
               channel);
  visitor.number({.key = "calibration",
                  .meaning = "force per unit of the column (CSV) or per full scale (WAV), negative "
                             "to turn the sign; \"file\": the file states a unit of force",
                  .unit = "N",
                  .word = "file"},
                 calibration);
  visitor.number(
      {.key = "delay", .meaning = "lag behind the other channels; it is shifted back", .unit = "s"},
      delay);
}

void RecordOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "file",
                .meaning = "recorded file, relative to the folder of the experiment's file",
                .required = true},
               file);
  visitor.text({.key = "format",
                .meaning = "format of the file; auto: by its extension",
                .choices = {"auto", "csv", "wav"}},
               format);
  visitor.number({.key = "sample_rate",
                  .meaning = "sample rate; \"file\": the file states it",
                  .unit = "Hz",
                  .range = Range::positive(),
                  .word = "file"},
                 sample_rate);
  const auto force = [&visitor](std::string_view key, std::string_view meaning, bool& present,
                                RecordedForceOptions& options) {
    visitor.optional_group({.key = key, .meaning = meaning}, present,
                           [&options](OptionVisitor& inner) { options.visit(inner); });
  };
  force("left", "reaction at x = 0", has_left, left);
  force("right", "reaction at x = L", has_right, right);
  force("reference", "force at the contact, for scoring only", has_reference, reference);
  visitor.number({.key = "start",
                  .meaning = "begin of the part that is used, after the first sample",
                  .unit = "s",
                  .range = Range::non_negative()},
                 start);
  visitor.number({.key = "stop",
                  .meaning = "end of the part that is used, after the first sample",
                  .unit = "s",
                  .range = Range::positive(),
                  .word = "end"},
                 stop);
}

void ContactOptions::visit(OptionVisitor& visitor) {
  visitor.number({.key = "position",
                  .meaning = "contact point x_c, from the end x = 0",
                  .unit = "m",
                  .range = Range::positive(),
                  .required = true},
                 position);
}

}  // namespace modcal
