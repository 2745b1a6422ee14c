// Reads a recording with npm's @mcap/core and @foxglove/omgidl-*: an independent judge. Through its
// indexes, as Foxglove opens it: summary, chunk indexes, message indexes, compressed chunks.
// node read_mcap.mjs FILE NODE_MODULES  →  one line per metadata, attachment and decoded sample.
import { decoder, openMcap } from "./open_mcap.mjs";

const [file, modules] = process.argv.slice(2);
const reader = await openMcap(file, modules);
const decode = decoder(modules);
console.log("chunks", reader.chunkIndexes.length);
for await (const { name, metadata } of reader.readMetadata()) {
  console.log("metadata", name, metadata.get("session") ?? "");
}
for await (const { name, mediaType, data } of reader.readAttachments()) {
  console.log("attachment", name, mediaType, data.length);
}
let count = 0n;
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const channel = reader.channelsById.get(message.channelId);
  const decoded = decode(reader.schemasById.get(channel.schemaId), message);
  const text = JSON.stringify(decoded, (_, v) =>
    typeof v === "bigint" ? Number(v) : ArrayBuffer.isView(v) ? Array.from(v) : v);
  console.log("message", channel.topic, message.sequence, String(message.logTime), text);
  ++count;
}
console.log("statistics", String(reader.statistics.messageCount));
console.log(count === reader.statistics.messageCount ? "whole" : "torn");
