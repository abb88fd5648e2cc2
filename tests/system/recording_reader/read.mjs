// Reads a recording with the field's own reader and prints what it found, as JSON.
// SPDX-License-Identifier: Apache-2.0
//
// usage: node read.mjs FILE. The packages are those of package.json beside this file. Reads the file
// twice: from front to end as a stream, and by its index, with all checksums; decodes the first
// message of each channel by its schema in the file. Exit status 1 and a sentence if
// anything is wrong.
import { open, readFile } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import rosmsg from "@foxglove/rosmsg";
import serialization from "@foxglove/rosmsg-serialization";

function check(holds, sentence) {
  if (!holds) throw new Error(sentence);
}

// Numbers of 64 bits as decimal text, typed arrays as arrays.
function plain(key, value) {
  if (typeof value === "bigint") return value.toString();
  return ArrayBuffer.isView(value) ? Array.from(value) : value;
}

function decode(channel, schema, data) {
  if (channel.messageEncoding === "json") {
    check(schema.encoding === "jsonschema", `${channel.topic}: schema is ${schema.encoding}`);
    JSON.parse(new TextDecoder().decode(schema.data));
    return JSON.parse(new TextDecoder().decode(data));
  }
  check(
    channel.messageEncoding === "ros1" && schema.encoding === "ros1msg",
    `${channel.topic}: ${channel.messageEncoding} by ${schema.encoding}`,
  );
  const definition = rosmsg.parse(new TextDecoder().decode(schema.data));
  const reader = new serialization.MessageReader(definition);
  check(
    reader.readMessage(data) !== undefined,
    `${channel.topic}: the first message does not decode`,
  );
  return reader.readMessage(data);
}

// Front to end. Each chunk's checksum is validated by the reader, which throws.
async function readStream(path) {
  const reader = new McapStreamReader({ includeChunks: true, validateCrcs: true });
  reader.append(await readFile(path));
  const result = { chunks: 0, checked: 0, counts: {} };
  const topics = new Map();
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Channel") topics.set(record.id, record.topic);
    if (record.type === "Chunk") {
      ++result.chunks;
      if (record.uncompressedCrc !== 0) ++result.checked;
    }
    if (record.type === "Message") {
      const topic = topics.get(record.channelId);
      result.counts[topic] = (result.counts[topic] ?? 0) + 1;
    }
  }
  check(reader.done(), "the file has no end");
  return result;
}

async function readIndexed(path) {
  const file = await open(path);
  const readable = {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, size) => {
      const bytes = new Uint8Array(Number(size));
      const { bytesRead } = await file.read(bytes, 0, bytes.length, Number(offset));
      check(bytesRead === bytes.length, "the file is shorter than its index says");
      return bytes;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable });
  const result = {
    library: reader.header.library,
    chunk_indexes: reader.chunkIndexes.length,
    in_order: true,
    counts: {},
    statistics: {},
    channels: {},
    metadata: {},
  };
  for (const [id, count] of reader.statistics.channelMessageCounts)
    result.statistics[reader.channelsById.get(id).topic] = Number(count);
  for await (const record of reader.readMetadata())
    result.metadata[record.name] = Object.fromEntries(record.metadata);
  let before = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    if (message.logTime < before) result.in_order = false;
    before = message.logTime;
    if (!(channel.topic in result.counts)) {
      result.counts[channel.topic] = 0;
      result.channels[channel.topic] = {
        encoding: channel.messageEncoding,
        schema: schema.name,
        first_time_ns: message.logTime,
        first: decode(channel, schema, message.data),
      };
    }
    ++result.counts[channel.topic];
    if (channel.topic === '/tf' && !result.channels['/tf'].of_map)
      result.channels['/tf'].of_map = decode(channel, schema, message.data).transforms.find(
        (one) => one.child_frame_id === 'map',
      );
  }
  await file.close();
  return result;
}

try {
  const path = process.argv[2];
  const result = { stream: await readStream(path), indexed: await readIndexed(path) };
  process.stdout.write(`${JSON.stringify(result, plain)}\n`);
} catch (error) {
  process.stderr.write(`${error.message}\n`);
  process.exitCode = 1;
}
