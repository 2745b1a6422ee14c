#include "modules/core/temporary_folder.h"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <optional>

#include "tests/scratch_folder.h"

using palpate::TemporaryFolder;

namespace {

/// TMPDIR is a folder of its own as long as this object lives.
struct OwnPlace {
  palpate::ScratchFolder folder;
  std::string earlier = std::getenv("TMPDIR") == nullptr ? "" : std::getenv("TMPDIR");

  OwnPlace() { ::setenv("TMPDIR", (folder / ".").c_str(), 1); }
  ~OwnPlace() { earlier.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", earlier.c_str(), 1); }
  long folders() const {
    return std::distance(std::filesystem::directory_iterator(folder / "."), {});
  }
};

}  // namespace

TEST_CASE("temporary folder: it goes with its owner, and several stand beside each other") {
  // Oracle: the file system.
  const OwnPlace place;
  std::optional<TemporaryFolder> first(std::in_place);
  {
    const TemporaryFolder second;
    CHECK(std::filesystem::exists(second.write("a", "text")));
    CHECK(place.folders() == 2);
  }
  CHECK(std::filesystem::exists(first->path()));
  first.reset();
  CHECK(place.folders() == 0);
}

TEST_CASE("temporary folder: what a killed owner left goes when the next one is made") {
  // Oracle: the file system. What is not ours by its name, or its owner lives, stays.
  const OwnPlace place;
  const pid_t owner = fork();
  if (owner == 0) {
    TemporaryFolder folder;
    folder.write("scene.yaml", "x");
    ::raise(SIGKILL);
  }
  REQUIRE(::waitpid(owner, nullptr, 0) == owner);
  CHECK(place.folders() == 1);
  std::filesystem::create_directory(place.folder / "palpate-somebody-else-77-abcdef");
  const TemporaryFolder one, another;
  CHECK(place.folders() == 3);
  CHECK(std::filesystem::exists(one.path()));
}
