// The sqlite3 storage of ROS 2 bags: tables `topics` and `messages`.
#include <algorithm>
#include <limits>
#include <map>

#include <sqlite3.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/message_file.hpp"

namespace groundloop::recordings {
namespace fs = std::filesystem;

namespace {

// A time that fits, whatever stands in a broken file.
Nanoseconds to_time(std::int64_t value) {
  return std::clamp<std::int64_t>(value, -kFarthestStamp, kFarthestStamp);
}

// A prepared statement; steps throw with the database's own words.
class Statement {
 public:
  Statement(sqlite3* database, const std::string& file, const char* sql)
      : database_(database), file_(file) {
    if (sqlite3_prepare_v2(database, sql, -1, &statement_, nullptr) != SQLITE_OK) fail();
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  bool step() {
    const int result = sqlite3_step(statement_);
    if (result != SQLITE_ROW && result != SQLITE_DONE) fail();
    return result == SQLITE_ROW;
  }
  void restart() {
    sqlite3_reset(statement_);
    sqlite3_clear_bindings(statement_);
  }
  void bind(int parameter, std::int64_t value) { sqlite3_bind_int64(statement_, parameter, value); }
  [[nodiscard]] std::int64_t integer(int column) {
    return sqlite3_column_int64(statement_, column);
  }
  [[nodiscard]] std::string text(int column) {
    const unsigned char* value = sqlite3_column_text(statement_, column);
    return value == nullptr ? std::string() : reinterpret_cast<const char*>(value);
  }
  [[nodiscard]] std::span<const std::byte> blob(int column) {
    const void* data = sqlite3_column_blob(statement_, column);
    const int size = sqlite3_column_bytes(statement_, column);
    return {static_cast<const std::byte*>(data),
            data == nullptr ? 0U : static_cast<std::size_t>(size)};
  }

 private:
  [[noreturn]] void fail() const {
    throw InputError(file_ + ": the database cannot be read (" + sqlite3_errmsg(database_) +
                     "); it is broken, cut off or no ROS 2 bag");
  }
  sqlite3* database_;
  std::string file_;
  sqlite3_stmt* statement_ = nullptr;
};

class SqliteFile final : public MessageFile {
 public:
  explicit SqliteFile(const fs::path& file) : file_(file) {
    open();
    Statement topics(database_.get(), file_.string(),
                     "SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    std::map<std::int64_t, std::size_t> index;
    while (topics.step()) {
      index.emplace(topics.integer(0), topics_.size());
      topics_.push_back({topics.text(1), topics.text(2), Encoding::cdr, 0, 0, 0});
    }
    Statement counts(database_.get(), file_.string(),
                     "SELECT topic_id, COUNT(*), MIN(timestamp), MAX(timestamp) FROM messages "
                     "GROUP BY topic_id");
    while (counts.step()) {
      const auto it = index.find(counts.integer(0));
      if (it == index.end()) continue;
      Topic& topic = topics_[it->second];
      topic.messages = static_cast<std::size_t>(counts.integer(1));
      topic.first = to_time(counts.integer(2));
      topic.last = to_time(counts.integer(3));
    }
    whole_ = std::make_unique<Statement>(database_.get(), file_.string(),
                                         "SELECT data FROM messages WHERE id = ?");
    part_ = std::make_unique<Statement>(database_.get(), file_.string(),
                                        "SELECT substr(data, 1, ?) FROM messages WHERE id = ?");
  }

  std::vector<MessageEntry> messages(const std::string& topic) override {
    std::vector<MessageEntry> entries;
    Statement list(database_.get(), file_.string(),
                   "SELECT messages.id, timestamp, topics.name FROM messages JOIN topics ON "
                   "topic_id = topics.id ORDER BY messages.id");
    while (list.step()) {
      if (list.text(2) != topic) continue;
      entries.push_back({to_time(list.integer(1)), static_cast<std::uint64_t>(list.integer(0)), 0});
    }
    return entries;
  }

  void read(const MessageEntry& entry, std::size_t limit, std::vector<std::byte>& out) override {
    const bool part = limit < std::numeric_limits<std::size_t>::max() / 2;
    Statement& statement = part ? *part_ : *whole_;
    statement.restart();
    if (part) statement.bind(1, static_cast<std::int64_t>(limit));
    statement.bind(part ? 2 : 1, static_cast<std::int64_t>(entry.place));
    if (!statement.step()) throw InputError(file_.string() + ": a message is gone");
    const std::span<const std::byte> data = statement.blob(0);
    out.assign(data.begin(), data.end());
    statement.restart();
  }

 private:
  void open() {
    sqlite3* database = nullptr;
    // A bag whose writer was killed has a journal beside it, which a reader cannot replay in a
    // folder that it must not write to; immutable leaves it alone.
    int result = sqlite3_open_v2(file_.c_str(), &database, SQLITE_OPEN_READONLY, nullptr);
    database_.reset(database);
    if (result == SQLITE_OK &&
        sqlite3_exec(database, "SELECT 1 FROM topics", nullptr, nullptr, nullptr) == SQLITE_OK) {
      return;
    }
    std::string uri = "file:";
    for (const char c : file_.string()) {
      // What would end the path of a URI.
      uri += c == '?' ? "%3f" : c == '#' ? "%23" : c == '%' ? "%25" : std::string(1, c);
    }
    uri += "?immutable=1";
    result =
        sqlite3_open_v2(uri.c_str(), &database, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(database);
    if (result != SQLITE_OK) {
      throw InputError(file_.string() + ": cannot be opened as a sqlite3 database");
    }
  }

  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
  };
  fs::path file_;
  std::unique_ptr<sqlite3, Close> database_;
  std::unique_ptr<Statement> whole_, part_;
};

}  // namespace

std::unique_ptr<MessageFile> open_sqlite_file(const fs::path& file) {
  return std::make_unique<SqliteFile>(file);
}

}  // namespace groundloop::recordings
