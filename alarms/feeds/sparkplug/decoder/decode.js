// Decodes MQTT messages of a file, one a line, "topic quality hex", with the npm package sparkplug-payload:
//   node decode.js messages.txt     prints one JSON object a line: {"topic", "quality", "payload"}
const fs = require('fs');
const sparkplug = require('sparkplug-payload').get('spBv1.0');

/// Whole numbers beyond 32 bits arrive as objects of the package `long`.
const plain = (key, value) =>
  value && typeof value === 'object' && 'low' in value && 'high' in value
    ? value.high * 4294967296 + (value.low >>> 0)
    : value;

for (const line of fs.readFileSync(process.argv[2], 'utf8').split('\n')) {
  if (line === '') continue;
  const [topic, quality, hex] = line.split(' ');
  const payload = sparkplug.decodePayload(Buffer.from(hex, 'hex'));
  console.log(JSON.stringify({ topic, quality: Number(quality), payload }, plain));
}
