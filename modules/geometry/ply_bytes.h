// A guard against a fault of assimp's PLY reader.
#pragma once

#include <string>

namespace palpate::geometry {

/// assimp 5.2 takes line ends after "end_header" for part of the header. In a binary PLY the first
/// byte of the data may look like one (0x0a, 0x0d): it would be lost and all numbers shifted. Flips
/// that byte's lowest bit: of a little-endian float that is the last digit, one part in 10⁷.
/// Anything else is left as it is.
void protect_first_data_byte(std::string& ply);

}  // namespace palpate::geometry
