#include "palpate/module_group.h"

#include <poll.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <ctime>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/runtime/clock.h"

namespace palpate::launcher {
namespace {

constexpr int kStopPollMs = 5;

bool is_information(const std::string& line) { return line.find("] info: ") != std::string::npos; }

}  // namespace

ModuleGroup::ModuleGroup(std::vector<ModuleCommand> commands, std::ostream& log,
                         Restarting restarting, std::filesystem::path folder)
    : restarting_(restarting),
      reaper_(std::move(folder)),
      reaper_began_ns_(runtime::monotonic_now_ns()),
      log_(log) {
  for (auto& command : commands) {
    Member member{std::move(command), nullptr};
    if (member.command.keeps_state && restarting_ != Restarting::kNever) {
      member.kept = std::make_unique<runtime::KeptMemory>();
    }
    start(member);
    members_.push_back(std::move(member));
  }
}

void ModuleGroup::start(Member& member) {
  ModuleCommand command = again(member.command, member.restarts);
  std::optional<int> inherited;
  if (member.kept) {
    inherited = member.kept->descriptor();
    command.arguments.insert(command.arguments.end(), {"--kept-state", std::to_string(*inherited)});
  }
  member.process = std::make_unique<ChildProcess>(command.program, command.arguments, inherited,
                                                  command.environment);
  reaper_.watch(member.process->process_id());
  member.began_ns = runtime::monotonic_now_ns();
  member.end_reported = false;
  member.due_ns.reset();
  member.hung.clear();
}

void ModuleGroup::start_due() {
  for (auto& member : members_) {
    if (!member.due_ns || runtime::monotonic_now_ns() < *member.due_ns) continue;
    ++member.restarts;
    start(member);
    log_ << "palpate: " << member.command.module << " is started again" << std::endl;
  }
}

void ModuleGroup::kill_hung(const std::string& module, const std::string& why) {
  for (auto& member : members_) {
    if (member.command.module != module || member.process->ended()) continue;
    member.hung = why;
    member.process->signal(SIGKILL);
  }
}

ModuleEnd ModuleGroup::end_of(Member& member, int wait_status) {
  const int code = WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : -1;
  ModuleEnd end{member.command.module,
                code != kExitDone,
                code == kExitBadInput,
                member.hung.empty() ? describe_exit(wait_status) : member.hung + ", was killed",
                member.last_error,
                command_text(again(member.command, member.restarts + 1)),
                /*returns=*/false,
                WIFSIGNALED(wait_status)};
  if (restarting_ == Restarting::kNever || !end.failed || end.bad_input) return end;
  const std::int64_t now = runtime::monotonic_now_ns();
  const auto pause =
      member.policy.pause_after(seconds_from_ns(member.began_ns), seconds_from_ns(now));
  if (!pause) return end;
  member.due_ns = now + ns_from_seconds(*pause);
  end.returns = true;
  return end;
}

void ModuleGroup::listen(Member& member) {
  for (auto& line : member.process->take_lines()) {
    log_ << line << '\n';
    if (!is_information(line)) member.last_error = line;
    member.last_line = std::move(line);
  }
  log_.flush();
}

/// Whoever killed it: the session is not its own.
void ModuleGroup::look_after_reaper() {
  const auto ended = reaper_.ended();
  if (!ended) return;
  log_ << "palpate: palpate-reaper, which ends what a killed launcher leaves, ended: "
       << describe_exit(*ended);
  const std::int64_t now = runtime::monotonic_now_ns();
  const bool returns =
      reaper_policy_
          .pause_after(seconds_from_ns(std::exchange(reaper_began_ns_, now)), seconds_from_ns(now))
          .has_value();
  try {
    if (returns) reaper_.start_again();
    log_ << (returns ? "; it is started again" : "; the session goes on without it") << std::endl;
  } catch (const std::runtime_error& error) {
    log_ << "; the session goes on without it: " << error.what() << std::endl;
  }
}

std::vector<ModuleEnd> ModuleGroup::poll() {
  look_after_reaper();
  start_due();  // first: an end is told before the return
  std::vector<ModuleEnd> ends;
  for (auto& member : members_) {
    const auto ended = member.process->ended();
    listen(member);
    if (!ended || member.end_reported) continue;
    member.end_reported = true;
    ends.push_back(end_of(member, *ended));
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
  for (auto* member : stopping) {
    member->due_ns.reset();
    member->process->signal(SIGTERM);
  }
  const auto deadline = runtime::monotonic_now_ns() + ns_from_seconds(kPatience);
  const auto still_running = [](Member* member) { return !member->process->ended(); };
  while (std::any_of(stopping.begin(), stopping.end(), still_running)) {
    for (auto* member : stopping) listen(*member);
    if (runtime::monotonic_now_ns() > deadline) {
      for (auto* member : stopping) {
        if (member->process->ended()) continue;
        member->deaf = true;
        member->process->signal(SIGKILL);
      }
    }
    ::poll(nullptr, 0, kStopPollMs);
  }
  for (auto* member : stopping) {
    listen(*member);
    member->end_reported = true;
  }
}

std::optional<ModuleEnd> ModuleGroup::last_end(const std::string& module) {
  for (auto& member : members_) {
    const auto ended = member.process->ended();
    if (member.command.module != module || !ended) continue;
    ModuleEnd end;
    end.module = module;
    end.how = describe_exit(*ended);
    end.killed = !WIFEXITED(*ended);
    end.failed = end.killed || WEXITSTATUS(*ended) != kExitDone;
    if (end.failed || !is_information(member.last_line)) {
      end.last_error = end.failed ? member.last_error : member.last_line;
    }
    return end;
  }
  return std::nullopt;
}

std::vector<std::string> ModuleGroup::deaf() const {
  std::vector<std::string> names;
  for (const auto& member : members_) {
    if (member.deaf) names.push_back(member.command.module);
  }
  return names;
}

bool ModuleGroup::any_running() {
  return std::any_of(members_.begin(), members_.end(), [](Member& member) {
    return member.due_ns.has_value() || !member.process->ended();
  });
}

bool ModuleGroup::running(const std::string& module) {
  return std::any_of(members_.begin(), members_.end(), [&](Member& member) {
    return member.command.module == module && !member.process->ended();
  });
}

pid_t ModuleGroup::process_id(const std::string& module) const {
  const auto member = std::ranges::find(
      members_, module,
      [](const Member& each) -> const std::string& { return each.command.module; });
  return member == members_.end() ? -1 : member->process->process_id();
}

double ModuleGroup::computed(const std::string& module) const {
  clockid_t clock{};
  timespec time{};
  const pid_t process = process_id(module);
  if (process < 0 || clock_getcpuclockid(process, &clock) != 0) return 0;
  if (clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::vector<std::string> ModuleGroup::modules() const {
  std::vector<std::string> names;
  for (const auto& member : members_) names.push_back(member.command.module);
  return names;
}

std::vector<std::string> ModuleGroup::reporting_modules() const {
  std::vector<std::string> names;
  for (const auto& member : members_) {
    if (member.command.reports_status) names.push_back(member.command.module);
  }
  return names;
}

std::map<std::string, int> ModuleGroup::restarts() const {
  std::map<std::string, int> counts;
  for (const auto& member : members_) {
    if (member.restarts > 0) counts[member.command.module] = member.restarts;
  }
  return counts;
}

std::map<std::string, std::string> ModuleGroup::last_words() const {
  std::map<std::string, std::string> words;
  for (const auto& member : members_) words[member.command.module] = member.last_line;
  return words;
}

}  // namespace palpate::launcher
