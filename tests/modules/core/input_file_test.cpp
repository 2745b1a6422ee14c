#include "modules/core/input_file.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <exception>

#include "modules/core/error.h"
#include "tests/scratch_folder.h"

using namespace palpate;

TEST_CASE("input file: what is no file is told from one before it is opened") {
  // Oracle: the texts by hand. A FIFO that is opened would hold the test up.
  const ScratchFolder folder;
  REQUIRE(::mkfifo((folder / "fifo").c_str(), 0600) == 0);
  CHECK(why_not_readable(folder / "none") == "no such file");
  CHECK(why_not_readable(folder.write("file", "x") / "none") == "no such file");
  CHECK(why_not_readable(folder.path()) == "is a folder, not a file");
  CHECK(why_not_readable(folder / "fifo") == "is a FIFO, not a file; write to a file first");
  CHECK(why_not_readable("/dev/zero") == "is a device or socket, not a file");
  CHECK(why_not_readable(folder / std::string(300, 'n')).starts_with("cannot be read: "));
  CHECK_THROWS_WITH(open_input(folder.path()),
                    folder.path().string() + ": is a folder, not a file");
  CHECK_THROWS_AS(open_input(folder / "fifo"), InputError);
  CHECK(read_input(folder / "file", 1) == "x");
  std::filesystem::resize_file(folder / "file", (5u << 20) + 1);
  CHECK_THROWS_WITH(read_input(folder / "file", 4u << 20),
                    (folder / "file").string() + ": is 5 MiB long; such a file may have 4 MiB");
  folder.write("file", "x");
  std::string word;
  CHECK((open_input(folder / "file") >> word && word == "x"));
}

TEST_CASE("input file: why it cannot be opened, or read further, is what the system says") {
  // Oracle: strerror(EMFILE), no fault of the file; and of a read that fails: nothing is mapped at
  // the beginning of a process's memory (EIO).
  const ScratchFolder folder;
  const auto file = folder.write("file", "x");
  rlimit before{};
  REQUIRE(::getrlimit(RLIMIT_NOFILE, &before) == 0);
  const int next = ::dup(STDIN_FILENO);
  ::close(next);
  rlimit none_left = before;
  none_left.rlim_cur = static_cast<rlim_t>(next);
  REQUIRE(::setrlimit(RLIMIT_NOFILE, &none_left) == 0);
  std::exception_ptr thrown;  // looked at when files can be opened again: sanitizers need some
  try {
    open_input(file);
  } catch (...) {
    thrown = std::current_exception();
  }
  ::setrlimit(RLIMIT_NOFILE, &before);
  REQUIRE(thrown);
  std::string said;
  try {
    std::rethrow_exception(thrown);
  } catch (const InputError&) {
    said = "bad input";
  } catch (const std::runtime_error& error) {
    said = error.what();
  }
  CHECK(said == file.string() + ": cannot be opened: Too many open files");
  CHECK_THROWS_WITH(read_input("/proc/self/mem", 1),
                    "/proc/self/mem: cannot be read: Input/output error");
}
