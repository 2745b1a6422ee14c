#include "studies/certify/group_store.h"

#include <json/json.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>

#include "studies/report/stored_json.h"

namespace palpate::certify {
namespace {

Json::Value json_of_line(const Line& line) {
  Json::Value json(Json::arrayValue);
  for (const std::string& text : {line.group, line.name, line.unit, line.source, line.note}) {
    json.append(text);
  }
  json.append(line.value);
  json.append(line.limit);
  json.append(line.at_least);
  json.append(static_cast<int>(line.verdict));
  return json;
}

Line line_of(const Json::Value& json) {
  Line line;
  Json::ArrayIndex i = 0;
  for (std::string* text : {&line.group, &line.name, &line.unit, &line.source, &line.note}) {
    *text = json[i++].asString();
  }
  line.value = json[i++].asDouble();
  line.limit = json[i++].asDouble();
  line.at_least = json[i++].asBool();
  line.verdict = static_cast<Verdict>(json[i].asInt());
  return line;
}

}  // namespace

GroupStore::GroupStore(const std::filesystem::path& folder, std::string of, std::ostream& log)
    : files_(folder, log), of_(std::move(of)) {}

std::string GroupStore::key(const std::string& group) const {
  std::string word;
  for (const char c : group) word += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return fmt::format("{}-{:016x}", word, std::hash<std::string>{}(of_));
}

bool GroupStore::read(const std::string& group, GroupResult& out) const {
  const auto json = report::stored_json(files_, key(group) + ".json", of_);
  if (!json) return false;
  out = {};
  for (const Json::Value& line : (*json)["lines"]) out.lines.push_back(line_of(line));
  out.push = (*json)["push_n"].asDouble();
  out.troubles = {(*json)["truncated"].asUInt64(), (*json)["lost"].asUInt64(),
                  (*json)["unsolved"].asUInt64()};
  return true;
}

void GroupStore::write(const std::string& group, const GroupResult& result) const {
  Json::Value json;
  json["lines"] = Json::arrayValue;
  for (const Line& line : result.lines) json["lines"].append(json_of_line(line));
  json["push_n"] = result.push;
  json["truncated"] = Json::UInt64(result.troubles.truncated);
  json["lost"] = Json::UInt64(result.troubles.lost);
  json["unsolved"] = Json::UInt64(result.troubles.unsolved);
  report::store_json(files_, key(group) + ".json", of_, std::move(json));
}

}  // namespace palpate::certify
