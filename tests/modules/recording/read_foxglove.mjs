// Judges a recording that was translated for Foxglove: are its schemas those that Foxglove
// publishes (@foxglove/schemas), and do the translations hold the numbers of the samples beside
// them? Sample and translation have the same time in the file.
// node read_foxglove.mjs FILE NODE_MODULES  →  a line per schema, the counts of what was compared.
import { join } from "node:path";
import { decoder, openMcap, requireFrom } from "./open_mcap.mjs";

const [file, modules] = process.argv.slice(2);
const require = requireFrom(modules);
const { parseIDL } = require("@foxglove/omgidl-parser");
const published = require("@foxglove/schemas/internal");

// Fields of a published message as text, nested ones in place.
const words = { float64: "double", bytes: "sequence<octet>" };
function publishedFields(schema) {
  return schema.fields.map(({ name, type, array }) => {
    const nested = type.type === "nested" ? `{${publishedFields(type.schema)}}`
      : type.type === "enum" ? `<${type.enum.values.map((v) => v.name)}>`
      : words[type.name] ?? type.name;
    return `${name}:${array ? `[${nested}]` : nested}`;
  }).join();
}
// The same of the file's IDL.
const idlWords = { float64: "double", uint8: "octet", bool: "boolean" };
function idlFields(definitions, name) {
  const find = (n) => definitions.find((d) => d.name === n);
  return find(name).definitions.map((field) => {
    let nested = idlWords[field.type] ?? field.type;
    if (field.enumType) nested = `<${find(field.enumType).definitions.map((d) => d.name)}>`;
    else if (field.isComplex) nested = `{${idlFields(definitions, field.type)}}`;
    if (field.isArray && nested === "octet") return `${field.name}:sequence<octet>`;
    return `${field.name}:${field.isArray ? `[${nested}]` : nested}`;
  }).join();
}

const reader = await openMcap(file, modules);
for (const schema of reader.schemasById.values()) {
  if (!schema.name.startsWith("foxglove::")) continue;
  const own = idlFields(parseIDL(new TextDecoder().decode(schema.data)), schema.name);
  const known = publishedFields(published.foxgloveMessageSchemas[schema.name.split("::")[1]]);
  console.log("schema", schema.name, schema.encoding, own === known ? "as published" : `${own}\n${known}`);
}

const same = (a, b) => JSON.stringify(Array.from(a)) === JSON.stringify(Array.from(b));
const xyz = ({ x, y, z }) => [x, y, z];
const xyzw = ({ x, y, z, w }) => [x, y, z, w];
const pose = (position, rotation) => [...xyz(position), ...xyzw(rotation)];
const newest = new Map(); // samples, by topic and key
const counts = {};
const differ = new Set();
const judge = (topic, equal) => {
  counts[topic] = (counts[topic] ?? 0) + 1;
  if (!equal) differ.add(topic);
};
const decode = decoder(modules);
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const { topic, schemaId } = reader.channelsById.get(message.channelId);
  const decoded = decode(reader.schemasById.get(schemaId), message);
  if (!topic.startsWith("/")) {
    newest.set(`${topic} ${decoded.probe ?? decoded.organ}`, { decoded, time: message.logTime });
    continue;
  }
  const number = Number(/\d+/.exec(topic + (decoded.child_frame_id ?? ""))?.[0]);
  const of = (name) => newest.get(`${name} ${number}`);
  const on = (source) => source.time === message.logTime;
  const stamp = decoded.timestamp ?? decoded.entities[0].timestamp;
  judge("time", BigInt(stamp.sec) * 1_000_000_000n + BigInt(stamp.nsec) === message.logTime);
  if (topic === "/tf" || topic.endsWith("/pose")) {
    const { decoded: sample } = of("probe_state");
    const told = decoded.pose ? pose(decoded.pose.position, decoded.pose.orientation)
      : pose(decoded.translation, decoded.rotation);
    judge(topic, on(of("probe_state")) && same(told, [...sample.position_m, ...sample.rotation_xyzw]));
  } else if (topic.endsWith("/wrench")) {
    const { decoded: sample } = of("haptic_force");
    judge(topic, on(of("haptic_force")) && same(xyz(decoded.force_n), sample.force_n) &&
      same(xyz(decoded.torque_n_m), sample.torque_n_m) &&
      Math.abs(decoded.force_size_n - Math.hypot(...sample.force_n)) <= 1e-15 * (1 + decoded.force_size_n));
  } else if (topic.endsWith("/surface")) {
    const { decoded: nodes } = of("node_positions");
    const { decoded: surface } = of("surface");
    const [{ points, indices }] = decoded.entities[0].triangles;
    judge(topic, on(of("node_positions")) && same(indices, surface.triangle_nodes) &&
      same(points.flatMap(xyz), nodes.positions_m.slice(0, 3 * surface.surface_node_count)));
  } else if (topic.endsWith("/force")) {
    // The arrow's length, and its x turned by its pose, are the force's.
    const { decoded: { force_n: f } } = of("haptic_force");
    const size = Math.hypot(...f);
    const [arrow] = decoded.entities[0].arrows;
    if (arrow) {
      const { x, y, z, w } = arrow.pose.orientation;
      const along = [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)];
      const length = arrow.shaft_length + arrow.head_length;
      judge(topic, Math.abs(length - 0.01 * size) < 1e-12 &&
        along.every((part, i) => Math.abs(part - f[i] / size) < 1e-9));
    } else judge(`${topic} none`, 0.01 * size < 0.0005);
  } else judge(topic, true);
}
for (const topic of Object.keys(counts).sort()) {
  console.log(topic, counts[topic], differ.has(topic) ? "differ" : "equal");
}
