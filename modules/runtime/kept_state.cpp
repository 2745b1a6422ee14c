#include "modules/runtime/kept_state.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "modules/core/units.h"

namespace palpate::runtime {
namespace {

constexpr std::uint64_t kKeptWords = 0x3174'7065'6b20'7061;  // "ap kept1"
/// Two places are written in turn, far enough from each other; what lies between takes no memory.
constexpr std::uint64_t kFirstPlace = 4096, kApart = std::uint64_t{1} << 36;

std::uint64_t offset_of(std::uint64_t place) { return kFirstPlace + kApart * (place & 1); }

bool read_all(int descriptor, void* bytes, std::size_t size, std::uint64_t at) {
  auto* to = static_cast<std::uint8_t*>(bytes);
  while (size > 0) {
    const ssize_t got = pread(descriptor, to, size, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    to += got;
    at += static_cast<std::uint64_t>(got);
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

}  // namespace

KeptMemory::KeptMemory() : descriptor_(memfd_create("palpate_kept_state", MFD_CLOEXEC)) {
  if (descriptor_ < 0) {
    throw std::runtime_error(std::string("no memory for what processes keep: ") +
                             std::strerror(errno));
  }
}

KeptMemory::~KeptMemory() { close(descriptor_); }

/// Before the stage's own.
struct KeptState::Contents {
  std::string scene_digest;
  std::int64_t kept_ns = 0;
  std::uint32_t reset_count = 0;
  void exchange(StateArchive& archive) { archive(scene_digest, kept_ns, reset_count); }
};

KeptState::KeptState(std::optional<int> descriptor, std::string scene_digest)
    : descriptor_(descriptor.value_or(-1)), scene_digest_(std::move(scene_digest)) {}

std::optional<double> KeptState::give_back(Stage& stage, std::int64_t now_ns) {
  began_ns_ = now_ns;
  if (descriptor_ < 0 || !read_all(descriptor_, &mark_, sizeof mark_, 0) ||
      mark_.words != kKeptWords) {
    mark_ = {};
    return std::nullopt;
  }
  if (mark_.taken > 0) return std::nullopt;
  mark_.taken = 1;
  memory_.resize(mark_.size);
  const bool whole = read_all(descriptor_, memory_.data(), memory_.size(), offset_of(mark_.place));
  if (!whole || !write(&mark_, sizeof mark_, 0)) return std::nullopt;
  StateArchive archive(memory_);
  Contents contents;
  try {
    archive(contents);
    if (contents.scene_digest != scene_digest_) return std::nullopt;
    stage.exchange(archive);
  } catch (const std::exception& error) {
    throw std::runtime_error(std::string("what its predecessor kept cannot be read: ") +
                             error.what());
  }
  reset_count_ = contents.reset_count;
  tells_ = true;
  return seconds_from_ns(now_ns - contents.kept_ns);
}

void KeptState::tell(const SessionControl& last_command, Cycle& now) {
  now.goes_on = std::exchange(tells_, false);
  if (!reset_count_ || last_command.header.source_time_ns == 0) return;
  now.reset |= last_command.reset_count != *reset_count_;
  reset_count_.reset();
}

void KeptState::keep(Stage& stage, const SessionControl& last_command, std::int64_t now_ns) {
  if (descriptor_ < 0 || now_ns - kept_ns_ < ns_from_seconds(kEvery)) return;
  if (reset_count_) return;  // no command has come: there may have been a reset
  kept_ns_ = now_ns;
  if (now_ns - began_ns_ > ns_from_seconds(kTrusted)) mark_.taken = 0;
  StateArchive archive(std::move(memory_));
  Contents contents{scene_digest_, now_ns, last_command.reset_count};
  archive(contents);
  stage.exchange(archive);
  memory_ = std::move(archive).take_bytes();
  mark_.words = kKeptWords;
  mark_.place ^= 1;
  mark_.size = memory_.size();
  const bool kept = write(memory_.data(), memory_.size(), offset_of(mark_.place)) &&
                    write(&mark_, sizeof mark_, 0);
  if (!kept) descriptor_ = -1;  // what was kept before is all there will be
}

bool KeptState::write(const void* bytes, std::size_t size, std::uint64_t at) {
  const auto* from = static_cast<const std::uint8_t*>(bytes);
  while (size > 0) {
    const ssize_t put = pwrite(descriptor_, from, size, static_cast<off_t>(at));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    from += put;
    at += static_cast<std::uint64_t>(put);
    size -= static_cast<std::size_t>(put);
  }
  return true;
}

}  // namespace palpate::runtime
