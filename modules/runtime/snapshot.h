// A session at one instant of simulated time, to go on from: what each module remembers then.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "modules/runtime/lockstep.h"
#include "modules/scene/scene.h"

namespace palpate::runtime {

struct Snapshot {
  std::int64_t time_ns = 0;  ///< all cycles before it are done, none that begins at it
  std::map<std::string, std::vector<std::uint8_t>> modules = {};  ///< by name: a StateArchive's
};

/// Whether a module's cycles depend on earlier ones: the visualizer's and the recorder's do not.
bool remembers(std::string_view module);

/// The first instant from `time_ns` on at which a module that remembers begins a cycle [ns]: a
/// session is the same at all times from there back to the cycle before.
std::int64_t snapshot_time(const scene::Scene& scene, std::int64_t time_ns);

/// A module's part; begins at its time, with what it remembers.
/// @param file  for messages
/// @throws InputError if the snapshot does not have it, or it is not this module's
void go_on_from(const Snapshot& snapshot, const std::filesystem::path& file,
                const std::string& module, LockstepCursor& cursor, Stage& stage,
                std::span<bus::Output* const> outputs);
/// Adds it, of a module that remembers.
void add_to(Snapshot& snapshot, const std::string& module, LockstepCursor& cursor, Stage& stage,
            std::span<bus::Output* const> outputs);

/// Whether a snapshot may be written there: a folder that is there, and nothing of that name but,
/// to be replaced, a snapshot, or a link to one, which stays.
/// @param to_overwrite  how to ask for that, for the message
/// @throws InputError if not
void check_snapshot_name(const std::filesystem::path& file, bool overwrite,
                         const std::string& to_overwrite = "--overwrite");

/// Appears whole or not at all.
/// @throws std::runtime_error if it cannot be written
void write_snapshot(const std::filesystem::path& file, const scene::Scene& scene,
                    const Snapshot& snapshot);

/// @throws InputError naming the file: there is none, torn or damaged, of another format or
///         version of Palpate, of another scene by its content
Snapshot read_snapshot(const std::filesystem::path& file, const scene::Scene& scene);

}  // namespace palpate::runtime
