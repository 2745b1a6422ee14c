#include "modules/recording/commands.h"

#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <ostream>
#include <thread>

#include "modules/bus/dds_bus.h"
#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/recording/csv_export.h"
#include "modules/recording/foxglove_export.h"
#include "modules/recording/inspect.h"
#include "modules/recording/player.h"
#include "modules/recording/repair.h"
#include "modules/runtime/clock.h"

namespace palpate::recording {
namespace {

constexpr double kAcknowledgeTimeout = 1;  // [s] per topic
constexpr int kInputPollMs = 20;

template <class Job>
int report_failure(std::ostream& err, const Job& job) {
  try {
    job();
    return kExitDone;
  } catch (const InputError& error) {
    err << "error: " << error.what() << '\n';
    return kExitBadInput;
  } catch (const std::exception& error) {
    err << "error: " << error.what() << '\n';
    return kExitFailed;
  }
}

// True once someone listens to the organs' motion.
bool wait_for_reader(const SessionWriter& session, double timeout,
                     const std::function<bool()>& stop_requested) {
  const bus::TopicInfo& topic = *bus::find_topic(bus::kNodePositions.name);
  const std::int64_t end_ns = runtime::monotonic_now_ns() + ns_from_seconds(timeout);
  while (session.matched_readers(topic) == 0) {
    if (stop_requested() || runtime::monotonic_now_ns() >= end_ns) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

// False at the end of standard input, or when asked to stop.
bool wait_for_line(const std::function<bool()>& stop_requested) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  while (!stop_requested()) {
    if (::poll(&input, 1, kInputPollMs) <= 0) continue;
    char letter = 0;
    if (::read(STDIN_FILENO, &letter, 1) != 1) return false;
    if (letter == '\n') return true;
  }
  return false;
}

void replay(const ReplayOptions& options, const std::function<bool()>& stop_requested,
            std::ostream& out, std::ostream& err) {
  SampleReader recording(options.recording);
  bus::DdsBus bus(options.session);
  SessionWriter session(bus);
  if (!wait_for_reader(session, options.wait_for_reader, stop_requested) && !stop_requested()) {
    err << "warning: nobody listens in session '" << options.session.session << "', domain "
        << options.session.domain << "; playing all the same\n";
  }
  PlayOptions playing{options.start, options.rate, {}, /*counts_anew=*/true};
  if (options.step) {
    err << "a picture for each press of Enter; Ctrl-C ends\n";
    playing.wait_for_step = [&] { return wait_for_line(stop_requested); };
  }
  const PlayReport report = play(recording, session, stop_requested, playing);
  if (!report.stopped) session.wait_until_received(kAcknowledgeTimeout);
  for (const auto& line : recording.warnings()) err << "warning: " << line << '\n';
  if (report.refused > 0) err << "warning: " << report.refused << " samples could not be sent\n";
  out << (report.stopped ? "stopped after " : "replayed ") << report.samples << " samples, "
      << report.duration << " s\n";
}

void translate(const std::filesystem::path& recording, const std::filesystem::path& file,
               std::ostream& err) {
  const FoxgloveReport report = export_to_foxglove(recording, file);
  err << file.string() << ": " << report.samples << " samples, and " << report.translations
      << " messages of Foxglove's types beside them\n";
  for (const auto& line : report.warnings) err << "warning: " << line << '\n';
}

void tell_repair(const std::filesystem::path& file, const RepairReport& report, std::ostream& err) {
  err << file.string() << ": " << report.samples << " samples";
  if (report.parts > 1) err << " of " << report.parts << " parts";
  if (report.mended > 0) {
    err << "; mended: " << report.mended << " types and topics, from the summary";
  }
  err << "; left out: " << report.skipped << " damaged pieces";
  if (report.samples_left_out > 0) {
    err << ", " << report.samples_left_out << " samples of damaged types and topics";
  }
  err << (report.torn ? " and a torn end" : "") << '\n';
  for (const auto& line : report.warnings) err << "warning: " << line << '\n';
}

}  // namespace

int run_inspect_command(const InspectOptions& options, std::ostream& out, std::ostream& err) {
  return report_failure(err, [&] {
    // Before anything is written.
    if (!options.csv_folder.empty() && !options.overwrite) check_no_tables(options.csv_folder);
    if (!options.repaired.empty()) {
      const RepairReport report = repair(options.recording, options.repaired);
      tell_repair(options.repaired, report, err);
    }
    const auto& file = options.repaired.empty() ? options.recording : options.repaired;
    if (!options.foxglove.empty()) translate(file, options.foxglove, err);
    const RecordingSummary summary = summarize(file, options.csv_folder, options.overwrite);
    options.json ? print_json(summary, out) : print_summary(summary, out);
    for (const auto& line : summary.warnings) err << "warning: " << line << '\n';
  });
}

int run_diff_command(const DiffOptions& options, std::ostream& out, std::ostream& err) {
  bool equal = false;
  const int code = report_failure(err, [&] {
    const RecordingDifference difference = compare(options);
    for (const std::string& warning : difference.warnings) err << "warning: " << warning << '\n';
    print_difference(difference, out);
    equal = difference.equal();
  });
  if (code != kExitDone) return kExitBadInput;
  return equal ? kExitDone : kExitFailed;
}

int run_replay_command(const ReplayOptions& options, const std::function<bool()>& stop_requested,
                       std::ostream& out, std::ostream& err) {
  return report_failure(err, [&] { replay(options, stop_requested, out, err); });
}

}  // namespace palpate::recording
