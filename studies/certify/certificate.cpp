#include "studies/certify/certificate.h"

#include <json/json.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "modules/core/data_folder.h"
#include "modules/core/whole_file.h"
#include "modules/runtime/program.h"
#include "modules/scene/scene_reader.h"
#include "studies/certify/hands.h"
#include "studies/report/plot_script.h"

namespace palpate::certify {
namespace {

constexpr unsigned kDigits = 10;

constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{0}</title><style>
body {{ font: 15px/1.5 sans-serif; max-width: 70em; margin: 2em auto; padding: 0 1em; }}
table {{ border-collapse: collapse; width: 100%; margin: 0.5em 0 2em; }}
td, th {{ text-align: left; padding: 0.3em 0.7em; border-bottom: 1px solid #ddd; vertical-align: top; }}
td.number {{ text-align: right; white-space: nowrap; }}
small {{ color: #555; }} img {{ max-width: 100%; }}
.pass {{ background: #dcefdc; }} .fail {{ background: #f5c9c0; }} .open {{ background: #eee; }}
</style></head><body><h1>{0}</h1>
)";

Json::Value number(double value) {
  return std::isfinite(value) ? Json::Value(value) : Json::Value();
}

Json::Value point(const Vec3& p) {
  Json::Value list(Json::arrayValue);
  for (const double x : {p.x(), p.y(), p.z()}) list.append(x);
  return list;
}

Json::Value json_of(const Line& line) {
  Json::Value json;
  json["group"] = line.group;
  json["name"] = line.name;
  json["verdict"] = line.verdict == Verdict::kFail ? "fail" : word_of(line.verdict);
  json["note"] = line.note;
  if (line.verdict == Verdict::kNotMeasured) return json;
  json["value"] = number(line.value);
  json["limit"] = number(line.limit);
  json["sense"] = line.at_least ? "at least" : "at most";
  json["unit"] = line.unit;
  json["source"] = line.source;
  return json;
}

const char* verdict_of(const Certificate& certificate) {
  if (certificate.passed()) return "pass";
  return any_failed(certificate.lines) ? "fail" : "incomplete";
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else {
      result += c;
    }
  }
  return result;
}

std::string row_of(const Line& line) {
  const bool open = line.verdict == Verdict::kNotMeasured;
  const char* kind = open ? "open" : line.verdict == Verdict::kPass ? "pass" : "fail";
  const std::string value = open ? "" : fmt::format("{:.4g} {}", line.value, line.unit);
  const std::string limit =
      open ? "" : fmt::format("{} {:.4g} {}", line.at_least ? "≥" : "≤", line.limit, line.unit);
  return fmt::format(
      "<tr class=\"{}\"><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>"
      "<td>{}</td><td>{}<br><small>{}</small></td></tr>\n",
      kind, escaped(line.name), escaped(value), escaped(limit), word_of(line.verdict),
      escaped(line.source), escaped(line.note));
}

std::string facts(const Certificate& certificate, const Subject& subject) {
  const Vec3& at = subject.place.pose.position;
  std::string text = fmt::format(
      "<p><b>{}</b>{}. Scene {}, probe '{}', organ '{}', touched at ({:.4f}, {:.4f}, {:.4f}) m; "
      "presses of {:g} mm at {:g} mm/s; device damping {:g} N·s/m, t_d {:g} ms. {}.</p>\n",
      certificate.complete ? verdict_of(certificate) : std::string("incomplete: it was stopped"),
      certificate.scope.empty() ? "" : ", of a part: " + escaped(certificate.scope),
      escaped(subject.scene.name), escaped(subject.scene.probes[0].name),
      escaped(subject.scene.organs[subject.place.organ].name), at.x(), at.y(), at.z(),
      1e3 * subject.depth, 1e3 * subject.speed, subject.scene.haptics.device_damping,
      1e3 * delay_of(subject.device), escaped(runtime::version_text()));
  if (!certificate.machine.empty()) {
    text += fmt::format("<p>Times are of this machine: {}.</p>\n", escaped(certificate.machine));
  }
  return text;
}

std::vector<std::string> pictures_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("certify_") && name.ends_with(".png")) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

void write_json(const Certificate& certificate, const Subject& subject,
                const std::filesystem::path& folder) {
  Json::Value json;
  json["program"] = runtime::version_text();
  json["scene"] = subject.scene.name;
  json["scene_digest"] = scene::scene_digest(scene::load_scene(subject.scene.file));
  json["probe"] = subject.scene.probes[0].name;
  json["organ"] = subject.scene.organs[subject.place.organ].name;
  json["touch_m"] = point(subject.place.pose.position);
  json["into"] = point(subject.place.into);
  json["depth_m"] = subject.depth;
  json["speed_m_per_s"] = subject.speed;
  if (!certificate.machine.empty()) json["machine"] = certificate.machine;
  json["scope"] = certificate.scope.empty() ? "whole" : certificate.scope;
  json["complete"] = certificate.complete;
  json["verdict"] = verdict_of(certificate);
  json["lines"] = Json::Value(Json::arrayValue);
  for (const Line& line : certificate.lines) json["lines"].append(json_of(line));
  Json::StreamWriterBuilder style;
  style["indentation"] = "  ";
  style["precision"] = kDigits;
  style["emitUTF8"] = true;
  write_whole_file(folder / "certificate.json", Json::writeString(style, json) + "\n");
}

void draw_pictures(const std::vector<std::string>& tables, const std::filesystem::path& folder) {
  for (const auto& picture : pictures_in(folder)) std::filesystem::remove(folder / picture);
  if (!tables.empty()) report::draw_figures(data_file("plots/plot_certify.py"), folder, tables);
}

void write_page(const Certificate& certificate, const Subject& subject,
                const std::filesystem::path& folder) {
  std::string page = fmt::format(kHead, "Certificate of " + escaped(subject.scene.name));
  page += facts(certificate, subject);
  std::string group;
  for (const Line& line : certificate.lines) {
    if (line.group != group) {
      if (!group.empty()) page += "</table>\n";
      group = line.group;
      page += fmt::format(
          "<h2>{}</h2>\n<table><tr><th>what</th><th>measured</th><th>limit</th>"
          "<th></th><th>where the limit comes from</th></tr>\n",
          escaped(group));
    }
    page += row_of(line);
  }
  if (!group.empty()) page += "</table>\n";
  for (const auto& picture : pictures_in(folder)) {
    page += fmt::format("<p><img src=\"{0}\" alt=\"{0}\"></p>\n", picture);
  }
  write_whole_file(folder / "certificate.html", page + "</body></html>\n");
}

}  // namespace palpate::certify
