#include "modules/bus/key_check.h"

#include <sys/stat.h>

#include <array>
#include <catch2/catch.hpp>
#include <fstream>
#include <functional>

#include "modules/bus/keys.h"
#include "modules/core/error.h"
#include "tests/scratch_folder.h"

namespace palpate::bus {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::hours kKeyHour(1);

std::string said_of(const fs::path& folder, const char* role = "haptics") {
  try {
    check_keys(folder, role);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

void overwrite(const fs::path& from, const fs::path& to) {
  fs::copy_file(from, to, fs::copy_options::overwrite_existing);
}

}  // namespace

TEST_CASE("key check: each wrong file is named, with what is wrong and what to do", "[bus]") {
  // Oracle: the texts. One file at a time of a sound folder is another's.
  const ScratchFolder scratch;
  const fs::path keys = scratch / "keys", others = scratch / "others";
  make_keys(others, kKeyHour);
  const KeyFiles other = key_files(others, "haptics"), viewer = key_files(keys, "viewer");
  const KeyFiles own = key_files(keys, "haptics");
  const std::string kCopy =
      "; copy authority.pem, governance.p7s and the role's three files from "
      "one folder of `palpate keys`";
  const std::string kForeign = "is not signed by the authority.pem beside it" + kCopy;
  const auto write = [](const fs::path& file) {
    return [file] { std::ofstream(file) << "nothing\n"; };
  };
  const auto put = [](const fs::path& from, const fs::path& to) {
    return [=] { overwrite(from, to); };
  };
  struct Wrong {
    std::function<void()> make;
    fs::path file;
    std::string what;
  };
  for (const Wrong& wrong : std::vector<Wrong>{
           {put(other.authority, own.authority), own.certificate, kForeign},
           {put(other.certificate, own.certificate), own.certificate, kForeign},
           {put(other.key, own.key), own.key, "is not the key of haptics.pem" + kCopy},
           {put(other.governance, own.governance), own.governance, kForeign},
           {put(other.permissions, own.permissions), own.permissions, kForeign},
           {put(viewer.certificate, own.certificate), own.certificate, "is of role viewer" + kCopy},
           {put(viewer.permissions, own.permissions), own.permissions, "is of 'CN=viewer'" + kCopy},
           {write(own.authority), own.authority, "is no certificate" + kCopy},
           {write(own.certificate), own.certificate, "is no certificate" + kCopy},
           {write(own.key), own.key, "is no key" + kCopy},
           {write(own.governance), own.governance, kForeign},
           {[&] { fs::remove(own.key); }, own.key, "no such file; `palpate keys` makes them"}}) {
    fs::remove_all(keys);
    make_keys(keys, kKeyHour);
    REQUIRE(said_of(keys) == "accepted");
    wrong.make();
    CHECK(said_of(keys) == "keys: " + wrong.file.string() + ": " + wrong.what);
  }
}

TEST_CASE("key check: a key that others may read is refused as ssh does, certificates may be",
          "[bus]") {
  // Oracle: the text by hand, for each right that others can have.
  const ScratchFolder scratch;
  const fs::path keys = scratch / "keys";
  make_keys(keys, kKeyHour);
  const KeyFiles own = key_files(keys, "haptics");
  for (const fs::path& file : {own.authority, own.governance, own.certificate, own.permissions}) {
    fs::permissions(file, fs::perms::others_read, fs::perm_options::add);
  }
  CHECK(said_of(keys) == "accepted");
  for (const auto right : {fs::perms::group_read, fs::perms::group_write, fs::perms::others_read,
                           fs::perms::others_write}) {
    fs::permissions(own.key, fs::perms::owner_read | right);
    CHECK(said_of(keys) == "keys: " + own.key.string() +
                               ": others may read or write it; chmod 600 it, and make new keys if "
                               "they did");
  }
  fs::permissions(own.key, fs::perms::owner_read);
  CHECK(said_of(keys) == "accepted");
}

TEST_CASE("key check: what is no file is told from one before it is opened", "[bus]") {
  // Oracle: the texts by hand. A FIFO that is opened would hold the test up.
  const ScratchFolder scratch;
  const fs::path keys = scratch / "keys";
  for (const std::size_t k : {0, 1, 2, 3, 4}) {
    fs::remove_all(keys);
    make_keys(keys, kKeyHour);
    const KeyFiles own = key_files(keys, "haptics");
    const fs::path file =
        std::array{own.authority, own.governance, own.certificate, own.key, own.permissions}[k];
    fs::remove(file);
    REQUIRE(::mkfifo(file.c_str(), 0600) == 0);
    CHECK(said_of(keys).starts_with("keys: " + file.string() + ": is no regular file; copy "));
  }
}

TEST_CASE("key check: a folder, or a file in it, that others may write to is refused", "[bus]") {
  // Oracle: the rule of ssh for what is trusted: nobody else could have put it there.
  const ScratchFolder scratch;
  const fs::path keys = scratch / "keys";
  make_keys(keys, kKeyHour);
  const KeyFiles own = key_files(keys, "haptics");
  for (const fs::path& place :
       {keys, own.authority, own.governance, own.certificate, own.permissions}) {
    const fs::perms before = fs::status(place).permissions();
    for (const fs::perms right : {fs::perms::group_write, fs::perms::others_write}) {
      fs::permissions(place, right, fs::perm_options::add);
      CHECK(said_of(keys) == "keys: " + place.string() +
                                 ": others may write to it; chmod go-w it, and make new keys if "
                                 "they did");
      fs::permissions(place, before);
      CHECK(said_of(keys) == "accepted");
    }
  }
}

TEST_CASE("key check: what was signed and then changed is refused", "[bus]") {
  // Oracle: one byte of each document.
  const ScratchFolder scratch;
  const fs::path keys = scratch / "keys";
  make_keys(keys, kKeyHour);
  for (const fs::path& file :
       {key_files(keys, "haptics").governance, key_files(keys, "viewer").permissions}) {
    std::ifstream in(file);
    std::string text(std::istreambuf_iterator<char>(in), {});
    const auto place = text.find("<dds>") + 1;
    text[place] = 'D';
    std::ofstream(file) << text;
  }
  CHECK(said_of(keys).find("governance.p7s: is not signed") != std::string::npos);
  CHECK(said_of(keys, "viewer").find(" is not signed") != std::string::npos);
}

TEST_CASE("key check: what has expired, or does not hold yet, is told with its time", "[bus]") {
  // Oracle: the validity that each was given; the authority's, the role's.
  const ScratchFolder scratch;
  const Validity now = valid_from_now(kKeyHour);
  const Validity past{now.from - kKeyHour, now.from}, later{now.to, now.to + kKeyHour};
  write_keys(scratch / "old", Authority(now), past);
  write_keys(scratch / "early", Authority(now), later);
  write_keys(scratch / "ended", Authority(past), now);
  CHECK(said_of(scratch / "old") == "keys: " + (scratch / "old/haptics.pem").string() +
                                        ": expired at " + text_of(past.to) +
                                        "; `palpate keys` makes new ones");
  CHECK(said_of(scratch / "early") == "keys: " + (scratch / "early/haptics.pem").string() +
                                          ": holds from " + text_of(later.from) +
                                          " on: is this host's clock right?");
  CHECK(said_of(scratch / "ended").find("authority.pem: expired at " + text_of(past.to)) !=
        std::string::npos);
}

TEST_CASE("key check: every role of a fresh folder is accepted, one that is none is refused",
          "[bus]") {
  // Oracle: roles.h, by some of its names.
  const ScratchFolder scratch;
  make_keys(scratch / "keys", kKeyHour);
  for (const char* role : {"palpate", "deformation", "collision", "haptics", "visualizer",
                           "recorder", "driver", "viewer"}) {
    CHECK(said_of(scratch / "keys", role) == "accepted");
  }
  CHECK(said_of(scratch / "keys", "nobody") == "keys: there is no role 'nobody'");
}

}  // namespace palpate::bus
