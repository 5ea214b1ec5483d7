#include "underbrush/core/temporary.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <optional>
#include <set>

#include "underbrush/core/check.hpp"
#include "underbrush/core/file.hpp"

namespace underbrush {
namespace {
namespace fs = std::filesystem;

struct Folder {
  Folder() {
    std::string name = (fs::temp_directory_path() / "temporary_test_XXXXXX").string();
    path = mkdtemp(name.data());
  }
  ~Folder() { fs::remove_all(path); }
  fs::path operator/(const char* name) const { return path / name; }
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(path)) all.insert(entry.path().filename());
    return all;
  }
  fs::path path;
};

std::string text_of(const fs::path& path) { return read_file(path); }

// Runs `body` in a process of its own, which is then killed (-9) unless it `lives`.
struct Process {
  template <class Body>
  explicit Process(const Body& body) {
    int ready[2];
    if (pipe(ready) != 0) throw std::runtime_error("pipe");
    id = fork();
    if (id == 0) {
      body();
      if (write(ready[1], "x", 1) != 1) _exit(1);
      for (;;) pause();
    }
    char byte;
    if (read(ready[0], &byte, 1) != 1) throw std::runtime_error("the process failed");
    close(ready[0]);
    close(ready[1]);
  }
  void end() {
    kill(id, SIGKILL);
    waitpid(id, nullptr, 0);
  }
  pid_t id;
};

void leave_a_half_written(const fs::path& folder) {
  auto* t = new TemporaryPath(folder, "out");
  make_temporary_folders(t->path());
  write_file(t->path() / "a", "half");
}

TEST(Temporary, IsPrivateAndGoes) {
  const Folder folder;
  {
    const TemporaryPath a(folder.path, "out"), b(folder.path, "out");
    EXPECT_NE(a.path(), b.path());
    EXPECT_EQ(folder.names().size(), 2u);
    EXPECT_FALSE(fs::exists(a.path()));
    struct stat status {};
    ASSERT_EQ(stat(a.path().parent_path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0700u);
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(Temporary, CommitReplacesFilesAndFolders) {
  const Folder folder;
  for (const char* text : {"first", "second"}) {
    TemporaryPath file(folder.path, "file"), model(folder.path, "model");
    write_file(file.path(), text);
    make_temporary_folders(model.path());
    write_file(model.path() / text, text);
    file.commit();
    model.commit();
  }
  EXPECT_EQ(folder.names(), (std::set<std::string>{"file", "model"}));
  EXPECT_EQ(text_of(folder / "file"), "second");
  EXPECT_FALSE(fs::exists(folder / "model/first"));
  EXPECT_EQ(text_of(folder / "model/second"), "second");
}

TEST(Temporary, OfAKilledProcessIsRemovedByTheNext) {
  const Folder folder;
  Process process([&] { leave_a_half_written(folder.path); });
  size_t removed = 0;
  on_remains_removed([&](const fs::path&, size_t count) { removed += count; });
  Process beside([&] { const TemporaryPath other(folder.path, "other"); });
  EXPECT_EQ(folder.names().size(), 1u) << "a living process keeps what it writes";
  beside.end();
  process.end();
  EXPECT_EQ(folder.names().size(), 1u);
  {
    const TemporaryPath next(folder.path, "next");
    EXPECT_EQ(removed, 1u);
    EXPECT_EQ(folder.names(), std::set<std::string>{next.path().parent_path().filename().string()});
  }
  on_remains_removed(nullptr);
  EXPECT_TRUE(folder.names().empty());
}

// Killed between two renames: the old output waits in the private folder.
TEST(Temporary, PutsBackWhatAKilledCommitMovedAway) {
  const Folder folder;
  const fs::path dead = folder / ".underbrush-abcdef";
  fs::create_directories(dead / "replaced" / "model");
  fs::permissions(dead, fs::perms::owner_all);
  std::ofstream(dead / "lock");
  std::ofstream(dead / "replaced/model/a") << "old";
  { const TemporaryPath next(folder.path, "next"); }
  EXPECT_EQ(folder.names(), std::set<std::string>{"model"});
  EXPECT_EQ(text_of(folder / "model/a"), "old");
}

TEST(Temporary, LeavesFoldersOfOthersAlone) {
  const Folder folder;
  for (const char* name : {".underbrush-notes", ".underbrush-abcdef", "underbrush-abcdef"}) {
    fs::create_directories(folder / name);
    std::ofstream(folder / name / "mine") << "kept";
  }
  fs::permissions(folder / ".underbrush-abcdef", fs::perms::owner_all);  // no lock in it
  { const TemporaryPath next(folder.path, "next"); }
  EXPECT_EQ(folder.names().size(), 3u);
  EXPECT_EQ(text_of(folder / ".underbrush-abcdef/mine"), "kept");
}

TEST(Temporary, WritesThroughNoLinkAndOverNoFile) {
  const Folder folder;
  write_file(folder / "important", "kept");
  fs::create_symlink(folder / "important", folder / "link");
  fs::create_symlink(folder / "new", folder / "dangling");
  for (const char* name : {"important", "link", "dangling"}) {
    EXPECT_THROW(write_file(folder / name, "lost"), IoError) << name;
  }
  EXPECT_EQ(text_of(folder / "important"), "kept");
  EXPECT_FALSE(fs::exists(folder / "new"));
}

TEST(Printable, IsOneShortLineForATerminal) {
  EXPECT_EQ(printable("a\x1b[31m\n\xff ä"), "a\\x1b[31m\\x0a\\xff ä");
  EXPECT_EQ(printable("\xc2\x9b"
                      "1"),
            "\\xc2\\x9b1");  // a control character in UTF-8
  EXPECT_EQ(printable("\xe2\x80\xae"
                      "x"),
            "\\xe2\\x80\\xaex");                   // turns the direction of writing
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");  // an overlong "/"
  std::string longer;
  for (int i = 0; i < 1000; ++i) longer += "ä";
  const std::string cut = printable(longer);
  EXPECT_LE(cut.size(), 400u);
  EXPECT_EQ(printable(cut, 1000), cut) << "no character is cut in two";
  EXPECT_EQ(in_quotes("daemon:*:19000:0:99999:7:::a-longer-secret").find("a-longer-secret"),
            std::string::npos);
}

}  // namespace
}  // namespace underbrush
