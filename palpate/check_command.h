// `palpate check`: what a scene holds and what it costs on this machine.
#pragma once

#include <filesystem>
#include <iosfwd>

namespace palpate::launcher {

/// Prints the resolved scene, then of each organ its size, mass, volume and stable step, then what
/// a step costs here, measured for about `measure_for` seconds, and the real-time factor that
/// allows. @throws InputError for a scene or mesh that cannot be used
int check_command(const std::filesystem::path& scene, double measure_for, std::ostream& out);

}  // namespace palpate::launcher
