#include "experiments/study/figure_options.hpp"

namespace modcal {

void TimeWindow::visit(OptionVisitor& visitor) {
  visitor.number(
      {.key = "start", .meaning = "first instant", .unit = "s", .range = Range::non_negative()},
      start);
  visitor.number({.key = "stop",
                  .meaning = "last instant",
                  .unit = "s",
                  .range = Range::positive(),
                  .word = "end"},
                 stop);
}

void FigureOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "id", .meaning = "name of the figure's files", .required = true}, id);
  visitor.text({.key = "title", .meaning = "title; empty: that of the experiment"}, title);
  visitor.text(
      {.key = "content",
       .meaning = "what is drawn",
       .choices = {"waveforms", "spectra", "parameter_curves", "objectives", "frequency_errors"}},
      content);
  visitor.texts({.key = "quantities",
                 .meaning = "rows of waveforms and spectra",
                 .choices = {"y", "v", "f_c", "R1", "R2"}},
                quantities);
  ListOf<TimeWindow> list(windows);
  visitor.list({.key = "windows", .meaning = "parts of the record; none: all of it"}, list);
  visitor.integer({.key = "modes",
                   .meaning = "number of modes whose objective is drawn",
                   .range = Range::closed(1, 5000)},
                  modes);
  visitor.number({.key = "lowest_frequency",
                  .meaning = "left end of a spectrum",
                  .unit = "Hz",
                  .range = Range::non_negative()},
                 lowest_frequency);
  visitor.number({.key = "highest_frequency",
                  .meaning = "right end of a spectrum; top_mode: 1.1 times the highest mode",
                  .unit = "Hz",
                  .range = Range::positive(),
                  .word = "top_mode"},
                 highest_frequency);
}

}  // namespace modcal
