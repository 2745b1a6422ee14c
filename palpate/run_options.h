// What `palpate run` was asked for.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "modules/bus/bus.h"
#include "modules/core/error.h"

namespace palpate::launcher {

struct RunOptions {
  std::filesystem::path scene;
  std::filesystem::path folder = {};  ///< where the scene lies, of this process alone; empty: none
  std::vector<std::string> settings = {};  ///< "key=value" each, instead of what the scene says
  bus::BusOptions bus;                     ///< session: a random name unless given
  std::filesystem::path secure = {};       ///< folder of keys (palpate keys); empty: none
  double duration = 0;    ///< of the session [s]; 0: the scene's, and if 0, until stopped
  bool headless = false;  ///< no window
  bool visualizer = true;
  bool close = false;  ///< the window, too, when the run ends; else it stays
  bool realtime = true;
  bool restart = true;                  ///< modules that die or hang
  bool lockstep = false;                ///< without a wall clock, as fast as the machine allows
  bool in_process = false;              ///< the same in one process
  std::optional<double> snapshot_at;    ///< without a clock: when one is written [s]
  std::filesystem::path snapshot;       ///< … and where
  std::filesystem::path from_snapshot;  ///< without a clock: goes on there; empty: at rest
  double ready_deadline = 60;           ///< lockstep: longest wait for a process [s]
  std::vector<std::string> only;        ///< modules to start; empty: all
  std::filesystem::path hosts;  ///< which host runs what (hosts_file.h); empty: this one all
  std::string host;             ///< which of them this one is
  std::vector<std::string> everywhere = {};  ///< modules of all hosts; set with `hosts`
  bool conducts = true;          ///< starts the session and ends it; else another host does
  std::filesystem::path record;  ///< recording to write; empty: none
  bool overwrite = false;        ///< a recording, pictures that are there already
  std::vector<std::string> record_topics;  ///< as recording::TopicSelection; empty: the usual
  std::filesystem::path frames;            ///< folder for pictures; empty: none
  double frame_interval = 1;               ///< simulated, between two pictures [s]
  std::filesystem::path summary;           ///< text file for the summary; empty: none
};

/// One program to start.
struct ModuleCommand {
  std::string module;  ///< "haptics"
  std::filesystem::path program;
  std::vector<std::string> arguments;
  bool reports_status = true;  ///< publishes module_status: the session waits until it is ready
  bool keeps_state = false;    ///< a successor goes on from what it remembered (kept_state.h)
  std::vector<std::string> environment = {};  ///< NAME=value, beside what it inherits
};

/// Fills in what `hosts` says: modules and participants, and for this process and its children
/// PALPATE_INTERFACES and PALPATE_PEERS. Without `hosts`: nothing.
/// @throws InputError as load_hosts() does; for --hosts without --host or beside --only; where a
/// recorder that the file names is given no file, or one that it does not name is in a lockstep
void apply_hosts(RunOptions& options);

/// What to start, in order: the recorder first, so that it hears everything. A visualizer that
/// could show its pictures to nobody (no window and no folder for frames) is left out.
/// @param program_folder  where the modules' programs are
/// @param processes  of deformation
/// @throws InputError for a module name that does not exist
std::vector<ModuleCommand> module_commands(const RunOptions& options,
                                           const std::filesystem::path& program_folder,
                                           std::size_t processes = 1);

/// With PALPATE_KEYS in the environment: that this program and all that it will start can take
/// part.
/// @throws InputError as bus::check_keys() does
void check_keys_of(const std::vector<ModuleCommand>& commands);

/// The modules that take part, on all hosts, the recorder among them.
/// @param modules  of the scene
std::vector<std::string> participants_of(const RunOptions& options,
                                         const std::vector<std::string>& modules);

/// The command of a module that was started before, `earlier` times; a recorder's names another
/// file, FILE.partN.mcap, and replaces nothing; haptics joins a session that runs.
ModuleCommand again(ModuleCommand command, int earlier);

/// Makes the folder for pictures.
/// @throws InputError if that fails, or if it holds an earlier run's that are not to be replaced
void check_frames(const RunOptions& options);
/// An earlier run's pictures go, before the first new one.
void clear_frames(const RunOptions& options);

/// A window of this run that stays when the run has ended.
bool window_stays(const RunOptions& options);
/// What is said then.
inline constexpr const char* kWindowStays =
    "palpate: the run has ended; its window stays until q closes it\n";

/// As one types it.
std::string command_text(const ModuleCommand& command);
/// A word as it is typed in a shell: quoted where it has to be.
std::string shell_word(const std::string& text);

/// Before anything is started.
/// @throws InputError where options.record cannot be written, or may not be replaced, and for
/// options of a recording without one; std::runtime_error where the disk has no room
void check_recording(const RunOptions& options);

/// Prints the summary, and writes it where options.summary says.
/// @throws std::runtime_error if it cannot be written
void write_run_summary(const RunOptions& options, const std::string& text, std::ostream& out);

/// A name no other session has: "s" and 8 random hex digits.
std::string random_session_name();

}  // namespace palpate::launcher
