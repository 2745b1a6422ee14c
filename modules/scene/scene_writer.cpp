// resolved_text() and scene_digest() of scene_reader.h.
#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>

#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/yaml_writer.h"

namespace palpate::scene {
namespace {

/// FNV-1a, 64 bit (Fowler, Noll, Vo; IETF draft-eastlake-fnv): order-dependent, the same on every
/// machine. Guards against mistakes, not against forgery.
class Digest {
 public:
  void add(const char* bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      state_ = (state_ ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3ULL;
    }
  }
  void add_file(const std::filesystem::path& file) {
    std::ifstream stream = open_input(file);
    std::array<char, 1 << 16> block;
    std::uint64_t size = 0;
    while (stream.read(block.data(), block.size()) || stream.gcount() > 0) {
      add(block.data(), static_cast<std::size_t>(stream.gcount()));
      size += static_cast<std::uint64_t>(stream.gcount());
    }
    if (!stream.eof()) throw InputError(file.string() + ": cannot be read");
    const std::string length = std::to_string(size) + "\n";  // ends one file, begins another
    add(length.data(), length.size());
  }
  std::string text() const {
    std::array<char, 17> digits;
    std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(state_));
    return digits.data();
  }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

YamlWriter written(Scene scene, YamlWriter::FileNames file_names) {
  YamlWriter writer(file_names);
  describe(writer, scene);
  return writer;
}

}  // namespace

std::string resolved_text(const Scene& scene) {
  return written(scene, YamlWriter::FileNames::kFull).text();
}

std::string scene_digest(const Scene& scene) {
  Scene unnamed = scene;
  unnamed.name.clear();
  const YamlWriter writer = written(std::move(unnamed), YamlWriter::FileNames::kOnlyFormat);
  Digest digest;
  digest.add(writer.text().data(), writer.text().size());
  for (const auto& file : writer.files()) digest.add_file(file);
  return digest.text();
}

}  // namespace palpate::scene
