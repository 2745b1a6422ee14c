#include "modules/recording/player.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <thread>
#include <tuple>

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/messages/csv.h"
#include "modules/runtime/clock.h"

namespace palpate::recording {
namespace {

constexpr std::int64_t kLongestSleepNs = 20'000'000;

// False if asked to stop before `due_ns`.
bool sleep_until(std::int64_t due_ns, const std::function<bool()>& stop_requested) {
  for (;;) {
    if (stop_requested()) return false;
    const std::int64_t left = due_ns - runtime::monotonic_now_ns();
    if (left <= 0) return true;
    std::this_thread::sleep_for(std::chrono::nanoseconds(std::min(left, kLongestSleepNs)));
  }
}

// Leaves out the samples before an instant.
// @param next  the first sample; becomes the first that is not left out
// @return the newest of each topic, writer and key, in the order they were received
std::vector<RecordedSample> skip_to(std::int64_t start_ns, std::optional<RecordedSample>& next,
                                    SampleReader& recording) {
  std::map<std::tuple<std::string_view, std::uint32_t, std::string>, RecordedSample> newest;
  messages::AnyMessage message;
  for (; next && next->received_time_ns < start_ns; next = recording.next()) {
    if (next->topic->type->decode(next->payload, message) != nullptr) continue;
    const std::tuple key(next->topic->name, next->channel, messages::key_text(message));
    newest[key] = std::move(*next);
  }
  if (!next && !newest.empty()) {
    throw InputError(recording.file().string() + ": ends before the start asked for");
  }
  std::vector<RecordedSample> held;
  for (auto& [key, sample] : newest) held.push_back(std::move(sample));
  std::ranges::stable_sort(held, {}, &RecordedSample::received_time_ns);
  return held;
}

struct MotionRow {
  std::int64_t time_ns;
  Pose pose;
};

struct Motion {
  std::vector<MotionRow> rows;
  std::size_t resets = 0;
};

void append(const ProbeState& state, Motion& motion) {
  const std::int64_t time_ns = state.header.sim_time_ns;
  if (!motion.rows.empty() && time_ns < motion.rows.back().time_ns) {
    motion.rows.clear();
    ++motion.resets;
  }
  // Standing still before the start and while paused repeats a time: the newest pose holds.
  if (!motion.rows.empty() && time_ns == motion.rows.back().time_ns) motion.rows.pop_back();
  motion.rows.push_back({time_ns, state.pose});
}

std::map<std::uint32_t, Motion> read_motions(SampleReader& recording, std::size_t& invalid) {
  std::map<std::uint32_t, Motion> motions;
  messages::AnyMessage message;
  while (const auto sample = recording.next()) {
    if (sample->topic->name != bus::kProbeState.name) continue;
    if (sample->topic->type->decode(sample->payload, message) != nullptr) {
      ++invalid;
      continue;
    }
    const auto& state = std::get<ProbeState>(message);
    append(state, motions[state.probe]);
  }
  return motions;
}

void write_trajectory(const std::filesystem::path& file, const std::vector<MotionRow>& rows) {
  std::ofstream stream(file);
  stream << "t,x,y,z,qx,qy,qz,qw\n";
  for (const MotionRow& row : rows) {
    const Quat& q = row.pose.rotation;
    messages::write_seconds(stream, row.time_ns);
    for (const double value : {row.pose.position.x(), row.pose.position.y(), row.pose.position.z(),
                               q.x(), q.y(), q.z(), q.w()}) {
      messages::write_number(stream << ',', value);
    }
    stream << '\n';
  }
  stream.close();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace

void check_start(const std::filesystem::path& recording, double start) {
  SampleReader reader(recording);
  const auto first = reader.next();
  if (start <= 0 || !first) return;
  const std::int64_t start_ns = first->received_time_ns + ns_from_seconds(start);
  std::int64_t newest_ns = first->received_time_ns;
  while (const auto sample = reader.next()) {
    newest_ns = std::max(newest_ns, sample->received_time_ns);
    if (newest_ns >= start_ns) return;
  }
  std::ostringstream text;
  text << recording.string() << ": is " << seconds_from_ns(newest_ns - first->received_time_ns)
       << " s long and ends before the start asked for, --start " << start;
  throw InputError(text.str());
}

PlayReport play(SampleReader& recording, SessionWriter& session,
                const std::function<bool()>& stop_requested, const PlayOptions& options) {
  PlayReport report;
  std::optional<RecordedSample> sample = recording.next();
  if (!sample) return report;
  const std::int64_t start_ns = sample->received_time_ns + ns_from_seconds(options.start);
  std::map<std::string_view, std::uint64_t> counts;  // by topic
  const auto write = [&](RecordedSample& each) {
    const std::uint64_t count = ++counts[each.topic->name];
    if (options.counts_anew) messages::set_sequence(each.payload, count);
    if (!session.write(*each.topic, each.payload)) ++report.refused;
    ++report.samples;
  };
  for (RecordedSample& held : skip_to(start_ns, sample, recording)) write(held);

  const std::int64_t began_ns = runtime::monotonic_now_ns();
  for (; sample; sample = recording.next()) {
    const std::int64_t played_ns = sample->received_time_ns - start_ns;
    const auto due_ns = began_ns + std::int64_t(double(played_ns) / options.rate);
    if (stop_requested() || (!options.wait_for_step && !sleep_until(due_ns, stop_requested))) {
      report.stopped = true;
      break;
    }
    write(*sample);
    report.duration = std::max(report.duration, seconds_from_ns(played_ns));
    const bool picture = sample->topic->name == bus::kNodePositions.name;
    if (picture && options.wait_for_step && !options.wait_for_step()) {
      report.stopped = true;
      break;
    }
  }
  return report;
}

std::vector<ProbeTrajectory> extract_probe_trajectories(const std::filesystem::path& recording,
                                                        const std::filesystem::path& folder,
                                                        std::vector<std::string>& warnings) {
  SampleReader reader(recording);
  std::size_t invalid = 0;
  const auto motions = read_motions(reader, invalid);
  const std::string name = recording.string();
  for (std::string& line : reader.warnings()) warnings.push_back(std::move(line));
  if (invalid > 0) {
    warnings.push_back(name + ": " + std::to_string(invalid) +
                       " invalid probe_state samples left out");
  }
  if (motions.empty()) throw InputError(name + ": holds no motion of a probe (topic probe_state)");

  std::filesystem::create_directories(folder);
  std::vector<ProbeTrajectory> trajectories;
  for (const auto& [probe, motion] : motions) {
    const std::string label = "probe_" + std::to_string(probe);
    if (motion.resets > 0) {
      std::ostringstream warning;
      warning << name << ": " << label << ": only the motion after the last of " << motion.resets
              << " resets is used";
      warnings.push_back(warning.str());
    }
    const auto file = folder / (label + ".csv");
    write_trajectory(file, motion.rows);
    trajectories.push_back(
        {probe, file, motion.rows.size(), seconds_from_ns(motion.rows.back().time_ns)});
  }
  return trajectories;
}

}  // namespace palpate::recording
