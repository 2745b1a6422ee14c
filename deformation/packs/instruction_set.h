// Which registers the CPU at hand has. What passes over all springs or tetrahedra is compiled for
// several instruction sets.
#pragma once

#include <cstdint>
#include <vector>

namespace palpate::deformation {

enum class InstructionSet : std::uint8_t { kPortable, kAvx2, kAvx512 };

const char* name_of(InstructionSet set);
/// Those this CPU has, from the slowest on.
std::vector<InstructionSet> available_instruction_sets();

}  // namespace palpate::deformation
