// Writes the built front end as a table for the program: node embed.mjs FOLDER OUT.cc (page/assets.h).
import { readFileSync, readdirSync, statSync, writeFileSync } from "node:fs";
import { extname, join } from "node:path";
import { gzipSync } from "node:zlib";

const [folder, out] = process.argv.slice(2);
const types = {
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript; charset=utf-8",
  ".css": "text/css; charset=utf-8",
  ".svg": "image/svg+xml",
  ".woff2": "font/woff2",
};

function filesIn(path) {
  return readdirSync(path).sort().flatMap((name) => {
    const file = join(path, name);
    return statSync(file).isDirectory() ? filesIn(file) : [file];
  });
}

let bytes = "", table = "";
filesIn(folder).forEach((file, index) => {
  const type = types[extname(file)];
  if (!type) return;
  const content = gzipSync(readFileSync(file), { level: 9 });
  const path = file === join(folder, "index.html") ? "/" : file.slice(folder.length);
  // One literal: a compiler reads it faster than a list of numbers.
  const literal = [...content].map((byte) => "\\" + byte.toString(8).padStart(3, "0")).join("");
  bytes += `constexpr char kBytes${index}[] = "${literal}";\n`;
  table += `    {"${path}", "${type}", {kBytes${index}, sizeof(kBytes${index}) - 1}, true},\n`;
});
writeFileSync(out, `#include "page/assets.h"

namespace hydroscope {
namespace {
${bytes}}  // namespace

std::span<const Asset> Assets() {
  static const Asset kAssets[] = {
${table}  };
  return kAssets;
}

}  // namespace hydroscope
`);
