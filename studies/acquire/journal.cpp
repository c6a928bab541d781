// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"
#include "optimizer/storage/sqlite.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* kTables = R"sql(
CREATE TABLE IF NOT EXISTS run(
  id INTEGER PRIMARY KEY CHECK (id = 1), schema INTEGER NOT NULL, digest TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS session(
  number INTEGER PRIMARY KEY, has_ended INTEGER NOT NULL);
CREATE TABLE IF NOT EXISTS picture(
  number INTEGER PRIMARY KEY, session INTEGER NOT NULL, file TEXT NOT NULL UNIQUE,
  object TEXT NOT NULL); -- as in acquired.json
CREATE TABLE IF NOT EXISTS ground(
  name TEXT PRIMARY KEY, value TEXT NOT NULL); -- an empty name: they have been recorded
)sql";

/// A descriptor that is closed.
class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags)
      : number_(::open(path.c_str(), flags | O_CLOEXEC, 0644)) {
    if (number_ < 0) {
      throw IoError(fmt::format("{}: {}", path.string(), last_system_error()));
    }
  }

  ~Descriptor() { ::close(number_); }

  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }

 private:
  int number_;
};

fs::path hidden(const fs::path& path) {
  return path.parent_path() / fmt::format(".{}.part", path.filename().string());
}

bool has_digest(const fs::path& path, const std::string& sha256) {
  std::error_code none;
  return fs::is_regular_file(path, none) && sha256_hex(read_file(path)) == sha256;
}

void check_plan(const fs::path& folder, const std::string& known, const std::string& digest) {
  if (!known.empty() && known != digest) {
    throw ConfigError(fmt::format(
        "{}: holds pictures of another plan, cell, scene or prototype, at another exposure, or of "
        "lights at another power; name another folder",
        folder.string()));
  }
}

/// Those that a folder was begun with; none: nobody recorded them.
std::optional<PictureGrounds> recorded_grounds(Database& database) {
  if (database.integer("SELECT count(*) FROM sqlite_master WHERE name = 'ground'") == 0) {
    return std::nullopt;
  }
  PictureGrounds grounds;
  Statement rows(database, "SELECT name, value FROM ground");
  while (rows.step()) {
    grounds[rows.text(0)] = rows.text(1);
  }
  return grounds.erase("") > 0 ? std::optional(std::move(grounds)) : std::nullopt;
}

void check_grounds(const fs::path& folder, Database& database, const PictureGrounds& now) {
  const std::optional<PictureGrounds> there = recorded_grounds(database);
  const std::string difference = there ? ground_difference(*there, now) : "";
  if (!difference.empty()) {
    throw ConfigError(
        fmt::format("{}: holds pictures of another part, or by a camera or stage set otherwise: "
                    "{}; name another folder",
                    folder.string(),
                    difference));
  }
}

void record_grounds(Database& database, PictureGrounds grounds) {
  if (recorded_grounds(database)) {
    return;
  }
  grounds[""] = "";
  Transaction all(database);
  for (const auto& [name, value] : grounds) {
    Statement(database, "INSERT INTO ground VALUES (?, ?)").bind(name).bind(value).run();
  }
  all.commit();
}

}  // namespace

std::string recorded_digest(const fs::path& folder) {
  if (!fs::exists(folder / "journal.sqlite")) {
    return "";
  }
  try {
    return Database(folder / "journal.sqlite", Database::Access::kReadOnly)
        .text("SELECT digest FROM run");
  } catch (const IoError&) {
    return "";  // what is wrong with it is told when it is opened to be written
  }
}

void check_recorded_grounds(const fs::path& folder, const PictureGrounds& grounds) {
  if (!fs::exists(folder / "journal.sqlite")) {
    return;
  }
  try {
    Database database(folder / "journal.sqlite", Database::Access::kReadOnly);
    check_grounds(folder, database, grounds);
  } catch (const IoError&) {  // what is wrong with it is told when it is opened to be written
  }
}

int recorded_sessions(const fs::path& folder) {
  if (!fs::exists(folder / "journal.sqlite")) {
    return 0;
  }
  try {
    return static_cast<int>(Database(folder / "journal.sqlite", Database::Access::kReadOnly)
                                .integer("SELECT count(*) FROM session"));
  } catch (const IoError&) {
    return 0;  // what is wrong with it is told when it is opened to be written
  }
}

std::vector<AcquiredPicture> whole_pictures(const fs::path& folder,
                                            const std::string& digest,
                                            const PictureGrounds& grounds) {
  std::vector<AcquiredPicture> whole;
  if (!fs::exists(folder / "journal.sqlite")) {
    return whole;
  }
  try {
    Database database(folder / "journal.sqlite", Database::Access::kReadOnly);
    check_grounds(folder, database, grounds);  // first: it names what differs
    check_plan(folder, database.text("SELECT digest FROM run"), digest);
    Statement rows(database, "SELECT object FROM picture ORDER BY number");
    while (rows.step()) {
      AcquiredPicture picture = picture_of_json(Json::parse(rows.text(0), nullptr, false));
      const fs::path path = folder / picture.file;
      if (has_digest(path, picture.sha256) || has_digest(hidden(path), picture.sha256)) {
        whole.push_back(std::move(picture));
      }
    }
  } catch (const IoError&) {
    whole.clear();  // what is wrong with it is told when it is opened to be written
  }
  return whole;
}

