// Reads a recording with npm's @mcap/core and @foxglove/omgidl-*: an independent judge.
// node read_mcap.mjs FILE NODE_MODULES  →  one line per channel and per decoded sample.
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";
import { join } from "node:path";

const [file, modules] = process.argv.slice(2);
const require = createRequire(join(modules, "x.js"));
const { McapStreamReader } = require("@mcap/core");
const { parseIDL } = require("@foxglove/omgidl-parser");
const { MessageReader } = require("@foxglove/omgidl-serialization");

const reader = new McapStreamReader({ validateCrcs: true });
reader.append(readFileSync(file));
const schemas = new Map();
const channels = new Map();
const readers = new Map();
for (let record; (record = reader.nextRecord()); ) {
  if (record.type === "Schema") schemas.set(record.id, record);
  if (record.type === "Channel" && !channels.has(record.id)) {
    channels.set(record.id, record);
    const schema = schemas.get(record.schemaId);
    const definitions = parseIDL(new TextDecoder().decode(schema.data));
    readers.set(record.id, new MessageReader(schema.name, definitions));
  }
  if (record.type === "Metadata") {
    console.log("metadata", record.name, record.metadata.get("session") ?? "");
  }
  if (record.type === "Message") {
    const { topic } = channels.get(record.channelId);
    const message = readers.get(record.channelId).readMessage(record.data);
    const text = JSON.stringify(message, (_, v) =>
      typeof v === "bigint" ? Number(v) : ArrayBuffer.isView(v) ? Array.from(v) : v);
    console.log("message", topic, record.sequence, String(record.logTime), text);
  }
  if (record.type === "Statistics") console.log("statistics", String(record.messageCount));
}
console.log(reader.done() ? "whole" : "torn");
