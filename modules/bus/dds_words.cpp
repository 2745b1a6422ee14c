#include "modules/bus/dds_words.h"

#include <fastdds/dds/log/Log.hpp>

#include <algorithm>
#include <iostream>
#include <memory>
#include <mutex>
#include <set>
#include <string>

namespace palpate::bus {
namespace {

namespace dds = eprosima::fastdds::dds;

constexpr std::size_t kMost = 20;

class PlainLines : public dds::LogConsumer {
 public:
  /// Called by the one thread of the log.
  void Consume(const dds::Log::Entry& entry) override {
    if (entry.kind != dds::Log::Kind::Error || said_.size() >= kMost) return;
    std::string line = std::string("DDS: ") + entry.context.category + ": " + entry.message;
    line.resize(std::min(line.find(" (./src"), line.size()));
    std::ranges::replace(line, '\n', ' ');
    if (said_.insert(line).second) std::cerr << line + "\n" << std::flush;
  }

 private:
  std::set<std::string> said_;
};

}  // namespace

void tell_plainly() {
  static std::once_flag once;
  std::call_once(once, [] {
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::make_unique<PlainLines>());
  });
}

}  // namespace palpate::bus
