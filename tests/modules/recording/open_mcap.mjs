// Opens a recording as Foxglove does: npm's @mcap/core through the file's indexes, messages decoded
// by their own schemas (@foxglove/omgidl-*).
import { createRequire } from "node:module";
import { open } from "node:fs/promises";
import { join } from "node:path";

export const requireFrom = (modules) => createRequire(join(modules, "x.js"));

export async function openMcap(file, modules) {
  const require = requireFrom(modules);
  const { McapIndexedReader } = require("@mcap/core");
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
  return McapIndexedReader.Initialize({ readable, decompressHandlers });
}

// (channel, schema, message) → the message as a plain object.
export function decoder(modules) {
  const require = requireFrom(modules);
  const { parseIDL } = require("@foxglove/omgidl-parser");
  const { MessageReader } = require("@foxglove/omgidl-serialization");
  const readers = new Map();
  return (schema, message) => {
    if (!readers.has(schema.id)) {
      const definitions = parseIDL(new TextDecoder().decode(schema.data));
      readers.set(schema.id, new MessageReader(schema.name, definitions));
    }
    return readers.get(schema.id).readMessage(message.data);
  };
}
