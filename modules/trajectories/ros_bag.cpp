#include "modules/trajectories/ros_bag.h"

#include <spdlog/fmt/fmt.h>

#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <span>

#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/trajectories/pose_collector.h"
#include "modules/trajectories/pose_topics.h"
#include "modules/trajectories/ros_message.h"

namespace palpate::trajectories {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::uint32_t kLargestRecord = 1u << 30;  // chunks are 768 KiB by default

using Bytes = std::span<const std::uint8_t>;
using Fields = std::map<std::string, Bytes, std::less<>>;

enum class Op : std::uint8_t { kMessage = 2, kChunk = 5, kConnection = 7 };

std::string text_of(Bytes bytes) { return {bytes.begin(), bytes.end()}; }

std::optional<std::uint32_t> number_at(Bytes bytes) {
  if (bytes.size() < 4) return {};
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

/// Takes a length and that many bytes off the front. None: there are not that many.
std::optional<Bytes> take_block(Bytes& rest) {
  const auto size = number_at(rest);
  if (!size || *size > rest.size() - 4) return {};
  const Bytes block = rest.subspan(4, *size);
  rest = rest.subspan(4 + *size);
  return block;
}

/// "name=value" each. None: they are not.
std::optional<Fields> fields_in(Bytes header) {
  Fields fields;
  while (!header.empty()) {
    const auto field = take_block(header);
    if (!field) return {};
    const auto equals = std::find(field->begin(), field->end(), '=');
    if (equals == field->end()) return {};
    const auto name = std::size_t(equals - field->begin());
    fields[text_of(field->first(name))] = field->subspan(name + 1);
  }
  return fields;
}

struct Record {
  Op op{};
  Fields fields;
  Bytes data;

  std::uint32_t number(std::string_view name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? 0 : number_at(found->second).value_or(0);
  }
  std::string text(std::string_view name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? "" : text_of(found->second);
  }
};

/// None: the header is not one.
std::optional<Record> record_of(Bytes header, Bytes data) {
  auto fields = fields_in(header);
  if (!fields || (*fields)["op"].size() != 1) return {};
  const Op op{(*fields)["op"][0]};
  return Record{op, std::move(*fields), data};
}

class BagReader {
 public:
  explicit BagReader(std::filesystem::path file) : file_(std::move(file)) {}

  /// All records, those in chunks among them.
  /// @returns false if the file ends within one
  template <class Visit>
  bool read(const Visit& visit) {
    std::ifstream stream = open_input(file_);
    std::string magic(kMagic.size(), '\0');
    if (!stream.read(magic.data(), std::streamsize(magic.size())) || magic != kMagic)
      throw InputError(file_.string() + ": is no ROS 1 bag of format 2.0");
    while (stream.peek() != std::ifstream::traits_type::eof()) {
      offset_ = std::uint64_t(stream.tellg());
      if (!read_block(stream, header_) || !read_block(stream, data_)) return false;
      const Record record = sound(record_of(header_, data_));
      record.op == Op::kChunk ? read_chunk(record, visit) : visit(record);
    }
    return true;
  }

  std::uint64_t offset() const { return offset_; }  ///< of the record last read, or its chunk

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{}: offset {}: {}", file_.string(), offset_, what));
  }

  Record sound(std::optional<Record> record) const {
    if (!record) refuse("is not a record of a bag");
    return std::move(*record);
  }

  /// @returns false at the end of the file
  bool read_block(std::ifstream& stream, std::vector<std::uint8_t>& block) const {
    std::uint32_t size = 0;
    if (!stream.read(reinterpret_cast<char*>(&size), sizeof size)) return false;
    if (size > kLargestRecord) refuse("is not a record of a bag");
    block.resize(size);
    return bool(stream.read(reinterpret_cast<char*>(block.data()), std::streamsize(size)));
  }

  template <class Visit>
  void read_chunk(const Record& chunk, const Visit& visit) const {
    const std::string compression = chunk.text("compression");
    if (compression != "none") {
      throw InputError(fmt::format("{}: is compressed ({}); first: rosbag decompress {}",
                                   file_.string(), compression, file_.filename().string()));
    }
    for (Bytes rest = chunk.data; !rest.empty();) {
      const auto header = take_block(rest);
      const auto data = header ? take_block(rest) : std::nullopt;
      if (!data) refuse("holds a chunk that is cut");
      visit(sound(record_of(*header, *data)));
    }
  }

  std::filesystem::path file_;
  std::uint64_t offset_ = 0;
  std::vector<std::uint8_t> header_, data_;
};

}  // namespace

std::vector<TimedPose> read_ros_bag(const scene::TrajectoryDevice& config,
                                    std::vector<std::string>& warnings, const Progress& progress) {
  BagReader bag(config.file);
  PoseTopics topics;
  std::map<std::uint32_t, std::string> topic_of;  // connections
  const bool whole = bag.read([&](const Record& record) {
    if (record.op != Op::kConnection) return;
    const auto told = fields_in(record.data);
    if (!told || told->find("type") == told->end()) return;
    topic_of[record.number("conn")] = record.text("topic");
    topics.add(record.text("topic"), text_of(told->find("type")->second));
  });
  if (!whole) {
    warnings.push_back(
        fmt::format("{}: ends within a record, at byte {}; what is before it is used",
                    config.file.string(), bag.offset()));
  }
  const PoseTopic topic = topics.choose(config);
  StampedPoses poses(config, topic, RosEncoding::kRos1, warnings);
  const double bytes = double(std::filesystem::file_size(config.file));
  bag.read([&](const Record& record) {
    if (record.op != Op::kMessage || topic_of[record.number("conn")] != topic.name) return;
    poses.add(record.data);
    if (progress && poses.count() % kProgressEvery == 0) {
      progress(double(bag.offset()) / bytes, poses.count());
    }
  });
  return std::move(poses).finish();
}

}  // namespace palpate::trajectories
