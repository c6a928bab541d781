// SPDX-License-Identifier: GPL-3.0-or-later
//
// The little of SQLite's C API that storage needs, with IoError texts. Private to the module.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace glint {

class Database {
 public:
  enum class Access {
    kReadOnly,
    kFrozen,  ///< read-only, and nobody else is writing: works in folders that cannot be written
    kReadWrite,
    kCreate
  };

  /// @throws IoError
  Database(const std::filesystem::path& path, Access access);

  /// Runs statements without results.
  void run(const std::string& sql);
  /// The first column of the first row, as an integer or as text.
  std::int64_t integer(const std::string& sql);
  std::string text(const std::string& sql);

  /// Throws IoError with what the code means for this file.
  [[noreturn]] void fail(int code) const;

  const std::filesystem::path& path() const { return path_; }

  sqlite3* handle() const { return handle_.get(); }

 private:
  struct Closer {
    void operator()(sqlite3* handle) const;
  };

  std::filesystem::path path_;
  std::unique_ptr<sqlite3, Closer> handle_;
};

/// One prepared statement: bind in order, then step through the rows.
class Statement {
 public:
  Statement(Database& database, std::string_view sql);

  Statement& bind(std::int64_t value);
  Statement& bind(std::optional<std::int64_t> value);  ///< empty becomes NULL
  Statement& bind(double value);                       ///< exact; NaN becomes NULL
  Statement& bind(std::string_view value);
  Statement& bind_doubles(std::span<const double> values);  ///< as a blob, bit for bit

  bool step();  ///< true while there is a row

  void run() { step(); }

  /// Ready to be bound anew and run once more.
  void reset();

  std::int64_t integer(int column) const;
  double real(int column) const;  ///< NULL becomes NaN
  std::string text(int column) const;
  std::vector<double> doubles(int column) const;
  bool is_null(int column) const;

 private:
  struct Finalizer {
    void operator()(sqlite3_stmt* statement) const;
  };

  void check(int code) const;

  Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalizer> statement_;
  int next_ = 1;
};

/// BEGIN IMMEDIATE ... COMMIT; rolled back when commit() was not reached.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  void commit();

 private:
  Database& database_;
  bool is_open_ = true;
};

}  // namespace glint
