#include "modules/geometry/ply_bytes.h"

namespace palpate::geometry {

void protect_first_data_byte(std::string& ply) {
  if (ply.compare(0, 3, "ply") != 0) return;
  const std::size_t mark = ply.find("end_header");
  if (mark == std::string::npos || ply.substr(0, mark).find("format binary") == std::string::npos) {
    return;
  }
  const std::size_t line_end = ply.find('\n', mark);
  if (line_end == std::string::npos || line_end + 1 >= ply.size()) return;
  char& first = ply[line_end + 1];
  if (first == '\n' || first == '\r') first = static_cast<char>(first ^ 1);
}

}  // namespace palpate::geometry
