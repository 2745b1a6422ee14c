#include "modules/bus/session_token.h"

#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <set>
#include <thread>

#include "modules/core/error.h"
#include "tests/scratch_folder.h"

namespace palpate::bus {
namespace {

/// A variable of the environment, for as long as this lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  ~Variable() { before_.empty() ? ::unsetenv(name_) : ::setenv(name_, before_.c_str(), 1); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::string before_;
};

template <class F>
std::string refusal(const F& f) {
  try {
    f();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("session token: the user's secret is made once, for him alone", "[bus]") {
  // Oracle: the file: 32 bytes, mode 0600, nothing beside it; whoever asks again gets the same.
  const ScratchFolder folder;
  const auto file = folder / "secret";
  const std::string secret = user_secret(file);
  CHECK(secret.size() == 32);
  CHECK(text_in(file) == secret);
  CHECK(folder.file_count() == 1);
  struct stat status {};
  REQUIRE(::stat(file.c_str(), &status) == 0);
  CHECK((status.st_mode & 07777) == 0600);
  CHECK(user_secret(file) == secret);
  CHECK(user_secret(folder / "other") != secret);
}

TEST_CASE("session token: programs that start together get one secret", "[bus]") {
  // Oracle: they all say the same.
  const ScratchFolder folder;
  std::vector<std::string> secrets(8);
  {
    std::vector<std::jthread> threads;
    for (std::string& secret : secrets) {
      threads.emplace_back([&] { secret = user_secret(folder / "secret"); });
    }
  }
  CHECK(std::set<std::string>(secrets.begin(), secrets.end()).size() == 1);
  CHECK(folder.file_count() == 1);
}

TEST_CASE("session token: a secret that others may read, or that is cut, is refused by name",
          "[bus]") {
  // Oracle: the texts, with the file and what does without it.
  const ScratchFolder folder;
  const auto open = folder.write("open", std::string(32, 'x'));
  ::chmod(open.c_str(), 0644);
  const auto cut = folder.write("cut", "x");
  ::chmod(cut.c_str(), 0600);
  std::filesystem::create_symlink(cut, folder / "link");
  const auto told = [&](const std::filesystem::path& file) {
    return refusal([&] { user_secret(file); });
  };
  CHECK(told(open) == "the user's secret for session tokens, " + open.string() +
                          ": others may read or write it; PALPATE_TOKEN in the environment of all "
                          "programs does without it");
  CHECK(told(cut).find("is too short") != std::string::npos);
  CHECK(told(folder / "link").find("symbolic links") != std::string::npos);
  CHECK(told(folder / "none" / "secret").find("No such file") != std::string::npos);
}

TEST_CASE("session token: what is no regular file is refused at once, a FIFO too", "[bus]") {
  // Oracle: the text; to open a FIFO for reading waits for a writer, and here comes none.
  const ScratchFolder folder;
  REQUIRE(::mkfifo((folder / "fifo").c_str(), 0600) == 0);
  std::filesystem::create_directory(folder / "folder");
  std::filesystem::permissions(folder / "folder", std::filesystem::perms::owner_all);
  for (const char* name : {"fifo", "folder"}) {
    CHECK_THAT(refusal([&] { user_secret(folder / name); }),
               Catch::Contains(std::string(name) + ": is no regular file; PALPATE_TOKEN"));
  }
}

TEST_CASE("session token: one per session, domain and user, the same each time", "[bus]") {
  // Oracle: all different; a second folder stands for another user, or another host.
  const ScratchFolder mine, another;
  std::set<std::uint64_t> tokens;
  {
    const Variable folder("XDG_RUNTIME_DIR", mine.path());
    for (const char* session : {"default", "lab", "1"}) {
      for (const int domain : {0, 1, 11}) tokens.insert(session_token(domain, session));
    }
    CHECK(session_token(0, "lab") == session_token(0, "lab"));
    CHECK(std::filesystem::exists(mine / "palpate.secret"));
  }
  const Variable folder("XDG_RUNTIME_DIR", another.path());
  tokens.insert(session_token(0, "lab"));
  CHECK(tokens.size() == 10);
}

TEST_CASE("session token: PALPATE_TOKEN is taken as it is, or refused by name", "[bus]") {
  // Oracle: the number, and the text that the contract promises.
  for (const auto& [text, token] : std::vector<std::pair<std::string, std::uint64_t>>{
           {"0", 0}, {"00ff", 255}, {"FEDCBA9876543210", 0xfedcba9876543210}}) {
    const Variable given("PALPATE_TOKEN", text);
    CHECK(session_token(0, "lab") == token);
    CHECK(session_token(7, "other") == token);
  }
  for (const std::string text : {"", "x", "-1", "0x1", "1 ", "10000000000000000"}) {
    const Variable given("PALPATE_TOKEN", text);
    CHECK(refusal([] { session_token(0, "lab"); }) ==
          "PALPATE_TOKEN: \"" + text + "\": allowed are 1 to 16 hex digits");
  }
}

TEST_CASE("session token: its text is read back as it was", "[bus]") {
  // Oracle: identity, through the environment as users do it.
  for (const std::uint64_t token : {std::uint64_t{0}, std::uint64_t{0xabc}, ~std::uint64_t{0}}) {
    CHECK(token_text(token).size() == 16);
    const Variable given("PALPATE_TOKEN", token_text(token));
    CHECK(session_token(0, "lab") == token);
  }
}

}  // namespace palpate::bus
