#include "modules/geometry/off_file.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "modules/core/error.h"
#include "modules/geometry/mesh_text.h"
#include "modules/geometry/polygon_fan.h"

namespace palpate::geometry {
namespace {

struct Counts {
  std::size_t vertices = 0, faces = 0;
};

class OffReader {
 public:
  OffReader(std::string_view bytes, const std::filesystem::path& file)
      : bytes_(bytes), file_(file) {}

  TriangleSurface read() {
    const Counts counts = read_counts();
    TriangleSurface surface;
    for (std::size_t i = 0; i < counts.vertices; ++i) {
      surface.nodes.push_back(place("vertex " + of(i, counts.vertices)));
    }
    for (std::size_t i = 0; i < counts.faces; ++i) {
      add_fan(corners("face " + of(i, counts.faces), counts.vertices), surface);
    }
    if (next_line()) refuse("'" + start_of(line_) + "' comes after the last face");
    return surface;
  }

 private:
  /// Behind the word, on its line or the next; some files leave the space out, or the word.
  Counts read_counts() {
    if (!next_line()) refuse("must begin with 'OFF'");
    const std::string said = start_of(line_);
    for (const std::string_view prefix : {"ST", "C", "N"}) {
      if (line_.starts_with(prefix)) line_.remove_prefix(prefix.size());
    }
    if (line_.starts_with("OFF")) {
      line_.remove_prefix(3);
      if (mesh_words(line_).empty() && !next_line()) refuse("the counts are not there");
    } else if (line_.empty() || line_.front() < '0' || line_.front() > '9' ||
               line_.starts_with("4OFF")) {
      refuse("'" + said + "' must be OFF, STOFF, COFF or NOFF: places of three numbers, as text");
    }
    const auto words = mesh_words(line_);
    Counts counts;
    if (words.size() != 3 || !is_mesh_number(words[0], counts.vertices) ||
        !is_mesh_number(words[1], counts.faces)) {
      refuse("'" + start_of(line_) + "' must be the counts of vertices, faces and edges");
    }
    return counts;
  }

  Vec3 place(const std::string& what) {
    const auto words = words_of_next(what);
    Vec3 place;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (axis >= words.size() || !is_mesh_number(words[axis], place[Eigen::Index(axis)])) {
        refuse(what + " is '" + start_of(line_) + "'; must be x y z");
      }
    }
    return place;
  }

  std::span<const std::uint32_t> corners(const std::string& what, std::size_t vertices) {
    const auto words = words_of_next(what);
    std::size_t count = 0;
    if (!is_mesh_number(words[0], count)) {
      refuse(what + " begins with '" + std::string(words[0].substr(0, 40)) +
             "'; must be how many corners it has");
    }
    if (count >= words.size()) {
      refuse(what + " has " + std::to_string(count) + " corners and names " +
             std::to_string(words.size() - 1));
    }
    corners_.clear();
    for (const std::string_view word : std::span(words).subspan(1, count)) {
      std::uint32_t node = 0;
      if (!is_mesh_number(word, node) || node >= vertices) {
        refuse(what + " names vertex " + std::string(word.substr(0, 40)) + "; allowed: 0 to " +
               std::to_string(static_cast<long long>(vertices) - 1));
      }
      corners_.push_back(node);
    }
    return corners_;
  }

  std::vector<std::string_view> words_of_next(const std::string& what) {
    if (!next_line()) refuse(what + " is not there: the file ends before");
    return mesh_words(line_);
  }

  /// Without comments, and none that is blank. False at the file's end.
  bool next_line() {
    while (at_ < bytes_.size()) {
      const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
      line_ = bytes_.substr(at_, end - at_);
      line_ = line_.substr(0, line_.find('#'));
      line_.remove_prefix(std::min(line_.find_first_not_of(" \t\r"), line_.size()));
      at_ = end + 1;
      ++number_;
      if (!line_.empty()) return true;
    }
    return false;
  }

  static std::string of(std::size_t i, std::size_t count) {
    return std::to_string(i) + " of " + std::to_string(count);
  }
  static std::string start_of(std::string_view line) {
    line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
    return std::string(line.substr(0, 60));
  }
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(file_.string() + ":" + std::to_string(number_) + ": " + what);
  }

  std::string_view bytes_, line_;
  const std::filesystem::path& file_;
  std::size_t at_ = 0;
  int number_ = 0;
  std::vector<std::uint32_t> corners_;
};

}  // namespace

TriangleSurface parse_off(std::string_view bytes, const std::filesystem::path& file) {
  return OffReader(bytes, file).read();
}

}  // namespace palpate::geometry
