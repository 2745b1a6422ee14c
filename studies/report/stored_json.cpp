#include "studies/report/stored_json.h"

#include <json/json.h>

#include <fstream>

#include "modules/core/whole_file.h"

namespace palpate::report {

std::optional<Json::Value> stored_json(const std::filesystem::path& file, const std::string& of) {
  std::ifstream stream(file);
  if (!stream) return std::nullopt;
  Json::CharReaderBuilder builder;
  builder["allowSpecialFloats"] = true;
  Json::Value json;
  std::string errors;
  if (!Json::parseFromStream(builder, stream, &json, &errors) || !json.isObject()) return {};
  return json["of"] == of ? std::optional(std::move(json)) : std::nullopt;
}

void store_json(const std::filesystem::path& file, const std::string& of, Json::Value result) {
  result["of"] = of;
  Json::StreamWriterBuilder builder;  // 17 digits: the same bits
  builder["useSpecialFloats"] = true;
  write_whole_file(file, Json::writeString(builder, result));
}

}  // namespace palpate::report
