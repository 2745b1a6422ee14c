#include "palpate/module_group.h"

#include <poll.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <ostream>

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/runtime/clock.h"

namespace palpate::launcher {
namespace {

constexpr int kStopPollMs = 5;

bool is_information(const std::string& line) { return line.find("] info: ") != std::string::npos; }

}  // namespace

ModuleGroup::ModuleGroup(std::vector<ModuleCommand> commands, std::ostream& log) : log_(log) {
  for (auto& command : commands) {
    auto process = std::make_unique<ChildProcess>(command.program, command.arguments);
    members_.push_back({std::move(command), std::move(process), false, {}, {}});
  }
}

void ModuleGroup::listen(Member& member) {
  for (auto& line : member.process->take_lines()) {
    log_ << line << '\n';
    if (!is_information(line)) member.last_error = line;
    member.last_line = std::move(line);
  }
  log_.flush();
}

std::vector<ModuleEnd> ModuleGroup::poll() {
  std::vector<ModuleEnd> ends;
  for (auto& member : members_) {
    const auto ended = member.process->ended();
    listen(member);
    if (!ended || member.end_reported) continue;
    member.end_reported = true;
    const int code = WIFEXITED(*ended) ? WEXITSTATUS(*ended) : -1;
    ends.push_back({member.command.module, code != kExitDone, code == kExitBadInput,
                    describe_exit(*ended), member.last_error, command_text(member.command)});
  }
  return ends;
}

void ModuleGroup::stop() { stop_all_but({}); }

void ModuleGroup::stop_all_but(const std::string& module) {
  stop(true, module);
  stop(false, module);
}

void ModuleGroup::stop(bool reporting, const std::string& but) {
  std::vector<Member*> stopping;
  for (auto& member : members_) {
    const bool meant = member.command.reports_status == reporting;
    if (meant && member.command.module != but) stopping.push_back(&member);
  }
  for (auto* member : stopping) member->process->signal(SIGTERM);
  const auto deadline = runtime::monotonic_now_ns() + ns_from_seconds(kPatience);
  const auto still_running = [](Member* member) { return !member->process->ended(); };
  while (std::any_of(stopping.begin(), stopping.end(), still_running)) {
    for (auto* member : stopping) listen(*member);
    if (runtime::monotonic_now_ns() > deadline) {
      for (auto* member : stopping) member->process->signal(SIGKILL);
    }
    ::poll(nullptr, 0, kStopPollMs);
  }
  for (auto* member : stopping) {
    listen(*member);
    member->end_reported = true;
  }
}

bool ModuleGroup::any_running() {
  return std::any_of(members_.begin(), members_.end(),
                     [](Member& member) { return !member.process->ended(); });
}

bool ModuleGroup::running(const std::string& module) {
  return std::any_of(members_.begin(), members_.end(), [&](Member& member) {
    return member.command.module == module && !member.process->ended();
  });
}

std::vector<std::string> ModuleGroup::reporting_modules() const {
  std::vector<std::string> names;
  for (const auto& member : members_) {
    if (member.command.reports_status) names.push_back(member.command.module);
  }
  return names;
}

std::map<std::string, std::string> ModuleGroup::last_words() const {
  std::map<std::string, std::string> words;
  for (const auto& member : members_) words[member.command.module] = member.last_line;
  return words;
}

}  // namespace palpate::launcher
