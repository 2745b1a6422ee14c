#include "modules/runtime/snapshot.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <limits>
#include <string_view>

#include "modules/core/crc32.h"
#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/core/state_archive.h"
#include "modules/core/whole_file.h"
#include "modules/runtime/program.h"
#include "modules/scene/scene_reader.h"

namespace palpate::runtime {
namespace {

// The file: these words, a line of its format's number, whose it is and what is in it as a
// StateArchive's bytes, the CRC-32 of all. The number changes with this form, and where what a
// module remembers means something else; that it has other members, its fingerprints tell.
constexpr std::string_view kWords = "palpate snapshot";
constexpr int kFormat = 2;
constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;
constexpr const char* kNoSnapshot = ": is no snapshot (palpate run --snapshot-at)";

struct Contents {
  std::string scene, digest;
  std::int64_t time_ns = 0;
  std::vector<std::string> names;
  std::vector<std::vector<std::uint8_t>> states;  ///< in their order
  void exchange(StateArchive& archive) { archive(scene, digest, time_ns, names, states); }
};

std::string first_line() { return std::string(kWords) + ' ' + std::to_string(kFormat); }

bool begins_as_snapshot(const std::filesystem::path& file) {
  std::string words(kWords.size(), ' ');
  return std::ifstream(file, std::ios::binary).read(words.data(), std::ssize(words)) &&
         words == kWords;
}

std::vector<std::uint8_t> bytes_of(const std::filesystem::path& file) {
  open_input(file);
  if (std::filesystem::file_size(file) > kWords.size() && !begins_as_snapshot(file)) {
    throw InputError(file.string() + kNoSnapshot);  // however long it is
  }
  const std::string text = read_input(file, kMostBytes);
  if (text.empty()) throw InputError(file.string() + ": is empty");
  return {text.begin(), text.end()};
}

/// Between its first line and its CRC, which are right.
std::span<const std::uint8_t> checked(std::span<const std::uint8_t> bytes,
                                      const std::filesystem::path& file) {
  const std::size_t begin = std::min(kWords.size(), bytes.size());
  if (std::memcmp(bytes.data(), kWords.data(), begin) != 0) {
    throw InputError(file.string() + kNoSnapshot);
  }
  std::uint32_t crc = 0;
  const bool long_enough = bytes.size() >= kWords.size() + sizeof crc;
  if (long_enough) std::memcpy(&crc, bytes.data() + bytes.size() - sizeof crc, sizeof crc);
  if (!long_enough || crc != crc32(bytes.first(bytes.size() - sizeof crc))) {
    throw InputError(file.string() + ": is torn or damaged");
  }
  const auto line_end = std::ranges::find(bytes, std::uint8_t{'\n'});
  const std::string line(bytes.begin(), line_end);
  if (line != first_line()) {
    const std::string number = line.substr(kWords.size(), 8);  // the first form had none
    throw InputError(file.string() + ": a snapshot of format" + (number.empty() ? " 1" : number) +
                     ", this program takes format " + std::to_string(kFormat) +
                     ": another build took it");
  }
  return bytes.subspan(line.size() + 1, bytes.size() - line.size() - 1 - sizeof crc);
}

}  // namespace

void check_snapshot_name(const std::filesystem::path& file, bool overwrite,
                         const std::string& to_overwrite) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_type type = fs::status(file, error).type();  // of a link what it names
  if (type == fs::file_type::none) throw InputError(file.string() + ": " + error.message());
  const bool is_there = type != fs::file_type::not_found;
  if (is_there && (type != fs::file_type::regular || !begins_as_snapshot(file))) {
    throw InputError(file.string() + ": is no snapshot, and is not replaced by one");
  }
  const FileInTheMaking making(file);  // nothing comes of it yet
  if (is_there && !overwrite) {
    throw InputError(file.string() + ": is there already; give another name, or " + to_overwrite);
  }
}

std::int64_t snapshot_time(const scene::Scene& scene, std::int64_t time_ns) {
  std::int64_t first_ns = std::numeric_limits<std::int64_t>::max();
  for (const std::string_view module : kModules) {
    if (!remembers(module)) continue;
    const std::int64_t period_ns = CycleGrid(rate_of(module, scene)).period_ns();
    first_ns = std::min(first_ns, (time_ns + period_ns - 1) / period_ns * period_ns);
  }
  return first_ns;
}

bool remembers(std::string_view module) {
  const std::string_view job = module_named(module).value().job;
  return job != "visualizer" && job != "recorder";
}

void go_on_from(const Snapshot& snapshot, const std::filesystem::path& file,
                const std::string& module, LockstepCursor& cursor, Stage& stage,
                std::span<bus::Output* const> outputs) {
  cursor.begin_at(snapshot.time_ns);
  if (!remembers(module)) return;
  const auto state = snapshot.modules.find(module);
  if (state == snapshot.modules.end()) {
    throw InputError(file.string() + ": does not have the state of " + module);
  }
  StateArchive archive(state->second);
  try {
    cursor.exchange(archive, stage, outputs, snapshot.time_ns);
    if (!archive.left().empty()) throw InputError(StateArchive::kOtherLayout);
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + module + ": " + error.what());
  }
}

void add_to(Snapshot& snapshot, const std::string& module, LockstepCursor& cursor, Stage& stage,
            std::span<bus::Output* const> outputs) {
  if (!remembers(module)) return;
  StateArchive archive;
  cursor.exchange(archive, stage, outputs, snapshot.time_ns);
  snapshot.modules[module] = archive.bytes();
}

void write_snapshot(const std::filesystem::path& file, const scene::Scene& scene,
                    const Snapshot& snapshot) {
  std::string version = version_text();
  Contents contents{scene.name, scene::scene_digest(scene), snapshot.time_ns, {}, {}};
  for (const auto& [name, state] : snapshot.modules) {
    contents.names.push_back(name);
    contents.states.push_back(state);
  }
  StateArchive archive;
  archive(version);
  archive(contents);
  const std::string line = first_line() + '\n';
  std::vector<std::uint8_t> bytes(line.begin(), line.end());
  bytes.insert(bytes.end(), archive.bytes().begin(), archive.bytes().end());
  const std::uint32_t crc = crc32(bytes);
  bytes.resize(bytes.size() + sizeof crc);
  std::memcpy(bytes.data() + bytes.size() - sizeof crc, &crc, sizeof crc);

  write_whole_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Snapshot read_snapshot(const std::filesystem::path& file, const scene::Scene& scene) {
  const std::vector<std::uint8_t> bytes = bytes_of(file);
  StateArchive archive(checked(bytes, file));
  std::string version;
  archive(version);
  if (version != version_text()) {
    throw InputError(file.string() + ": a snapshot of " + version + ", this is " + version_text() +
                     ": a state is that of one version");
  }
  Contents contents;
  archive(contents);
  const std::string digest = scene::scene_digest(scene);
  if (contents.digest != digest) {
    throw InputError(file.string() + ": a snapshot of scene '" + contents.scene + "' (digest " +
                     contents.digest + "), not of this one (digest " + digest +
                     "): it goes on with a scene of the same keys, meshes and settings");
  }
  Snapshot snapshot{contents.time_ns};
  for (std::size_t i = 0; i < std::min(contents.names.size(), contents.states.size()); ++i) {
    snapshot.modules[contents.names[i]] = std::move(contents.states[i]);
  }
  return snapshot;
}

}  // namespace palpate::runtime
