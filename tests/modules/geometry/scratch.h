// Files and small surfaces for the tests of this folder.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry::test {

/// A folder of its own that vanishes with the test.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "palpate_test_XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }
  std::size_t file_count() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

inline std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Both surfaces in one, the second one's indices shifted.
inline TriangleSurface both(TriangleSurface first, const TriangleSurface& second) {
  const auto offset = static_cast<std::uint32_t>(first.nodes.size());
  first.nodes.insert(first.nodes.end(), second.nodes.begin(), second.nodes.end());
  for (const auto& [a, b, c] : second.triangles) {
    first.triangles.push_back({a + offset, b + offset, c + offset});
  }
  return first;
}

inline TriangleSurface moved(TriangleSurface surface, const Vec3& by) {
  for (Vec3& node : surface.nodes) node += by;
  return surface;
}

inline TriangleSurface inside_out(TriangleSurface surface) {
  for (Triangle& triangle : surface.triangles) std::swap(triangle[1], triangle[2]);
  return surface;
}

/// Every triangle with nodes of its own, as in an STL file.
inline TriangleSurface exploded(const TriangleSurface& surface) {
  TriangleSurface result;
  for (const Triangle& triangle : surface.triangles) {
    const auto next = static_cast<std::uint32_t>(result.nodes.size());
    for (const std::uint32_t node : triangle) result.nodes.push_back(surface.nodes[node]);
    result.triangles.push_back({next, next + 1, next + 2});
  }
  return result;
}

/// Asserts that `call` throws `Error` and returns its message.
template <typename Error, typename Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  FAIL("nothing was thrown");
  return {};
}

}  // namespace palpate::geometry::test
