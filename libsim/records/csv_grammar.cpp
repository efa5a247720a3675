#include "libsim/records/csv_grammar.hpp"

#include <csv.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>

#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"
#include "libsim/base/words.hpp"

namespace modcal {
namespace {

constexpr char kQuote = '"';
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::ifstream open_text(const std::filesystem::path& path) {
  const std::string name = path.string();
  require_regular_file(path);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  MODCAL_REQUIRE(file.is_open(), "{}: cannot be opened: {}; check the path and its permissions",
                 name, std::strerror(errno));
  return file;
}

/// Looks at the beginning only: a record in another encoding shows there.
char find_newline(std::ifstream& file, const std::string& name) {
  std::string head(1 << 16, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  MODCAL_REQUIRE(!head.empty(), "{}: the file is empty; a record needs a header and samples", name);
  const bool zeros = head.find('\0') != std::string::npos;
  MODCAL_REQUIRE(!zeros && !head.starts_with("\xFF\xFE") && !head.starts_with("\xFE\xFF"),
                 "{}: this is not 8-bit text (a binary file or UTF-16); save it as UTF-8 text, or "
                 "state its format",
                 name);
  file.clear();
  file.seekg(head.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0);
  const bool only_cr = head.find('\n') == std::string::npos && head.find('\r') != std::string::npos;
  return only_cr ? '\r' : '\n';
}

/// Calls visit(position) for every character outside of quotes until it returns false.
template <typename Visit>
void visit_unquoted(std::string_view line, Visit visit) {
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == kQuote) quoted = !quoted;
    if (!quoted && !visit(i)) return;
  }
}

// "sep=;" in the first line, as Excel has it.
constexpr std::string_view kSeparator = "sep=";
bool states_separator(std::string_view line) {
  return line.size() == kSeparator.size() + 2 &&
         lower_case(std::string(line)).starts_with(kSeparator);
}

char find_separator(std::string_view header) {
  for (const char candidate : {'\t', ';'}) {
    bool found = false;
    visit_unquoted(header, [&](std::size_t i) { return !(found = header[i] == candidate); });
    if (found) return candidate;
  }
  return ',';
}

}  // namespace

/// libcsv's parser. Its callbacks run inside C code, which an exception must not cross.
class CsvFile::Parser {
 public:
  explicit Parser(CsvHandler& handler) : handler_(handler) {
    if (csv_init(&parser_, CSV_STRICT) != 0) throw std::bad_alloc();
  }
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;
  ~Parser() { csv_free(&parser_); }

  void set_separator(char separator) {
    csv_set_delim(&parser_, static_cast<unsigned char>(separator));
  }
  /// One line with its end. False where a quote is misplaced.
  bool parse(std::string_view line) {
    row_ended_ = false;
    const std::size_t done =
        csv_parse(&parser_, line.data(), line.size(), &on_field, &on_row, this);
    if (exception_) std::rethrow_exception(std::exchange(exception_, nullptr));
    return done == line.size();
  }
  bool row_ended() const { return row_ended_; }

 private:
  template <typename Call>
  void guard(Call call) noexcept {
    if (exception_) return;
    try {
      call();
    } catch (...) {
      exception_ = std::current_exception();
    }
  }
  static void on_field(void* text, std::size_t size, void* self) {
    auto& parser = *static_cast<Parser*>(self);
    parser.guard([&] {
      parser.handler_.field(parser.fields_++, {static_cast<const char*>(text), size});
    });
  }
  static void on_row(int /*end*/, void* self) {
    auto& parser = *static_cast<Parser*>(self);
    parser.row_ended_ = true;
    parser.guard([&] { parser.handler_.end_row(std::exchange(parser.fields_, 0)); });
  }

  CsvHandler& handler_;
  csv_parser parser_{};
  std::size_t fields_ = 0;
  bool row_ended_ = false;
  std::exception_ptr exception_;
};

CsvFile::CsvFile(const std::filesystem::path& path)
    : name_(path.string()), file_(open_text(path)), newline_(find_newline(file_, name_)) {}

bool CsvFile::next_line() {
  if (!std::getline(file_, text_, newline_)) {
    MODCAL_REQUIRE(!file_.bad(), "{}:{}: reading stopped: {}", name_, line_, std::strerror(errno));
    return false;
  }
  ++line_;
  taken_ += text_.size() + 1;
  if (!text_.empty() && text_.back() == '\r') text_.pop_back();
  text_.push_back('\n');
  return true;
}

void CsvFile::parse(CsvHandler& handler, std::uint64_t most) {
  Parser parser(handler);
  std::size_t open_quote_line = 0;
  while (taken_ < most && next_line()) {
    const std::size_t first = text_.find_first_not_of(" \t\n");
    if (line_ == 1 && states_separator(text_)) {
      parser.set_separator(separator_ = text_[kSeparator.size()]);
      continue;
    }
    if (open_quote_line == 0) {
      if (first == std::string::npos) continue;
      if (text_[first] == '#' || text_[first] == '%') {
        handler.comment(std::string_view(text_).substr(first + 1, text_.size() - first - 2));
        continue;
      }
    }
    if (separator_ == 0) parser.set_separator(separator_ = find_separator(text_));
    MODCAL_REQUIRE(parser.parse(text_),
                   "{}:{}: a quote stands inside a field; a field with quotes is written "
                   "\"a \"\"quoted\"\" word\"",
                   name_, line_);
    if (parser.row_ended()) {
      open_quote_line = 0;
    } else if (open_quote_line == 0) {
      open_quote_line = line_;
    }
  }
  MODCAL_REQUIRE(open_quote_line == 0 || taken_ >= most,
                 "{}:{}: the quote opened on this line is never closed; add the missing \"", name_,
                 open_quote_line);
}

std::string CsvFile::separator_name() const {
  return separator_ == '\t' ? "tabs" : fmt::format("'{}'", separator_);
}

std::string CsvFile::place(std::size_t index) const {
  std::size_t column = 0;
  visit_unquoted(text_, [&](std::size_t i) {
    if (index > 0 && text_[i] == separator_ && --index == 0) column = i + 1;
    return index > 0;
  });
  column = std::min(text_.find_first_not_of(' ', column), text_.size() - 1);
  return fmt::format("{}:{}:{}", name_, line_, column + 1);
}

ColumnHeading parse_heading(std::string_view text) {
  text = trimmed(text);
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    const std::size_t start = text.rfind(open);
    if (text.ends_with(close) && start != std::string_view::npos) {
      const std::string_view unit = text.substr(start + 1, text.size() - start - 2);
      return {std::string(trimmed(text.substr(0, start))), std::string(trimmed(unit))};
    }
  }
  return {std::string(text), {}};
}

std::string heading_text(std::string_view name, std::string_view unit) {
  return unit.empty() ? std::string(name) : fmt::format("{} [{}]", name, unit);
}

}  // namespace modcal
