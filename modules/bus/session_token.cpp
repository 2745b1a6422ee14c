#include "modules/bus/session_token.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "modules/core/error.h"

namespace palpate::bus {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSecretBytes = 32;
constexpr int kHex = 16;

constexpr int kMaxDomain = 200;  // higher ones have ports beyond 65535 for many participants
constexpr std::size_t kMaxSessionBytes = 64;

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

[[noreturn]] void refuse(const fs::path& file, const std::string& why) {
  throw InputError("the user's secret for session tokens, " + file.string() + ": " + why +
                   "; PALPATE_TOKEN in the environment of all programs does without it");
}

std::array<char, kSecretBytes> random_bytes() {
  std::array<char, kSecretBytes> bytes;
  // So few bytes come whole.
  if (::getrandom(bytes.data(), bytes.size(), 0) != kSecretBytes) {
    throw std::runtime_error("the kernel gives no random numbers");
  }
  return bytes;
}

// Whole or not at all, and once: programs that start together get the same.
void make_secret(const fs::path& file) {
  std::string made = file.string() + ".XXXXXX";
  const Descriptor descriptor(::mkostemp(made.data(), O_CLOEXEC));  // readable by its owner alone
  if (descriptor.number() < 0) refuse(file, std::strerror(errno));
  const auto bytes = random_bytes();
  const bool written = ::write(descriptor.number(), bytes.data(), kSecretBytes) == kSecretBytes;
  const bool linked = written && (::link(made.c_str(), file.c_str()) == 0 || errno == EEXIST);
  const int failure = errno;
  ::unlink(made.c_str());
  if (!linked) refuse(file, std::strerror(failure));
}

std::uint64_t token_from(const std::string& text) {
  std::uint64_t token = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, token, kHex);
  if (parsed.ec == std::errc() && parsed.ptr == end && !text.starts_with('-')) return token;
  throw InputError("PALPATE_TOKEN: \"" + text + "\": allowed are 1 to 16 hex digits");
}

}  // namespace

void check_session(int domain, const std::string& session) {
  if (domain < 0 || domain > kMaxDomain) {
    throw InputError("domain: " + std::to_string(domain) + ": allowed are 0 to " +
                     std::to_string(kMaxDomain));
  }
  // A partition with * ? [ ] would match other sessions.
  const bool plain = session.find_first_not_of(
                         "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                         "0123456789_-.") == std::string::npos;
  if (session.empty() || session.size() > kMaxSessionBytes || !plain) {
    throw InputError("session: \"" + session + "\": allowed are 1 to " +
                     std::to_string(kMaxSessionBytes) + " letters, digits, '_', '-', '.'");
  }
}

fs::path user_secret_file() {
  const char* const named = std::getenv("XDG_RUNTIME_DIR");
  const std::string user = std::to_string(::geteuid());
  for (const fs::path& folder :
       {fs::path(named == nullptr ? "" : named), "/run/user" / fs::path(user)}) {
    if (folder.is_absolute() && ::access(folder.c_str(), W_OK | X_OK) == 0) {
      return folder / "palpate.secret";
    }
  }
  return "/tmp/palpate-" + user + ".secret";
}

std::string user_secret(const fs::path& file) {
  // Without O_NONBLOCK another user's FIFO of that name would hold up every program here.
  const auto open = [&] {
    return ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  };
  int number = open();
  if (number < 0 && errno == ENOENT) {
    make_secret(file);
    number = open();
  }
  const Descriptor descriptor(number);
  if (number < 0) refuse(file, std::strerror(errno));
  struct stat status {};
  if (::fstat(number, &status) != 0) refuse(file, std::strerror(errno));
  if (!S_ISREG(status.st_mode)) refuse(file, "is no regular file");
  if (status.st_uid != ::geteuid()) refuse(file, "belongs to another user");
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) refuse(file, "others may read or write it");
  std::string secret(kSecretBytes, '\0');
  if (::read(number, secret.data(), secret.size()) != kSecretBytes) refuse(file, "is too short");
  return secret;
}

std::uint64_t session_token(int domain, const std::string& session) {
  check_session(domain, session);
  if (const char* const given = std::getenv("PALPATE_TOKEN"); given != nullptr) {
    return token_from(given);
  }
  const std::string text = user_secret(user_secret_file()) + std::to_string(domain) + '/' + session;
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  if (EVP_Digest(text.data(), text.size(), digest.data(), nullptr, EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("OpenSSL refuses SHA-256");
  }
  std::uint64_t token = 0;
  std::memcpy(&token, digest.data(), sizeof token);
  return token;
}

std::string token_text(std::uint64_t token) {
  std::string text(2 * sizeof token, '0');
  std::array<char, 2 * sizeof token> digits;
  const auto end = std::to_chars(digits.begin(), digits.end(), token, kHex).ptr;
  const std::size_t count = static_cast<std::size_t>(end - digits.begin());
  text.replace(text.size() - count, count, digits.begin(), count);
  return text;
}

}  // namespace palpate::bus
