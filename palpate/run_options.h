// What `palpate run` was asked for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "modules/bus/bus.h"

namespace palpate::launcher {

struct RunOptions {
  std::filesystem::path scene;
  bus::BusOptions bus;    ///< session: a random name unless given
  double duration = 0;    ///< of the session [s]; 0: the scene's, and if 0, until stopped
  bool headless = false;  ///< no window
  bool visualizer = true;
  bool realtime = true;
  std::vector<std::string> only;  ///< modules to start; empty: all
  std::filesystem::path record;   ///< recording to write; empty: none
  std::filesystem::path frames;   ///< folder for pictures; empty: none
  double frame_interval = 1;      ///< simulated, between two pictures [s]
  std::filesystem::path summary;  ///< text file for the summary; empty: none
};

/// One program to start.
struct ModuleCommand {
  std::string module;  ///< "haptics"
  std::filesystem::path program;
  std::vector<std::string> arguments;
  bool reports_status = true;  ///< publishes module_status: the session waits until it is ready
};

/// What to start, in order: the recorder first, so that it hears everything. A visualizer that
/// could show its pictures to nobody (no window and no folder for frames) is left out.
/// @param program_folder  where the modules' programs are
/// @throws InputError for a module name that does not exist
std::vector<ModuleCommand> module_commands(const RunOptions& options,
                                           const std::filesystem::path& program_folder);

/// As one types it.
std::string command_text(const ModuleCommand& command);

/// A name no other session has: "s" and 8 random hex digits.
std::string random_session_name();

/// The folder of the running program.
std::filesystem::path own_program_folder();

}  // namespace palpate::launcher
