#include "modules/bus/keys.h"

#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <thread>

#include "modules/bus/key_check.h"
#include "modules/bus/roles.h"
#include "modules/core/error.h"
#include "tests/file_size_limit.h"
#include "tests/modules/bus/keyed_process.h"
#include "tests/scratch_folder.h"

namespace palpate::bus {
namespace {

namespace fs = std::filesystem;
using testing::keyed_process;
using testing::own_options;
using testing::take_soon;
using testing::wait_until;

constexpr std::chrono::hours kHour(1);

template <class F>
std::string told(const F& f) {
  try {
    f();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

bool is_bad_input(const auto& f) {
  try {
    f();
  } catch (const InputError&) {
    return true;
  } catch (const std::exception&) {
  }
  return false;
}

/// Haptics says forces, a viewer hears them.
struct Felt {
  Felt(const fs::path& keys, const BusOptions& options)
      : haptics(keyed_process(keys, "haptics", options)),
        viewer(keyed_process(keys, "viewer", options)),
        forces(haptics->writer(kHapticForce)),
        heard(viewer->reader(kHapticForce)) {}
  bool matched() {
    return wait_until(
        [&] { return forces.matched_readers() == 1 && heard.matched_writers() == 1; });
  }
  /// One force after the other comes, for so many milliseconds, longer on a busy machine.
  bool goes_on(int milliseconds) {
    HapticForce force, received;
    int written = 0, came = 0;
    return wait_until([&] {
      forces.write(force);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      while (heard.take(received)) ++came;
      return ++written >= milliseconds && came > milliseconds / 2;
    });
  }

  std::unique_ptr<DdsBus> haptics, viewer;
  Writer<HapticForce> forces;
  Reader<HapticForce> heard;
};

/// A second each of listening and of speaking, beside a session that goes on.
void check_shut_out(Felt& felt, DdsBus& listener, DdsBus& speaker) {
  constexpr int kPieces = 10, kPieceMs = 100;
  HapticForce force;
  {
    auto hears = listener.reader(kHapticForce);
    for (int k = 0; k < kPieces; ++k) {
      CHECK(felt.goes_on(kPieceMs));
      CHECK_FALSE(hears.take(force));
    }
    CHECK(hears.matched_writers() == 0);
    CHECK(felt.forces.matched_readers() == 1);
  }
  auto says = speaker.writer(kHapticForce);
  const std::uint64_t refused = felt.viewer->packets_refused().count;
  for (int k = 0; k < kPieces; ++k) {
    says.write(force);
    CHECK(felt.goes_on(kPieceMs));
  }
  CHECK(says.matched_readers() == 0);
  CHECK(felt.heard.matched_writers() == 1);
  INFO("refused last: " << felt.viewer->packets_refused().last);
  CHECK(felt.viewer->packets_refused().count == refused);  // it does not even send
}

}  // namespace

TEST_CASE("keys: files are their owner's alone, the authority's key is not among them", "[bus]") {
  // Oracle: the folder; a second time it is refused.
  const ScratchFolder folder;
  const fs::path keys = folder / "keys";
  make_keys(keys, kHour);
  CHECK((fs::status(keys).permissions() & fs::perms::mask) == fs::perms::owner_all);
  std::size_t files = 0;
  for (const auto& file : fs::directory_iterator(keys)) {
    ++files;
    CHECK((file.status().permissions() & fs::perms::mask) ==
          (fs::perms::owner_read | fs::perms::owner_write));
  }
  CHECK(files == 2 + 3 * roles().size());
  CHECK_FALSE(fs::exists(keys / "authority.key"));
  CHECK(told([&] { make_keys(keys, kHour); }).find("is not empty") != std::string::npos);
}

TEST_CASE("keys: a folder that is there and empty is taken, however it is named", "[bus]") {
  // Oracle: the stated rule.
  const ScratchFolder folder;
  fs::create_directory(folder / "there");
  fs::create_directory_symlink(folder / "there", folder / "link");
  CHECK_NOTHROW(make_keys(folder / "link", kHour));
  CHECK(fs::is_symlink(folder / "link"));
  CHECK_NOTHROW(check_keys(folder / "there", "haptics"));
  CHECK_NOTHROW(make_keys((folder / "new").string() + "/", kHour));
  CHECK_NOTHROW(check_keys(folder / "new", "haptics"));
  CHECK(is_bad_input([&] { make_keys(folder / std::string(300, 'k'), kHour); }));
}

TEST_CASE("keys: a full disk leaves none of them, nor a folder that was not there", "[bus]") {
  // Oracle: the folder; a limit on the size of files fails where a full disk does. Of the files the
  // authority's certificate is the shortest: some are written before one is too long. No bad input:
  // exit code 1, as of every full disk.
  const ScratchFolder folder;
  const fs::path keys = folder / "keys", empty = folder / "empty";
  fs::create_directory(empty);
  {
    const FileSizeLimit limit(1000);
    for (const auto& place : {keys, empty}) {
      const std::string said = told([&] { make_keys(place, kHour); });
      CHECK(said == (place / "governance.p7s").string() + ": No space left on device");
      CHECK_FALSE(is_bad_input([&] { make_keys(place, kHour); }));
    }
  }
  CHECK_FALSE(fs::exists(keys));
  CHECK(fs::is_empty(empty));
  CHECK_NOTHROW(make_keys(keys, kHour));
}

TEST_CASE("keys: what is missing is named", "[bus]") {
  // Oracle: the texts.
  const ScratchFolder folder;
  CHECK(told([&] { keyed_process(folder.path(), "haptics", own_options()); }) ==
        "keys: " + (folder / "authority.pem").string() +
            ": no such file; `palpate keys` makes them");
  CHECK(told([&] { keyed_process(folder.path(), "nobody", own_options()); }) ==
        "keys: there is no role 'nobody'");
}

TEST_CASE("keys: roles of one session hear each other, messages of many datagrams too", "[bus]") {
  // Oracle: identity of what was sent; no packet is refused on either side.
  const ScratchFolder folder;
  const fs::path keys = folder / "keys";
  make_keys(keys, kHour);
  const BusOptions options = own_options();
  const auto deformation = keyed_process(keys, "deformation", options);
  const auto collision = keyed_process(keys, "collision", options);
  auto writer = deformation->writer(kNodePositions);
  auto reader = collision->reader(kNodePositions);
  REQUIRE(
      wait_until([&] { return writer.matched_readers() == 1 && reader.matched_writers() == 1; }));
  for (const std::size_t nodes : {std::size_t{4}, std::size_t{19'362}}) {
    NodePositions sent, received;
    sent.positions.assign(3 * nodes, 0.5f);
    REQUIRE(wait_until([&] {
      writer.write(sent);
      return take_soon(reader, received, 0.2) && received.positions.size() == 3 * nodes;
    }));
  }
  CHECK(deformation->packets_refused().count == 0);
  CHECK(collision->packets_refused().count == 0);
}

TEST_CASE("keys: a role writes and reads what is its own", "[bus]") {
  // Oracle: roles.h; the refusal says role and topic.
  const ScratchFolder folder;
  const fs::path keys = folder / "keys";
  make_keys(keys, kHour);
  const BusOptions options = own_options();
  const auto haptics = keyed_process(keys, "haptics", options);
  const auto viewer = keyed_process(keys, "viewer", options);
  CHECK(told([&] { haptics->writer(kHapticForce); }) == "accepted");
  CHECK(told([&] { haptics->writer(kNodePositions); }) ==
        "DDS refused a writer of node_positions: role haptics may have none");
  CHECK(told([&] { haptics->reader(kNodePositions); }) ==
        "DDS refused a reader of node_positions: role haptics may have none");
  CHECK(told([&] { viewer->reader(kNodePositions); }) == "accepted");
  CHECK(told([&] { viewer->writer(kSessionControl); }) ==
        "DDS refused a writer of session_control: role viewer may have none");
}

TEST_CASE("keys: without keys nothing is read or written", "[bus]") {
  // Oracle: counts on both sides, while the session goes on.
  const ScratchFolder folder;
  make_keys(folder / "keys", kHour);
  const BusOptions options = own_options();
  Felt felt(folder / "keys", options);
  REQUIRE(felt.matched());
  const auto stranger = keyed_process({}, "haptics", options);
  check_shut_out(felt, *stranger, *stranger);
}

TEST_CASE("keys: with those of another session nothing is read or written", "[bus]") {
  // Oracle: counts on both sides, while the session goes on.
  const ScratchFolder folder;
  make_keys(folder / "keys", kHour);
  make_keys(folder / "others", kHour);
  const BusOptions options = own_options();
  Felt felt(folder / "keys", options);
  REQUIRE(felt.matched());
  const auto listener = keyed_process(folder / "others", "viewer", options);
  const auto speaker = keyed_process(folder / "others", "haptics", options);
  check_shut_out(felt, *listener, *speaker);
}

TEST_CASE("keys: with expired ones of the session nothing is read or written", "[bus]") {
  // Oracle: counts on both sides. Signed by the session's own authority, and good when the process
  // began; a later one does not even begin. Two begin in the short time, on a busy machine, too.
  constexpr std::chrono::seconds kShort(4);
  const ScratchFolder folder;
  const Authority authority(valid_from_now(kHour));
  write_keys(folder / "keys", authority, valid_from_now(kHour));
  const Validity validity = valid_from_now(kShort);
  write_keys(folder / "old", authority, validity);
  const BusOptions options = own_options();
  const auto listener = keyed_process(folder / "old", "viewer", options);
  const auto speaker = keyed_process(folder / "old", "haptics", options);
  std::this_thread::sleep_until(validity.to + std::chrono::seconds(1));
  Felt felt(folder / "keys", options);
  REQUIRE(felt.matched());
  check_shut_out(felt, *listener, *speaker);
  CHECK(told([&] { keyed_process(folder / "old", "viewer", options); }) ==
        "keys: " + (folder / "old/viewer.pem").string() + ": expired at " + text_of(validity.to) +
            "; `palpate keys` makes new ones");
}

}  // namespace palpate::bus
