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
  [[nodiscard]] std::int64_t integer(int column) {
    return sqlite3_column_int64(statement_, column);
  }
  [[nodiscard]] std::string text(int column) {
    const unsigned char* value = sqlite3_column_text(statement_, column);
    return value == nullptr ? std::string() : reinterpret_cast<const char*>(value);
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
    list_topics();
    list_messages();
    if (cut_off_) {
      warnings_.push_back(file_.filename().string() +
                          " is cut off or broken: it is shorter than its header says, or its pages "
                          "do not hang together; the messages before that are used.");
    }
  }
  ~SqliteFile() override { sqlite3_blob_close(blob_); }
  SqliteFile(const SqliteFile&) = delete;
  SqliteFile& operator=(const SqliteFile&) = delete;

  std::vector<MessageEntry> messages(const std::string& topic) override {
    std::vector<MessageEntry> entries;
    for (const Row& row : messages_) {
      if (topics_[row.topic].name == topic) entries.push_back(row.entry);
    }
    return entries;
  }

  // Only as much of a message is read from the disk as is asked for.
  void read(const MessageEntry& entry, std::size_t limit, std::vector<std::byte>& out) override {
    const auto row = static_cast<sqlite3_int64>(entry.place);
    const int opened = blob_ == nullptr ? sqlite3_blob_open(database_.get(), "main", "messages",
                                                            "data", row, 0, &blob_)
                                        : sqlite3_blob_reopen(blob_, row);
    const std::size_t size =
        opened == SQLITE_OK
            ? std::min<std::size_t>(static_cast<std::size_t>(sqlite3_blob_bytes(blob_)), limit)
            : 0;
    out.resize(size);
    if (opened == SQLITE_OK &&
        sqlite3_blob_read(blob_, out.data(), static_cast<int>(size), 0) == SQLITE_OK)
      return;
    const std::string why = sqlite3_errmsg(database_.get());
    sqlite3_blob_close(blob_);
    blob_ = nullptr;
    throw InputError(file_.string() + ": message " + std::to_string(entry.place) +
                     " cannot be read (" + why + "); the database is broken or cut off there");
  }

 private:
  struct Row {
    std::size_t topic = 0;
    MessageEntry entry;
  };

  void list_topics() {
    Statement topics(database_.get(), file_.string(),
                     "SELECT id, name, type FROM topics ORDER BY id");
    while (topics.step()) {
      index_.emplace(topics.integer(0), topics_.size());
      topics_.push_back({topics.text(1), topics.text(2), Encoding::cdr, 0, 0, 0});
    }
  }

  // In the order of writing, up to where a database that is cut off ends. Its last page may be a
  // part of one, of which the rest reads as zeros: rows do not grow any more there, and the last
  // one before may end in it.
  void list_messages() {
    std::int64_t last = std::numeric_limits<std::int64_t>::min();
    try {
      Statement list(database_.get(), file_.string(),
                     "SELECT rowid, topic_id, timestamp FROM messages ORDER BY rowid");
      while (list.step()) {
        if (list.integer(0) <= last) {
          cut_off_ = true;
          break;
        }
        last = list.integer(0);
        const auto it = index_.find(list.integer(1));
        if (it == index_.end()) continue;
        Topic& topic = topics_[it->second];
        const Nanoseconds time = to_time(list.integer(2));
        topic.count(time);
        if (topic.is_read())
          messages_.push_back({it->second, {time, static_cast<std::uint64_t>(list.integer(0)), 0}});
      }
    } catch (const InputError&) {
      if (messages_.empty()) throw;
      cut_off_ = true;
    }
    if (cut_off_ && !messages_.empty()) messages_.pop_back();
  }

  bool is_readable() const {
    return sqlite3_exec(database_.get(), "SELECT 1 FROM topics", nullptr, nullptr, nullptr) ==
           SQLITE_OK;
  }

  void open() {
    sqlite3* database = nullptr;
    int result = sqlite3_open_v2(file_.c_str(), &database, SQLITE_OPEN_READONLY, nullptr);
    database_.reset(database);
    if (result == SQLITE_OK && is_readable()) return;
    // A bag whose writer was killed has a journal beside it, which a reader cannot replay in a
    // folder that it must not write to; immutable leaves it alone.
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
    if (is_readable()) return warn_of_journal();
    // A database shorter than its header says is refused unless its schema may be written, by
    // which repairs are made; nothing is written here.
    sqlite3_exec(database, "PRAGMA writable_schema=ON", nullptr, nullptr, nullptr);
    cut_off_ = is_readable();
  }

  void warn_of_journal() {
    for (const char* end : {"-wal", "-journal"}) {
      std::error_code error;
      const fs::path journal = file_.string() + end;
      const auto size = fs::file_size(journal, error);
      if (error || size == 0) continue;
      warnings_.push_back("The recorder of " + file_.filename().string() +
                          " did not close it: what is in " + journal.filename().string() + " (" +
                          std::to_string(size) + " bytes) is not read; `sqlite3 " +
                          file_.filename().string() +
                          " 'PRAGMA wal_checkpoint'` on a copy of both brings it in.");
    }
  }

  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
  };
  fs::path file_;
  std::unique_ptr<sqlite3, Close> database_;
  sqlite3_blob* blob_ = nullptr;
  std::map<std::int64_t, std::size_t> index_;  // of topics, by their ids
  std::vector<Row> messages_;
  bool cut_off_ = false;
};

}  // namespace

std::unique_ptr<MessageFile> open_sqlite_file(const fs::path& file) {
  return std::make_unique<SqliteFile>(file);
}

}  // namespace groundloop::recordings
