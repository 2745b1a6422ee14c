#include "palpate/run_snapshot.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <ostream>

#include "modules/core/error.h"
#include "modules/core/output_file.h"
#include "modules/core/units.h"
#include "modules/runtime/snapshot.h"
#include "modules/runtime/wiring.h"

namespace palpate::launcher {
namespace {

std::vector<std::filesystem::path> parts_of(const RunOptions& options,
                                            const std::vector<std::string>& modules) {
  std::vector<std::filesystem::path> parts;
  if (!options.snapshot_at) return parts;
  for (const std::string& module : modules) {
    if (runtime::remembers(module)) parts.push_back(snapshot_part(options, module));
  }
  return parts;
}

}  // namespace

void check_snapshots(const RunOptions& options) {
  const bool from = !options.from_snapshot.empty();
  if (!options.snapshot_at && options.snapshot.empty() && !from) return;
  if (options.snapshot_at.has_value() == options.snapshot.empty()) {
    throw InputError(options.snapshot_at ? "--snapshot-at: where to? Give --snapshot FILE, too"
                                         : "--snapshot: when? Give --snapshot-at SECONDS, too");
  }
  if (!options.lockstep && !options.in_process) {
    throw InputError(fmt::format(
        "{}: of --lockstep and --in-process; in real time no two processes are at the same instant",
        from ? "--from-snapshot" : "--snapshot-at"));
  }
  if (!options.hosts.empty() && options.snapshot_at) {
    throw InputError("--snapshot-at: not with --hosts; its parts would lie on several hosts");
  }
  if (!options.snapshot_at) return;
  runtime::check_snapshot_name(options.snapshot, options.overwrite);
  if (!options.lockstep) return;
  // Parts are taken away in the end: none may be a file that somebody keeps.
  check_writable(snapshot_part(options, "part"));
  const auto folder = std::filesystem::absolute(options.snapshot).parent_path();
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string module = entry.path().extension().string();
    if (module.size() < 2 || !runtime::module_named(module.substr(1))) continue;
    if (entry.path() == snapshot_part(options, module.substr(1))) {
      runtime::check_snapshot_name(entry.path(), true);
    }
  }
}

std::filesystem::path snapshot_part(const RunOptions& options, const std::string& module) {
  return std::filesystem::absolute(options.snapshot).string() + "." + module;
}

void tell_snapshot(const RunOptions& options, std::int64_t time_ns, std::ostream& log) {
  log << fmt::format("palpate: snapshot {} of {:.10g} s", options.snapshot.string(),
                     seconds_from_ns(time_ns));
  if (time_ns > ns_from_seconds(*options.snapshot_at)) {
    log << fmt::format(", where the first cycle from {:.10g} s on begins", *options.snapshot_at);
  }
  log << std::endl;
}

int tell_no_snapshot(const RunOptions& options, double reached, std::ostream& log) {
  log << fmt::format(
             "palpate: there is no snapshot {}: the run ended at {:.10g} s, before {:.10g} s",
             options.snapshot.string(), reached, *options.snapshot_at)
      << std::endl;
  return kExitFailed;
}

void remove_snapshot_parts(const RunOptions& options, const std::vector<std::string>& modules) {
  for (const auto& part : parts_of(options, modules)) std::filesystem::remove(part);
}

bool unite_snapshot(const RunOptions& options, const std::vector<std::string>& modules,
                    const scene::Scene& scene, std::ostream& log) {
  const auto parts = parts_of(options, modules);
  const auto there = [](const auto& part) { return std::filesystem::exists(part); };
  if (!std::ranges::all_of(parts, there)) return false;
  runtime::Snapshot whole;
  for (const auto& file : parts) {
    runtime::Snapshot part = runtime::read_snapshot(file, scene);
    whole.time_ns = part.time_ns;
    whole.modules.merge(part.modules);
  }
  runtime::write_snapshot(options.snapshot, scene, whole);
  tell_snapshot(options, whole.time_ns, log);
  return true;
}

}  // namespace palpate::launcher
