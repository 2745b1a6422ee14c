#include "modules/core/files_of_kind.h"

#include <sys/stat.h>

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "tests/scratch_folder.h"

using namespace palpate;

TEST_CASE("files of a kind: by name and first bytes, and nothing else") {
  // Oracle: the names by hand. A FIFO that is opened would hold the test up.
  const ScratchFolder folder;
  const FileKind kind{"frame_", ".png", "PNG", "pictures of a run"};
  CHECK(files_of_kind(folder / "none", kind).empty());
  CHECK_NOTHROW(check_none_of_kind(folder / "none", kind, "--frames"));
  for (const char* other : {"photo.png", "frame_2.txt"}) folder.write(other, "PNG of a person");
  folder.write("frame_text.png", "words");
  REQUIRE(::mkfifo((folder / "frame_fifo.png").c_str(), 0600) == 0);
  CHECK(files_of_kind(folder.path(), kind).empty());
  const auto second = folder.write("frame_2.png", "PNG 2");
  const auto first = folder.write("frame_1.png", "PNG 1");
  const auto found = files_of_kind(folder.path(), kind);
  CHECK(found == std::vector<std::filesystem::path>{first, second});
  CHECK_THROWS_WITH(check_none_of_kind(folder.path(), kind, "--frames"),
                    "--frames '" + folder.path().string() +
                        "': holds pictures of a run already (frame_1.png and 1 more); give another "
                        "folder, or --overwrite");
  remove_files(found);
  CHECK_NOTHROW(check_none_of_kind(folder.path(), kind, "--frames"));
  CHECK(folder.file_count() == 4);
}
