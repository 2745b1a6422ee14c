#include "modules/core/output_file.h"

#include <sys/stat.h>

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "tests/scratch_folder.h"

using namespace palpate;

TEST_CASE("output file: what cannot be written is known before") {
  // Oracle: the texts by hand; permissions are root's in some places and not asked for here.
  const ScratchFolder folder;
  const std::string at = folder.path().string();
  CHECK(why_not_writable(folder / "new").empty());
  std::ofstream(folder / "old") << "x";
  CHECK(why_not_writable(folder / "old").empty());
  CHECK(why_not_writable(folder.path()) == "it is a folder");
  CHECK(why_not_writable(folder / std::string(256, 'n')) == "File name too long");
  CHECK(why_not_writable(folder / "no/new") == "there is no folder " + at + "/no");
  CHECK(why_not_writable(folder / "old/new") == "there is no folder " + at + "/old");
  CHECK(why_not_writable("/proc/x").starts_with("the folder /proc takes no file: "));
  CHECK(folder.file_count() == 1);
  std::filesystem::create_symlink(folder / "nowhere", folder / "link");
  CHECK(why_not_writable(folder / "link") == "it is a link that leads to no file");
  CHECK_THROWS_AS(check_writable(folder.path()), InputError);
  CHECK_NOTHROW(check_writable("/dev/null"));
}

TEST_CASE("output file: a file written anew replaces its like and nothing else") {
  // Oracle: the messages by hand. A FIFO that is opened would hold the test up.
  const ScratchFolder folder;
  const auto check = [&](const std::string& name) {
    check_replaces_its_like(folder / name, "scene ", "summary");
  };
  const auto refusal = [&](const std::string& name) {
    return (folder / name).string() + ": is no summary, and is not replaced by one";
  };
  folder.write("own", "scene liver: 1 s");
  folder.write("empty", "");
  for (const char* name : {"new", "own", "empty"}) CHECK_NOTHROW(check(name));
  folder.write("other", "palpate_scene: 1");
  folder.write("short", "sc");
  REQUIRE(::mkfifo((folder / "fifo").c_str(), 0600) == 0);
  for (const char* name : {"other", "short", "fifo"}) CHECK_THROWS_WITH(check(name), refusal(name));
  CHECK(text_in(folder / "other") == "palpate_scene: 1");
  CHECK_THROWS_AS(check_replaces_its_like("/nowhere/x", "scene ", "summary"), InputError);
}
