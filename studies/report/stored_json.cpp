#include "studies/report/stored_json.h"

#include <json/json.h>

#include <sstream>

namespace palpate::report {

std::optional<Json::Value> stored_json(const PointFiles& files, const std::string& name,
                                       const std::string& of) {
  const auto text = files.read(name);
  if (!text) return std::nullopt;
  std::istringstream stream(*text);
  Json::CharReaderBuilder builder;
  builder["allowSpecialFloats"] = true;
  Json::Value json;
  std::string errors;
  if (!Json::parseFromStream(builder, stream, &json, &errors) || !json.isObject()) return {};
  return json["of"] == of ? std::optional(std::move(json)) : std::nullopt;
}

void store_json(const PointFiles& files, const std::string& name, const std::string& of,
                Json::Value result) {
  result["of"] = of;
  Json::StreamWriterBuilder builder;  // 17 digits: the same bits
  builder["useSpecialFloats"] = true;
  files.write(name, Json::writeString(builder, result) + '\n');
}

}  // namespace palpate::report
