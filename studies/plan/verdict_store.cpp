#include "studies/plan/verdict_store.h"

#include <json/json.h>
#include <spdlog/fmt/fmt.h>

#include "studies/report/stored_json.h"

namespace palpate::plan {
namespace {

/// Visits every number of a verdict with its name.
template <class Visit>
void visit_numbers(Verdict& v, const Visit& visit) {
  Errors& e = v.errors;
  visit("force", e.force);
  visit("surface", e.surface);
  visit("volume", e.volume);
  visit("force_bar", e.force_bar);
  visit("surface_bar", e.surface_bar);
  visit("stiffness", e.feel.stiffness);
  visit("uneven", e.feel.uneven);
  visit("moving", e.feel.moving);
  visit("sideways", e.feel.sideways);
  visit("deformation_load", v.deformation_load);
  visit("total_load", v.total_load);
}

}  // namespace

VerdictStore::VerdictStore(const std::filesystem::path& folder, std::string of, std::ostream& log)
    : stores_(!folder.empty()), files_(folder, log), of_(std::move(of)) {}

std::string VerdictStore::key(const std::string& organ, const Candidate& candidate) const {
  return fmt::format("plan-{:016x}",
                     std::hash<std::string>{}(of_ + "\n" + organ + "\n" + candidate.name()));
}

bool VerdictStore::read(const std::string& organ, const Candidate& candidate,
                        StoredVerdict& out) const {
  if (!stores_) return false;
  const auto stored = report::stored_json(files_, key(organ, candidate) + ".json", of_);
  if (!stored) return false;
  const Json::Value& json = *stored;
  out = {};
  out.verdict.candidate = candidate;
  visit_numbers(out.verdict,
                [&](const char* name, double& value) { value = json[name].asDouble(); });
  out.verdict.node_count = json["nodes"].asUInt64();
  for (const Json::Value& failure : json["misses"]) {
    out.verdict.failures.push_back(failure.asString());
  }
  out.verdict.is_cut = json["is_cut"].asBool();
  out.machine = json["machine"].asString();
  return true;
}

void VerdictStore::write(const std::string& organ, const StoredVerdict& stored) const {
  Verdict verdict = stored.verdict;
  Json::Value json;
  json["organ"] = organ;
  json["candidate"] = verdict.candidate.name();
  visit_numbers(verdict, [&](const char* name, double& value) { json[name] = value; });
  json["nodes"] = Json::UInt64(verdict.node_count);
  json["misses"] = Json::arrayValue;
  for (const std::string& failure : verdict.failures) json["misses"].append(failure);
  json["is_cut"] = verdict.is_cut;
  json["machine"] = stored.machine;
  report::store_json(files_, key(organ, verdict.candidate) + ".json", of_, std::move(json));
}

}  // namespace palpate::plan
