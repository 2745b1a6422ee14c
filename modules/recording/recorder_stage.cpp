#include "modules/recording/recorder_stage.h"

#include <algorithm>
#include <exception>

#include "modules/core/units.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/wiring.h"

namespace palpate::recording {

RecorderStage::RecorderStage(bus::Bus& bus, const std::filesystem::path& file,
                             TopicSelection topics)
    : file_(SampleFile::of_lockstep(file, std::move(topics))), space_(file), name_(file) {
  for (const bus::TopicInfo& topic : bus::all_topics()) {
    if (runtime::find_wire(topic.name) == nullptr) continue;
    inputs_.push_back(std::make_unique<bus::Input>(bus, topic));
  }
}

RecorderStage::~RecorderStage() {
  try {
    file_.close();
  } catch (const std::exception&) {  // the disk is full: the file is whole up to its last record
  }
}

runtime::Health RecorderStage::cycle(const runtime::Cycle&) {
  write_all();
  return {};
}

void RecorderStage::finish(const runtime::Cycle&) {
  write_all();
  while_there_is_room([this] { file_.close(); });
}

/// @throws std::runtime_error that says how far the recording goes where there is none
void RecorderStage::while_there_is_room(const std::function<void()>& write) const {
  try {
    write();
  } catch (const DiskFull& full) {
    throw std::runtime_error(full.what() + std::string("; the recording is whole up to there"));
  }
}

void RecorderStage::write_all() {
  samples_.clear();
  for (const auto& input : inputs_) {
    while (const bus::RawSample* raw = input->next()) {
      const Header header = messages::header_of(raw->payload);
      input->accept(*raw, header);
      TopicSample sample;
      sample.topic = bus::find_topic(input->topic().name);
      sample.received_time_ns = std::max<std::int64_t>(0, header.source_time_ns);
      sample.payload = raw->payload;
      // DDS fills a payload up to whole words, the memory bus does not.
      sample.payload.resize((sample.payload.size() + 3) / 4 * 4, 0);
      samples_.push_back(std::move(sample));
    }
  }
  // Each input hands its samples out in order; here they are merged.
  std::stable_sort(samples_.begin(), samples_.end(),
                   [](const TopicSample& a, const TopicSample& b) {
                     return a.received_time_ns < b.received_time_ns;
                   });
  while_there_is_room([this] {
    for (const TopicSample& sample : samples_) file_.add(sample);
    file_.flush();
  });
  const double now = seconds_from_ns(runtime::monotonic_now_ns());
  const std::string said = space_.look(now, file_.bytes_written());
  if (!space_.full()) return;
  file_.close();
  throw std::runtime_error(name_.string() + ": " + said);
}

}  // namespace palpate::recording
