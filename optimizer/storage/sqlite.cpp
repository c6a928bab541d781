// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/storage/sqlite.h"

#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <system_error>

#include "core/error.h"

namespace glint {

namespace {

/// How long a statement waits for another connection before it fails.
constexpr int kBusyTimeoutMs = 20000;

static_assert(std::endian::native == std::endian::little, "blobs are little-endian doubles");

int open_flags(Database::Access access) {
  switch (access) {
    case Database::Access::kReadOnly:
      return SQLITE_OPEN_READONLY;
    case Database::Access::kFrozen:
      return SQLITE_OPEN_READONLY | SQLITE_OPEN_URI;
    case Database::Access::kReadWrite:
      return SQLITE_OPEN_READWRITE;
    case Database::Access::kCreate:
      break;
  }
  return SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
}

/// What sqlite3_open takes: a plain path, or an address with the option only addresses can carry.
std::string file_name(const std::filesystem::path& path, Database::Access access) {
  if (access != Database::Access::kFrozen) {
    return path.string();
  }
  std::string name = "file:";
  for (const char c : path.string()) {
    const bool is_special = c == '?' || c == '#' || c == '%';
    name += is_special ? (c == '?' ? "%3f" : c == '#' ? "%23" : "%25") : std::string(1, c);
  }
  return name + "?immutable=1";
}

/// ": " and the reason that SQLite does not tell by itself; empty: it is another one.
std::string why_not_opened(const std::filesystem::path& path) {
  constexpr std::size_t kLongest = 500;  // SQLite takes 512 bytes, with endings of its own
  std::error_code ignored;
  const bool is_long = std::filesystem::absolute(path, ignored).native().size() > kLongest;
  return is_long ? ": its path is longer than the 500 bytes that are possible" : "";
}

}  // namespace

void Database::Closer::operator()(sqlite3* handle) const {
  sqlite3_close_v2(handle);
}

void Statement::Finalizer::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

Database::Database(const std::filesystem::path& path, Access access) : path_(path) {
  sqlite3* raw = nullptr;
  const int flags = open_flags(access) | SQLITE_OPEN_FULLMUTEX | SQLITE_OPEN_PRIVATECACHE;
  const int code = sqlite3_open_v2(file_name(path, access).c_str(), &raw, flags, nullptr);
  handle_.reset(raw);
  if (code != SQLITE_OK) {
    fail(code);
  }
  sqlite3_busy_timeout(raw, kBusyTimeoutMs);
}

void Database::run(const std::string& sql) {
  const int code = sqlite3_exec(handle(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) {
    fail(code);
  }
}

std::int64_t Database::integer(const std::string& sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.integer(0) : 0;
}

std::string Database::text(const std::string& sql) {
  Statement statement(*this, sql);
  return statement.step() ? statement.text(0) : "";
}

void Database::fail(int code) const {
  const std::string name = path_.string();
  switch (code & 0xFF) {
    case SQLITE_NOTADB:
      throw IoError(name + ": is not a study database, or a damaged one");
    case SQLITE_CORRUPT:
      throw IoError(name + ": the study database is damaged or truncated");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw IoError(name + ": another program keeps the study database locked");
    case SQLITE_FULL:
      throw IoError(name + ": cannot write, the disk is full");
    case SQLITE_READONLY:
    case SQLITE_PERM:
      throw IoError(name + ": cannot write the study database, it is read-only");
    case SQLITE_CANTOPEN:
      throw IoError(name + ": cannot open the study database" + why_not_opened(path_));
    case SQLITE_IOERR:
      throw IoError(name +
                    ": the study database cannot be read or written: the disk is full, a limit on "
                    "the size of files is reached, or the disk fails");
    default:
      throw IoError(name + ": " + (handle_ ? sqlite3_errmsg(handle()) : sqlite3_errstr(code)));
  }
}

Statement::Statement(Database& database, std::string_view sql) : database_(database) {
  sqlite3_stmt* raw = nullptr;
  check(sqlite3_prepare_v2(
      database.handle(), sql.data(), static_cast<int>(sql.size()), &raw, nullptr));
  statement_.reset(raw);
}

void Statement::check(int code) const {
  if (code != SQLITE_OK) {
    database_.fail(code);
  }
}

Statement& Statement::bind(std::int64_t value) {
  check(sqlite3_bind_int64(statement_.get(), next_++, value));
  return *this;
}

Statement& Statement::bind(std::optional<std::int64_t> value) {
  if (value) {
    return bind(*value);
  }
  check(sqlite3_bind_null(statement_.get(), next_++));
  return *this;
}

Statement& Statement::bind(double value) {
  check(std::isnan(value) ? sqlite3_bind_null(statement_.get(), next_)
                          : sqlite3_bind_double(statement_.get(), next_, value));
  ++next_;
  return *this;
}

Statement& Statement::bind(std::string_view value) {
  const char* data = value.empty() ? "" : value.data();
  check(sqlite3_bind_text(
      statement_.get(), next_++, data, static_cast<int>(value.size()), SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::bind_doubles(std::span<const double> values) {
  // SQLite takes a null pointer for NULL, so an empty blob needs an address.
  const void* data = values.empty() ? static_cast<const void*>("") : values.data();
  const auto size = static_cast<int>(values.size_bytes());
  check(sqlite3_bind_blob(statement_.get(), next_++, data, size, SQLITE_TRANSIENT));
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) {
    database_.fail(code);
  }
  return code == SQLITE_ROW;
}

void Statement::reset() {
  check(sqlite3_reset(statement_.get()));
  next_ = 1;
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

double Statement::real(int column) const {
  return is_null(column) ? std::numeric_limits<double>::quiet_NaN()
                         : sqlite3_column_double(statement_.get(), column);
}

std::string Statement::text(int column) const {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return data == nullptr ? "" : std::string(static_cast<const char*>(data), size);
}

std::vector<double> Statement::doubles(int column) const {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  std::vector<double> values(size / sizeof(double));
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::array<char, sizeof(double)> bytes;
    const char* first = static_cast<const char*>(data) + i * bytes.size();
    std::copy(first, first + bytes.size(), bytes.begin());
    values[i] = std::bit_cast<double>(bytes);
  }
  return values;
}

bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

Transaction::Transaction(Database& database) : database_(database) {
  database.run("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (is_open_) {
    // Nothing to do about a failure here: SQLite undoes an open transaction when it is reopened.
    sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

void Transaction::commit() {
  database_.run("COMMIT");
  is_open_ = false;
}

}  // namespace glint
