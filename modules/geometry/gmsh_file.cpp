#include "modules/geometry/gmsh_file.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "modules/core/error.h"
#include "modules/core/input_file.h"

namespace palpate::geometry {
namespace {

/// Gmsh's numbers of element kinds.
constexpr int kLine = 1, kTriangle = 2, kTetrahedron = 4, kPoint = 15;
/// A tetrahedron below this part of its longest edge cubed is flat.
constexpr double kFlatVolume = 1e-9;

std::string quoted(const std::string& text) {
  std::string result(1, '"');
  return result.append(text).append(1, '"');
}

/// "$Nodes" → "$EndNodes"
std::string end_of(const std::string& section) { return std::string("$End").append(section, 1); }

/// Lines of a file, with their numbers and the words in them.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& file) : file_(file), stream_(open_input(file)) {}

  /// @returns false at the end of the file
  bool next() {
    std::string line;
    if (!std::getline(stream_, line)) return false;
    ++number_;
    std::istringstream words(line);
    words_.clear();
    for (std::string word; words >> word;) words_.push_back(word);
    return true;
  }
  void demand_next(const std::string& section) {
    if (!next()) refuse("the file ends within " + section);
  }
  [[noreturn]] void refuse(const std::string& what) const { refuse_at(number_, what); }
  [[noreturn]] void refuse_at(std::size_t line, const std::string& what) const {
    throw InputError(file_.string() + ":" + std::to_string(line) + ": " + what);
  }

  std::size_t number() const { return number_; }
  std::string word(std::size_t i) const { return i < words_.size() ? words_[i] : ""; }

  double real(std::size_t i) const {
    const double value = parse<double>(i, "a number");
    if (!std::isfinite(value)) refuse(quoted(word(i)) + "; allowed: finite numbers");
    return value;
  }
  long integer(std::size_t i, long least) const {
    const long value = parse<long>(i, "a whole number");
    if (value < least) {
      refuse(quoted(word(i)) + "; allowed: whole numbers from " + std::to_string(least));
    }
    return value;
  }

 private:
  template <typename Number>
  Number parse(std::size_t i, const char* what) const {
    if (i >= words_.size()) {
      refuse("only " + std::to_string(words_.size()) + " words; " + what + " is missing");
    }
    const std::string& text = words_[i];
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) {
      refuse(quoted(text) + "; allowed: " + what);
    }
    return value;
  }

  std::filesystem::path file_;
  std::ifstream stream_;
  std::size_t number_ = 0;
  std::vector<std::string> words_;
};

struct FileTetrahedron {
  std::array<long, 4> nodes{};
  std::size_t line = 0;
};

struct FileContent {
  std::vector<Vec3> nodes;          ///< in the file's order
  std::map<long, std::size_t> ids;  ///< of the nodes
  std::vector<FileTetrahedron> tetrahedra;
};

void read_format(LineReader& lines) {
  lines.demand_next("$MeshFormat");
  if (lines.word(0) != "2.2" || lines.word(1) != "0") {
    lines.refuse("format " + quoted(lines.word(0) + ' ' + lines.word(1)) +
                 "; allowed: 2.2 0 (text; gmsh -format msh22)");
  }
}

void read_nodes(LineReader& lines, FileContent& content) {
  lines.demand_next("$Nodes");
  const long count = lines.integer(0, 1);
  for (long i = 0; i < count; ++i) {
    lines.demand_next("$Nodes");
    const long id = lines.integer(0, 1);
    if (!content.ids.emplace(id, content.nodes.size()).second) {
      lines.refuse("node " + std::to_string(id) + " stands twice");
    }
    content.nodes.emplace_back(lines.real(1), lines.real(2), lines.real(3));
  }
}

void read_elements(LineReader& lines, FileContent& content) {
  lines.demand_next("$Elements");
  const long count = lines.integer(0, 1);
  std::set<long> ids;
  for (long i = 0; i < count; ++i) {
    lines.demand_next("$Elements");
    const long id = lines.integer(0, 1), kind = lines.integer(1, 1), tags = lines.integer(2, 0);
    if (!ids.insert(id).second) lines.refuse("element " + std::to_string(id) + " stands twice");
    if (kind == kPoint || kind == kLine || kind == kTriangle) continue;
    if (kind != kTetrahedron) {
      lines.refuse("element kind " + std::to_string(kind) +
                   "; allowed: 4 (four-node tetrahedron), and 1, 2, 15, which are skipped");
    }
    FileTetrahedron tetrahedron{{}, lines.number()};
    for (std::size_t k = 0; k < 4; ++k) {
      const long node = lines.integer(3 + static_cast<std::size_t>(tags) + k, 1);
      if (content.ids.count(node) == 0) lines.refuse("no node " + std::to_string(node));
      tetrahedron.nodes[k] = node;
    }
    content.tetrahedra.push_back(tetrahedron);
  }
}

