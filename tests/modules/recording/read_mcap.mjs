// Reads a recording with npm's @mcap/core and @foxglove/omgidl-*: an independent judge. Through its
// indexes, as Foxglove opens it: summary, chunk indexes, message indexes, compressed chunks.
// node read_mcap.mjs FILE NODE_MODULES  →  one line per metadata, attachment and decoded sample.
import { createRequire } from "node:module";
import { open } from "node:fs/promises";
import { join } from "node:path";

const [file, modules] = process.argv.slice(2);
const require = createRequire(join(modules, "x.js"));
const { McapIndexedReader } = require("@mcap/core");
const { parseIDL } = require("@foxglove/omgidl-parser");
const { MessageReader } = require("@foxglove/omgidl-serialization");
const { decompress } = require("fzstd");

const handle = await open(file, "r");
const { size } = await handle.stat();
const readable = {
  size: async () => BigInt(size),
  read: async (offset, length) => {
    const bytes = new Uint8Array(Number(length));
    await handle.read(bytes, 0, bytes.length, Number(offset));
    return bytes;
  },
};
const decompressHandlers = {
  zstd: (bytes, decompressedSize) => decompress(bytes, new Uint8Array(Number(decompressedSize))),
};
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
console.log("chunks", reader.chunkIndexes.length);
for await (const { name, metadata } of reader.readMetadata()) {
  console.log("metadata", name, metadata.get("session") ?? "");
}
for await (const { name, mediaType, data } of reader.readAttachments()) {
  console.log("attachment", name, mediaType, data.length);
}
const readers = new Map();
let count = 0n;
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (!readers.has(schema.id)) {
    const definitions = parseIDL(new TextDecoder().decode(schema.data));
    readers.set(schema.id, new MessageReader(schema.name, definitions));
  }
  const decoded = readers.get(schema.id).readMessage(message.data);
  const text = JSON.stringify(decoded, (_, v) =>
    typeof v === "bigint" ? Number(v) : ArrayBuffer.isView(v) ? Array.from(v) : v);
  console.log("message", channel.topic, message.sequence, String(message.logTime), text);
  ++count;
}
console.log("statistics", String(reader.statistics.messageCount));
console.log(count === reader.statistics.messageCount ? "whole" : "torn");
