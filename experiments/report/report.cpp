#include <algorithm>
#include <cmath>
#include <future>
#include <system_error>

#include "experiments/report/drawing.hpp"
#include "experiments/report/encoding.hpp"
#include "experiments/report/html_page.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"

namespace modcal::report {
namespace {

constexpr double kPeak = 0.9;
constexpr double kFade = 5e-3;  // [s]: without it both ends click

// Samples in [−1, 1].
std::vector<double> leveled(const std::vector<double>& samples, double sample_rate) {
  double mean = 0.0;
  for (const double sample : samples) mean += sample / static_cast<double>(samples.size());
  double peak = 0.0;
  for (const double sample : samples) peak = std::max(peak, std::abs(sample - mean));
  // What rounding leaves of a constant is silence.
  const double scale = peak > 1e-12 * std::abs(mean) ? kPeak / peak : 0.0;
  const double fade = std::max(1.0, kFade * sample_rate);
  std::vector<double> result(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto to_end = static_cast<double>(std::min(i, samples.size() - 1 - i));
    result[i] = scale * (samples[i] - mean) * std::min(1.0, to_end / fade);
  }
  return result;
}

class LittleEndian {
 public:
  void text(std::string_view letters) { bytes.insert(bytes.end(), letters.begin(), letters.end()); }
  void number(std::uint32_t value, int size) {
    for (int i = 0; i < size; ++i) bytes.push_back(static_cast<unsigned char>(value >> (8 * i)));
  }
  std::vector<unsigned char> bytes;
};

namespace fs = std::filesystem;

// What gnuplot reads and writes, per figure.
constexpr std::array kDrawnFiles = {".dat", ".gp", ".svg", ".pdf"};

template <typename Item>
std::vector<const Item*> items_of(const Report& report) {
  std::vector<const Item*> items;
  for (const Section& section : report.sections) {
    for (const Block& block : section.blocks) {
      if (const auto* item = std::get_if<Item>(&block)) items.push_back(item);
    }
  }
  return items;
}

void check(const std::vector<const Figure*>& figures, const std::vector<const Table*>& tables,
           const std::vector<const Audio*>& sounds) {
  std::set<std::string> ids;
  const auto check_all = [&ids](const auto& items, auto check_item) {
    for (const auto* item : items) {
      check_item(*item);
      MODCAL_REQUIRE(ids.insert(item->id).second, "two figures or tables are called \"{}\"",
                     item->id);
    }
  };
  check_all(figures, check_figure);
  check_all(tables, check_table);
  check_all(sounds, check_audio);
}

// About what tables and sounds take in the page: 16 bits a sample in base64, elements about a cell.
std::size_t bytes_beside_charts(const std::vector<const Table*>& tables,
                                const std::vector<const Audio*>& sounds) {
  std::size_t bytes = 0;
  for (const Table* table : tables) {
    for (const auto& row : table->rows) {
      for (std::size_t j = 0; j < row.size(); ++j) {
        bytes += 40 + cell_text(row[j], table->columns[j]).size();
      }
    }
  }
  for (const Audio* audio : sounds) {
    for (const Track& track : audio->tracks) bytes += 8 * track.samples.size() / 3;
  }
  return bytes;
}

struct DrawnFigures {
  std::vector<DrawnFigure> figures;
  std::string data;  ///< chart_data_json() of them
};

// Figures thinned to as many pixel columns as a page under 2 MB can hold.
DrawnFigures draw_all(const std::vector<Figure>& figures, std::size_t other_bytes,
                      const std::string& replay) {
  constexpr std::size_t kPage = 1'700'000;     // bytes; 0.2 MB of scripts go beside
  constexpr std::size_t kLeastData = 200'000;  // where a report holds more sound than fits
  const std::size_t largest = other_bytes + kLeastData < kPage ? kPage - other_bytes : kLeastData;
  DrawnFigures drawn;
  for (const std::size_t columns : {1000u, 500u, 250u, 120u, 60u, 30u, 15u}) {
    drawn.figures.clear();
    for (const Figure& figure : figures) drawn.figures.push_back(draw_figure(figure, columns));
    drawn.data = chart_data_json(drawn.figures, replay);
    if (drawn.data.size() <= largest) break;
  }
  return drawn;
}

// Remembers what has been written, by its name relative to the report's folder.
class ReportFolder {
 public:
  ReportFolder(fs::path root, bool has_figures) : root_(std::move(root)) {
    std::error_code error;
    fs::create_directories(root_, error);
    MODCAL_REQUIRE(!error, "the folder {} cannot be made: {}", root_.string(), error.message());
    if (has_figures) make_own_folder(figures());
  }
  void write(const std::string& name, std::string_view content) {
    write_file_atomically(root_ / name, content);
    names_.push_back(name);
  }
  void note_if_there(const std::string& name) {
    if (fs::exists(root_ / name)) names_.push_back(name);
  }
  fs::path figures() const { return root_ / kFigures; }
  const std::vector<std::string>& names() const { return names_; }
  const fs::path& root() const { return root_; }

