// A report as plain data: what an experiment hands over to be written, with all files beside it.
#pragma once

#include <filesystem>

#include "experiments/report/table.hpp"

namespace modcal::report {

// Signals that the page plays.

struct Track {
  std::string label = {};
  std::vector<double> samples = {};
};

/// Players, one a track; each is scaled to its own peak, so that quiet signals are heard. The files
/// of a report do not have them.
struct Audio {
  std::string id = {};  ///< anchor of its place in the page: [A-Za-z0-9_-]+
  std::string title = {};
  std::string caption = {};
  double sample_rate = 0.0;  ///< of all tracks [Hz]
  std::vector<Track> tracks = {};
};

/// Throws InvalidInput where the rate is not a whole number of hertz from 1000 to 192000, a track
/// is empty or longer than 60 s or has a value that is not finite, or the id cannot be an anchor.
void check_audio(const Audio& audio);

/// "data:audio/wav;base64,…": RIFF WAVE, one channel, 16 bits. The peak is at 0.9 of full scale, a
/// constant part is taken out, both ends fade over 5 ms.
std::string wav_data_uri(const std::vector<double>& samples, double sample_rate);

/// Plain text; an empty line starts a new paragraph, kPreformatted keeps all lines.
struct Text {
  enum class Kind { kParagraph, kNote, kWarning, kFailure, kPreformatted };
  std::string text = {};
  Kind kind = Kind::kParagraph;
};

/// What a section is made of. A new type of block is added here; the compiler then names every
/// writer that has to learn it.
using Block = std::variant<Text, Figure, Table, Audio>;

struct Section {
  std::string title = {};
  std::vector<Block> blocks = {};
  bool folded = false;  ///< closed until a reader opens it; printed whole
};

/// kFailed: nothing succeeded (the page is headed in red); kSomeFailed: part of it did.
enum class Status { kOk, kSomeFailed, kFailed };

/// A line on where the numbers come from: {"commit", "1a2b3c…"}.
struct ProvenanceLine {
  std::string name = {};
  std::string value = {};
};

struct Report {
  std::string title = {};
  std::string description = {};
  Status status = Status::kOk;
  std::string status_text = {};  ///< "40 of 40 tasks done"; empty: the status alone
  std::vector<Section> sections = {};
  std::vector<ProvenanceLine> provenance = {};
  std::string command = {};  ///< what makes the whole report again
  /// Command that replays a task, without the task's number at its end; empty: none.
  std::string replay = {};
};

struct WriteOptions {
  bool vector_figures = true;       ///< SVG and PDF by gnuplot
  std::string gnuplot = "gnuplot";  ///< looked up in PATH
};

struct WrittenReport {
  std::filesystem::path page;
  std::vector<std::filesystem::path> files;  ///< all of them, the page last
  std::string warning;                       ///< why SVG and PDF are missing; empty: they are not
};

inline constexpr const char* kPageFile = "report.html";

/// Names of all files that write_report() may write, relative to its directory.
std::vector<std::string> file_names(const Report& report);

/// Writes into `directory` (made if it is not there) report.html, ID.csv and ID.json of every table
/// and figures/ID.{csv,dat,gp,svg,pdf} of every figure, each of them under a temporary name first.
/// A report without vector figures is complete otherwise and says so. Throws InvalidInput where a
/// figure or table is malformed or two have one id (before anything is written), and where a file
/// cannot be written.
WrittenReport write_report(const Report& report, const std::filesystem::path& directory,
                           const WriteOptions& options = {});

}  // namespace modcal::report
