#include "modules/core/whole_file.h"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>

#include "modules/core/error.h"
#include "tests/file_size_limit.h"
#include "tests/scratch_folder.h"

namespace palpate {
namespace {

TEST_CASE("whole file: without finish nothing is left, and what was there stays") {
  // Oracle: the folder.
  const ScratchFolder folder;
  const auto file = folder.write("a.csv", "old");
  {
    WholeFile whole(file);
    whole.stream() << "new" << std::flush;
    CHECK(text_in(file) == "old");
    CHECK(folder.file_count() == 2);
  }
  CHECK(text_in(file) == "old");
  CHECK(folder.file_count() == 1);
  write_whole_file(file, "new");
  CHECK(text_in(file) == "new");
  CHECK(folder.file_count() == 1);
}

TEST_CASE("whole file: a full disk leaves nothing, and what was there stays") {
  // Oracle: the folder, and strerror(EFBIG): a limit on the size of files fails where a full disk
  // does. At once, in a buffer that is written later, and letter by letter.
  const ScratchFolder folder;
  const auto file = folder.write("a.csv", "old");
  const auto refused = Catch::Equals("cannot write " + file.string() + ": File too large");
  {
    const FileSizeLimit limit(100);
    CHECK_THROWS_WITH(write_whole_file(file, std::string(100'000, 'x')), refused);
    CHECK_THROWS_WITH(write_whole_file(file, std::string(200, 'x')), refused);
    WholeFile whole(file);
    for (int k = 0; k < 20'000; ++k) whole.stream() << 'x';
    CHECK_THROWS_WITH(whole.finish(), refused);
  }
  CHECK(text_in(file) == "old");
  CHECK(folder.file_count() == 1);
}

TEST_CASE("whole file: Ctrl-C, SIGTERM and SIGHUP leave nothing") {
  // Oracle: the folder, and how the child ended.
  const int signal = GENERATE(SIGINT, SIGTERM, SIGHUP);
  const ScratchFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(signal, SIG_DFL);
    WholeFile one(folder / "a.csv"), two(folder / "b.csv");
    one.stream() << "x" << std::flush;
    if (folder.file_count() == 2) ::raise(signal);
    ::_exit(0);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == signal);
  CHECK(folder.file_count() == 0);
}

TEST_CASE("whole file: a link stays one, and what it names is replaced") {
  // Oracle: the folder.
  const ScratchFolder folder;
  const auto file = folder.write("a.csv", "old");
  std::filesystem::create_symlink(file, folder / "link");
  write_whole_file(folder / "link", "new");
  CHECK(std::filesystem::is_symlink(folder / "link"));
  CHECK(text_in(file) == "new");
}

TEST_CASE("whole file: a name as long as one may be is written") {
  // Oracle: the folder; Linux takes 255 bytes.
  const ScratchFolder folder;
  const auto file = folder / std::string(255, 'n');
  write_whole_file(file, "new");
  CHECK(text_in(file) == "new");
  CHECK(folder.file_count() == 1);
}

TEST_CASE("whole file: of one writer, a second is refused while the first is at work") {
  // Oracle: the message by hand, and the first one's text. One that was killed keeps nobody out.
  const ScratchFolder folder;
  const auto file = folder / "a.csv";
  const auto write = [&](const std::string& text) {
    WholeFile whole(file, Writers::kOne);
    whole.stream() << text;
    CHECK_THROWS_WITH(WholeFile(file, Writers::kOne),
                      file.string() + ": another program is writing it");
    whole.finish();
  };
  write("one");
  CHECK(text_in(file) == "one");
  folder.write("a.csv.part", "left behind");
  write("two");
  CHECK(text_in(file) == "two");
  CHECK(folder.file_count() == 1);
}

TEST_CASE("whole file: where nothing can be written it says so") {
  // Oracle: the messages by hand.
  CHECK_THROWS_WITH(WholeFile("/nowhere/a.csv"),
                    "/nowhere/a.csv: cannot be written: there is no folder /nowhere");
  CHECK_THROWS_WITH(WholeFile("/dev/null"),
                    "/dev/null: cannot be written: it is there and no regular file");
}

TEST_CASE("whole file: a signal leaves nothing, at whatever place of the making it comes") {
  // Oracle: the folder, and kill(2) at times that differ by a few microseconds.
  const ScratchFolder folder;
  const auto file = folder / "a.csv";
  for (int round = 0; round < 400; ++round) {
    int ready[2];
    REQUIRE(::pipe(ready) == 0);
    const pid_t process = ::fork();
    if (process == 0) {
      std::signal(SIGTERM, SIG_DFL);  // Catch2 has its own
      // The handler is there from the first file on, which is the state in which the second begins.
      FileInTheMaking(folder / "first.csv", Writers::kOne);
      if (::write(ready[1], "x", 1) != 1) ::_exit(1);
      while (true) FileInTheMaking(file, Writers::kOne);
    }
    char letter = 0;
    REQUIRE(::read(ready[0], &letter, 1) == 1);
    ::usleep(static_cast<useconds_t>(3 * round));
    ::kill(process, SIGTERM);
    int status = 0;
    ::waitpid(process, &status, 0);
    ::close(ready[0]);
    ::close(ready[1]);
    CAPTURE(round);
    REQUIRE(WIFSIGNALED(status));
    REQUIRE(folder.file_count() == 0);
  }
}

}  // namespace
}  // namespace palpate
