#include "experiments/runs/results_database.hpp"

#include <sqlite3.h>

#include <optional>

#include "experiments/runs/journal.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// "name" quoted as SQL wants an identifier.
std::string identifier(const std::string& name) {
  std::string quoted = "\"";
  for (const char letter : name) {
    quoted += letter;
    if (letter == '"') quoted += letter;
  }
  return quoted + "\"";
}

// Lengths before texts: no two lists give one line of bytes.
std::string framed(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += fmt::format("{}:{}", part.size(), part);
  return text;
}

class Database {
 public:
  explicit Database(const std::filesystem::path& file) : file_(file) {
    sqlite3* handle = nullptr;
    const int code = sqlite3_open(file.c_str(), &handle);
    handle_.reset(handle);
    check(code);
  }
  void execute(const std::string& sql) {
    check(sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr));
  }
  void check(int code) const {
    MODCAL_REQUIRE(code == SQLITE_OK || code == SQLITE_DONE || code == SQLITE_ROW,
                   "{}: the database cannot be written: {}", file_.string(),
                   sqlite3_errmsg(handle_.get()));
  }
  sqlite3* handle() const { return handle_.get(); }

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close(handle); }
  };
  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> handle_;
};

class Insert {
 public:
  Insert(Database& database, const std::string& table, std::size_t columns) : database_(database) {
    std::string sql = "INSERT INTO " + table + " VALUES (?";
    for (std::size_t i = 1; i < columns; ++i) sql += ",?";
    sqlite3_stmt* statement = nullptr;
    database_.check(
        sqlite3_prepare_v2(database.handle(), (sql + ")").c_str(), -1, &statement, nullptr));
    statement_.reset(statement);
  }
  Insert& number(std::uint64_t value) {
    return bound(
        sqlite3_bind_int64(statement_.get(), ++column_, static_cast<sqlite3_int64>(value)));
  }
  Insert& real(double value) {
    return bound(sqlite3_bind_double(statement_.get(), ++column_, value));
  }
  Insert& text(const std::string& value) {
    return bound(sqlite3_bind_text64(statement_.get(), ++column_, value.data(), value.size(),
                                     SQLITE_STATIC, SQLITE_UTF8));
  }
  Insert& text_or_null(const std::string& value) {
    return value.empty() ? bound(sqlite3_bind_null(statement_.get(), ++column_)) : text(value);
  }
  void end_row() {
    database_.check(sqlite3_step(statement_.get()));
    database_.check(sqlite3_reset(statement_.get()));
    column_ = 0;
  }

 private:
  Insert& bound(int code) {
    database_.check(code);
    return *this;
  }
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  int column_ = 0;
};

}  // namespace

class ResultsDatabase::Writer {
 public:
  Writer(const std::filesystem::path& file, const std::vector<std::string>& axes)
      : database_(file) {
    // Not shared, and thrown away where it is not finished: no journal of its own is needed.
    database_.execute("PRAGMA journal_mode=OFF");
    database_.execute("PRAGMA synchronous=OFF");
    database_.execute("BEGIN");
    std::string columns;
    for (const std::string& axis : axes) columns += identifier(axis) + " TEXT, ";
    database_.execute("CREATE TABLE tasks (task INTEGER PRIMARY KEY, " + columns +
                      "failure TEXT, outcome TEXT)");
    database_.execute("CREATE TABLE timing (task INTEGER PRIMARY KEY, seconds REAL)");
    database_.execute("CREATE TABLE run (name TEXT PRIMARY KEY, value TEXT)");
    task_.emplace(database_, "tasks", axes.size() + 3);
    timing_.emplace(database_, "timing", 2);
  }
  void add(const ResultRow& row) {
    task_->number(row.task);
    for (const std::string& value : row.axis_values) task_->text(value);
    task_->text_or_null(row.failure).text(row.outcome).end_row();
    timing_->number(row.task).real(row.seconds).end_row();
  }
  void finish(const std::vector<std::pair<std::string, std::string>>& facts) {
    task_.reset();
    timing_.reset();
    {
      Insert fact(database_, "run", 2);
      for (const auto& [name, value] : facts) fact.text(name).text(value).end_row();
    }
    database_.execute("COMMIT");
  }

 private:
  Database database_;
  std::optional<Insert> task_, timing_;
};

RowsDigest::RowsDigest(const std::vector<std::string>& axes) : digest_(digest_of(framed(axes))) {}

void RowsDigest::add(const ResultRow& row) {
  digest_ = digest_of(fmt::format("{}\n{}:{}{}", digest_, row.task, framed(row.axis_values),
                                  framed({row.failure, row.outcome})));
}

ResultsDatabase::ResultsDatabase(const std::filesystem::path& file,
                                 const std::vector<std::string>& axes)
    : part_(file), digest_(axes), writer_(std::make_unique<Writer>(part_.path(), axes)) {
  remove_abandoned_parts(file.parent_path());
}

ResultsDatabase::~ResultsDatabase() = default;

void ResultsDatabase::add(const ResultRow& row) {
  digest_.add(row);
  writer_->add(row);
}

std::string ResultsDatabase::finish(std::vector<std::pair<std::string, std::string>> facts) {
  std::string digest = digest_.text();
  facts.emplace_back("digest", digest);
  writer_->finish(facts);
  writer_.reset();
  part_.put_in_place();
  return digest;
}

}  // namespace modcal
