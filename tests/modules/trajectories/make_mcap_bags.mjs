// Writes the bags that mcap_bag_test.cpp reads, as `ros2 bag record` does, with npm's MCAP writer (scripts/node_modules).
//
//     node make_mcap_bags.mjs FOLDER MODULES
import { createRequire } from "node:module";
import { writeFileSync } from "node:fs";

const [folder, modules] = process.argv.slice(2);
const require = createRequire(modules + "/");
const { McapWriter, TempBuffer } = require("@mcap/core");

const ROWS = 50;

/// CDR, little-endian: each number at a multiple of its size behind the encapsulation.
class Cdr {
  constructor() {
    this.view = new DataView(new ArrayBuffer(512));
    this.view.setUint8(1, 1);
    this.at = 4;
  }
  align(size) {
    this.at += (size - ((this.at - 4) % size)) % size;
  }
  four(value) {
    this.align(4);
    this.view.setUint32(this.at, value, true);
    this.at += 4;
    return this;
  }
  text(value) {
    this.four(value.length + 1);
    for (const c of value) this.view.setUint8(this.at++, c.charCodeAt(0));
    this.at += 1;
    return this;
  }
  doubles(...values) {
    for (const value of values) {
      this.align(8);
      this.view.setFloat64(this.at, value, true);
      this.at += 8;
    }
    return this;
  }
  bytes() {
    return new Uint8Array(this.view.buffer, 0, this.at);
  }
}

/// The first at 1700000000.995 s, a hundred a second.
function header(cdr, i) {
  const hundredths = 995 / 10 + i;
  return cdr.four(1700000000 + Math.floor(hundredths / 100)).four(Math.round((hundredths % 100) * 1e7));
}
const pose = (i) => header(new Cdr(), i).text("base").doubles(0.001 * i, -0.5, 0.25, 0.6, 0, 0, 0.8).bytes();
const transform = (i) =>
  header(new Cdr(), i).text("base").text("tool_tip").doubles(0.002 * i, -0.5, 0.25, 0, 0.6, 0, 0.8).bytes();
const twist = () => new Cdr().doubles(0, 0, 0, 0, 0, 0).bytes();

async function write(file, topics) {
  const buffer = new TempBuffer();
  const writer = new McapWriter({ writable: buffer, chunkSize: 4096 });
  await writer.start({ profile: "ros2", library: "make_mcap_bags" });
  const channels = [];
  for (const [topic, [type, make]] of Object.entries(topics)) {
    const schemaId = await writer.registerSchema({ name: `geometry_msgs/msg/${type}`, encoding: "ros2msg", data: new Uint8Array() });
    const id = await writer.registerChannel({ schemaId, topic, messageEncoding: "cdr", metadata: new Map() });
    channels.push([id, make]);
  }
  for (let i = 0; i < ROWS; ++i) {
    for (const [channelId, make] of channels) {
      const time = 1700000000995000000n + 10000000n * BigInt(i);
      await writer.addMessage({ channelId, sequence: i, logTime: time, publishTime: time, data: make(i) });
    }
  }
  await writer.end();
  writeFileSync(`${folder}/${file}`, buffer.get());
}

await write("one.mcap", { "/tool/pose": ["PoseStamped", pose], "/cmd_vel": ["Twist", twist] });
await write("topics.mcap", { "/tool/pose": ["PoseStamped", pose], "/tf_tip": ["TransformStamped", transform] });
