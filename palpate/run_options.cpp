#include "palpate/run_options.h"

#include <spdlog/fmt/fmt.h>
#include <stdlib.h>

#include <algorithm>
#include <cstdlib>
#include <ostream>
#include <random>
#include <stdexcept>
#include <string_view>

#include "modules/bus/addresses.h"
#include "modules/bus/key_check.h"
#include "modules/bus/roles.h"
#include "modules/core/error.h"
#include "modules/core/files_of_kind.h"
#include "modules/core/output_file.h"
#include "modules/core/whole_file.h"
#include "modules/recording/mcap_writer.h"
#include "modules/recording/sample_reader.h"
#include "modules/recording/space_watch.h"
#include "modules/recording/topic_selection.h"
#include "modules/runtime/snapshot.h"
#include "modules/runtime/wiring.h"
#include "palpate/hosts_file.h"
#include "palpate/run_snapshot.h"

namespace palpate::launcher {
namespace {

constexpr FileKind kPictures{"frame_", ".png", "\x89PNG", "pictures of a run"};

/// All that a session may have, in the order in which they are started.
std::vector<std::string> modules_of(std::size_t processes) {
  std::vector<std::string> names;
  for (std::size_t process = 1; process <= processes; ++process) {
    names.push_back(runtime::name_of({"deformation", process}));
  }
  for (const char* name : {"collision", "haptics", "visualizer"}) names.emplace_back(name);
  return names;
}

void check_names(const std::vector<std::string>& only, const std::vector<std::string>& modules) {
  for (const auto& name : only) {
    if (name == "recorder") continue;  // of a hosts file
    if (std::find(modules.begin(), modules.end(), name) == modules.end()) {
      throw InputError(fmt::format("--only: there is no module '{}'; there are {}", name,
                                   fmt::join(modules, ", ")));
    }
  }
}

/// Of a hosts file, all hosts together; who looks on may be missing.
void check_everywhere(const RunOptions& options, const std::vector<std::string>& modules) {
  for (const auto& name : options.everywhere) {
    if (name == "recorder" || std::ranges::find(modules, name) != modules.end()) continue;
    throw InputError(fmt::format("{}: the scene has no module '{}'; it has {}",
                                 options.hosts.string(), name, fmt::join(modules, ", ")));
  }
  for (const auto& name : modules) {
    const auto& everywhere = options.everywhere;
    if (name == "visualizer" || everywhere.empty()) continue;
    if (std::ranges::find(everywhere, name) != everywhere.end()) continue;
    throw InputError(fmt::format("{}: no host has the module '{}', which the scene needs",
                                 options.hosts.string(), name));
  }
}

/// To haptics, whose devices would else tell where they are at the session's beginning.
constexpr const char* kJoins = "--joins";

std::vector<std::string> session_arguments(const bus::BusOptions& bus) {
  return {"--session", bus.session, "--domain", std::to_string(bus.domain)};
}

bool wanted(const RunOptions& options, std::string_view module) {
  if (module == "visualizer") {
    const bool seen_by_someone = !options.headless || !options.frames.empty();
    if (!options.visualizer || !seen_by_someone) return false;
  }
  return options.only.empty() ||
         std::find(options.only.begin(), options.only.end(), module) != options.only.end();
}

/// Everybody learns who takes part.
void add_lockstep(const RunOptions& options, const std::vector<std::string>& modules,
                  ModuleCommand& command) {
  if (!options.lockstep) return;
  std::string participants;
  for (const std::string& module : participants_of(options, modules)) {
    participants += (participants.empty() ? "" : ",") + module;
  }
  auto& arguments = command.arguments;
  arguments.insert(arguments.end(), {"--lockstep", participants});
  if (!options.from_snapshot.empty()) {
    const auto from = std::filesystem::absolute(options.from_snapshot).string();
    arguments.insert(arguments.end(), {"--from-snapshot", from});
  }
  if (options.snapshot_at && runtime::remembers(command.module)) {
    arguments.insert(arguments.end(),
                     {"--snapshot-at", fmt::format("{}", *options.snapshot_at), "--snapshot",
                      snapshot_part(options, command.module).string()});
  }
}

/// glibc's wish for huge pages (its manual, "Memory Allocation Tunables"), beside what the user
/// asks of it and not against that: the memory of a fine organ is wider than the processor's tables
/// of small pages reach.
std::string wish_for_huge_pages() {
  const std::string wish = "glibc.malloc.hugetlb=";
  const char* const variable = std::getenv("GLIBC_TUNABLES");
  std::string own = variable == nullptr ? "" : variable;
  if (own.find(wish) == std::string::npos) own += (own.empty() ? "" : ":") + wish + "1";
  return "GLIBC_TUNABLES=" + own;
}

ModuleCommand module_command(const RunOptions& options, const std::vector<std::string>& modules,
                             const std::string& module, const std::filesystem::path& folder) {
  ModuleCommand command;
  command.module = module;
  const runtime::ModuleName name = *runtime::module_named(module);
  command.keeps_state = name.job == "deformation" && !options.lockstep;
  if (name.job == "deformation") command.environment = {wish_for_huge_pages()};
  command.program = folder / ("palpate-" + std::string(name.job));
  command.arguments = {std::filesystem::absolute(options.scene).string()};
  for (auto& argument : session_arguments(options.bus)) command.arguments.push_back(argument);
  if (!options.realtime) command.arguments.push_back("--no-realtime");
  add_lockstep(options, modules, command);
  // Of a part of a session the rest may run already.
  if (module == "haptics" && !options.only.empty() && !options.lockstep) {
    command.arguments.emplace_back(kJoins);
  }
  if (name.process > 1) {
    command.arguments.insert(command.arguments.end(), {"--process", std::to_string(name.process)});
  }
  if (module == "visualizer") {
    if (options.headless) command.arguments.push_back("--headless");
    if (!options.lockstep && options.only.empty()) command.arguments.push_back("--ends-run");
    if (options.lockstep && window_stays(options)) command.arguments.push_back("--stays");
    if (!options.frames.empty()) {
      command.arguments.insert(command.arguments.end(),
                               {"--frames", options.frames.string(), "--frame-interval-s",
                                fmt::format("{}", options.frame_interval)});
    }
  }
  return command;
}

}  // namespace

std::vector<std::string> participants_of(const RunOptions& options,
                                         const std::vector<std::string>& modules) {
  if (!options.everywhere.empty()) return options.everywhere;
  std::vector<std::string> all;
  if (!options.record.empty()) all.emplace_back("recorder");
  for (const std::string& module : modules) {
    if (wanted(options, module)) all.push_back(module);
  }
  return all;
}

void apply_hosts(RunOptions& options) {
  if (options.hosts.empty()) {
    if (!options.host.empty()) throw InputError("--host " + options.host + ": needs --hosts FILE");
    return;
  }
  if (options.host.empty()) throw InputError("--hosts: which of them is this? Give --host NAME");
  if (!options.only.empty()) throw InputError("--only: --hosts says already what runs where");
  const HostsFile hosts = load_hosts(options.hosts);
  const HostEntry& own = hosts.host(options.host);
  const bool recorder = std::ranges::find(own.modules, "recorder") != own.modules.end();
  if (recorder && options.record.empty())
    throw InputError("--hosts: host " + own.name + " has the recorder: give it --record FILE");
  if (options.lockstep && !recorder && !options.record.empty()) {
    throw InputError(
        "--record: in lockstep all must know of it: list recorder among the modules of " +
        own.name + " in " + options.hosts.string());
  }
  const std::vector<std::string> here = bus::addresses_of_this_host();
  if (std::ranges::find(here, own.address) == here.end()) {
    throw InputError(fmt::format("{}: host {}: address {} is none of this host, which has {}",
                                 options.hosts.string(), own.name, own.address,
                                 fmt::join(here, ", ")));
  }
  if (!bus::has_link(own.address)) {
    throw std::runtime_error(
        fmt::format("{}: host {}: address {} has no link: start it when that is up",
                    options.hosts.string(), own.name, own.address));
  }
  options.only = own.modules;
  options.everywhere = hosts.all_modules();
  options.conducts = hosts.conducts(own.name);
  ::setenv("PALPATE_INTERFACES", own.address.c_str(), 1);
  ::setenv("PALPATE_PEERS", hosts.peers_of(own.name).c_str(), 1);
}

std::vector<ModuleCommand> module_commands(const RunOptions& options,
                                           const std::filesystem::path& program_folder,
                                           std::size_t processes) {
  const std::vector<std::string> modules = modules_of(processes);
  check_everywhere(options, modules);
  check_names(options.only, modules);
  static_cast<void>(recording::TopicSelection(options.record_topics));  // throws what is wrong
  std::vector<ModuleCommand> commands;
  if (!options.record.empty()) {
    ModuleCommand recorder{
        "recorder", program_folder / "palpate-recorder", {options.record.string()}, false};
    for (auto& argument : session_arguments(options.bus)) recorder.arguments.push_back(argument);
    if (!options.record_topics.empty()) {
      recorder.arguments.insert(
          recorder.arguments.end(),
          {"--topics", fmt::format("{}", fmt::join(options.record_topics, ","))});
    }
    auto heard = participants_of(options, modules);
    std::erase(heard, "recorder");
    if (!options.lockstep && !heard.empty()) {
      recorder.arguments.insert(recorder.arguments.end(),
                                {"--hears", fmt::format("{}", fmt::join(heard, ","))});
    }
    if (options.lockstep) {
      recorder.reports_status = true;
      recorder.arguments.insert(recorder.arguments.end(),
                                {"--scene", std::filesystem::absolute(options.scene).string()});
      add_lockstep(options, modules, recorder);
    }
    commands.push_back(std::move(recorder));
  }
  for (const std::string& module : modules) {
    if (wanted(options, module)) {
      commands.push_back(module_command(options, modules, module, program_folder));
    }
  }
  return commands;
}

void check_keys_of(const std::vector<ModuleCommand>& commands) {
  const char* const folder = std::getenv("PALPATE_KEYS");
  if (folder == nullptr) return;
  bus::check_keys(folder, "palpate");
  for (const auto& command : commands) {
    const bus::Role* const role = bus::find_role(command.module);
    bus::check_keys(folder, role == nullptr ? command.module : role->name);
  }
}

ModuleCommand again(ModuleCommand command, int earlier) {
  if (earlier == 0) return command;
  if (command.module == "recorder") {
    command.arguments.front() = recording::part_of(command.arguments.front(), earlier + 1).string();
  } else if (command.module == "haptics" &&
             std::ranges::find(command.arguments, kJoins) == command.arguments.end()) {
    command.arguments.emplace_back(kJoins);
  }
  return command;
}

void check_frames(const RunOptions& options) {
  if (options.frames.empty()) return;
  if (!options.overwrite) check_none_of_kind(options.frames, kPictures, "--frames");
  make_writable_folder(options.frames, "--frames");
}

void clear_frames(const RunOptions& options) {
  if (!options.frames.empty()) remove_files(files_of_kind(options.frames, kPictures));
}

bool window_stays(const RunOptions& options) {
  return !options.headless && !options.close && options.only.empty() &&
         wanted(options, "visualizer");
}

std::string command_text(const ModuleCommand& command) {
  std::string text;
  for (const char* const name : {"PALPATE_KEYS", "PALPATE_INTERFACES", "PALPATE_PEERS"}) {
    const char* const value = std::getenv(name);
    if (value != nullptr) text += std::string(name) + "=" + shell_word(value) + " ";
  }
  text += shell_word(command.program.string());
  for (const auto& argument : command.arguments) text += " " + shell_word(argument);
  return text;
}

std::string shell_word(const std::string& text) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("_./=:@%+,-[]").find(char(c)) != std::string_view::npos;
  };
  if (!text.empty() && std::ranges::all_of(text, plain)) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string random_session_name() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::random_device random;
  std::string name = "s";
  for (int i = 0; i < 8; ++i) name += kDigits[random() % kDigits.size()];
  return name;
}

void check_recording(const RunOptions& options) {
  if (options.record.empty()) {
    const bool overwrites = options.overwrite && options.snapshot.empty() && options.frames.empty();
    if (options.record_topics.empty() && !overwrites) return;
    throw InputError(
        fmt::format("{}: of a recording; give --record FILE, too",
                    options.record_topics.empty() ? "--overwrite" : "--record-topics"));
  }
  recording::check_recording_target(options.record);
  if (!options.overwrite && std::filesystem::exists(options.record)) {
    throw InputError(options.record.string() +
                     ": is there already; give another name, or --overwrite");
  }
  recording::check_recording_space(options.record);
}

void write_run_summary(const RunOptions& options, const std::string& text, std::ostream& out) {
  out << text << std::flush;
  if (options.summary.empty()) return;
  try {
    write_whole_file(options.summary, text);
  } catch (const std::exception& error) {  // its place was good before the run
    throw std::runtime_error(std::string(error.what()) + "; the summary is not in a file");
  }
}

}  // namespace palpate::launcher