  static constexpr const char* kFigures = "figures";

 private:
  fs::path root_;
  std::vector<std::string> names_;
};

// Files of an earlier report must not be taken for those of this one.
void remove_drawn_files(const std::vector<DrawnFigure>& figures, const fs::path& directory) {
  for (const DrawnFigure& figure : figures) {
    for (const char* extension : kDrawnFiles) {
      const fs::path file = directory / (figure.source->id + extension);
      std::error_code error;
      fs::remove(file, error);
      MODCAL_REQUIRE(!error, "{} cannot be replaced: {}", file.string(), error.message());
    }
  }
}

void write_tables(const std::vector<const Table*>& tables, ReportFolder& folder) {
  for (const Table* table : tables) {
    folder.write(table->id + ".csv", table_csv(*table));
    folder.write(table->id + ".json", table_json(*table));
  }
}

std::string figure_file(const std::string& id, const char* extension) {
  return std::string(ReportFolder::kFigures) + "/" + id + extension;
}

}  // namespace

void check_audio(const Audio& audio) {
  MODCAL_REQUIRE(is_file_stem(audio.id),
                 "\"{}\" cannot name a place in the page; use letters, digits, - and _", audio.id);
  const double rate = audio.sample_rate;
  MODCAL_REQUIRE(rate == std::round(rate) && rate >= 1000.0 && rate <= 192000.0,
                 "audio \"{}\": {} Hz cannot be played; use whole hertz from 1000 to 192000",
                 audio.id, rate);
  for (const Track& track : audio.tracks) {
    MODCAL_REQUIRE(
        !track.samples.empty() && static_cast<double>(track.samples.size()) <= 60.0 * rate,
        "audio \"{}\": track \"{}\" has {} samples; it must last up to 60 s", audio.id, track.label,
        track.samples.size());
    MODCAL_REQUIRE(std::all_of(track.samples.begin(), track.samples.end(),
                               [](double sample) { return std::isfinite(sample); }),
                   "audio \"{}\": track \"{}\" has values that are not finite", audio.id,
                   track.label);
  }
}

std::string wav_data_uri(const std::vector<double>& samples, double sample_rate) {
  const auto rate = static_cast<std::uint32_t>(sample_rate);
  const auto size = static_cast<std::uint32_t>(2 * samples.size());
  LittleEndian wav;
  wav.text("RIFF");
  wav.number(36 + size, 4);
  wav.text("WAVEfmt ");
  wav.number(16, 4);
  wav.number(1, 2);  // PCM
  wav.number(1, 2);  // channel
  wav.number(rate, 4);
  wav.number(2 * rate, 4);
  wav.number(2, 2);
  wav.number(16, 2);
  wav.text("data");
  wav.number(size, 4);
  for (const double sample : leveled(samples, sample_rate)) {
    wav.number(static_cast<std::uint32_t>(std::lround(32767.0 * sample)), 2);
  }
  return "data:audio/wav;base64," + base64(wav.bytes);
}

std::vector<std::string> file_names(const Report& report) {
  std::vector<std::string> names = {kPageFile};
  for (const Table* table : items_of<Table>(report)) {
    names.insert(names.end(), {table->id + ".csv", table->id + ".json"});
  }
  for (const Figure* figure : items_of<Figure>(report)) {
    names.push_back(figure_file(figure->id, ".csv"));
    for (const char* extension : kDrawnFiles) names.push_back(figure_file(figure->id, extension));
  }
  return names;
}

WrittenReport write_report(const Report& report, const fs::path& directory,
                           const WriteOptions& options) {
  const auto figures = items_of<Figure>(report);
  const auto tables = items_of<Table>(report);
  const auto sounds = items_of<Audio>(report);
  check(figures, tables, sounds);
  std::vector<Figure> readable;
  for (const Figure* figure : figures) readable.push_back(in_readable_units(*figure));
  const auto [drawn, data] = draw_all(readable, bytes_beside_charts(tables, sounds), report.replay);

  ReportFolder folder(directory, !figures.empty());
  remove_drawn_files(drawn, folder.figures());
  std::future<std::string> drawing;
  if (options.vector_figures) {
    drawing = std::async(std::launch::async, draw_with_gnuplot, std::span(drawn), folder.figures(),
                         options.gnuplot);
  }
  write_tables(tables, folder);
  for (const Figure* figure : figures) {
    folder.write(figure_file(figure->id, ".csv"), figure_csv(*figure));
  }

  PageLinks links;
  links.figures = ReportFolder::kFigures;
  if (drawing.valid()) links.warning = drawing.get();
  for (const Figure* figure : figures) {
    for (const char* extension : kDrawnFiles) {
      folder.note_if_there(figure_file(figure->id, extension));
    }
  }
  links.files = {folder.names().begin(), folder.names().end()};
  folder.write(kPageFile, html_page(report, drawn, data, links));

  WrittenReport written{.page = folder.root() / kPageFile, .files = {}, .warning = links.warning};
  for (const std::string& name : folder.names()) written.files.push_back(folder.root() / name);
  return written;
}

}  // namespace modcal::report