/// The database, and the lock that one process has on the folder.
struct AcquireJournal::Rows {
  explicit Rows(const fs::path& folder)
      : lock(folder / "journal.lock", O_RDWR | O_CREAT),
        database(locked(folder), Database::Access::kCreate) {
    database.run("PRAGMA journal_mode = DELETE");
    database.run("PRAGMA synchronous = EXTRA");
    database.run(kTables);
  }

  fs::path locked(const fs::path& folder) const {
    if (::flock(lock.number(), LOCK_EX | LOCK_NB) != 0) {
      throw ConfigError(
          fmt::format("{}: another process takes pictures into this folder", folder.string()));
    }
    return folder / "journal.sqlite";
  }

  Descriptor lock;
  Database database;
  std::int64_t session = 1;
};

AcquireJournal::AcquireJournal(fs::path folder,
                               const std::string& plan_digest,
                               const std::string& former_digest,
                               const PictureGrounds& grounds)
    : folder_(std::move(folder)), rows_(std::make_unique<Rows>(folder_)) {
  Database& database = rows_->database;
  check_grounds(folder_, database, grounds);
  const std::string known = database.text("SELECT digest FROM run");
  if (!known.empty() && known == former_digest) {
    Statement(database, "UPDATE run SET digest = ?").bind(plan_digest).run();
  } else {
    check_plan(folder_, known, plan_digest);
  }
  if (known.empty()) {
    Statement(database, "INSERT INTO run VALUES (1, 1, ?)").bind(plan_digest).run();
  }
  record_grounds(database, grounds);
  rows_->session = database.integer("SELECT max(number) FROM session") + 1;
  Statement(database, "INSERT INTO session VALUES (?, 0)").bind(rows_->session).run();
  repair();
}

AcquireJournal::~AcquireJournal() = default;

bool AcquireJournal::find_bytes(const AcquiredPicture& picture) const {
  const fs::path path = folder_ / picture.file;
  if (has_digest(path, picture.sha256)) {
    return true;
  }
  if (!has_digest(hidden(path), picture.sha256)) {
    return false;
  }
  rename_durably(hidden(path), path);
  return true;
}

void AcquireJournal::repair() {
  Database& database = rows_->database;
  std::vector<std::int64_t> lost;
  Statement rows(database, "SELECT number, object FROM picture ORDER BY number");
  while (rows.step()) {
    AcquiredPicture picture = picture_of_json(Json::parse(rows.text(1), nullptr, false));
    if (find_bytes(picture)) {
      pictures_.push_back(std::move(picture));
    } else {
      lost.push_back(rows.integer(0));
    }
  }
  for (const std::int64_t number : lost) {
    Statement(database, "DELETE FROM picture WHERE number = ?").bind(number).run();
  }
  num_resumed_ = static_cast<int>(pictures_.size());
  remove_strangers(folder_ / "views");
  remove_strangers(folder_ / "rejected");
}

/// Files of pictures, finished or not, that no row tells of.
void AcquireJournal::remove_strangers(const fs::path& below) const {
  std::error_code none;
  std::vector<fs::path> strangers;
  for (const auto& entry : fs::recursive_directory_iterator(below, none)) {
    const std::string name = entry.path().filename().string();
    const std::string file = entry.path().lexically_relative(folder_).string();
    const bool is_picture = name.starts_with("frame_") || name.starts_with(".frame_");
    if (entry.is_regular_file(none) && is_picture &&
        std::ranges::find(pictures_, file, &AcquiredPicture::file) == pictures_.end()) {
      strangers.push_back(entry.path());
    }
  }
  for (const fs::path& path : strangers) {
    fs::remove(path, none);
  }
}

void AcquireJournal::keep(AcquiredPicture picture, const std::string& bytes) {
  const fs::path path = folder_ / picture.file;
  make_folder_durably(path.parent_path());
  picture.sha256 = sha256_hex(bytes);
  try {
    write_synced(hidden(path), bytes);
    sync_folder(path.parent_path());
    Statement(rows_->database, "INSERT INTO picture(session, file, object) VALUES (?, ?, ?)")
        .bind(rows_->session)
        .bind(picture.file)
        .bind(picture_json(picture).dump())
        .run();
  } catch (const IoError&) {  // as a rule the disk is full: what is to be told needs the room
    std::error_code none;
    fs::remove(hidden(path), none);
    throw;
  }
  rename_durably(hidden(path), path);
  pictures_.push_back(std::move(picture));
}

int AcquireJournal::next_try(const std::string& stem) const {
  int last = 0;
  for (const AcquiredPicture& picture : pictures_) {
    const std::string_view file = picture.file;
    int number = 0;
    if (file.starts_with(stem) &&
        std::from_chars(file.data() + stem.size(), file.data() + file.size(), number).ec ==
            std::errc()) {
      last = std::max(last, number);
    }
  }
  return last + 1;
}

void AcquireJournal::end_session() {
  Statement(rows_->database, "UPDATE session SET has_ended = 1 WHERE number = ?")
      .bind(rows_->session)
      .run();
}

}  // namespace glint