void skip_section(LineReader& lines, const std::string& name) {
  const std::string end = end_of(name);
  do {
    lines.demand_next(name);
  } while (lines.word(0) != end);
}

FileContent read_content(LineReader& lines) {
  FileContent content;
  bool format_known = false;
  while (lines.next()) {
    const std::string name = lines.word(0);
    if (name.empty()) continue;
    if (name[0] != '$') lines.refuse(quoted(name) + "; allowed: a section, $MeshFormat first");
    if (!format_known && name != "$MeshFormat") {
      lines.refuse(quoted(name) + "; allowed: $MeshFormat first");
    }
    if (name == "$MeshFormat") {
      read_format(lines);
      format_known = true;
    } else if (name == "$Nodes") {
      read_nodes(lines, content);
    } else if (name == "$Elements") {
      read_elements(lines, content);
    } else {
      skip_section(lines, name);
      continue;
    }
    lines.demand_next(name);
    if (lines.word(0) != end_of(name)) {
      lines.refuse(quoted(lines.word(0)) + "; allowed: " + end_of(name));
    }
  }
  if (content.tetrahedra.empty()) {
    lines.refuse(
        "no tetrahedra, which files of this kind are read as; convert a surface to .ply, "
        ".stl, .obj or .off first");
  }
  return content;
}

void check_shape(const LineReader& lines, const FileTetrahedron& tetrahedron,
                 const std::array<Vec3, 4>& x) {
  double longest = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < a; ++b) longest = std::max(longest, (x[a] - x[b]).norm());
  }
  const double volume = tetrahedron_volume(x[0], x[1], x[2], x[3]);
  if (volume > kFlatVolume * longest * longest * longest) return;
  lines.refuse_at(tetrahedron.line,
                  "the tetrahedron is flat or inside out; allowed: positive volume");
}

template <class Element>
void write(const std::vector<Vec3>& nodes, int kind, const std::vector<Element>& elements,
           std::ostream& out) {
  out.precision(17);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << nodes.size() << '\n';
  for (std::size_t i = 0; i < nodes.size(); ++i)
    out << i + 1 << ' ' << nodes[i].transpose() << '\n';
  out << "$EndNodes\n$Elements\n" << elements.size() << '\n';
  for (std::size_t k = 0; k < elements.size(); ++k) {
    out << k + 1 << ' ' << kind << " 2 1 1";
    for (const std::uint32_t node : elements[k]) out << ' ' << node + 1;
    out << '\n';
  }
  out << "$EndElements\n";
}

}  // namespace

TetMesh read_gmsh(const std::filesystem::path& file) {
  LineReader lines(file);
  const FileContent content = read_content(lines);
  std::vector<std::uint32_t> new_index(content.nodes.size(), 0);
  for (const auto& tetrahedron : content.tetrahedra) {
    for (const long id : tetrahedron.nodes) new_index[content.ids.at(id)] = 1;
  }
  TetMesh mesh;
  for (std::size_t i = 0; i < content.nodes.size(); ++i) {
    if (new_index[i] == 0) continue;
    new_index[i] = static_cast<std::uint32_t>(mesh.nodes.size());
    mesh.nodes.push_back(content.nodes[i]);
  }
  for (const auto& tetrahedron : content.tetrahedra) {
    auto& nodes = mesh.tetrahedra.emplace_back();
    std::array<Vec3, 4> corners;
    for (int k = 0; k < 4; ++k) {
      nodes[k] = new_index[content.ids.at(tetrahedron.nodes[k])];
      corners[k] = mesh.nodes[nodes[k]];
    }
    check_shape(lines, tetrahedron, corners);
  }
  return mesh;
}

void write_gmsh(const TriangleSurface& surface, const std::filesystem::path& file) {
  std::ofstream out(file);
  write(surface.nodes, kTriangle, surface.triangles, out);
  out.flush();
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
}

void write_gmsh(const TetMesh& mesh, std::ostream& out) {
  write(mesh.nodes, kTetrahedron, mesh.tetrahedra, out);
}

}  // namespace palpate::geometry
